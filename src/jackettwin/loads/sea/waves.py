r"""Linear waves: dispersion, spectra, random seas and the water's motion under them.

A sea is a sum of Airy waves. With :math:`θ = ωt − k(x\cos β + y\sin β) + φ` and z up from still water,

.. math:: η = Σ a \cos θ,\quad u = Σ a ω \frac{\cosh k(z+d)}{\sinh kd} \cos θ,\quad
          w = −Σ a ω \frac{\sinh k(z+d)}{\sinh kd} \sin θ
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.errors import InputError, require_between

STRETCHING = ("none", "vertical", "extrapolated", "wheeler")


class Waves(Protocol):
    """Any wave theory: surface and motion of the water at points (x, y, z), z up from still water."""

    def elevation(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return η [m] above points (n, 2 or 3) at times (m,), shape (m, n)."""
        ...

    def surface(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return the level up to which the theory gives water [m], (m, n)."""
        ...

    def motion(self, points: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return velocity [m/s] and acceleration [m/s²], each (m, n, 3).

        Points above the surface have the values at the surface; callers must account for the wet part.
        """
        ...

    def pressure(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return the dynamic pressure over the density [m²/s²], (m, n)."""
        ...


def wave_number(omega: FloatArray | float, depth: float) -> FloatArray:
    """Return k [rad/m] of ω² = g k tanh kd, by Newton's method from Guo's (2002) approximation.

    >>> k = wave_number(0.6, 50.0)
    >>> round(float(9.80665 * k * np.tanh(50.0 * k)), 10)
    0.36
    """
    omega = np.asarray(omega, dtype=np.float64)
    x = omega * np.sqrt(depth / GRAVITY_M_S2)
    kd = x**2 * (1.0 - np.exp(-(np.maximum(x, 1e-12) ** 2.5))) ** (-0.4)
    for _ in range(6):
        tanh = np.tanh(kd)
        kd = kd - (kd * tanh - x**2) / (tanh + kd * (1.0 - tanh**2))
    return np.asarray(kd / depth)


def jonswap(frequency_hz: FloatArray, *, Hs: float, Tp: float, gamma: float | None = None) -> FloatArray:
    """Return the one-sided spectrum S(f) [m²/Hz], IEC 61400-3-1 (2019) annex D, m0 = Hs²/16.

    With the factor 1 − 0.287 ln γ the error of Hs is below 1 % for γ from 1 to 7; γ = 1 is Pierson–Moskowitz.
    The default is the standard's γ for Tp/√Hs.
    """
    gamma = peak_factor(Hs, Tp) if gamma is None else gamma
    require_between("Hs", Hs, 0.0, 40.0)
    require_between("Tp", Tp, 1.0, 40.0)
    require_between("gamma", gamma, 1.0, 10.0)
    f, fp = np.asarray(frequency_hz, dtype=np.float64), 1.0 / Tp
    positive = np.maximum(f, 1e-6)
    sigma = np.where(f <= fp, 0.07, 0.09)
    peak = gamma ** np.exp(-0.5 * ((f / fp - 1.0) / sigma) ** 2)
    shape = (fp / positive) ** 4
    S = 0.3125 * Hs**2 * Tp * shape * (fp / positive) * np.exp(-1.25 * shape) * (1.0 - 0.287 * np.log(gamma))
    return np.asarray(np.where(f > 0.0, S * peak, 0.0))


def peak_factor(Hs: float, Tp: float) -> float:
    """Return γ of IEC 61400-3-1 annex D: 5 for Tp/√Hs ≤ 3.6, 1 for ≥ 5, exp(5.75 − 1.15 Tp/√Hs) between."""
    ratio = Tp / np.sqrt(Hs) if Hs > 0.0 else 5.0
    if ratio <= 3.6:
        return 5.0
    return float(np.exp(5.75 - 1.15 * ratio)) if ratio < 5.0 else 1.0


@dataclass(frozen=True)
class AirySea:
    """A sum of Airy waves, each array (n_waves,).

    Attributes
    ----------
    amplitude, omega, direction, phase : amplitude [m], ω [rad/s], heading β from +x [rad], φ [rad]
    depth : water depth [m]
    stretching : ``"none"``: linear theory up to still water. The others extend to the moving surface:
        ``"vertical"``: above still water as at still water; ``"extrapolated"``: linearly with the slope at
        still water; ``"wheeler"``: z is mapped to (z − η) d/(d + η). They are HydroDyn's ``WaveStMod`` 0 to
        3.
    """

    amplitude: FloatArray
    omega: FloatArray
    direction: FloatArray
    phase: FloatArray
    depth: float
    stretching: str = "wheeler"

    def __post_init__(self) -> None:
        require_between("depth", self.depth, 0.1, 12e3)
        if self.stretching not in STRETCHING:
            raise InputError(
                "unknown stretching", field="stretching", value=self.stretching, allowed=", ".join(STRETCHING)
            )

    @cached_property
    def k(self) -> FloatArray:
        """Wave numbers [rad/m]."""
        return wave_number(self.omega, self.depth)

    def elevation(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return η [m], (n_times, n_points)."""
        rotating = self.amplitude * np.exp(1j * (np.outer(t, self.omega) + self.phase))
        return np.asarray((rotating @ self._spatial(points).T).real)

    def surface(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return the elevation if stretched, else still water, (n_times, n_points)."""
        if self.stretching == "none":
            return np.zeros((np.size(t), points.shape[0]))
        return self.elevation(points, t)

    def motion(self, points: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return velocity and acceleration, each (n_times, n_points, 3)."""
        t = np.atleast_1d(np.asarray(t, dtype=np.float64))
        spatial, z = self._spatial(points), points[:, 2]
        if self.stretching != "wheeler":
            return self._fields(np.exp(1j * np.outer(t, self.omega)), spatial, z)
        steps = [
            self._fields(np.exp(1j * self.omega * time)[None], spatial, row)
            for time, row in zip(t, self._stretched(points, t), strict=True)
        ]
        return np.concatenate([u for u, _ in steps]), np.concatenate([du for _, du in steps])

    def pressure(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return Σ a g cosh k(z+d)/cosh kd cos θ [m²/s²], (n_times, n_points)."""
        t = np.atleast_1d(np.asarray(t, dtype=np.float64))
        steady = self.amplitude * self.omega**2 / self.k * np.exp(1j * self.phase) * self._spatial(points)
        rotating = np.exp(1j * np.outer(t, self.omega))
        if self.stretching != "wheeler":
            horizontal, _ = self.depth_functions(points[:, 2])
            return np.asarray((rotating @ (steady * horizontal).T).real)
        levels = self._stretched(points, t)
        steps = [
            (row * steady * depth_functions(self.k, z, self.depth)[0]).sum(axis=1).real
            for row, z in zip(rotating, levels, strict=True)
        ]
        return np.array(steps)

    def depth_functions(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return cosh k(z+d)/sinh kd and sinh k(z+d)/sinh kd at levels, (n_points, n_waves).

        Above still water they are constant or linear, depending on the stretching.
        """
        C, S = depth_functions(self.k, np.minimum(z, 0.0), self.depth)
        if self.stretching != "extrapolated":
            return C, S
        rise = np.outer(np.maximum(z, 0.0), self.k)
        return C + rise * S, S + rise * C

    def _stretched(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return Wheeler's levels (n_times, n_points)."""
        eta = self.elevation(points, t)
        return np.minimum((points[:, 2] - eta) * self.depth / (self.depth + eta), 0.0)

    def _spatial(self, points: FloatArray) -> ComplexArray:
        """Return e^{−ik·x}, (n_points, n_waves)."""
        along = np.outer(points[:, 0], np.cos(self.direction)) + np.outer(
            points[:, 1], np.sin(self.direction)
        )
        return np.asarray(np.exp(-1j * self.k * along))

    def _fields(
        self, rotating: ComplexArray, spatial: ComplexArray, z: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return (velocity, acceleration) at levels ``z``, whether or not these are wet."""
        horizontal, vertical = self.depth_functions(z)
        steady = self.amplitude * self.omega * np.exp(1j * self.phase) * spatial
        u, w = steady * horizontal, 1j * steady * vertical
        columns = np.stack([u * np.cos(self.direction), u * np.sin(self.direction), w], axis=1)
        velocity = np.einsum("tw,pcw->tpc", rotating, columns)
        acceleration = np.einsum("tw,pcw->tpc", rotating, 1j * self.omega * columns)
        return velocity.real, acceleration.real


def depth_functions(k: FloatArray, z: FloatArray, depth: float) -> tuple[FloatArray, FloatArray]:
    """Return cosh k(z+d)/sinh kd and sinh k(z+d)/sinh kd, (n_points, n_waves), without overflow."""
    down = np.exp(np.outer(z, k))
    up = np.exp(-np.outer(z + 2.0 * depth, k))
    base = 1.0 - np.exp(-2.0 * k * depth)
    return (down + up) / base, (down - up) / base


def airy_wave(
    *, height: float, period: float, depth: float, direction: float = 0.0, phase: float = 0.0,
    stretching: str = "none",
) -> AirySea:  # fmt: skip
    """Return one regular wave of ``height`` [m] and ``period`` [s] towards ``direction`` [rad] from +x."""
    require_between("height", height, 0.0, 0.8 * depth)
    require_between("period", period, 0.5, 60.0)
    one = np.ones(1)
    return AirySea(
        0.5 * height * one, 2.0 * np.pi / period * one, direction * one, phase * one, depth, stretching
    )


def irregular_sea(
    *,
    Hs: float,
    Tp: float,
    depth: float,
    duration: float,
    seed: int,
    gamma: float | None = None,
    direction: float = 0.0,
    spreading: float | None = None,
    highest_hz: float | None = None,
    stretching: str = "wheeler",
) -> AirySea:
    """Return a random sea that is periodic with ``duration`` [s].

    Components have the spacing Δf = 1/duration; their amplitudes are Rayleigh distributed (an exactly
    Gaussian sea) and their phases uniform, both determined by ``seed``.

    Parameters
    ----------
    Hs, Tp, gamma : JONSWAP parameters; γ = 1 is Pierson–Moskowitz
    direction : float
        Mean heading from +x [rad].
    spreading : float, optional
        Exponent s of the cos^{2s}((β − β̄)/2) distribution; None is long-crested. Each component has one
        random heading, so that the sea is ergodic.
    highest_hz : float, optional
        Cut-off frequency, by default 4/Tp, above which a Pierson–Moskowitz sea has 0.5 % of its energy.
    """
    cutoff = 4.0 / Tp if highest_hz is None else highest_hz
    df = 1.0 / duration
    f = np.arange(1, int(cutoff / df) + 1, dtype=np.float64) * df
    rng = np.random.default_rng(seed)
    variance = jonswap(f, Hs=Hs, Tp=Tp, gamma=gamma) * df
    amplitude = np.asarray(np.sqrt(variance) * np.hypot(*rng.standard_normal((2, f.size))))
    phase = rng.uniform(0.0, 2.0 * np.pi, f.size)
    heading = np.full(f.size, direction)
    if spreading is not None:
        heading += _headings(rng, spreading, f.size)
    return AirySea(amplitude, 2.0 * np.pi * f, heading, phase, depth, stretching)


def _headings(rng: np.random.Generator, s: float, n: int) -> FloatArray:
    """Draw from D(β) ∝ cos^{2s}(β/2) by inverting its distribution."""
    beta = np.linspace(-np.pi, np.pi, 4001)
    cumulative = np.cumsum(np.cos(0.5 * beta) ** (2.0 * s))
    return np.interp(rng.uniform(size=n), cumulative / cumulative[-1], beta)


@dataclass(frozen=True)
class SeaState:
    """A JONSWAP sea: Hs [m], Tp [s], heading from +x [rad]; other fields as in ``irregular_sea``."""

    Hs: float
    Tp: float
    direction: float = 0.0
    gamma: float | None = None
    spreading: float | None = None

    def waves(self, *, depth: float, duration: float, seed: int) -> AirySea:
        """Return the sea's random waves."""
        return irregular_sea(
            Hs=self.Hs,
            Tp=self.Tp,
            depth=depth,
            duration=duration,
            seed=seed,
            gamma=self.gamma,
            direction=self.direction,
            spreading=self.spreading,
        )
