"""Rejection by the model of identified modes that resemble none of its modes or are forced by the sea."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.findings import Finding
from jackettwin.identification import Identification, ModalEstimate
from jackettwin.identification.status import ModeStatus

if TYPE_CHECKING:
    from jackettwin.structure import Assembly
    from jackettwin.updating import Counterpart, Feet

BELOW = 0.8
"""Share of the lowest recognised frequency below which no other mode can have its shape."""
THE_SEAS = 0.95
"""Share of a shape from which the sea is its cause. On simulated jackets peaks of waves have 0.967 to 1,
modes of bending blades at most 0.91."""


def unlike_model(
    found: Identification, held: Sequence[Counterpart], sea: Sequence[float] | FloatArray
) -> Identification:
    """Return the identification with doubt on modes unlike the model's, and on shapes forced by the sea.

    Waves and the rotor cause peaks between the modes, which subspace methods identify as modes. A peak
    without the shape of wave response is not doubted if the refinement confirmed it, since a model may lack
    modes, as of blades. Below its lowest mode a structure responds to forces in the shape of that mode, so
    that a second peak with this shape, however narrow, is due to the forces.

    Parameters
    ----------
    sea : (n_modes,)
        Share of each shape that forces of the sea explain, by :func:`sea_share`.
    """
    seen = [m.frequency_hz for m, one in zip(found.modes, held, strict=True) if one.verdict == "paired"]
    if not seen:
        return found  # no mode is recognised: the model gives no evidence on the others
    modes = []
    for mode, one, share in zip(found.modes, held, sea, strict=True):
        if one.verdict != "paired" and mode.method != "decay" and share >= THE_SEAS:
            mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("sea_forced", params={"share": float(share)}))
        elif one.verdict == "shape" and mode.unrefined is None and mode.method != "decay":
            mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("unlike_model", params={"mac": one.mac}))
        elif one.verdict in ("frequency", "taken") and mode.frequency_hz < BELOW * min(seen):
            mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("below_model", params={"mac": one.mac}))
        modes.append(mode)
    return replace(found, modes=tuple(modes))


LOSS = 0.02
"""Loss factor η of every mode, which only keeps the response at a natural frequency finite."""


def sea_share(
    modes: tuple[ModalEstimate, ...], assembly: Assembly, at: sp.csr_array, feet: Feet
) -> FloatArray:
    r"""Return the share of each measured shape that horizontal forces of the sea explain, (n_modes,).

    A force p at still water level displaces the sensors by

    .. math:: y(\omega) = \sum_i \frac{\phi_i\,(\phi_i^T p)}{\omega_i^2 (1 + i\eta) - \omega^2}.

    Waves from few directions load all legs in phase at lengths that match the distance of the legs, so that
    the force and the motion have peaks as narrow as those of modes. Their shape is that of y and of no mode.
    The shape due to a bending blade differs, for its force acts on the tower's top.

    Parameters
    ----------
    at : (n_channels, n_dof) observation matrix of the channels
    feet : Feet
        With the modes of the sum.
    """
    force = _still_water(assembly)
    known = np.isfinite(feet.frequency_hz)
    if force is None or not known.any():
        return np.zeros(len(modes))
    shapes, omega2 = feet.shapes[:, known], (2.0 * np.pi * feet.frequency_hz[known]) ** 2
    seen, pressed = at @ shapes, shapes.T @ force
    return np.array([_share(m, seen, pressed, omega2) for m in modes])


def _share(mode: ModalEstimate, seen: FloatArray, pressed: FloatArray, omega2: FloatArray) -> float:
    gain = 1.0 / (omega2 * (1.0 + 1j * LOSS) - (2.0 * np.pi * mode.frequency_hz) ** 2)
    basis: ComplexArray = np.linalg.qr(seen @ (gain[:, None] * pressed))[0]
    shape = mode.mode_shape / np.linalg.norm(mode.mode_shape)
    return float(np.sum(np.abs(basis.conj().T @ shape) ** 2))


def _still_water(assembly: Assembly) -> FloatArray | None:
    """Return unit forces along x and y on members that cross still water, (n_dof, 2); None without any."""
    mesh = assembly.mesh
    z = mesh.coordinates[:, 2] - assembly.structure.sea_level_z_m
    crossing = np.flatnonzero((z[mesh.start] < 0.0) != (z[mesh.end] < 0.0))
    if not len(crossing):
        return None
    a, b = mesh.start[crossing], mesh.end[crossing]
    up = z[a] / (z[a] - z[b])
    weights = np.zeros((6 * len(z), 2))
    for axis in (0, 1):
        np.add.at(weights[:, axis], 6 * a + axis, (1.0 - up) / len(a))
        np.add.at(weights[:, axis], 6 * b + axis, up / len(a))
    return np.asarray(assembly.expand.T @ weights)
