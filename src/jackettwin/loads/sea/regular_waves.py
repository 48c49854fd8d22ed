"""Steep regular waves: Stokes' fifth order and the stream function, through the optional package raschii.

Both theories are sums of harmonics of one potential, so that the harmonics of η and of the horizontal
velocity at one level define a solution; all other quantities follow in closed form.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.errors import InputError, MissingExtra, NumericalError
from jackettwin.loads.sea.waves import wave_number

THEORIES = ("stokes-5", "stream-function")
HIGHEST_URSELL = 30.0
"""Hλ²/d³ up to which Stokes' fifth order is valid (DNV-RP-C205); crests are then at most 6 % too low."""


@dataclass(frozen=True)
class RegularWave:
    """A periodic wave of permanent form.

    Attributes
    ----------
    k, omega, depth : wave number [rad/m], frequency [rad/s], depth [m]
    eta : (n,) harmonics 1… of the surface [m], η = Σ η_j cos jθ about still water
    u : (n,) harmonics 1… of the horizontal velocity, extrapolated to still water [m/s]
    direction : heading from +x [rad]
    """

    k: float
    omega: float
    depth: float
    eta: FloatArray
    u: FloatArray
    direction: float = 0.0

    def elevation(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return η [m], (n_times, n_points)."""
        theta = self._phase(points, t)
        j = np.arange(1, self.eta.size + 1)
        return np.asarray(np.cos(theta[..., None] * j) @ self.eta)

    def surface(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return η, up to which these theories are valid."""
        return self.elevation(points, t)

    def motion(self, points: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return velocity and total acceleration Du/Dt, each (n_times, n_points, 3)."""
        C, S, kj, cos, sin = self._harmonics_at(points, t)
        u, w = (C * cos).sum(-1), -(S * sin).sum(-1)
        u_x, u_z = (kj * C * sin).sum(-1), (kj * S * cos).sum(-1)
        # irrotational and incompressible: w_x = u_z, w_z = −u_x; permanent form: ∂/∂t = −(ω/k) ∂/∂x
        relative = u - self.omega / self.k
        du, dw = relative * u_x + w * u_z, relative * u_z - w * u_x
        return self._heading(u, w), self._heading(du, dw)

    def pressure(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return cu − (u² + w²)/2 [m²/s²], shifted to gη at the crest (Bernoulli), (n_times, n_points)."""

        def total(points: FloatArray, t: FloatArray) -> FloatArray:
            C, S, _, cos, sin = self._harmonics_at(points, t)
            u, w = (C * cos).sum(-1), -(S * sin).sum(-1)
            return np.asarray(self.omega / self.k * u - 0.5 * (u**2 + w**2))

        crest = float(self.eta.sum())
        at_crest = total(np.array([[0.0, 0.0, crest]]), np.zeros(1))[0, 0]
        return np.asarray(total(points, t) + GRAVITY_M_S2 * crest - at_crest)

    def _harmonics_at(
        self, points: FloatArray, t: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return harmonics of u and w at the points, jk, cos jθ and sin jθ, (n_times, n_points, n)."""
        theta = self._phase(points, t)
        z = np.minimum(points[:, 2], self.elevation(points, t))
        j = np.arange(1, self.u.size + 1)
        kj, cos, sin = j * self.k, np.cos(theta[..., None] * j), np.sin(theta[..., None] * j)
        down, up = np.exp(kj * z[..., None]), np.exp(-kj * (z[..., None] + 2.0 * self.depth))
        base = 1.0 + np.exp(-2.0 * kj * self.depth)
        C, S = np.asarray(self.u * (down + up) / base), np.asarray(self.u * (down - up) / base)
        return C, S, np.asarray(kj), np.asarray(cos), np.asarray(sin)

    def _phase(self, points: FloatArray, t: FloatArray) -> FloatArray:
        along = points[:, 0] * np.cos(self.direction) + points[:, 1] * np.sin(self.direction)
        return np.asarray(self.omega * np.atleast_1d(t)[:, None] - self.k * along)

    def _heading(self, u: FloatArray, w: FloatArray) -> FloatArray:
        return np.stack([u * np.cos(self.direction), u * np.sin(self.direction), w], axis=-1)


def regular_wave(
    theory: str,
    *,
    height: float,
    period: float,
    depth: float,
    direction: float = 0.0,
    order: int | None = None,
) -> RegularWave:
    """Return a steep regular wave with its crest at the origin at t = 0 and zero mean Eulerian current.

    Parameters
    ----------
    theory : {"stokes-5", "stream-function"}
        Fenton (1985), or Rienecker & Fenton (1981).
    order : int, optional
        Number of harmonics of the stream function; default 12, more in shallow water.

    Raises
    ------
    MissingExtra
        If raschii is not installed.
    InputError
        If the theory is unknown or not valid for the wave, or the wave breaks.
    NumericalError
        If the solution does not converge.
    """
    if theory not in THEORIES:
        raise InputError("unknown wave theory", field="theory", value=theory, allowed=", ".join(THEORIES))
    length = 2.0 * np.pi / float(wave_number(2.0 * np.pi / period, depth))
    # steep waves are up to a fifth longer than linear ones
    _require_unbroken(height, highest_wave(1.2 * length, depth))
    ursell = height * length**2 / depth**3
    if theory == "stokes-5" and ursell > HIGHEST_URSELL:
        raise InputError(
            "wave too long for the depth: Stokes' fifth order is not valid",
            field="theory",
            value=f"stokes-5 at an Ursell number Hλ²/d³ of {ursell:.0f}",
            allowed=f"up to {HIGHEST_URSELL:g}",
            remedy="use the stream function",
        )
    n = 5 if theory == "stokes-5" else order or min(12 + int(ursell / 10.0), 30)
    wave = _solve(theory, height, period, depth, n)
    _require_unbroken(height, highest_wave(float(wave.length), depth))
    return _harmonics(wave, n, depth, direction)


def highest_wave(length: float, depth: float) -> float:
    """Return the height [m] at which waves of a length break, Fenton (1990) eq. (32) from Williams (1981).

    >>> round(highest_wave(100.0, 1e4), 2)  # deep water: 0.141 λ
    14.1
    """
    x = length / depth
    above = 0.141063 * x + 0.0095721 * x**2 + 0.0077829 * x**3
    below = 1.0 + 0.0788340 * x + 0.0317567 * x**2 + 0.0093407 * x**3
    return depth * above / below


def _require_unbroken(height: float, highest: float) -> None:
    if not 0.0 < height <= highest:
        raise InputError("wave breaks", field="height", value=height, allowed=f"0 to {highest:.3g} m")


def _solve(theory: str, height: float, period: float, depth: float, n: int):  # type: ignore[no-untyped-def]
    """Return raschii's solution."""
    try:
        import raschii
    except ImportError:
        raise MissingExtra(
            "steep regular waves need raschii",
            field="theory",
            value=theory,
            remedy="pip install jackettwin[waves]",
        ) from None
    model = raschii.StokesWave if theory == "stokes-5" else raschii.FentonWave
    try:
        return model(height=height, depth=depth, period=period, N=n, g=GRAVITY_M_S2)
    except (raschii.common.RaschiiError, ArithmeticError) as error:
        raise NumericalError(f"{theory} wave: {error}") from error


def _harmonics(wave, n: int, depth: float, direction: float) -> RegularWave:  # type: ignore[no-untyped-def]
    """Return the harmonics of a solution, sampled over one wave length."""
    m = 8 * n
    x = np.arange(m) / m * wave.length
    k = 2.0 * np.pi / wave.length
    eta = np.asarray(wave.surface_elevation(x)) - depth
    level = float(eta.min()) + depth
    u = np.asarray(wave.velocity(x, np.full(m, level)))[:, 0]
    j = np.arange(1, n + 1)
    at_level = 2.0 / m * np.fft.rfft(u).real[1 : n + 1]
    surface = 2.0 / m * np.fft.rfft(eta).real[1 : n + 1]
    to_bed = np.cosh(j * k * depth) / np.cosh(j * k * level)
    return RegularWave(k, float(wave.c) * k, depth, surface, at_level * to_bed, direction)
