r"""From the modes of a subspace method to their maximum-likelihood estimates.

What a small sample does is taken back: the bias b of ln ζ from the curvature of the model
(``accuracy.curvature_bias``), and that of ζ over its logarithm, whose error is the one that is nearly
Gaussian: :math:`\hat\zeta = \zeta\,e^{-b}/(1+\sigma^2/2)`, σ the standard deviation of ln ζ. The information
is that of many lines, and of few the scatter is larger: :math:`\sigma^2(1+\sigma^2)` is reported (of one
mode alone, intervals then cover 94 to 95 % down to 2πζfT = 6; without it, 93 to 95 %).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, Int64Array
from jackettwin.identification.maximum_likelihood import accuracy, likelihood
from jackettwin.identification.maximum_likelihood.admission import (
    APPROACH,
    PARAMETERS_OF_A_MODE,
    joined,
    needed_gain,
    thinned,
)
from jackettwin.identification.maximum_likelihood.background import with_background
from jackettwin.identification.maximum_likelihood.periodogram import periodogram
from jackettwin.identification.maximum_likelihood.refined import Refined

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.maximum_likelihood.parameters import Parameters
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram


BEYOND_HOPE = 3.5
"""A fit is given up before the doubtful modes are looked at, if it lacks this many times what it may, …"""
STUCK, LEFT_OF_FIRST = 2.0, 0.5
"""… or this many times that, and more than this of what it lacked at first. Of a hundred fits that came to
be accepted none lacked more than 2.6 times what it may by then, and these less than four tenths of it. …"""
HOPELESS = 3.0
"""A fit is given up when the doubtful modes are judged, if it lacks this many times what it may …"""
WORTH_A_TRY = 12
"""… and after so many steps more …"""
STILL_HOPELESS = 1.5
"""… if it still lacks this many times that."""
MOST_STEPS, FEWEST_STEPS = 30, 8
"""Steps after those: fits that end take eight to twenty as a rule …"""
MOST_WORK = 4e9
"""… and no more than this many products: what is still on its way then seldom arrives."""
MOST_STEP_WORK = 2e9
"""A fit of which one step takes more products is not tried: of seven hundred that came to be accepted none
took more than half as many, and one such fit costs more than the whole rest of an identification."""
MOST_BIAS = 0.5
"""Standard deviations beyond which an expansion to second order is not believed."""


@dataclass(frozen=True)
class Narrow:
    """What the fit of a narrow band is told of the rest of the spectrum.

    Attributes
    ----------
    dither_share : float
        So much of the local median spectrum is added to model and data.
    frequency_hz, damping_ratio : (n_beside,)
        Of the modes beside the band; they are kept.
    shapes : (n_beside, n_channels)
        Real, where the fit starts.
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
    narrow: Narrow | None = None,
    most_lack_of_fit: float = np.inf,
) -> Refined:
    """Fit the sure candidates together, admit the doubtful ones that are needed.

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
        Derivatives in time by which a channel lags acceleration.
    avoid_hz : sequence of (low, high)
        Ranges that are left out of the fit.
    background : bool
        Whether shapes that follow their force are fitted too: the modes outside the band, or waves below it.
    narrow : Narrow, optional
        Given where the band holds some of the modes only; the shapes of its modes may lag there.
    most_lack_of_fit : float
        A fit that lacks more is returned before modes are dropped from it: fewer fit no better. One that
        lacks much more is given up, and returned without modes.
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
    first = likelihood.start(data, *sought) if narrow is None else _beside(narrow, data, *sought)
    if background:
        first = with_background(data, first)
    if _step_work(data, first) > MOST_STEP_WORK:
        return _given_up(np.full(len(sure), np.inf), unit.shape[1], np.inf)
    climb = likelihood.climbed(data, first, APPROACH)
    lack = accuracy.lack_of_fit(data, climb.parameters)
    if narrow is None and _beyond_hope(lack, accuracy.lack_of_fit(data, first), most_lack_of_fit):
        return _given_up(np.full(len(sure), np.inf), unit.shape[1], lack)
    least = PARAMETERS_OF_A_MODE + unit.shape[1] if narrow is None else needed_gain(data)
    climb, chosen, gain = joined(data, climb, chosen, frequency_hz, damping_ratio, unit, least)
    lack = accuracy.lack_of_fit(data, climb.parameters)
    if narrow is None and lack > HOPELESS * most_lack_of_fit:
        return _given_up(gain, unit.shape[1], lack)
    climb = likelihood.climbed(data, climb.parameters, WORTH_A_TRY)
    lack = accuracy.lack_of_fit(data, climb.parameters)
    if lack > STILL_HOPELESS * most_lack_of_fit:
        return _given_up(gain, unit.shape[1], lack)
    if not climb.converged:
        climb = likelihood.climbed(data, climb.parameters, _steps(data, climb.parameters))
        lack = accuracy.lack_of_fit(data, climb.parameters)
    known = accuracy.accuracy_of(data, climb.parameters)
    if climb.converged and lack <= most_lack_of_fit:
        climb, chosen, known = thinned(data, climb, chosen, known)
    return _result(data, climb, chosen, gain, known)


def _beyond_hope(lack: float, at_first: float, most: float) -> bool:
    """Tell whether a fit of the whole band that has taken its first steps cannot come to be accepted."""
    stuck = lack > STUCK * most and lack > LEFT_OF_FIRST * at_first
    return stuck or lack > BEYOND_HOPE * most


def _steps(data: Periodogram, p: Parameters) -> int:
    """Return the steps a fit may take yet, by what each costs."""
    return int(np.clip(MOST_WORK / _step_work(data, p), FEWEST_STEPS, MOST_STEPS))


def _step_work(data: Periodogram, p: Parameters) -> int:
    """Return how many products one step of a fit takes."""
    return int(p.vector.size**2 * p.shapes.shape[1] ** 2 * len(data.omega))


def _beside(
    narrow: Narrow, data: Periodogram, f: FloatArray, zeta: FloatArray, unit: FloatArray
) -> Parameters:
    """Return first parameters of the modes of a narrow band and of those beside it."""
    first = likelihood.start(
        data,
        np.append(narrow.frequency_hz, f),
        np.append(narrow.damping_ratio, zeta),
        np.vstack([narrow.shapes, unit]),
        len(narrow.shapes),
    )
    # one channel has nothing to lag behind: its phase is that of the mode, which no spectrum knows
    return replace(first, lag=np.zeros_like(unit)) if unit.shape[1] > 1 else first


def _result(
    data: Periodogram,
    climb: likelihood.Climb,
    chosen: Int64Array,
    gain: FloatArray,
    known: accuracy.Accuracy,
) -> Refined:
    p = climb.parameters
    n, n_channels = p.shapes.shape
    covariance = known.covariance
    mode = np.arange(p.held, n)
    mode = mode[np.argsort(p.log_f[mode])]
    both = np.stack([mode, mode + n], axis=1)
    shape = 3 * n + mode[:, None] * n_channels + np.arange(n_channels)
    log_covariance = covariance[both[:, :, None], both[:, None, :]]
    bias, excess = np.zeros((len(mode), 2)), np.zeros(len(mode))
    # a background takes its share of the peaks, and with it the bias of the small sample
    if not p.background:
        excess = log_covariance[:, 1, 1]
        most = MOST_BIAS * np.sqrt(np.diagonal(log_covariance, axis1=1, axis2=2))
        bias = np.clip(accuracy.curvature_bias(data, p, known)[both], -most, most)
    wider = np.stack([np.ones(len(mode)), np.sqrt(1.0 + excess)], axis=1)
    return Refined(
        candidate=chosen[mode - p.held],
        frequency_hz=np.exp(p.log_f[mode] - bias[:, 0]),
        damping_ratio=np.exp(p.log_zeta[mode] - bias[:, 1]) / (1.0 + 0.5 * excess),
        shapes=p.shapes[mode],
        covariance=log_covariance * wider[:, :, None] * wider[:, None, :],
        shape_covariance=covariance[shape[:, :, None], shape[:, None, :]],
        cramer_rao=known.cramer_rao[both],
        gain=gain,
        lack_of_fit=accuracy.lack_of_fit(data, p),
        converged=climb.converged,
    )


def _given_up(gain: FloatArray, n_channels: int, lack_of_fit: float) -> Refined:
    """Return a fit of no mode."""
    return Refined(
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
