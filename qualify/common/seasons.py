"""Seasons of a jacket's modes, made without any code of ``jackettwin``: what a detector is judged on.

Tide, a temperature that the steel follows hours later, storms, records in clusters while the rotor is parked,
what no condition explains, stated standard deviations that are wrong, and a few outliers.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

N_MODES = 4
FREQUENCY_HZ = np.array([0.30, 0.303, 1.15, 1.22])
DAMPING = np.array([0.012, 0.011, 0.009, 0.010])
LEVEL = 1e-2 * np.array([-0.07, -0.07, -0.25, -0.23])
"""d ln f per metre of sea level."""
STEEL = 1e-2 * np.array([-0.010, -0.010, -0.012, -0.011])
"""d ln f per kelvin."""
WIND = 1e-2 * np.array([-0.010, -0.006, -0.008, -0.008])
"""d ln f per m/s."""
WAVE = 1e-2 * np.array([-0.04, -0.05, -0.03, -0.03])
"""d ln f per metre of significant height."""
PAIRS = ((0, 1), (2, 3))
TURN = 3e-5
"""What a m/s of wind adds to the coupling of a pair: half a degree for the closer one."""
NO_ANGLE = np.radians(20.0)
"""Standard deviation from which identification states no direction of a pair."""


@dataclass(frozen=True)
class Kind:
    """What the seasons are like.

    Attributes
    ----------
    memory : "two days", "six hours", "week", "month", "flicker" (1/f from hours to a season), "telegraph"
        (two levels), or "none"
    unexplained : standard deviation of it in ln f
    shared : share of its variance that both modes of a pair have in common
    common : share that all modes have in common
    wrong : by which the stated standard deviations are wrong, one factor exp(± wrong) a mode
    heavy : noise of Student's t with 4 degrees of freedom instead of a normal one, twice as strong in storms
    curved : wind and waves act as squares
    growth : by which ln f of the first pair falls in a year as marine growth thickens, most in late summer
    storms : by which the worst storm of the series lowers it: the ground softens and heals within weeks
    ground : by which it swings over the year with a temperature of the ground that nobody measures
    """

    memory: str = "two days"
    unexplained: float = 1e-3
    shared: float = 0.6
    common: float = 0.0
    wrong: float = 0.15
    heavy: bool = False
    curved: bool = False
    growth: float = 0.0
    storms: float = 0.0
    ground: float = 0.0
    outliers: float = 0.004
    clusters_a_year: float = 170.0
    records_a_cluster: float = 20.0


@dataclass(frozen=True)
class Seasons:
    """Modes through time: ``days`` (n,), the others (n, 4); ``conditions`` by name (n,).

    ``expected`` (2, n, 4) is what moves ln f and ln ζ, without the noise of identification. ``angle`` [rad]
    stands at the lower mode of a pair, and is NaN where there is none.
    """

    days: np.ndarray
    frequency: np.ndarray
    frequency_std: np.ndarray
    damping: np.ndarray
    damping_std: np.ndarray
    conditions: dict[str, np.ndarray]
    process: np.ndarray = field(repr=False)
    expected: np.ndarray = field(repr=False)
    noise_std: np.ndarray = field(repr=False)
    angle: np.ndarray = field(repr=False)
    angle_std: np.ndarray = field(repr=False)

    def changed(self, ln_f: np.ndarray, ln_zeta: np.ndarray | float = 0.0) -> Seasons:
        """Return the same seasons with (n, 4) added to ln f and ln ζ."""
        return replace(self, frequency=self.frequency * np.exp(ln_f), damping=self.damping * np.exp(ln_zeta))


def step(days: np.ndarray, begin: float, size: np.ndarray) -> np.ndarray:
    """Return (n, n_modes): a step of each mode at a time."""
    return (days >= begin)[:, None] * np.asarray(size)[None, :]


def ramp(days: np.ndarray, begin: float, over: float, size: np.ndarray) -> np.ndarray:
    """Return (n, n_modes): a ramp of each mode from a time on."""
    return np.clip((days - begin) / over, 0.0, 1.0)[:, None] * np.asarray(size)[None, :]


def seasons(seed: int, days: float, kind: Kind | None = None) -> Seasons:
    """Return some days of modes."""
    kind = kind or Kind()
    rng = np.random.default_rng((1812, seed))
    t = _record_times(rng, days, kind)
    grid = np.arange(0.0, days + 1.0, 1.0 / 144.0)
    level, air, steel, wind, wave = _weather(rng, grid)
    at = np.minimum(np.searchsorted(grid, t), grid.size - 1)
    drawn_wind, drawn_wave = wind[at], wave[at]
    if kind.curved:
        wind_effect, wave_effect = (drawn_wind / 10.0) ** 2 * 10.0, drawn_wave**2 / 2.0
    else:
        wind_effect, wave_effect = drawn_wind, drawn_wave
    process = unexplained(rng, t, days, kind)
    ln_f = (
        level[at][:, None] * LEVEL
        + (steel[at] - 10.0)[:, None] * STEEL
        + wind_effect[:, None] * WIND
        + wave_effect[:, None] * WAVE
        + process
        + benign(seed, grid, air, wave, kind)[at]
    )
    ln_zeta = 0.02 * drawn_wave[:, None] + 0.02 * (drawn_wind[:, None] - 8.0) * np.array([1.0, 0.3, 0.2, 0.2])
    ln_zeta = ln_zeta + 0.05 * unexplained(rng, t, days, replace(kind, unexplained=1.0))
    zeta = DAMPING * np.exp(ln_zeta)
    expected = np.stack([ln_f, ln_zeta])
    # Au's law with a factor for what identification loses and differs by record
    cycles = FREQUENCY_HZ * 600.0
    quality = np.exp(0.3 * rng.standard_normal((t.size, 1)) + 0.15 * rng.standard_normal((t.size, N_MODES)))
    if kind.heavy:
        quality = quality * (1.0 + drawn_wave[:, None] / 3.0)
    f_std = 1.2 * quality * np.sqrt(zeta / (2.0 * np.pi * cycles))
    z_std = 1.2 * quality / np.sqrt(2.0 * np.pi * zeta * cycles)
    draw = _student if kind.heavy else np.random.Generator.standard_normal
    ln_f = ln_f + f_std * draw(rng, (t.size, N_MODES))
    ln_zeta_seen = np.log(zeta) + np.minimum(z_std, 0.6) * draw(rng, (t.size, N_MODES))
    out = rng.random((t.size, N_MODES)) < kind.outliers
    ln_f = ln_f + out * rng.choice([-1.0, 1.0], out.shape) * rng.uniform(0.02, 0.08, out.shape)
    wrong_f = np.exp(kind.wrong * rng.choice([-1.0, 1.0], N_MODES))
    wrong_z = np.exp(kind.wrong * rng.choice([-1.0, 1.0], N_MODES))
    frequency = FREQUENCY_HZ * np.exp(ln_f)
    damping = np.exp(ln_zeta_seen)
    angle, angle_std = _angles(seed, t, days, kind, frequency, f_std, drawn_wind)
    wrong_a = np.exp(kind.wrong * rng.choice([-1.0, 1.0], N_MODES))
    return Seasons(
        t, frequency, frequency * f_std * wrong_f, damping, damping * np.minimum(z_std, 0.6) * wrong_z,
        {"sea_level_m": level[at], "air_temperature_c": air[at], "wind_speed_m_s": drawn_wind, "hs_m":
        drawn_wave}, process, expected, f_std, angle, angle_std * wrong_a,
    )  # fmt: skip


def benign(seed: int, t: np.ndarray, air: np.ndarray, wave: np.ndarray, kind: Kind) -> np.ndarray:
    """Return (n, 4) what slow processes that harm nobody add to ln f: growth, storms that heal, the ground.

    Each turbine has its own rate, time to heal and lag.
    """
    rng = np.random.default_rng((1814, seed))
    rate, healing, lag = rng.uniform(0.5, 1.5), rng.uniform(10.0, 40.0), rng.uniform(25.0, 60.0)
    season = 2.0 * np.pi * (t - 240.0) / 365.25
    thickness = (t + 0.9 * np.sin(season) * 365.25 / (2.0 * np.pi)) / 365.25
    hit = np.maximum(wave - 3.5, 0.0) ** 1.5
    softened = _behind(hit, t[1] - t[0], healing)
    anomaly = 1.5 * _ou(rng, t, 30.0)
    warmth = _behind(air + anomaly, t[1] - t[0], lag)
    slow = (
        -kind.growth * rate * np.array([1.0, 1.0, 0.6, 0.7])[:, None] * thickness,
        -kind.storms * rate * np.array([1.0, 0.9, 0.4, 0.5])[:, None] * softened / max(softened.max(), 1e-12),
        -kind.ground * rate * np.array([1.0, 1.0, 0.5, 0.4])[:, None] * (warmth - warmth.mean()) / 7.0,
    )
    return np.sum(slow, axis=0).T


def _behind(x: np.ndarray, gap: float, memory: float) -> np.ndarray:
    """Return what follows a series with a time constant, from its own mean on."""
    keep = np.exp(-gap / memory)
    out, value = np.empty(x.size), float(x.mean())
    for i, one in enumerate(x):
        value = keep * value + (1.0 - keep) * one
        out[i] = value
    return out


def _angles(
    seed: int, t: np.ndarray, days: float, kind: Kind, frequency: np.ndarray, f_std: np.ndarray,
    wind: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Return the directions of pairs and their standard deviations, (n, 4) each; NaN where there is none.

    What couples two modes turns them, by ½ atan 2κ/g where the coupling is κ and the frequencies are ln g
    apart; identification does the same by what it is unsure of.
    """
    rng = np.random.default_rng((1813, seed))
    angle, std = np.full((2, t.size, N_MODES), np.nan)
    draw = _student if kind.heavy else np.random.Generator.standard_normal
    for pair in PAIRS:
        own = np.sqrt(max(1.0 - kind.shared - kind.common, 0.0))
        coupling = kind.unexplained * own * _slow(rng, t, days, kind.memory) + TURN * wind
        gap = np.log(FREQUENCY_HZ[pair[1]] / FREQUENCY_HZ[pair[0]])
        mixed = np.hypot(*f_std[:, pair].T)
        turned = 0.5 * np.arctan2(2.0 * coupling, gap) + mixed / gap * draw(rng, (t.size,))
        turned = np.where(rng.random(t.size) < kind.outliers, rng.uniform(-np.pi, np.pi, t.size), turned)
        seen = np.log(frequency[:, pair])
        stated = mixed / np.abs(seen[:, 1] - seen[:, 0])
        rows = np.flatnonzero(stated < NO_ANGLE)
        lower = np.array(pair)[np.argmin(seen[rows], axis=1)]
        angle[rows, lower], std[rows, lower] = turned[rows], stated[rows]
    return angle, std


def _student(rng: np.random.Generator, size: tuple[int, ...]) -> np.ndarray:
    return rng.standard_t(4.0, size) / np.sqrt(2.0)


def _record_times(rng: np.random.Generator, days: float, kind: Kind) -> np.ndarray:
    starts = np.cumsum(rng.exponential(365.0 / kind.clusters_a_year, int(3 * days) + 50))
    times: list[np.ndarray] = []
    last = 0.0
    for start in starts[starts < days]:
        begin = np.ceil(max(start, last) * 144.0) / 144.0
        number = 1 + rng.geometric(1.0 / kind.records_a_cluster)
        times.append(begin + np.arange(number) / 144.0)
        last = begin + number / 144.0
    t = np.concatenate(times)
    return t[t < days]


def _weather(rng: np.random.Generator, t: np.ndarray) -> tuple[np.ndarray, ...]:
    spring = 1.0 + 0.3 * np.cos(2.0 * np.pi * t / 14.77)
    surge = 0.15 * _ou(rng, t, 1.0)
    level = 1.3 * spring * np.cos(2.0 * np.pi * t / (12.42 / 24.0) + rng.uniform(0, 6)) + surge
    season = np.cos(2.0 * np.pi * (t - 30.0) / 365.25)
    sun = 2.0 * np.cos(2.0 * np.pi * (t - 0.6)) * (1.0 - 0.3 * season)
    air = 10.0 - 7.0 * season + sun + 2.5 * _ou(rng, t, 3.0)
    lag = 6.0 / 24.0
    keep = np.exp(-(t[1] - t[0]) / lag)
    steel = np.empty_like(air)
    steel[0] = air[0]
    for i in range(1, t.size):
        steel[i] = keep * steel[i - 1] + (1.0 - keep) * air[i]
    blow = _ou(rng, t, 1.5)
    wind = np.clip(8.5 * (1.0 + 0.15 * season) * np.exp(0.45 * blow - 0.1), 0.3, 35.0)
    wave = 0.3 + 0.012 * wind**2 * np.exp(0.15 * _ou(rng, t, 0.5))
    return level, air, steel, wind, wave


def _ou(rng: np.random.Generator, t: np.ndarray, memory: float) -> np.ndarray:
    gaps = np.diff(t, prepend=t[0])
    keep = np.exp(-gaps / memory)
    drive = rng.standard_normal(t.size) * np.sqrt(1.0 - keep**2)
    drive[0] = rng.standard_normal()
    x = np.empty(t.size)
    value = 0.0
    for i in range(t.size):
        value = keep[i] * value + drive[i] if i else drive[0]
        x[i] = value
    return x


def unexplained(rng: np.random.Generator, t: np.ndarray, days: float, kind: Kind) -> np.ndarray:
    """Return (n, 4): common to all, shared by pairs, and of each mode."""

    def one() -> np.ndarray:
        return _slow(rng, t, days, kind.memory)

    everywhere, pairs = one(), [one(), one()]
    columns = []
    for mode in range(N_MODES):
        own = 1.0 - kind.shared - kind.common
        columns.append(
            np.sqrt(kind.common) * everywhere
            + np.sqrt(kind.shared) * pairs[mode // 2]
            + np.sqrt(max(own, 0.0)) * one()
        )
    return kind.unexplained * np.stack(columns, axis=1)


def _slow(rng: np.random.Generator, t: np.ndarray, days: float, memory: str) -> np.ndarray:
    """Return a process of unit variance."""
    if memory == "none":
        return np.zeros(t.size)
    if memory == "flicker":
        times = (0.1, 0.4, 1.6, 6.4, 25.6, 100.0)
        return sum(_ou(rng, t, m) for m in times) / np.sqrt(len(times))
    if memory == "telegraph":
        flips = np.cumsum(rng.exponential(4.0, int(days) + 20))
        return 1.0 - 2.0 * (np.searchsorted(flips, t) % 2)
    return _ou(rng, t, {"two days": 2.0, "six hours": 0.25, "week": 7.0, "month": 30.0}[memory])
