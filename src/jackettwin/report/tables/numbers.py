"""Formatting of numbers: sensible digits, units, a dash for unknown values."""

from __future__ import annotations

import math
import re

from jackettwin.intervals import NORMAL_90

UNKNOWN = "–"
_MINUS = str.maketrans("-", "−")
"""The true minus sign is as wide as a digit."""
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_WIDE = 0.2
"""Relative width of an interval above which two digits distinguish its ends."""


def known(value: float | None) -> bool:
    """Return whether there is a finite number."""
    return value is not None and math.isfinite(value)


def fixed(value: float | None, decimals: int, *, sign: bool = False) -> str:
    """Return a number with a given number of decimals.

    >>> fixed(-0.00001, 2), fixed(-1.5, 1), fixed(None, 2)
    ('0.00', '−1.5', '–')
    """
    if value is None or not math.isfinite(value):
        return UNKNOWN
    rounded = round(float(value), decimals) + 0.0
    text = f"{rounded:+.{decimals}f}" if sign and rounded else f"{rounded:.{decimals}f}"
    return text.translate(_MINUS)


def frequency(value: float | None, std: float | None = None) -> str:
    """Return hertz with four decimals, and with a standard deviation half the 90 % interval.

    >>> frequency(0.18192, 0.00081)
    '0.1819 ± 0.0013'
    """
    return _with_std(value, std, 1.0, 4)


def percent(value: float | None, std: float | None = None, *, decimals: int = 2) -> str:
    """Return a ratio in per cent, without the sign, and with a standard deviation half the 90 % interval.

    >>> percent(0.0127, 0.004)
    '1.27 ± 0.66'
    """
    return _with_std(value, std, 100.0, decimals)


def rounded_percent(share: float) -> str:
    """Return a share in per cent with two significant digits, and never with an exponent.

    Examples
    --------
    >>> rounded_percent(0.0123), rounded_percent(1.234)
    ('1.2 %', '120 %')
    """
    return f"{float(f'{100.0 * share:.2g}'):g} %"


def _with_std(value: float | None, std: float | None, scale: float, decimals: int) -> str:
    if value is None or not math.isfinite(value):
        return UNKNOWN
    if std is None or not math.isfinite(std):
        return fixed(scale * value, decimals)
    half = NORMAL_90 * scale * std
    if half > 0.0:  # a small one has one digit at least
        decimals = max(decimals, min(math.ceil(-math.log10(half)), 9))
    return f"{fixed(scale * value, decimals)} ± {fixed(half, decimals)}"


def interval(low_high: tuple[float, float] | None, scale: float, decimals: int) -> str:
    """Return ``low … high``."""
    if low_high is None:
        return UNKNOWN
    return " … ".join(fixed(scale * value, decimals) for value in low_high)


def scientific(value: float | None, digits: int = 3) -> str:
    """Return a number of any size with ``digits`` significant ones.

    >>> scientific(2.5e9), scientific(0.1234)
    ('2.50 × 10⁹', '0.123')
    """
    if value is None or not math.isfinite(value):
        return UNKNOWN
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    power = int(exponent)
    if -3 <= power <= digits:
        return f"{float(f'{mantissa}e{exponent}'):.{max(digits - 1 - power, 0)}f}".translate(_MINUS)
    return f"{mantissa.translate(_MINUS)} × 10{str(power).translate(_SUPERSCRIPT)}"


def words(label: str) -> str:
    """Return a mode's label as text.

    >>> words("fore_aft_1")
    'fore-aft 1'
    """
    kind, _, number = label.rpartition("_")
    return f"{kind.replace('_', '-')} {number}" if kind else label


def sentence(text: str) -> str:
    """Return a sentence of the engine with modes and negative numbers as pages write them.

    >>> sentence("side_side_1 fell by 9 % (-13 to -3.3)")
    'side-side 1 fell by 9 % (−13 to −3.3)'
    """
    named = re.sub(r"\b(?:fore_aft|side_side|torsion|heave|foot)_\d+\b", lambda found: words(found[0]), text)
    return re.sub(r"(?<=[ (])-(?=\d)", "−", named)


def count(n: int, noun: str) -> str:
    """Return ``1 mode``, ``2 modes``."""
    return f"{n} {noun}" if n == 1 else f"{n} {noun}s"


def listed(items: list[str]) -> str:
    """Return ``a, b and c``."""
    return items[0] if len(items) == 1 else ", ".join(items[:-1]) + " and " + items[-1] if items else "none"


def factor(value: float | None) -> str:
    """Return a factor with two digits, with three just above one.

    >>> factor(1.94), factor(915.3), factor(1.036), factor(None)
    ('1.9', '920', '1.04', '–')
    """
    digits = 3 if value is not None and 1.0 < value < 1.1 else 2
    return UNKNOWN if value is None or not math.isfinite(value) else f"{float(f'{value:.{digits}g}'):g}"


_PREFIXES = ((1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k"))


def quantity(value: float, unit: str, *, digits: int = 2) -> str:
    """Return a number with its unit and a suitable prefix; without a unit, no prefix.

    >>> quantity(3.797e9, "N/m"), quantity(0.0352, "-"), quantity(0.9, ""), quantity(9.996e8, "N/m")
    ('3.8 GN/m', '0.035', '0.9', '1 GN/m')
    """
    if not math.isfinite(value):
        return UNKNOWN
    if unit in ("", "-"):
        return f"{value:.{digits}g}".translate(_MINUS)
    value = float(f"{value:.{digits}g}")
    scale, prefix = next(((s, p) for s, p in _PREFIXES if abs(value) >= s), (1.0, ""))
    text = f"{value / scale:.{digits}g}"
    return f"{float(text):g}".translate(_MINUS) + f" {prefix}{unit}"


def digits_of(low: float, high: float) -> int:
    """Return the number of significant digits that distinguish the ends of an interval of positive numbers.

    >>> digits_of(1.0, 2.0), digits_of(4.1e8, 4.25e8), digits_of(1.0, 1.001)
    (2, 3, 4)
    """
    width = high / low - 1.0 if low > 0.0 else 1.0
    return 2 if width > _WIDE else 3 if width > _WIDE / 10.0 else 4


def between(low: float, high: float, unit: str) -> str:
    """Return ``low to high`` with the unit once where both have the same prefix.

    >>> between(2.01e9, 1.395e10, "N/m"), between(2e8, 4.6e9, "N/m"), between(4.1e8, 4.25e8, "N/m")
    ('2 to 14 GN/m', '200 MN/m to 4.6 GN/m', '410 to 425 MN/m')
    """
    digits = digits_of(low, high)
    a, b = quantity(low, unit, digits=digits), quantity(high, unit, digits=digits)
    number, _, same = a.partition(" ")
    return f"{number} to {b}" if same == b.partition(" ")[2] else f"{a} to {b}"
