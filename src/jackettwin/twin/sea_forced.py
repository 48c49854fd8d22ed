r"""Peaks that the sea makes between a structure's modes, told by the shape in which the sea forces it.

A force p at still water moves the sensors by

.. math:: y(\omega) = \sum_i \frac{\phi_i\,(\phi_i^T p)}{\omega_i^2 (1 + i\eta) - \omega^2}.

Waves of few directions press on all legs at once where their length fits the distance of the legs: the force
has peaks, and so has the motion, as narrow as those of modes. Their shape is y's, not that of any mode. That
of a bending blade is another: it pulls at the tower's top.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification import ModalEstimate
from jackettwin.structure import Assembly
from jackettwin.updating import Feet

LOSS = 0.02
"""Loss factor η of every mode: it only keeps a force at a mode's own frequency finite."""


def sea_share(
    modes: tuple[ModalEstimate, ...], assembly: Assembly, at: sp.csr_array, feet: Feet
) -> FloatArray:
    """Return the share of each measured shape that horizontal forces of the sea make, (n_modes,).

    Parameters
    ----------
    at : (n_channels, n_dof) what the channels see of every motion
    feet : Feet
        With the modes that the response is made of.
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
    """Return unit forces along x and y on all that crosses still water, (n_dof, 2); None if nothing does."""
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
