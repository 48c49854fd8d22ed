"""Headings of tables of modes, in English and German: what a column is, in which unit, of which interval."""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import pi

from jackettwin.intervals import NORMAL_95

NAME = re.compile(r"^(?:mode|label|name|shape|description|no|nr|#|number)\b", re.IGNORECASE)
SPREAD = re.compile(r"std|sigma|σ|±|\+/?-|uncert|error|dev|abw|streu", re.IGNORECASE)
FREQUENCY = re.compile(r"^(?:f|fn|fre[qk]\w*|eigenfreq\w*|natural freq\w*)(?:[\s_.,:\[(]|$)", re.IGNORECASE)
DAMPING = re.compile(r"^(?:ζ|zeta|xi|ξ|d[aä]e?mp\w*|d)(?:[\s_.,:\[(]|$)", re.IGNORECASE)
PERCENT = re.compile(r"%|percent|pct", re.IGNORECASE)
IN_PERCENT = re.compile(r"%\s*[\])]?\s*$")
OF_FREQUENCY = re.compile(r"\bf|fre[qk]|hz", re.IGNORECASE)
OF_DAMPING = re.compile(r"ζ|zeta|xi|ξ|d[aä]e?mp", re.IGNORECASE)
DECREMENT = re.compile(r"\blog|decrement|δ", re.IGNORECASE)
HERTZ = ((re.compile(r"\bmHz", re.IGNORECASE), 1e-3), (re.compile(r"\brad\s*/\s*s", re.IGNORECASE), 0.5 / pi))
"""Other units of a frequency's column, and their values in hertz."""
INTERVAL_95 = re.compile(r"95", re.IGNORECASE)


def heading_key(heading: str) -> str | None:
    """Return the key of a column of modes, ``mode`` for their names, or None.

    Examples
    --------
    >>> [heading_key(text) for text in ("Frequenz [Hz]", "Dämpfung [%]", "Std f", "Lufttemperatur [°C]")]
    ['frequency_hz', 'damping_ratio', 'frequency_std_hz', None]
    """
    name = heading.strip()
    if SPREAD.search(name):
        return "damping_ratio_std" if OF_DAMPING.search(name) else "frequency_std_hz"
    for pattern, key in ((FREQUENCY, "frequency_hz"), (DAMPING, "damping_ratio"), (NAME, "mode")):
        if pattern.search(name):
            return key
    return None


def is_bare_spread(heading: str) -> bool:
    """Tell whether a heading is that of a spread and does not say of what."""
    return bool(
        SPREAD.search(heading) and not OF_FREQUENCY.search(heading) and not OF_DAMPING.search(heading)
    )


def with_owners(headings: Sequence[str]) -> list[str]:
    """Return the headings of columns; one of ± alone refers to the quantity before it."""
    owned, owner = [], ""
    for name in headings:
        owned.append(f"{owner} {name}" if is_bare_spread(name) else name)
        if not SPREAD.search(name) and heading_key(name) in ("frequency_hz", "damping_ratio"):
            owner = name
    return owned


def heading_scale(key: str, heading: str) -> float:
    """Return the factor from a column's numbers to hertz, or to a ratio of damping, by its heading."""
    if not key.startswith("damping"):
        return next((hertz for unit, hertz in HERTZ if unit.search(heading)), 1.0)
    return (0.01 if PERCENT.search(heading) else 1.0) / (2.0 * pi if DECREMENT.search(heading) else 1.0)


def heading_width(heading: str) -> float:
    """Return how many standard deviations wide a column of spreads is by its heading."""
    return NORMAL_95 if INTERVAL_95.search(heading) else 1.0
