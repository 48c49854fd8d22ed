"""Assignment of measured modes to modes of the model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import scipy.linalg as la
from scipy.optimize import linear_sum_assignment

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.identification import ModalEstimate, mac
from jackettwin.response import near_degenerate

Verdict = Literal["paired", "shape", "frequency", "taken"]

FREQUENCY_WIDTH = 0.15
"""Standard deviation of ln f of a measured mode about the model's."""
MIXING = 0.06
"""Modes closer than this (relative) mix in a measured shape, since their half-power bands 2ζf overlap."""
LEAST_MAC = 0.8
"""Smallest MAC of a pair: correct pairs of OpenFAST records have 0.87 or more, false ones (another direction,
a blade mode) 0.73 or less."""
BELIEVED = 0.05
"""Difference of ln f up to which a doubtful estimate is paired: three times the error that drawings leave.
Beside a mode there are shoulders of its shape, doubted by their records, which a fit would take for it."""
LEAST_VISIBLE = 0.1
"""Smallest motion at the sensors relative to that of the most visible mode for a mode to be measurable."""


@dataclass(frozen=True)
class Counterpart:
    """The mode of the model that is most similar to a measured one.

    Attributes
    ----------
    mode : int
        Index of the model's mode, from 0.
    frequency_hz : float
        Its frequency.
    difference : float
        Ratio of the measured frequency to the model's, minus one.
    mac : float
        Share of the measured shape in the model's (or in the plane of its close pair).
    verdict : {"paired", "shape", "frequency", "taken"}
        Paired, or why not: another shape, another frequency, or another measured mode is more similar to it.
    """

    mode: int
    frequency_hz: float
    difference: float
    mac: float
    verdict: Verdict


def pair(
    estimates: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: ComplexArray | FloatArray
) -> dict[int, tuple[int, float]]:
    """Return {model mode (from 0): (index of the estimate, subspace MAC)}.

    Two bending modes a few per cent apart mix in a measured shape, the more the weaker one is excited. Close
    model modes that are visible to the sensors are therefore compared as a subspace; its MAC is the share of
    the measured shape within it (the MAC for a single mode). The score is this MAC times a Gaussian in ln f,
    plus a small share of the single MAC to distinguish modes of a subspace. The assignment maximises the sum
    of scores, so that two measured modes never share a model mode.

    Parameters
    ----------
    estimates : measured modes
    frequency_hz : (n_modes,) frequencies of the model, in any order; NaN for a mode that cannot be compared
    shapes : (n_channels, n_modes) mass-normalised shapes at the sensors, in the channels' order
    """
    return {one.mode: (i, one.mac) for i, one in _paired(estimates, frequency_hz, shapes).items()}


def pairing_score(
    estimates: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: ComplexArray | FloatArray
) -> float:
    """Return the similarity of measured modes to a model: the score of ``pair`` summed over the pairs."""
    found = _paired(estimates, frequency_hz, shapes)
    return float(sum(h.mac * _nearness(np.log1p(h.difference)) for h in found.values()))


def counterparts(
    estimates: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: ComplexArray | FloatArray
) -> tuple[Counterpart, ...]:
    """Return for each measured mode its counterpart, or the most similar mode and why it is not paired.

    Parameters
    ----------
    estimates, frequency_hz, shapes
        As in ``pair``.
    """
    if not estimates or not np.isfinite(frequency_hz).any():
        return ()
    visible, _, subspace_mac, apart = _compared(estimates, frequency_hz, shapes)
    paired = _paired(estimates, frequency_hz, shapes)
    # in logarithms, since the Gaussian of distant frequencies would underflow
    likely = np.log(np.maximum(subspace_mac, 1e-12)) - 0.5 * (apart / FREQUENCY_WIDTH) ** 2
    found = []
    for i, k in enumerate(np.argmax(likely, axis=1)):
        far, unlike = abs(apart[i, k]) > _reach(estimates[i]), subspace_mac[i, k] < LEAST_MAC
        verdict: Verdict = "shape" if unlike else "frequency" if far else "taken"
        mode, share = int(visible[k]), float(subspace_mac[i, k])
        other = Counterpart(mode, float(frequency_hz[mode]), float(np.expm1(apart[i, k])), share, verdict)
        found.append(paired.get(i, other))
    return tuple(found)


def _paired(
    estimates: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: ComplexArray | FloatArray
) -> dict[int, Counterpart]:
    """Return the counterpart of each measured mode that has one, by index."""
    if not estimates or not np.isfinite(frequency_hz).any():
        return {}
    visible, single, subspace_mac, apart = _compared(estimates, frequency_hz, shapes)
    rows, columns = linear_sum_assignment(-(subspace_mac + 0.1 * single) * _nearness(apart))
    return {
        int(i): Counterpart(
            int(visible[k]),
            float(frequency_hz[visible[k]]),
            float(np.expm1(apart[i, k])),
            float(subspace_mac[i, k]),
            "paired",
        )
        for i, k in zip(rows, columns, strict=True)
        if subspace_mac[i, k] >= LEAST_MAC and abs(apart[i, k]) <= _reach(estimates[i])
    }


def _reach(estimate: ModalEstimate) -> float:
    """Return the largest difference of ln f over which a measured mode is paired."""
    return BELIEVED if estimate.status == "doubtful" else 2.0 * FREQUENCY_WIDTH


def _nearness(apart: Any) -> Any:
    return np.exp(-0.5 * (apart / FREQUENCY_WIDTH) ** 2)


def subspace_mac_nearby(
    estimates: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: ComplexArray | FloatArray
) -> FloatArray:
    """Return for each measured mode its largest subspace MAC with model modes near it; 0 if none is near.

    Parameters
    ----------
    estimates, frequency_hz, shapes
        As in ``pair``.
    """
    _, _, subspace_mac, apart = _compared(estimates, frequency_hz, shapes)
    best: FloatArray = np.where(np.abs(apart) <= 2.0 * FREQUENCY_WIDTH, subspace_mac, 0.0).max(axis=1)
    return best


def _compared(
    estimates: tuple[ModalEstimate, ...], frequency_hz: FloatArray, shapes: ComplexArray | FloatArray
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Return the visible modes by frequency; per estimate and visible mode, MAC, subspace MAC and Δ ln f."""
    measured = np.array([e.mode_shape / np.linalg.norm(e.mode_shape) for e in estimates])
    size = np.where(np.isfinite(frequency_hz), np.linalg.norm(shapes, axis=0), 0.0)
    visible = np.flatnonzero(size >= LEAST_VISIBLE * size.max())
    visible = visible[np.argsort(frequency_hz[visible], kind="stable")]
    single = np.array([[mac(x, shape) for shape in shapes[:, visible].T] for x in measured])
    subspace_mac = np.empty_like(single)
    for group in near_degenerate(frequency_hz[visible], MIXING):
        basis = la.orth(shapes[:, visible[group]])
        subspace_mac[:, group] = (np.abs(measured.conj() @ basis) ** 2).sum(axis=1)[:, None]
    apart = np.log(np.array([e.frequency_hz for e in estimates])[:, None] / frequency_hz[visible])
    return visible, single, subspace_mac, apart
