r"""Skewed wake: more induction where the blade points downwind, less where it points upwind.

.. math:: w(ψ) = w \left(1 + \frac{15π}{32} \tan\frac{χ}{2} \frac{r}{R} \cos(ψ - ψ_0)\right), \quad
          χ = (1 + 0.6 a) χ_0

with χ₀ the angle between the shaft and the wind that the disc sees, and ψ₀ the azimuth towards which its
component in the disc blows (Pitt & Peters 1981, Vertica 5:21; the wake's angle after Burton et al., Wind
Energy Handbook, eq. (3.107)). The disc's wind includes the motion of the tower top: that alone turns the
wake, without lag, as in AeroDyn.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray

_GRADIENT = 15.0 * np.pi / 32.0
_SMALL = 1e-12
"""Skew below any that changes a load; it keeps a wake without skew from having no direction."""


def redistributed(
    induced: FloatArray, axial: FloatArray, skew: FloatArray, *, pointing: FloatArray, share: FloatArray
) -> FloatArray:
    """Return the induced velocities (..., 2) of a skewed wake, the axial one changed.

    Parameters
    ----------
    induced : (places, n, 2)
        Axial and tangential induced velocity without skew [m/s].
    axial : (places, n)
        Wind normal to the blade [m/s].
    skew : (2,)
        Wind in the disc's plane over that along the shaft.
    pointing : (places, 2)
        Direction of the blade in the same axes.
    share : (n,)
        r/R.
    """
    size = float(np.hypot(*skew)) + _SMALL
    angle = (1.0 + 0.6 * induced[..., 0] / axial) * np.arctan(size)
    change = _GRADIENT * np.tan(0.5 * angle) * share * (pointing @ skew / size)[:, None]
    out = induced.copy()
    out[..., 0] *= 1.0 + change
    return out
