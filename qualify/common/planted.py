"""Random modal systems, and which identified mode stands for which true one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from jackettwin.identification import Identification, mac
from jackettwin.identification.synthetic import ModalSystem

CLOSE_SHARE = 0.5
"""Share of the systems that hold a close pair."""
SAME = 0.7
"""Largest distance, frequency in three half bandwidths plus 1 − MAC, of an estimate and its truth."""
FINDABLE_PEAK = 4.0
"""A mode is findable if its peak stands this far above everything else in some direction of the channels …"""
FINDABLE_CYCLES = 3.0
"""… and the record holds so many times its memory, ζfT."""


@dataclass(frozen=True)
class RandomSystem:
    """A system and how its record is taken."""

    system: ModalSystem
    duration_s: float
    sample_rate_hz: float
    rank: int


def random_system(rng: np.random.Generator) -> RandomSystem:
    """Draw a system: 2–12 channels, 2–10 modes, damping 0.3–6 %, white to f⁻³ forces of rank one to full."""
    n_modes, n_channels = int(rng.integers(2, 11)), int(rng.integers(2, 13))
    first = 10 ** rng.uniform(-1.0, 0.3)
    ratio = rng.uniform(1.15, 2.2, n_modes - 1)
    if rng.uniform() < CLOSE_SHARE:
        ratio[rng.integers(0, n_modes - 1)] = 1.0 + 10 ** rng.uniform(-2.0, -0.9)
    f = first * np.cumprod(np.append(1.0, ratio))
    f = f[f < 20.0 * first]
    n_modes = len(f)
    zeta = 10 ** rng.uniform(np.log10(0.003), np.log10(0.06), n_modes)
    shapes = rng.standard_normal((n_modes, n_channels))
    rank = int(rng.integers(1, 2 * n_modes + 1))
    mixing = rng.standard_normal((n_modes, rank))
    # a trace of independent force keeps the matrix positive definite
    force = mixing @ mixing.T + 1e-4 * rank * np.eye(n_modes)
    size = f / 10 ** rng.uniform(-0.5, 0.5, n_modes)
    slope = float(rng.choice([0.0, 0.0, 1.0, 2.0, 3.0]))
    force = force / np.outer(size, size) * np.sqrt(np.outer(f, f)) ** slope
    noise = float(10 ** rng.uniform(-2.5, -0.52))
    rate = f[-1] * float(10 ** rng.uniform(np.log10(3.0), 1.5))
    duration = float(10 ** rng.uniform(np.log10(120.0), np.log10(1500.0)) / first)
    duration = min(duration, 120_000 / rate)
    system = ModalSystem(f, zeta, shapes, force, noise, slope)
    return RandomSystem(system, duration, float(rate), min(rank, n_modes))


def matched(
    found: Identification,
    system: ModalSystem,
    duration_s: float | None = None,
    *,
    channels: list[int] | None = None,
    sense: list[float] | None = None,
) -> list[dict[str, Any]]:
    """Return for every true mode what stands for it: status, errors, whether its intervals hold.

    Each identified mode stands for one true mode at most.

    Parameters
    ----------
    channels : of the system that are in the result; default: all
    sense : sign of every channel of the system that was planted: shapes may be turned as these are
    """
    f, zeta = system.frequency_hz, system.damping_ratio
    peak = findable(system, found.duration_s if duration_s is None else duration_s)
    low, high = found.settings.lowest_frequency_hz, found.settings.highest_frequency_hz
    out: list[dict[str, Any]] = [
        {
            "frequency_hz": float(f[k]),
            "findable": bool(peak[k] and 1.1 * low < f[k] < high / 1.1),
            "status": None,
            "mode": None,
            "frequency_inside": None,
            "damping_inside": None,
            "damping_z": None,
        }
        for k in range(len(f))
    ]
    if not found.modes:
        return out
    own = np.array([m.frequency_hz for m in found.modes])
    own_zeta = np.array([m.damping_ratio for m in found.modes])
    own_shapes = np.array([m.mode_shape for m in found.modes])
    kept = np.arange(system.mode_shapes.shape[1]) if channels is None else np.array(channels)
    similar = mac(system.mode_shapes[:, kept], own_shapes)
    if sense is not None:
        turned = (system.mode_shapes * np.array(sense))[:, kept]
        similar = np.maximum(similar, mac(turned, own_shapes))
    width = 3.0 * np.maximum(zeta[:, None], np.minimum(own_zeta, 2.0 * zeta[:, None]))
    apart = np.abs(np.log(own / f[:, None])) / width + 1.0 - similar
    rows, columns = linear_sum_assignment(np.minimum(apart, 2.0))
    for k, j in zip(rows, columns, strict=True):
        if apart[k, j] > SAME:
            continue
        m = found.modes[j]
        out[k] |= {"status": m.status.value, "mode": int(j), **inside(m, float(f[k]), float(zeta[k]))}
    return out


def inside(m: Any, f: float, zeta: float) -> dict[str, Any]:
    """Return whether the intervals of a mode hold its truth, and the error of ln ζ in standard deviations."""
    if m.frequency_interval_90 is None:
        return {"frequency_inside": False, "damping_inside": False, "damping_z": np.nan}
    (a, b), (c, d) = m.frequency_interval_90, m.damping_ratio_interval_90
    z = np.log([m.frequency_hz / f, m.damping_ratio / zeta]) / np.sqrt(np.diag(m.log_covariance))
    return {
        "frequency_inside": bool(a < f < b),
        "damping_inside": bool(c < zeta < d),
        "frequency_z": float(z[0]),
        "damping_z": float(z[1]),
    }


def findable(system: ModalSystem, duration_s: float) -> np.ndarray:
    """Return which modes stand out at their frequency in the direction that sees nothing else, (n_modes,).

    The power there of the mode alone over that of everything else, seen through the inverse of the
    spectral matrix of the rest: what the best linear combination of the channels can make of it.
    """
    f, zeta = system.frequency_hz, system.damping_ratio
    diagonal = np.diag(system.force)
    noise = system.noise_ratio**2 * _noise(system)
    out = np.zeros(len(f), dtype=bool)
    for k in range(len(f)):
        h = -(f[k] ** 2) / (f**2 - f[k] ** 2 + 2j * zeta * f * f[k]) * f[k] ** (-0.5 * system.force_slope)
        others = [i for i in range(len(f)) if i != k]
        moved = system.mode_shapes.T * h
        rest = moved[:, others] @ system.force[np.ix_(others, others)] @ moved[:, others].conj().T
        rest = rest + np.diag(noise)
        phi = moved[:, k]
        ratio = diagonal[k] * np.real(phi.conj() @ np.linalg.solve(rest, phi))
        out[k] = ratio > FINDABLE_PEAK and zeta[k] * f[k] * duration_s > FINDABLE_CYCLES
    return out


def _noise(system: ModalSystem) -> np.ndarray:
    """Return the mean density of every channel below twice the highest mode, (n_channels,)."""
    f = system.frequency_hz
    x = np.linspace(0.0, 2.0 * f[-1], 4001)[1:, None]
    h = -(x**2) / (f**2 - x**2 + 2j * system.damping_ratio * f * x) * x ** (-0.5 * system.force_slope)
    moved = h * system.mode_shapes.T[:, None, :]
    return np.asarray(np.mean(np.sum(moved @ system.force * moved.conj(), axis=2).real, axis=1))


def recognised(
    said: list[tuple[float, float, np.ndarray]],
    system: ModalSystem,
    clear: list[bool],
    sense: list[float] | None = None,
) -> dict[str, int]:
    """Return how many reported modes are true, how many are not, and how many findable ones are lost."""
    f, zeta = system.frequency_hz, system.damping_ratio
    taken: set[int] = set()
    if said:
        own = np.array([mode[0] for mode in said])
        shapes = system.mode_shapes * (1.0 if sense is None else np.array(sense))
        similar = mac(shapes, np.array([mode[2] for mode in said]))
        apart = np.abs(np.log(own / f[:, None])) / (3.0 * zeta[:, None]) + 1.0 - similar
        rows, columns = linear_sum_assignment(np.minimum(apart, 2.0))
        taken = {int(k) for k, j in zip(rows, columns, strict=True) if apart[k, j] <= SAME}
    lost = sum(clear[k] and k not in taken for k in range(len(f)))
    return {"true": len(taken), "false": len(said) - len(taken), "lost": lost, "findable": sum(clear)}
