r"""Maximum-likelihood estimates of the modes that a subspace method found.

Two small-sample biases are corrected: b, the bias of ln ζ due to the curvature of the model
(``accuracy.curvature_bias``), and that of ζ given an error of ln ζ that is nearly Gaussian with standard
deviation σ: :math:`\hat\zeta = \zeta\,e^{-b}/(1+\sigma^2/2)`. The Fisher information is asymptotic: with few
lines the scatter is larger, so that :math:`\sigma^2(1+\sigma^2)` is reported as variance.
Intervals of a single mode then cover 94 to 95 % down to 2πζfT = 6; without this factor, 93 to 95 %.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, Int64Array
from jackettwin.identification.maximum_likelihood import accuracy, likelihood
from jackettwin.identification.maximum_likelihood.admission import (
    PARAMETERS_OF_A_MODE,
    STEPS_BEFORE_ADMISSION,
    admit_modes,
    drop_unneeded_modes,
    required_gain,
)
from jackettwin.identification.maximum_likelihood.background import with_background
from jackettwin.identification.maximum_likelihood.band_fit import BandFit
from jackettwin.identification.maximum_likelihood.periodogram import periodogram

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.maximum_likelihood.parameters import Parameters
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram


FIRST_STEPS, FIRST_LIMIT = 2, 5.0
"""Steps of a fit of the whole band after which it is abandoned if its lack of fit exceeds the accepted one by
this factor. Fits of random systems that were finally accepted had at most 3.0 times the accepted one; of
OpenFAST records, which are never accepted, 4.2 to 19 times."""
EARLY_LIMIT = 3.5
"""A fit is abandoned before admission if its lack of fit exceeds the accepted one by this factor."""
SLOW_LIMIT, SLOW_SHARE = 2.0, 0.5
"""A fit is also abandoned before admission if its lack of fit exceeds the accepted one by the first factor
and is still above the second, a share of its initial value. Of a hundred fits that were finally accepted,
none had more than 2.6 times the accepted lack of fit at this point, and those above 2.0 had fallen below 0.4
of their initial value."""
ADMISSION_LIMIT = 3.0
"""A fit is abandoned after admission if its lack of fit exceeds the accepted one by this factor."""
TRIAL_STEPS = 12
"""Number of scoring steps after admission, after which ``TRIAL_LIMIT`` applies."""
TRIAL_LIMIT = 1.5
"""A fit is abandoned after the trial steps if its lack of fit exceeds the accepted one by this factor."""
MAX_STEPS, MIN_STEPS = 30, 8
"""Most and fewest steps after the trial; fits that converge usually take eight to twenty."""
MOST_LEFT = 20.0
"""A fit so costly that only the fewest steps are left is abandoned if more log-likelihood is to be gained;
fits that converge have at most 12 left after the trial."""
MAX_WORK = 4e9
"""Most products in these steps; fits that need more rarely converge."""
MAX_STEP_WORK = 2e9
"""A fit with more products than this in one step is not tried: it costs more than the rest of an
identification. Of seven hundred accepted fits none needed more than half as many."""
MAX_BIAS = 0.5
"""Largest bias corrected, in standard deviations; beyond it a second-order expansion is not valid."""


@dataclass(frozen=True)
class NarrowBand:
    """Assumptions of the fit of a narrow band about the rest of the spectrum.

    Attributes
    ----------
    dither_share : float
        Share of the local median spectrum added to model and data.
    frequency_hz, damping_ratio : (n_outside,)
        Modes outside the band; these values are fixed.
    shapes : (n_outside, n_channels)
        Real initial values of their shapes, which are fitted.
    """

    dither_share: float
    frequency_hz: FloatArray
    damping_ratio: FloatArray
    shapes: FloatArray


def refine(
    y: FloatArray,
    sample_rate_hz: float,
    band_hz: tuple[float, float],
    *,
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    shapes: FloatArray,
    sure: BoolArray,
    derivatives: Sequence[int],
    avoid_hz: Sequence[tuple[float, float]] = (),
    background: bool = False,
    narrow: NarrowBand | None = None,
    max_lack_of_fit: float = np.inf,
) -> BandFit:
    """Fit the sure candidates together and admit the doubtful ones that are needed.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean, of comparable size; NaN marks a missing sample.
    frequency_hz, damping_ratio : (n_candidates,)
    shapes : (n_candidates, n_channels)
        Real, in the scaling of y.
    sure : (n_candidates,) bool
        At least one.
    derivatives : (n_channels,) int
        Number of time derivatives from a channel's quantity to acceleration.
    avoid_hz : sequence of (low, high)
        Ranges left out of the fit.
    background : bool
        Whether background shapes are fitted too: the quasi-static response of modes above the band, or to
        waves below it.
    narrow : NarrowBand, optional
        Given if the band contains only some of the modes; their shapes may then have a phase lag.
    max_lack_of_fit : float
        Largest accepted lack of fit. A fit above it is returned without removing modes; a fit far above it is
        abandoned and returned without modes.
    """
    data = periodogram(
        y,
        sample_rate_hz,
        band_hz,
        modes=(frequency_hz, damping_ratio),
        derivatives=derivatives,
        avoid_hz=avoid_hz,
        dither_share=None if narrow is None else narrow.dither_share,
    )
    unit = shapes / np.linalg.norm(shapes, axis=1, keepdims=True)
    chosen = np.flatnonzero(sure)
    sought = (frequency_hz[chosen], damping_ratio[chosen], unit[chosen])
    first = likelihood.start(data, *sought) if narrow is None else _start_narrow(narrow, data, *sought)
    if background:
        first = with_background(data, first)
    if _step_work(data, first) > MAX_STEP_WORK:
        return _abandoned(np.full(len(sure), np.inf), unit.shape[1], np.inf)
    optimum = likelihood.maximise(data, first, FIRST_STEPS)
    if narrow is None and accuracy.lack_of_fit(data, optimum.parameters) > FIRST_LIMIT * max_lack_of_fit:
        return _abandoned(np.full(len(sure), np.inf), unit.shape[1], FIRST_LIMIT * max_lack_of_fit)
    optimum = _further(data, optimum, STEPS_BEFORE_ADMISSION - FIRST_STEPS)
    lack = accuracy.lack_of_fit(data, optimum.parameters)
    if narrow is None and _abandon_early(lack, accuracy.lack_of_fit(data, first), max_lack_of_fit):
        return _abandoned(np.full(len(sure), np.inf), unit.shape[1], lack)
    least = PARAMETERS_OF_A_MODE + unit.shape[1] if narrow is None else required_gain(data)
    optimum, chosen, gain = admit_modes(data, optimum, chosen, frequency_hz, damping_ratio, unit, least)
    lack = accuracy.lack_of_fit(data, optimum.parameters)
    if narrow is None and lack > ADMISSION_LIMIT * max_lack_of_fit:
        return _abandoned(gain, unit.shape[1], lack)
    optimum = _further(data, optimum, TRIAL_STEPS)
    lack = accuracy.lack_of_fit(data, optimum.parameters)
    if lack > TRIAL_LIMIT * max_lack_of_fit:
        return _abandoned(gain, unit.shape[1], lack)
    if not optimum.converged:
        most = _steps(data, optimum.parameters)
        if most == MIN_STEPS and optimum.expected_gain > MOST_LEFT:
            return _abandoned(gain, unit.shape[1], lack)
        optimum = _further(data, optimum, most)
        lack = accuracy.lack_of_fit(data, optimum.parameters)
    known = accuracy.accuracy_of(data, optimum.parameters)
    if optimum.converged and lack <= max_lack_of_fit:
        optimum, chosen, known = drop_unneeded_modes(data, optimum, chosen, known)
    return _result(data, optimum, chosen, gain, known)


def _further(data: Periodogram, optimum: likelihood.Optimum, most: int) -> likelihood.Optimum:
    """Continue an optimisation by at most so many steps."""
    if optimum.converged:
        return optimum
    return likelihood.maximise(data, optimum.parameters, most, ridge=optimum.ridge)


def _abandon_early(lack: float, at_first: float, most: float) -> bool:
    """Tell whether a fit of the whole band is unlikely to be accepted, judged after its first steps."""
    stuck = lack > SLOW_LIMIT * most and lack > SLOW_SHARE * at_first
    return stuck or lack > EARLY_LIMIT * most


def _steps(data: Periodogram, p: Parameters) -> int:
    """Return how many more steps a fit may take, given the work per step."""
    return int(np.clip(MAX_WORK / _step_work(data, p), MIN_STEPS, MAX_STEPS))


def _step_work(data: Periodogram, p: Parameters) -> int:
    """Return the number of products in one step of a fit."""
    return int(p.vector.size**2 * p.shapes.shape[1] ** 2 * len(data.omega))


def _start_narrow(
    narrow: NarrowBand, data: Periodogram, f: FloatArray, zeta: FloatArray, unit: FloatArray
) -> Parameters:
    """Return the starting point for the modes of a narrow band and those just outside it."""
    first = likelihood.start(
        data,
        np.append(narrow.frequency_hz, f),
        np.append(narrow.damping_ratio, zeta),
        np.vstack([narrow.shapes, unit]),
        len(narrow.shapes),
    )
    # the phase of a single channel cannot be told from the phase of the mode
    return replace(first, lag=np.zeros_like(unit)) if unit.shape[1] > 1 else first


def _result(
    data: Periodogram,
    optimum: likelihood.Optimum,
    chosen: Int64Array,
    gain: FloatArray,
    known: accuracy.Accuracy,
) -> BandFit:
    p = optimum.parameters
    n, n_channels = p.shapes.shape
    covariance = known.covariance
    mode = np.arange(p.n_fixed, n)
    mode = mode[np.argsort(p.log_f[mode])]
    both = np.stack([mode, mode + n], axis=1)
    shape = 3 * n + mode[:, None] * n_channels + np.arange(n_channels)
    log_covariance = covariance[both[:, :, None], both[:, None, :]]
    bias, excess = np.zeros((len(mode), 2)), np.zeros(len(mode))
    # a background absorbs part of the peaks and with it the small-sample bias, so none is corrected
    if not p.background:
        excess = log_covariance[:, 1, 1]
        most = MAX_BIAS * np.sqrt(np.diagonal(log_covariance, axis1=1, axis2=2))
        bias = np.clip(accuracy.curvature_bias(data, p, known)[both], -most, most)
    wider = np.stack([np.ones(len(mode)), np.sqrt(1.0 + excess)], axis=1)
    return BandFit(
        candidate=chosen[mode - p.n_fixed],
        frequency_hz=np.exp(p.log_f[mode] - bias[:, 0]),
        damping_ratio=np.exp(p.log_zeta[mode] - bias[:, 1]) / (1.0 + 0.5 * excess),
        shapes=p.shapes[mode],
        covariance=log_covariance * wider[:, :, None] * wider[:, None, :],
        shape_covariance=covariance[shape[:, :, None], shape[:, None, :]],
        cramer_rao=known.cramer_rao[both],
        gain=gain,
        lack_of_fit=accuracy.lack_of_fit(data, p),
        converged=optimum.converged,
    )


def _abandoned(gain: FloatArray, n_channels: int, lack_of_fit: float) -> BandFit:
    """Return a fit without modes."""
    return BandFit(
        candidate=np.zeros(0, dtype=np.int64),
        frequency_hz=np.zeros(0),
        damping_ratio=np.zeros(0),
        shapes=np.zeros((0, n_channels)),
        covariance=np.zeros((0, 2, 2)),
        shape_covariance=np.zeros((0, n_channels, n_channels)),
        cramer_rao=np.zeros((0, 2)),
        gain=gain,
        lack_of_fit=lack_of_fit,
        converged=False,
    )
