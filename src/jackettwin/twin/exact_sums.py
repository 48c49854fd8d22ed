r"""Sums that are the same to the last bit in whatever order they are added: what a state keeps of a mode.

Every contribution is rounded once to a multiple of 2⁻²⁴ and added as a whole number, which is exact,
commutative and associative; so records may come late, twice over two workers or in any order.

Of n records with frequencies f, damping ratios ζ, lengths T and stated variances of ln f and ln ζ,

.. math:: p = ζ / \mathrm{var}(\ln f), \qquad q = 2π f T,

are the weights of ln f and of ζ that do not depend on the damping that all share (at which variances are
taken, as in :mod:`jackettwin.identification.many_records.fusion`): var(ln f) is :math:`\barζ/p`, var(ζ/ζ̄) is
:math:`r/(\barζ q)` with r the geometric mean of what records claim over the least possible.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log, pi, sqrt
from typing import Any, NamedTuple, TypeVar

from jackettwin.identification import ModalEstimate
from jackettwin.identification.many_records.fusion import Average

UNIT = 2**24
"""Whole numbers a unit: 6e-8, three digits below what ten minutes tell of any sum."""

Sums = TypeVar("Sums", bound=tuple[Any, ...])
"""A named tuple of whole numbers, or of such tuples."""


def whole(value: float) -> int:
    """Return a number in units of 2⁻²⁴, rounded."""
    return round(value * UNIT)


def plus(a: Sums, b: Sums) -> Sums:
    """Return the sums of both."""
    return type(a)(*(plus(x, y) if isinstance(x, tuple) else x + y for x, y in zip(a, b, strict=True)))


def negated(a: Sums) -> Sums:
    """Return what takes sums out again when it is added."""
    return type(a)(*(negated(x) if isinstance(x, tuple) else -x for x in a))


class ModeSums(NamedTuple):
    """What records say of one mode, as whole numbers of 2⁻²⁴ (counts as they are).

    Attributes
    ----------
    n, known : int
        Records that show the mode, and those of them that state a covariance.
    p, px, pxx : int
        Sums of the weights of ln f, and of weight times ln f and its square.
    q, qz, qzz : int
        Sums of the weights of ζ, and of weight times ζ and its square.
    log_ratio, correlation : int
        Sums over the known ones of ln r, and of the correlation of ln f and ln ζ.
    """

    n: int = 0
    known: int = 0
    p: int = 0
    px: int = 0
    pxx: int = 0
    q: int = 0
    qz: int = 0
    qzz: int = 0
    log_ratio: int = 0
    correlation: int = 0


def of_estimate(mode: ModalEstimate, duration_s: float) -> ModeSums:
    """Return what one record says of a mode; without a covariance it weighs as the best possible would."""
    x, zeta = log(mode.frequency_hz), mode.damping_ratio
    cycles = 2.0 * pi * mode.frequency_hz * duration_s
    p, known, log_ratio, correlation = cycles, 0, 0, 0
    c = mode.log_covariance
    if c is not None and c[0, 0] > 0.0 and c[1, 1] > 0.0:
        p, known = zeta / float(c[0, 0]), 1
        log_ratio = whole(log(float(c[1, 1]) * zeta * cycles))
        correlation = whole(float(c[0, 1]) / sqrt(float(c[0, 0] * c[1, 1])))
    return ModeSums(
        n=1,
        known=known,
        p=whole(p),
        px=whole(p * x),
        pxx=whole(p * x * x),
        q=whole(cycles),
        qz=whole(cycles * zeta),
        qzz=whole(cycles * zeta * zeta),
        log_ratio=log_ratio,
        correlation=correlation,
    )


class ModeTotal(NamedTuple):
    """The sums of a mode over days, and what tells how far the days lie apart.

    Attributes
    ----------
    days : int
        With the mode.
    f_days, z_days : int
        Sums over the days of (Σpx)²/Σp and of (Σqζ)²/Σq.
    """

    sums: ModeSums = ModeSums()
    days: int = 0
    f_days: int = 0
    z_days: int = 0


def of_day(sums: ModeSums) -> ModeTotal:
    """Return the total of one day."""
    return ModeTotal(sums, 1, sums.px * sums.px // sums.p, sums.qz * sums.qz // sums.q)


def average(total: ModeTotal) -> Average:
    r"""Return the mean of a mode with its uncertainty.

    Weighted means of ln f and of ζ; their variances are those of the weights, widened by the larger of χ² per
    degree of freedom over the records and over the days (Birge 1932): records of one day share its tide and
    its wind, and days that lie apart are no chance. The scatter beyond the records' own uncertainty is
    DerSimonian and Laird's (1986) for equal weights.
    """
    s = total.sums
    zeta = s.qz / s.q
    typical = exp(s.log_ratio / UNIT / s.known) if s.known else 1.0
    f = _spread(s.n, total.days, s.px * s.px, s.p, s.pxx, total.f_days, 1.0 / zeta)
    z = _spread(s.n, total.days, s.qz * s.qz, s.q, s.qzz, total.z_days, 1.0 / (typical * zeta))
    own_f, own_z = sqrt(zeta * UNIT / s.p), sqrt(typical * UNIT / (zeta * s.q))
    std_f, std_z = own_f * sqrt(f.widened), own_z * sqrt(z.widened)
    correlation = s.correlation / UNIT / s.known if s.known else 0.0
    return Average(
        frequency_hz=exp(s.px / s.p),
        damping_ratio=zeta,
        log_std=(std_f, std_z),
        scatter=(own_f * sqrt(s.n * f.excess), own_z * sqrt(s.n * z.excess)),
        correlation=correlation / sqrt(f.widened * z.widened),
    )


@dataclass(frozen=True)
class _Spread:
    """χ² per degree of freedom, at least 1, and what the records' scatter exceeds their own by."""

    widened: float
    excess: float


def _spread(n: int, days: int, square: int, weight: int, squares: int, by_day: int, scale: float) -> _Spread:
    """Return how far records and days lie apart, from whole numbers: differences without rounding."""
    records = scale * (squares * weight - square) / weight / UNIT
    between = scale * (by_day * weight - square) / weight / UNIT
    by_records = records / (n - 1) if n > 1 else 1.0
    by_days = between / (days - 1) if days > 1 else 1.0
    return _Spread(max(1.0, by_records, by_days), max(0.0, by_records - 1.0))
