"""Curves of a law: storage, loss, creep and relaxation on grids of frequency and time."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import InputError, require
from jackettwin.soil.laws.viscoelastic import Law

_POINTS = 201


@dataclass(frozen=True)
class LawCurves:
    """A law's response to harmonic motion and to steps.

    Attributes
    ----------
    frequency_hz : (n,)
    stiffness : (n,) D(2πif) [N/m]: its real part stores, its imaginary part loses
    time_s : (n,)
    creep : (n,) displacement under a unit step of force [m/N]; NaN if the law cannot carry a force
    relaxation : (n,) force under a unit step of displacement [N/m], without the impulse of a dashpot at zero
    """

    frequency_hz: FloatArray
    stiffness: ComplexArray
    time_s: FloatArray
    creep: FloatArray
    relaxation: FloatArray

    @property
    def loss_factor(self) -> FloatArray:
        """Im D/Re D, (n,); infinite where nothing is stored."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.stiffness.imag / self.stiffness.real)


def law_curves(law: Law, low_hz: float, high_hz: float, n: int = _POINTS) -> LawCurves:
    """Return a law's curves between two frequencies, and between the times 1/2πf of both.

    Raises
    ------
    InputError
        If the frequencies are not positive and in order.
    """
    require(
        0.0 < low_hz < high_hz < np.inf,
        "are not a lower and a higher frequency",
        field="frequency_hz",
        value=[low_hz, high_hz],
        allowed="0 < low < high",
    )
    frequency = np.geomspace(low_hz, high_hz, n)
    time = 1.0 / (2.0 * pi * frequency[::-1])
    try:
        creep = law.creep(time)
    except InputError:
        creep = np.full(n, np.nan)
    s = np.asarray(2j * pi * frequency, dtype=np.complex128)
    return LawCurves(frequency, law.stiffness(s), time, creep, law.relaxation(time))
