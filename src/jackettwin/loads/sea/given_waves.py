"""A sea with given elevation, measured or from another program."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located, require
from jackettwin.files import read_text
from jackettwin.loads.sea.waves import AirySea

_LONGEST = 2_000_000
"""Largest number of rows of a file of elevations."""
FIELD = "file"
"""Key of ``waves`` in a scenario."""
_STEP_S = 1.0
"""Longest step between rows; the shortest wave that is used has a period of 1.7 s."""
_HIGHEST_M = 100.0
_COLUMNS = "give two columns, time [s] and elevation [m], with decimal points"


@dataclass(frozen=True, eq=False)
class Elevation:
    """Elevation η [m] at the structure's axis, at increasing times from the start of the simulation [s]."""

    time_s: FloatArray
    eta_m: FloatArray

    def __post_init__(self) -> None:
        steps = np.diff(self.time_s)
        if steps.size < 7 or not (steps > 0.0).all():
            raise InputError(
                "too few rows, or times do not increase",
                field=FIELD,
                value=int(self.time_s.size),
                allowed="8 rows or more",
                remedy="sort the rows by their time in seconds",
            )
        if steps.max() > _STEP_S + 1e-6:
            raise InputError(
                f"a gap after {self.time_s[np.argmax(steps)]:g} s",
                field=FIELD,
                value=float(steps.max()),
                allowed=f"steps up to {_STEP_S:g} s",
                remedy="fill the gap, or give times in seconds",
            )
        require_physical("elevation", self.eta_m, _HIGHEST_M, "m")

    @property
    def significant_height_m(self) -> float:
        """4σ."""
        return float(4.0 * np.std(self.eta_m))

    @property
    def peak_period_s(self) -> float:
        """Period of the largest line of the spectrum, averaged over five."""
        t = np.linspace(self.time_s[0], self.time_s[-1], self.time_s.size)
        eta = np.interp(t, self.time_s, self.eta_m)
        power = np.abs(np.fft.rfft(eta - eta.mean())) ** 2
        smooth = np.convolve(power, np.ones(5) / 5.0, mode="same")
        f = np.fft.rfftfreq(t.size, t[1] - t[0])
        return float(1.0 / f[1:][np.argmax(smooth[1:])])


def require_physical(what: str, values: FloatArray, highest: float, unit: str) -> None:
    """Raise an error for values that are not finite or physically impossible.

    Raises
    ------
    InputError
        If there is such a value; the message names the first.
    """
    wrong = ~(np.abs(values) <= highest)
    if wrong.any():
        raise InputError(
            f"no {what} of water",
            field=FIELD,
            value=float(values[wrong][0]),
            allowed=f"numbers up to {highest:g} {unit}",
            remedy="check the unit, and give a number in every row",
        )


def read_elevation(path: Path) -> Elevation:
    """Read two columns, time [s] and elevation [m], after any header lines, from a CSV or text file.

    Raises
    ------
    InputError
        If the file is missing or has no such columns.
    """
    rows = []
    for line in read_text(path, what="file of wave elevations").splitlines()[:_LONGEST]:
        # a comma together with another separator is a decimal comma, which is not accepted
        words = line.split(";" if ";" in line else "," if "," in line else None)
        try:
            rows.append((float(words[0]), float(words[1])))
        except (ValueError, IndexError):
            if rows and line.strip():
                raise InputError(
                    "not two numbers", file=path, field=FIELD, value=line.strip(), remedy=_COLUMNS
                ) from None
    require(rows, "no rows of time and elevation", file=path, field=FIELD, remedy=_COLUMNS)
    with located(file=path):
        return Elevation(*np.array(rows).T)


def require_cover(elevation: Elevation, duration: float) -> None:
    """Raise an error if an elevation does not cover ``duration`` [s].

    Raises
    ------
    InputError
        If it is shorter by more than a second, or starts after the simulation.
    """
    t = elevation.time_s
    if t[0] > 1e-6 or t[-1] < duration * (1.0 - 1e-3) - 1.0:
        raise InputError(
            "the elevation does not cover the simulation",
            field="waves.file",
            value=[float(t[0]), float(t[-1])],
            allowed=f"0 to {duration:g} s, including the discarded part",
            remedy="shorten time.duration_s, or give a longer elevation",
        )


def given_sea(
    elevation: Elevation,
    *,
    depth: float,
    duration: float,
    direction: float = 0.0,
    highest_hz: float = 0.6,
    stretching: str = "wheeler",
) -> AirySea:
    """Return the long-crested sea of linear waves that has this elevation at the origin.

    It is periodic with ``duration`` [s] and consists of components at multiples of 1/duration up to
    ``highest_hz``. The mean is removed, since it is due to the tide.

    Raises
    ------
    InputError
        If the elevation does not cover the duration.
    """
    require_cover(elevation, duration)
    n = 2 * int(np.ceil(2.0 * highest_hz * duration))
    at = np.arange(n) * (duration / n)
    lines = np.fft.rfft(np.interp(at, elevation.time_s, elevation.eta_m)) * (2.0 / n)
    f = np.arange(lines.size) / duration
    kept = (f > 0.0) & (f <= highest_hz)
    heading = np.full(int(kept.sum()), direction)
    return AirySea(
        np.abs(lines[kept]), 2.0 * np.pi * f[kept], heading, np.angle(lines[kept]), depth, stretching
    )
