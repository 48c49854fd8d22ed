"""Random cantilevers, buildings and bridges whose sensors are right: what faults must not be seen in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from jackettwin.records import Channel, Record

ELEMENTS = 30
UP = (0.0, 0.0, 1.0)
ALONG = (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class Driven:
    """How a structure is shaken and measured; frequencies in units of the first."""

    rate: float
    duration: float
    exponent: float
    noise: float
    wave: tuple[float, float]


def driven(rng: np.random.Generator) -> Driven:
    """Return forces white to f^−3 in power, waves in 40 %, noise of 0.1 to 20 %, 15 to 3,600 cycles."""
    rate = rng.choice([12.0, 25.0, 60.0])
    duration = min(10 ** rng.uniform(np.log10(15.0), np.log10(3600.0)), 60_000 / rate)
    wave = (rng.uniform(0.3, 1.5), rng.choice([0.0, 10 ** rng.uniform(0.0, 1.0)], p=[0.6, 0.4]))
    return Driven(rate, duration, rng.choice([0.0, 0.5, 1.0, 1.5]), 10 ** rng.uniform(-3.0, -0.7), wave)


def bending(
    n: int,
    *,
    taper: float = 1.0,
    tip_mass: float = 0.0,
    foot: float | None = None,
    piers: tuple[int, ...] = (),
) -> tuple[np.ndarray, np.ndarray]:
    """Return n frequencies, in units of the first, and shapes (nodes, n) of a beam of unit length.

    Euler–Bernoulli elements; ``foot`` is the rotational stiffness of a clamped end, ``piers`` are held nodes.
    """
    h, middle = 1.0 / ELEMENTS, (np.arange(ELEMENTS) + 0.5) / ELEMENTS
    width = 1.0 - (1.0 - taper) * middle
    k, m = np.zeros((2, 2 * ELEMENTS + 2, 2 * ELEMENTS + 2))
    bend = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], dtype=float)
    move = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]], dtype=float)
    size = np.array([1.0, h, 1.0, h])
    for e in range(ELEMENTS):
        at = slice(2 * e, 2 * e + 4)
        k[at, at] += width[e] ** 3 / h**3 * np.outer(size, size) * bend
        m[at, at] += width[e] * h / 420.0 * np.outer(size, size) * move
    m[-2, -2] += tip_mass
    held = [2 * node for node in piers]
    if foot is not None:
        held, k[1, 1] = [0], k[1, 1] + foot
    free = [i for i in range(len(k)) if i not in held]
    square, vectors = la.eigh(k[np.ix_(free, free)], m[np.ix_(free, free)], subset_by_index=(0, n - 1))
    shapes = np.zeros((len(k), n))
    shapes[free] = vectors
    return np.sqrt(square / square[0]), shapes[::2]


def measured(
    rng: np.random.Generator,
    f: np.ndarray,
    at_sensors: np.ndarray,
    at_forces: np.ndarray,
    channels: tuple[Channel, ...],
) -> Record:
    """Return accelerations of modes under random forces; the second half of twice the duration."""
    how = driven(rng)
    f1 = 10 ** rng.uniform(-0.9, 0.7)
    n = int(how.rate * how.duration)
    line = np.fft.rfftfreq(2 * n, 1.0 / how.rate)
    force = rng.normal(size=(len(at_forces), len(line), 2)) @ np.array([1.0, 1j])
    force *= np.maximum(line, 0.05) ** -how.exponent
    force *= 1.0 + how.wave[1] * np.exp(-0.5 * ((line / how.wave[0] - 1.0) / 0.15) ** 2)
    zeta = 10 ** rng.uniform(-2.4, -1.3, len(f))[:, None]
    modal = at_forces.T @ force / (f[:, None] ** 2 - line**2 + 2j * zeta * f[:, None] * line)
    modal[f > 0.45 * how.rate] = 0.0
    y = np.fft.irfft(-(line**2) * (at_sensors @ modal), 2 * n)[:, n:]
    y += how.noise * y.std(axis=1, keepdims=True) * rng.normal(size=y.shape)
    return Record(y, how.rate * f1, channels)


def cantilever(rng: np.random.Generator) -> Record:
    """Return a tower: tapered, with or without a mass on top, on a soft or stiff foot, two to six heights."""
    f, shapes = bending(
        5,
        taper=rng.uniform(0.2, 1.0),
        tip_mass=rng.choice([0.0, rng.uniform(0.0, 3.0)]),
        foot=10 ** rng.uniform(-1.0, 3.0),
    )
    nodes = np.sort(rng.choice(np.arange(6, 31), rng.integers(2, 7), replace=False))
    channels = tuple(Channel(f"a{i}_x", height_m=3.0 * i, direction=ALONG) for i in nodes)
    return measured(rng, f, shapes[nodes], shapes[rng.integers(5, 31, 3)], channels)


def building(rng: np.random.Generator) -> Record:
    """Return floors with one to three parallel sensors beside the axis, torsion at 0.7 to 2 times bending."""
    f, shapes = bending(3, foot=10 ** rng.uniform(-1.0, 3.0))
    floors = np.repeat(np.sort(rng.choice(np.arange(6, 31), 3, replace=False)), rng.integers(1, 4, 3))
    both = [
        np.hstack([shapes[nodes], 3.0 * rng.uniform(-1.0, 1.0, (len(nodes), 1)) * shapes[nodes]])
        for nodes in (floors, rng.integers(5, 31, 4))
    ]
    channels = tuple(
        Channel(f"f{k}_x", height_m=3.0 * node, direction=ALONG) for k, node in enumerate(floors)
    )
    f = np.concatenate([f, rng.uniform(0.7, 2.0) * f])
    return measured(rng, f / f.min(), both[0], both[1], channels)


def bridge(rng: np.random.Generator, *, height_m: float | None = None) -> Record:
    """Return one to five equal spans with two to eight vertical sensors anywhere."""
    spans = int(rng.choice([1, 2, 3, 5]))
    piers = tuple(range(0, ELEMENTS + 1, ELEMENTS // spans))
    f, shapes = bending(6, piers=piers)
    open_nodes = [i for i in range(ELEMENTS) if i not in piers]
    nodes = rng.choice(open_nodes, rng.integers(2, 9), replace=False)
    channels = tuple(Channel(f"a{k}_z", height_m=height_m, direction=UP) for k in range(len(nodes)))
    return measured(rng, f, shapes[nodes], shapes[rng.choice(open_nodes, 5)], channels)
