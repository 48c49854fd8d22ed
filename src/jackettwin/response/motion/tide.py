r"""Effect of the sea level on frequencies: the slope ∂f/∂level of every mode, from the model.

The added mass and the water inside flooded members end at the free surface. With unit modal mass φᵀMφ = 1,

.. math:: \frac{∂f}{∂η} = -\tfrac{f}{2}\, φ^T \frac{∂M}{∂η} φ

where ∂M/∂η is the change of mass per metre of water level
(``jackettwin.loads.members.water.mass_per_level``). Marine growth is fixed to the steel and does not change
with the tide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.response.system import Matrix


@dataclass(frozen=True)
class TideSlopes:
    """Slopes of the modes' frequencies at a sea level.

    Attributes
    ----------
    frequency_hz : (n_modes,) natural frequencies
    slope_hz_m : (n_modes,) ∂f/∂level [Hz/m], negative or zero
    """

    frequency_hz: FloatArray
    slope_hz_m: FloatArray

    @property
    def relative(self) -> FloatArray:
        """∂ ln f/∂level [1/m]."""
        return np.asarray(self.slope_hz_m / self.frequency_hz)


def tide_slopes(frequency_hz: FloatArray, shapes: FloatArray, mass: Matrix, mass_per_m: Matrix) -> TideSlopes:
    """Return the slopes of undamped modes with shapes (n_dof, n_modes) of any size.

    For damped modes the formula has an error of order ζ: dashpots that cause ζ = 10 % change it by up to a
    sixth.

    Parameters
    ----------
    mass : (n_dof, n_dof) total mass at the level
    mass_per_m : (n_dof, n_dof) ∂M/∂level

    Raises
    ------
    InputError
        If shapes and frequencies differ in number.
    """
    if shapes.shape[1] != np.size(frequency_hz):
        raise InputError(
            "shapes and frequencies differ in number",
            field="shapes",
            value=int(shapes.shape[1]),
            allowed=str(np.size(frequency_hz)),
        )
    f = np.asarray(frequency_hz, dtype=np.float64)
    modal, change = (np.einsum("ij,ij->j", shapes, matrix @ shapes) for matrix in (mass, mass_per_m))
    return TideSlopes(f, np.asarray(-0.5 * f * change / modal))
