r"""Which doubtful modes join a fit, and which modes leave it.

Modes that the subspace method is sure of are fitted together; a doubtful one joins when it explains
enough of what the others leave, by the gain of log-likelihood

.. math:: g(s) = \sum_k n_k\left[\frac{s h_k\,b_k}{1+s h_k a_k} - \ln(1+s h_k a_k)\right], \quad
          a = \phi^T E^{-1}\phi,\ b = \phi^T E^{-1}\hat S E^{-1}\phi

of adding power s with its shape and kernel h held: one unit at least for each parameter of a mode (Akaike's
criterion; poles that fit noise have 0 to 3, with eight channels 11 are asked). In a narrow band, where shapes
may lag and the model is less exact, it must gain as much as it must to stay: Schwarz's criterion.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray, Int64Array
from jackettwin.identification.maximum_likelihood import accuracy, likelihood
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.identification.maximum_likelihood.spectral_model import expected, response_power

if TYPE_CHECKING:
    from collections.abc import Callable

    from jackettwin.identification.maximum_likelihood.parameters import Parameters
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram


SUSPECT = 2.5
"""A fitted mode is put to the test when its damping is this many times as uncertain as the record allows."""
APPROACH = 4
"""Steps before the doubtful modes are judged."""
PARAMETERS_OF_A_MODE = 3
"""f, ζ and colour; its shape has one for each channel."""
MOST_STEPS = 20
"""Steps of a fit with one mode less, from where that with it ended."""
MOST_ADDED = 6
"""Doubtful modes admitted at most."""


def joined(
    data: Periodogram,
    climb: likelihood.Climb,
    chosen: Int64Array,
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    unit: FloatArray,
    least: float,
) -> tuple[likelihood.Climb, Int64Array, FloatArray]:
    """Admit the doubtful candidate that explains most, again and again, while one gains enough."""
    gain = np.full(len(frequency_hz), np.inf)
    for _ in range(MOST_ADDED):
        doubtful = np.setdiff1d(np.arange(len(frequency_hz)), chosen)
        if not len(doubtful):
            break
        p = climb.parameters
        tried = [gain_of(data, p, frequency_hz[i], damping_ratio[i], unit[i]) for i in doubtful]
        gain[doubtful] = [g for g, _ in tried]
        best = int(np.argmax(gain[doubtful]))
        i = doubtful[best]
        if gain[i] < least:
            break
        shape = unit[i] * np.sqrt(tried[best][1])
        more = p.joined(float(np.log(frequency_hz[i])), float(np.log(damping_ratio[i])), shape)
        climb, chosen = likelihood.climbed(data, more, APPROACH), np.append(chosen, i)
    return climb, chosen, gain


def thinned(
    data: Periodogram, climb: likelihood.Climb, chosen: Int64Array, known: accuracy.Accuracy
) -> tuple[likelihood.Climb, Int64Array, accuracy.Accuracy]:
    """Drop modes whose damping stays hardly known and without which the spectrum is explained as well."""
    kept: set[int] = set()
    while len(chosen) > 1:
        p = climb.parameters
        mode = p.held + np.arange(len(chosen))
        std = np.sqrt(np.diag(known.covariance))[len(p.log_f) + mode]
        limit = long_data_limits(np.exp(p.log_f[mode]), np.exp(p.log_zeta[mode]), data.duration_s)[1]
        suspect = [int(k) for k in np.argsort(-std / limit) if std[k] > SUSPECT * limit[k]]
        suspect = [k for k in suspect if int(chosen[k]) not in kept]
        if not suspect:
            break
        fewer = likelihood.climbed(data, p.without(p.held + suspect[0]), MOST_STEPS)
        if climb.value - fewer.value < needed_gain(data):
            climb, chosen = fewer, np.delete(chosen, suspect[0])
            known = accuracy.accuracy_of(data, climb.parameters)
        else:
            kept.add(int(chosen[suspect[0]]))
    return climb, chosen, known


def needed_gain(data: Periodogram) -> float:
    """Return what a fitted mode must add to the log-likelihood to stay: Schwarz's criterion."""
    n_parameters = PARAMETERS_OF_A_MODE + data.floor.shape[1]
    return float(0.5 * n_parameters * np.log(data.count.sum()))


def gain_of(data: Periodogram, p: Parameters, f: float, zeta: float, phi: FloatArray) -> tuple[float, float]:
    """Return the largest gain of log-likelihood by adding a mode, and the power at which it is reached."""
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
    best = lowest(loss, middle - 15.0, middle + 15.0)
    return max(-loss(best), 0.0), float(np.exp(best))


def lowest(loss: Callable[[float], float], low: float, high: float, within: float = 1e-5) -> float:
    """Return where a function with one valley is lowest, by golden sections.

    >>> round(lowest(lambda x: (x - 0.3) ** 2, -1.0, 1.0), 4)
    0.3
    """
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    at = [high - golden * (high - low), low + golden * (high - low)]
    values = [loss(x) for x in at]
    while high - low > within:
        if values[0] < values[1]:
            high, at[1], values[1] = at[1], at[0], values[0]
            at[0] = high - golden * (high - low)
            values[0] = loss(at[0])
        else:
            low, at[0], values[0] = at[0], at[1], values[1]
            at[1] = low + golden * (high - low)
            values[1] = loss(at[1])
    return float(0.5 * (low + high))
