r"""S-N curves: how many cycles of a stress range a weld endures.

.. math:: \log_{10} N = \log_{10} a - m \log_{10}\left(Δσ \max(1, t/t_{ref})^k\right)

with a second slope beyond a number of cycles (DNV-RP-C203, (2.4.1)–(2.4.3)). Curves lie two standard
deviations of log N below the mean of the tests.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log10
from typing import Literal, get_args

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import located, look_up, require, require_between
from jackettwin.files import Schema, find_file, read_yaml, shipped, validate

Environment = Literal["air", "cathodic", "free-corrosion"]
ENVIRONMENTS: tuple[Environment, ...] = get_args(Environment)
_KIND = "sn_curves"
_NEWEST = "dnv_rp_c203_2016"
_JUMP = 0.05
"""Of log₁₀ N between two slopes, which rounded intercepts leave."""


@dataclass(frozen=True)
class SNCurve:
    """An S-N curve of two slopes.

    Attributes
    ----------
    name, environment, edition : str
    m, log_a : slopes and intercepts, log₁₀ of cycles at 1 MPa; the second is that of many cycles
    knee_cycles : float
        Where the second slope begins; infinite where there is one slope.
    thickness_exponent : float
        k of the formula above.
    reference_thickness_m : float
        Thinner plates are as good as this one.
    log_std : float
        Standard deviation of log₁₀ N, of which the curve lies two below the mean.
    """

    name: str
    environment: str
    edition: str
    m: tuple[float, float]
    log_a: tuple[float, float]
    knee_cycles: float
    thickness_exponent: float
    reference_thickness_m: float
    log_std: float

    @property
    def knee_pa(self) -> float:
        """The range at which the slope changes [Pa]; zero where there is one slope."""
        if not np.isfinite(self.knee_cycles):
            return 0.0
        return float(1e6 * (10.0 ** self.log_a[0] / self.knee_cycles) ** (1.0 / self.m[0]))

    def cycles_to_failure(self, range_pa: FloatArray, *, thickness_m: float | None = None) -> FloatArray:
        """Return N of stress ranges [Pa]; infinite for a range of zero.

        Parameters
        ----------
        thickness_m : float, optional
            Of the plate that would crack; without it no effect of thickness.
        """
        S = 1e-6 * np.abs(np.asarray(range_pa, dtype=float)) * self.thickness_factor(thickness_m)
        many = S < 1e-6 * self.knee_pa
        m, log_a = np.where(many, self.m[1], self.m[0]), np.where(many, self.log_a[1], self.log_a[0])
        with np.errstate(divide="ignore"):
            return np.asarray(10.0 ** (log_a - m * np.log10(S)))

    def thickness_factor(self, thickness_m: float | None) -> float:
        """Return by how much a plate's thickness raises its stress ranges, at least 1.

        Raises
        ------
        InputError
            If the thickness is not between 1 mm and 1 m.
        """
        if thickness_m is None:
            return 1.0
        require_between("thickness_m", thickness_m, 1e-3, 1.0)
        return float(max(1.0, thickness_m / self.reference_thickness_m) ** self.thickness_exponent)

    def damage(self, range_pa: FloatArray, cycles: FloatArray, *, thickness_m: float | None = None) -> float:
        """Return Miner's sum of cycles (n,) of stress ranges (n,) [Pa]."""
        return float((cycles / self.cycles_to_failure(range_pa, thickness_m=thickness_m)).sum())


class _Slopes(Schema):
    m: tuple[float, float] | tuple[float]
    log_a: tuple[float, float] | tuple[float]
    knee_cycles: float | None = None


class _Curve(Schema):
    thickness_exponent: float
    reference_thickness_m: float
    air: _Slopes
    cathodic: _Slopes
    free_corrosion: _Slopes


class _Edition(Schema):
    edition: str
    source: str
    log_std: float
    curves: dict[str, _Curve]


def shipped_editions() -> tuple[str, ...]:
    """Return the names of the sets of curves that come with the package."""
    return shipped(_KIND)


def read_curve(name: str, environment: Environment, source: str = _NEWEST) -> SNCurve:
    """Return a curve of a shipped edition, or of a YAML file of the user's own.

    Raises
    ------
    InputError
        If there is no such edition, curve or environment.
    """
    path = find_file(source, _KIND)
    edition = validate(_Edition, read_yaml(path), file=path)
    curve = look_up(edition.curves, name, "S-N curve", file=path, field="curves")
    sets = {"air": curve.air, "cathodic": curve.cathodic, "free-corrosion": curve.free_corrosion}
    slopes = look_up(sets, environment, "environment", field="environment")
    with located(file=path, field=f"curves.{name}"):
        require_between("thickness_exponent", curve.thickness_exponent, 0.0, 1.0)
        require_between("reference_thickness_m", curve.reference_thickness_m, 0.001, 0.2, "m")
        with located(field=environment):
            _require_curve(slopes)
    require_between("log_std", edition.log_std, 0.0, 1.0)
    return SNCurve(
        name,
        environment,
        edition.edition,
        (slopes.m[0], slopes.m[-1]),
        (slopes.log_a[0], slopes.log_a[-1]),
        np.inf if slopes.knee_cycles is None else slopes.knee_cycles,
        curve.thickness_exponent,
        curve.reference_thickness_m,
        edition.log_std,
    )


def _require_curve(slopes: _Slopes) -> None:
    """Raise an error unless the slopes fall and meet where the second begins."""
    for m, log_a in zip(slopes.m, slopes.log_a, strict=False):
        require_between("m", m, 1.0, 15.0)
        require_between("log_a", log_a, 3.0, 40.0)
    require(
        len(slopes.m) == len(slopes.log_a) and (len(slopes.m) == 1) == (slopes.knee_cycles is None),
        "two slopes have two intercepts and a knee",
        field="knee_cycles",
        value=slopes.knee_cycles,
        remedy="state m and log_a once, or twice with knee_cycles",
    )
    if slopes.knee_cycles is not None:
        require_between("knee_cycles", slopes.knee_cycles, 1e3, 1e10)
        knee = log10(slopes.knee_cycles)
        log_range = (slopes.log_a[0] - knee) / slopes.m[0]
        after = slopes.log_a[-1] - slopes.m[-1] * log_range
        require(
            abs(after - knee) < _JUMP,
            "the slopes do not meet where the second begins",
            field="log_a",
            value=f"10^{knee:.3g} and 10^{after:.3g} cycles at {10.0**log_range:.3g} MPa",
            remedy="correct log_a or knee_cycles",
        )
