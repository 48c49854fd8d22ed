"""Which measured mode is which mode of the model."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.linalg as la
from scipy.optimize import linear_sum_assignment

from jackettwin.identification import ModalEstimate, mac
from jackettwin.response.mode_tracking import near_degenerate

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

FREQUENCY_WIDTH = 0.15
"""How far (standard deviation of ln f) a measured mode may lie from the pinned model's."""
MIXING = 0.06
"""Modes closer than this (relative) mix in a measured shape: half-power bands, 2ζf, of 1 to 3 % overlap."""
LEAST_MAC = 0.8
"""A shape less like the model's is no match: true pairs of OpenFAST records reach 0.87 and more,
false ones (another direction, a blade mode) 0.73 and less."""
LEAST_VISIBLE = 0.1
"""A mode that moves the sensors less than this share of the most visible one cannot have been measured."""


def pair(
    estimates: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: ComplexArray | FloatArray
) -> dict[int, tuple[int, float]]:
    """Return {model mode (from 0): (index of the estimate, subspace MAC)}.

    Two bending modes a few percent apart mix in any measured shape, the more the weaker one is excited, so
    close model modes that the sensors see are compared as a subspace: its MAC is the share of the measured
    shape that lies in it (the MAC if it is one mode).
    The score is this times a Gaussian of ln f, with a little of the single MAC to say which is which; the
    assignment maximises its sum, so that two measured modes never share a model mode.

    Parameters
    ----------
    estimates : measured modes
    frequency_hz : (n_modes,) of the model, ascending
    shapes : (n_channels, n_modes) mass-normalised, at the sensors, in the channels' order
    """
    if not estimates or not frequency_hz.size:
        return {}
    visible, single, subspace_mac, apart = _compared(estimates, frequency_hz, shapes)
    score = (subspace_mac + 0.1 * single) * np.exp(-0.5 * (apart / FREQUENCY_WIDTH) ** 2)
    rows, columns = linear_sum_assignment(-score)
    return {
        int(visible[column]): (int(row), float(subspace_mac[row, column]))
        for row, column in zip(rows, columns, strict=True)
        if subspace_mac[row, column] >= LEAST_MAC and abs(apart[row, column]) <= 2.0 * FREQUENCY_WIDTH
    }


def subspace_mac_nearby(
    estimates: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: ComplexArray | FloatArray
) -> FloatArray:
    """Return for each measured mode its best subspace MAC with modes of the model near it; 0 if none is near.

    Parameters
    ----------
    estimates, frequency_hz, shapes
        As those of ``pair``.
    """
    _, _, subspace_mac, apart = _compared(estimates, frequency_hz, shapes)
    best: FloatArray = np.where(np.abs(apart) <= 2.0 * FREQUENCY_WIDTH, subspace_mac, 0.0).max(axis=1)
    return best


def _compared(
    estimates: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: ComplexArray | FloatArray
) -> tuple[npt.NDArray[np.intp], FloatArray, FloatArray, FloatArray]:
    """Return the visible modes of the model and, per estimate and visible mode, MAC, subspace MAC, Δ ln f."""
    measured = np.array([e.mode_shape / np.linalg.norm(e.mode_shape) for e in estimates])
    size = np.linalg.norm(shapes, axis=0)
    visible = np.flatnonzero(size >= LEAST_VISIBLE * size.max())
    single = np.array([[mac(x, shape) for shape in shapes[:, visible].T] for x in measured])
    subspace_mac = np.empty_like(single)
    for group in near_degenerate(frequency_hz[visible], MIXING):
        basis = la.orth(shapes[:, visible[group]])
        subspace_mac[:, group] = (np.abs(measured.conj() @ basis) ** 2).sum(axis=1)[:, None]
    apart = np.log(np.array([e.frequency_hz for e in estimates])[:, None] / frequency_hz[visible])
    return visible, single, subspace_mac, apart
