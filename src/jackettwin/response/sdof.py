"""A single-degree-of-freedom system on a viscoelastic law."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt
from typing import Literal

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import require
from jackettwin.response.modes.poles import damping_ratio
from jackettwin.response.motion.time import first_order_hold, march, state_space
from jackettwin.response.state import state_matrix
from jackettwin.response.system import Group, Pencil
from jackettwin.soil import Law, Springpot, prony_fit
from jackettwin.structure import Rayleigh


def sdof(mass_kg: float, law: Law) -> Pencil:
    """Return a mass on a viscoelastic law, thesis (3.1) and (4.10)–(4.11)."""
    one = np.ones((1, 1))
    return Pencil(mass_kg * one, 0.0 * one, Rayleigh(), (Group(law, one, np.array([0])),))


def poles(pencil: Pencil) -> ComplexArray:
    """Return all poles of a small dense pencil, complex pairs first, by |λ|."""
    values = np.linalg.eigvals(state_matrix(pencil)).astype(np.complex128)
    return values[np.lexsort((-values.imag, np.abs(values), np.abs(values.imag) < 1e-12 * np.abs(values)))]


Regime = Literal["underdamped", "critically damped", "overdamped"]
_DOUBLE = 1e-6
"""Relative difference below which two poles are a double root, accurate to the root of rounding."""
_CYCLES = 5.0
"""Number of cycles of the free vibration that are computed."""
_BAND = 1e3
"""A springpot is approximated by branches up to this factor above and below the frequency of the mass."""


@dataclass(frozen=True)
class FreeVibration:
    """Free vibration of a mass on a law after release.

    Attributes
    ----------
    poles : complex pairs first [rad/s]; a springpot's pair alone, whose relaxation is a continuum
    regime : whether the motion is underdamped, critically damped or overdamped
    frequency_hz, damping_ratio : frequency and damping ratio of the pair; None if the motion does not
        oscillate
    time_s, displacement : (n,) motion after release at rest from unit displacement, before any dashpot in
        series has moved
    """

    poles: ComplexArray
    regime: Regime
    frequency_hz: float | None
    damping_ratio: float | None
    time_s: FloatArray
    displacement: FloatArray

    @property
    def logarithmic_decrement(self) -> float | None:
        """δ = 2πζ/√(1 − ζ²): the logarithm of one maximum over the next; None without maxima."""
        if self.damping_ratio is None:
            return None
        return 2.0 * pi * self.damping_ratio / sqrt(1.0 - self.damping_ratio**2)


def free_vibration(
    mass_kg: float, law: Law, *, duration_s: float | None = None, n: int = 401
) -> FreeVibration:
    """Return the free vibration of a mass on a law (thesis (3.6)–(3.8), (4.14), figures 3.2 and 4.3).

    Parameters
    ----------
    duration_s : float, optional
        Default: five cycles at √(|D|/m)/2π.
    n : number of times

    Raises
    ------
    InputError
        If the law has no stiffness and no damping.
    """
    omega, given, continuum = swinging(mass_kg, law), law, isinstance(law, Springpot)
    if isinstance(law, Springpot):
        law = prony_fit(law, omega / (2.0 * pi * _BAND), omega * _BAND / (2.0 * pi))
    pencil = sdof(mass_kg, law)
    found = poles(pencil)
    if continuum:
        found = np.array([_refined(mass_kg, given, found[0])])
        found = np.concatenate([found, found.conj()])
    step = (_CYCLES * 2.0 * pi / omega if duration_s is None else duration_s) / (n - 1)
    space = state_space(pencil)
    start = np.zeros(space.A.shape[0])
    start[0] = 1.0
    motion = march(first_order_hold(space.A, space.B, step), start, np.zeros((n, 1)))[:, 0]
    pair = found[0] if abs(found[0].imag) > _DOUBLE * abs(found[0]) else None
    return FreeVibration(
        found,
        "underdamped" if pair is not None else _regime(found),
        None if pair is None else float(abs(pair)) / (2.0 * pi),
        None if pair is None else float(damping_ratio(pair)),
        np.arange(n, dtype=np.float64) * step,
        motion,
    )


def swinging(mass_kg: float, law: Law) -> float:
    """Return ω [rad/s] at which a mass' inertia equals the size of a law's stiffness, m ω² = |D(iω)|."""
    size = abs(complex(law.stiffness(1j)))
    require(size > 0.0, "a law without stiffness and damping", field="law", value=size, allowed="> 0")
    omega = 1.0
    for _ in range(200):
        new = sqrt(abs(complex(law.stiffness(1j * omega))) / mass_kg)
        if abs(new - omega) <= 1e-12 * omega:
            break
        # damped by half in the logarithm: with a dashpot alone, |D| = cω, the iteration would alternate
        omega = sqrt(new * omega)
    return omega


def _refined(mass_kg: float, law: Law, start: complex) -> complex:
    """Return the root of m s² + D(s) near a start, by Newton's method."""
    s = complex(start)
    for _ in range(20):
        s -= (mass_kg * s * s + complex(law.stiffness(s))) / (2.0 * mass_kg * s + complex(law.slope(s)))
    return s


def _regime(found: ComplexArray) -> Regime:
    rates = np.sort(-found.real)
    double = (np.diff(rates) <= _DOUBLE * rates[1:]).any()
    return "critically damped" if double else "overdamped"
