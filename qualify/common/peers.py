"""What other programs say of a record, with the settings their documentation proposes for such records."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from jackettwin.identification.estimate import ResolvedSettings
from jackettwin.records import Record, decimate, detrend

Said = list[tuple[float, float, np.ndarray]]
"""Frequency, damping ratio and shape of every mode that is reported."""


def prepared(record: Record, settings: ResolvedSettings) -> Record:
    """Return the record at the rate of our identification: nobody shall lose by the rate."""
    filled = detrend(record)
    filled = type(filled)(np.nan_to_num(filled.data), filled.sample_rate_hz, filled.channels)
    if settings.sample_rate_hz < filled.sample_rate_hz:
        return decimate(filled, sample_rate_hz=settings.sample_rate_hz)
    return filled


def pyoma2(record: Record, settings: ResolvedSettings) -> Said:
    """Return pyOMA2's SSI-cov: stable poles by its default criteria, one a group of equal frequency."""
    from pyoma2.algorithms import SSI
    from pyoma2.setup import SingleSetup

    ready = prepared(record, settings)
    setup = SingleSetup(ready.data.T, fs=ready.sample_rate_hz)
    algorithm = SSI(name="ssi", method="cov", br=settings.block_rows, ordmax=settings.orders[-1], step=2)
    setup.add_algorithms(algorithm)
    setup.run_all()
    result = algorithm.result
    stable = np.asarray(result.Lab) >= 1
    f, zeta = np.asarray(result.Fn_poles)[stable], np.asarray(result.Xi_poles)[stable]
    return grouped(f, zeta, np.asarray(result.Phi_poles)[stable], settings)


def koma(record: Record, settings: ResolvedSettings) -> Said:
    """Return koma's SSI-cov and its stable poles, grouped in the same way."""
    from koma import oma

    ready = prepared(record, settings)
    orders = np.asarray(settings.orders)
    lambd, phi, order = oma.covssi(
        ready.data.T, ready.sample_rate_hz, settings.block_rows, orders, showinfo=False
    )
    stable, shapes, _, _ = oma.find_stable_poles(lambd, phi, order, 3)
    stable = np.asarray(stable)
    f, zeta = np.abs(stable) / (2.0 * np.pi), -stable.real / np.abs(stable)
    return grouped(f, zeta, np.asarray(shapes).T, settings)


def grouped(f: np.ndarray, zeta: np.ndarray, shapes: np.ndarray, settings: ResolvedSettings) -> Said:
    """Return the median of poles within 2 % of frequency and of one shape that 40 % of the orders hold."""
    inside = (f > settings.lowest_frequency_hz) & (f < settings.highest_frequency_hz) & (zeta > 0.0)
    f, zeta, shapes = f[inside], zeta[inside], shapes[inside]
    free, out = np.ones(len(f), dtype=bool), []
    unit = shapes / np.linalg.norm(shapes, axis=1, keepdims=True)
    for k in np.argsort(zeta):
        if not free[k]:
            continue
        alike = free & (np.abs(f / f[k] - 1.0) < 0.02) & (np.abs(unit @ unit[k].conj()) ** 2 > 0.9)
        free &= ~alike
        if alike.sum() >= 0.4 * len(settings.orders):
            out.append((float(np.median(f[alike])), float(np.median(zeta[alike])), unit[k]))
    return out


PEERS: dict[str, Callable[[Record, ResolvedSettings], Said]] = {"pyoma2": pyoma2, "koma": koma}
"""Name of the module → what it says."""
