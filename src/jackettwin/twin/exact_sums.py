r"""Sums of a mode's data that do not depend, to the last bit, on the order of addition.

Every contribution is rounded once to a multiple of 2⁻²⁴ and added as a whole number, which is exact,
commutative and associative; so the order of records and the division of work do not matter.

Of n records with frequencies f, damping ratios ζ, lengths T and stated variances of ln f and ln ζ,

.. math:: p = ζ / \mathrm{var}(\ln f), \qquad q = 2π f T,

are the weights of ln f and of ζ, which do not depend on the common damping (at which variances are computed,
as in :mod:`jackettwin.identification.many_records.fusion`): var(ln f) is :math:`\barζ/p`, var(ζ/ζ̄) is
:math:`r/(\barζ q)` where r is the geometric mean over records of the ratio of the stated variance to the
least possible.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log, pi, sqrt
from typing import Any, NamedTuple, TypeVar

from jackettwin.identification import ModalEstimate
from jackettwin.identification.many_records.fusion import Average

UNIT = 2**24
"""Whole numbers per unit. The step of 6e-8 is 1/1000 of any sum's uncertainty from ten minutes."""

Sums = TypeVar("Sums", bound=tuple[Any, ...])
"""A named tuple of whole numbers, or of such tuples."""


def whole(value: float) -> int:
    """Return a number in units of 2⁻²⁴, rounded."""
    return round(value * UNIT)


def plus(a: Sums, b: Sums) -> Sums:
    """Return the sum of both, element by element."""
    return type(a)(*(plus(x, y) if isinstance(x, tuple) else x + y for x, y in zip(a, b, strict=True)))


def negated(a: Sums) -> Sums:
    """Return the negative of sums, element by element."""
    return type(a)(*(negated(x) if isinstance(x, tuple) else -x for x in a))


class ModeSums(NamedTuple):
    """Sums of records for one mode, as whole numbers in units of 2⁻²⁴; counts are plain.

    Attributes
    ----------
    n, known : int
        Number of records with the mode, and of those that state a covariance.
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
    """Return the sums of one record; without a covariance its weight is that of the least variance."""
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
    """The sums of a mode over days, with sums for the scatter between days.

    Attributes
    ----------
    days : int
        Number of days with the mode.
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

    Weighted means of ln f and of ζ; their variances follow from the weights, multiplied by χ² per degree of
    freedom over the records or over the days, whichever is larger (Birge 1932), since records of one day
    share tide and wind. The scatter in excess of the records' uncertainty is that of DerSimonian and Laird
    (1986) for equal weights.
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
    """χ² per degree of freedom, at least 1, and the records' scatter in excess of their uncertainty."""

    widened: float
    excess: float


def _spread(n: int, days: int, square: int, weight: int, squares: int, by_day: int, scale: float) -> _Spread:
    """Return the scatter of records and days, from whole numbers to avoid rounding of differences."""
    records = scale * (squares * weight - square) / weight / UNIT
    between = scale * (by_day * weight - square) / weight / UNIT
    by_records = records / (n - 1) if n > 1 else 1.0
    by_days = between / (days - 1) if days > 1 else 1.0
    return _Spread(max(1.0, by_records, by_days), max(0.0, by_records - 1.0))
