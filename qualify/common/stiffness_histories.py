"""Years of daily records of a jacket whose stiffness is known on every day, seasons and all.

Weather and what no condition explains are made here, without any of the product's processes; of the product
only frequencies on ground of a given stiffness are taken, from a table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

import numpy as np

MODES = (1, 2, 4, 5)
START = datetime(2021, 3, 1, 12, tzinfo=UTC)
TEMPERATURE = 1e-4 * np.array([-1.0, -0.9, -1.3, -1.2])
"""d ln f per kelvin of the steel: as of welded towers and jackets, E falls by some 0.03 % a kelvin."""
LEVEL = 1e-3 * np.array([-0.4, -0.4, -1.6, -1.5])
"""d ln f per metre of sea level."""
WIND = 1e-4 * np.array([-0.8, -0.5, -0.6, -0.6])
"""d ln f per m/s."""
KINDS = ("steady", "step", "fall", "wander", "two steps")


@dataclass(frozen=True)
class History:
    """Daily records: ``ln_f`` and ``std`` (n, 4), ``stiffness`` (n,) over that of the first day."""

    days: np.ndarray
    ln_f: np.ndarray
    std: np.ndarray
    damping: np.ndarray
    damping_std: np.ndarray
    stiffness: np.ndarray
    conditions: dict[str, np.ndarray]
    k: float
    kind: str
    begun: int

    def records(
        self,
    ) -> Iterator[tuple[datetime, dict[int, tuple[float, float, float, float]], dict[str, float]]]:
        """Yield when each record began, f, σ(ln f), ζ and σ(ln ζ) of its modes, and its conditions."""
        for i, day in enumerate(self.days):
            f, spread = np.exp(self.ln_f[i]), self.std[i]
            modes = {
                mode: (float(f[q]), float(spread[q]), float(self.damping[q]), float(self.damping_std[q]))
                for q, mode in enumerate(MODES)
            }
            beside = {name: float(values[i]) for name, values in self.conditions.items()}
            yield START + timedelta(days=float(day)), modes, beside


def modes_table(poles: Callable[[float], np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return ln k, and ln f and ζ of the modes there, from a function that returns the poles at ln k."""
    ln_k = np.linspace(np.log(4e8), np.log(1.6e10), 50)
    found = np.array([poles(x) for x in ln_k])
    return ln_k, np.log(np.abs(found) / (2.0 * np.pi)), -found.real / np.abs(found)


def stiffness(rng: np.random.Generator, n: int, kind: str, step: float, begun: int) -> np.ndarray:
    """Return the stiffness of every day over that of the first."""
    x = np.zeros(n)
    if kind in ("step", "two steps"):
        x[begun:] += np.log1p(step)
    if kind == "two steps":
        x[begun // 2 :] += np.log(1.08)
    if kind == "fall":  # scour that goes on for some months, then stays
        x += np.log(0.88) * np.clip((np.arange(n) - begun) / 200.0, 0.0, 1.0)
    if kind == "wander":
        x += np.cumsum(0.002 * rng.standard_t(5.0, n))
        x -= x[0]
    return np.exp(x)


def history(
    seed: int, table: tuple[np.ndarray, ...], *, kind: str, days: int = 1095, k: float | None = None,
    step: float = -0.15, told: bool = True, missing: float = 0.1, off: float = 0.0,
) -> History:  # fmt: skip
    """Return one history.

    Parameters
    ----------
    table : ln k, and of the modes ln f and ζ there, (n,), (n, 4), (n, 4)
    told : whether conditions stand beside the records
    missing : share of days without a record
    off : standard deviation of ln f by which the structure is not its model
    """
    rng = np.random.default_rng((3107, seed))
    t = np.arange(days)[rng.random(days) >= missing].astype(float)
    n = t.size
    begun = int(rng.uniform(0.25, 0.75) * n)
    k = float(np.exp(rng.uniform(np.log(1e9), np.log(5e9)))) if k is None else k
    ratio = stiffness(rng, n, kind, step, begun)
    year = np.cos(2.0 * np.pi * (t - 20.0) / 365.25) + 0.15 * np.cos(4.0 * np.pi * t / 365.25 + 1.0)
    weather = _moving(rng, t, 5)
    air = 10.0 - 7.0 * year + 2.5 * weather
    steel = 10.0 - 7.0 * np.roll(year, 3) + 1.8 * np.convolve(weather, np.ones(4) / 4.0, "same")
    level = 0.9 * np.sin(2.0 * np.pi * t / 14.77 + rng.uniform(0, 6)) + 0.3 * _moving(rng, t, 3)
    wind = 9.0 * rng.weibull(2.2, n) * (1.0 + 0.2 * year)
    size = float(rng.choice([2e-4, 5e-4, 1e-3]))
    rest = np.sqrt(0.4) * _moving(rng, t, 9)[:, None] + np.sqrt(0.6) * np.stack(
        [_moving(rng, t, 4) for _ in MODES], axis=1
    )
    at = np.log(k * ratio)
    ln_k, ln_f, zeta = table
    true = np.stack([np.interp(at, ln_k, column) for column in ln_f.T], axis=1) + off * rng.standard_normal(4)
    true = true + (steel - 10.0)[:, None] * TEMPERATURE + level[:, None] * LEVEL + wind[:, None] * WIND
    damping = np.array([np.interp(np.log(k), ln_k, column) for column in zeta.T])
    # Au 2014: what ten minutes tell at best; an identification loses a third of it
    cycles = 600.0 * np.exp(true.mean(axis=0))
    std = 1.3 * np.sqrt(damping / (2.0 * np.pi * cycles))
    heavy = rng.standard_t(6.0, (n, 4)) / np.sqrt(1.5)
    wild = (rng.random((n, 4)) < 0.004) * rng.uniform(-0.02, 0.02, (n, 4))
    seen = true + size * rest + std * heavy + wild
    beside = {"air_temperature_c": air, "mean_wind_speed_m_s": wind, "water_level_m": level} if told else {}
    stated = std * np.exp(0.15 * rng.standard_normal((n, 4)))
    zeta_std = np.minimum(1.3 / np.sqrt(2.0 * np.pi * damping * cycles), 0.5)
    return History(t, seen, stated, damping, zeta_std, ratio, beside, k, kind, begun)


def _moving(rng: np.random.Generator, t: np.ndarray, width: int) -> np.ndarray:
    """Return a moving mean of unit variance: not one of the processes that the product knows."""
    days = int(t.max()) + 1
    weight = np.hanning(2 * width + 3)[1:-1]
    x = np.convolve(rng.standard_normal(days + weight.size), weight / np.linalg.norm(weight), "valid")
    return x[t.astype(int)]
