r"""Admission of doubtful modes to a fit, and removal of modes that the fit does not need.

Modes without doubt are fitted together. A doubtful mode is admitted if it explains enough of what the others
leave unexplained, measured by the gain of log-likelihood

.. math:: g(s) = \sum_k n_k\left[\frac{s h_k\,b_k}{1+s h_k a_k} - \ln(1+s h_k a_k)\right], \quad
          a = \phi^T E^{-1}\phi,\ b = \phi^T E^{-1}\hat S E^{-1}\phi

of adding power s while its shape φ and kernel h are fixed. Over the whole band the gain must be at least one
unit per parameter of the mode (Akaike's criterion: 11 with eight channels; poles that fit noise gain 0 to 3).
In a narrow band, where shapes may have a phase lag and the model is less exact, Schwarz's criterion decides;
it also decides whether a fitted mode stays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, Int64Array
from jackettwin.identification.maximum_likelihood import accuracy, likelihood
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.identification.maximum_likelihood.spectral_model import expected, response_power

if TYPE_CHECKING:
    from collections.abc import Callable

    from jackettwin.identification.maximum_likelihood.parameters import Parameters
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram


SUSPECT_UNCERTAINTY = 2.5
"""A fitted mode is tested for removal if its damping is this many times as uncertain as the long-data
limit."""
CLOSE_DISTANCE, SAME_SHAPE = 2.0, 0.8
"""Distance over the sum of half bandwidths below which two modes are close,
and MAC above which they may be one."""
STEPS_BEFORE_ADMISSION = 4
"""Scoring steps taken before doubtful modes are considered."""
PARAMETERS_OF_A_MODE = 3
"""f, ζ and the exponent of the force spectrum; the shape adds one parameter per channel."""
MAX_REMOVAL_STEPS = 20
"""Most scoring steps of the fit without a mode, started from the fit with it."""
MAX_ADMITTED = 6
"""Most doubtful modes admitted to one fit."""


def admit_modes(
    data: Periodogram,
    optimum: likelihood.Optimum,
    chosen: Int64Array,
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    unit: FloatArray,
    least: float,
) -> tuple[likelihood.Optimum, Int64Array, FloatArray]:
    """Admit doubtful candidates one by one, the largest gain first, as long as the gain reaches ``least``."""
    gain = np.full(len(frequency_hz), np.inf)
    for _ in range(MAX_ADMITTED):
        doubtful = np.setdiff1d(np.arange(len(frequency_hz)), chosen)
        if not len(doubtful):
            break
        p = optimum.parameters
        tried = [likelihood_gain(data, p, frequency_hz[i], damping_ratio[i], unit[i]) for i in doubtful]
        gain[doubtful] = [g for g, _ in tried]
        best = int(np.argmax(gain[doubtful]))
        i = doubtful[best]
        if gain[i] < least:
            break
        shape = unit[i] * np.sqrt(tried[best][1])
        more = p.with_mode(float(np.log(frequency_hz[i])), float(np.log(damping_ratio[i])), shape)
        optimum, chosen = likelihood.maximise(data, more, STEPS_BEFORE_ADMISSION), np.append(chosen, i)
    return optimum, chosen, gain


def drop_unneeded_modes(
    data: Periodogram, optimum: likelihood.Optimum, chosen: Int64Array, known: accuracy.Accuracy
) -> tuple[likelihood.Optimum, Int64Array, accuracy.Accuracy]:
    """Remove modes of very uncertain damping and possible duplicates that the likelihood does not need."""
    needed: set[int] = set()
    while len(chosen) > 1:
        p = optimum.parameters
        mode = p.n_fixed + np.arange(len(chosen))
        std = np.sqrt(np.diag(known.covariance))[len(p.log_f) + mode]
        limit = long_data_limits(np.exp(p.log_f[mode]), np.exp(p.log_zeta[mode]), data.duration_s)[1]
        doubled = possible_doubles(p, mode)
        suspect = [
            int(k) for k in np.argsort(-std / limit) if std[k] > SUSPECT_UNCERTAINTY * limit[k] or doubled[k]
        ]
        suspect = [k for k in suspect if int(chosen[k]) not in needed]
        if not suspect:
            break
        fewer = likelihood.maximise(data, p.without(p.n_fixed + suspect[0]), MAX_REMOVAL_STEPS)
        if optimum.value - fewer.value < required_gain(data):
            optimum, chosen = fewer, np.delete(chosen, suspect[0])
            known = accuracy.accuracy_of(data, optimum.parameters)
        else:
            needed.add(int(chosen[suspect[0]]))
    return optimum, chosen, known


def possible_doubles(p: Parameters, mode: Int64Array) -> BoolArray:
    """Return which modes are close to one of nearly the same shape, or to two other modes, (n_modes,) bool.

    Two modes always fit a single peak slightly better than one mode, and three fit a pair slightly better
    than two. A mode marked here is therefore retained only if the likelihood needs it.
    """
    f, zeta = np.exp(p.log_f[mode]), np.exp(p.log_zeta[mode])
    close = np.abs(f[:, None] - f) < CLOSE_DISTANCE * np.add.outer(f * zeta, f * zeta)
    unit = p.shapes[mode] / np.linalg.norm(p.shapes[mode], axis=1, keepdims=True)
    alike = (unit @ unit.T) ** 2 > SAME_SHAPE
    return np.asarray((np.sum(close & alike, axis=1) > 1) | (np.sum(close, axis=1) > 2))


def required_gain(data: Periodogram) -> float:
    """Return the log-likelihood that a fitted mode must add in order to stay (Schwarz's criterion)."""
    n_parameters = PARAMETERS_OF_A_MODE + data.floor.shape[1]
    return float(0.5 * n_parameters * np.log(data.count.sum()))


def likelihood_gain(
    data: Periodogram, p: Parameters, f: float, zeta: float, phi: FloatArray
) -> tuple[float, float]:
    """Return the largest gain of log-likelihood from adding a mode, and the power s that gives it."""
    model = expected(data, p)
    inverse = np.linalg.inv(model.matrix)
    left = inverse @ phi
    a = np.real(left @ phi)
    b = np.einsum("ka,kab,kb->k", left.conj(), data.density, left, optimize=True).real
    b += np.sum(np.abs(left) ** 2 * data.dither, axis=1)
    h = response_power(data, f, zeta)

    def loss(log_s: float) -> float:
        s = np.exp(log_s) * h
        return float(-np.sum(data.count * (s * b / (1.0 + s * a) - np.log1p(s * a))))

    middle = -np.log(np.max(h * a))
    best = golden_section_minimum(loss, middle - 15.0, middle + 15.0)
    return max(-loss(best), 0.0), float(np.exp(best))


def golden_section_minimum(loss: Callable[[float], float], low: float, high: float) -> float:
    """Return the minimiser of a unimodal function on an interval, to 1e-5, by golden-section search.

    >>> round(golden_section_minimum(lambda x: (x - 0.3) ** 2, -1.0, 1.0), 4)
    0.3
    """
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    at = [high - golden * (high - low), low + golden * (high - low)]
    values = [loss(x) for x in at]
    while high - low > 1e-5:
        if values[0] < values[1]:
            high, at[1], values[1] = at[1], at[0], values[0]
            at[0] = high - golden * (high - low)
            values[0] = loss(at[0])
        else:
            low, at[0], values[0] = at[0], at[1], values[1]
            at[1] = low + golden * (high - low)
            values[1] = loss(at[1])
    return float(0.5 * (low + high))
