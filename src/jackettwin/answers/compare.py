"""What changed between two runs, and by how much of its uncertainty: from their ``result.json``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import hypot, log
from typing import Any

from jackettwin.answers.result import Span

CHANGED = 2.0
"""Standard deviations of the difference from which a change is called one: by chance once in twenty."""


@dataclass(frozen=True)
class ChangedNumber:
    """One number in two runs.

    Attributes
    ----------
    before, after : float or None
        None where a run does not have it.
    log_change : float or None
        ln after/before.
    sigmas : float or None
        That, over the standard deviation of the difference; None where an uncertainty is not known.
    """

    what: str
    unit: str
    before: float | None
    after: float | None
    log_change: float | None
    sigmas: float | None

    @property
    def verdict(self) -> str:
        """``changed``, ``the same``, ``gone``, ``new``, or that nobody can tell."""
        if self.before is None or self.after is None:
            return "gone" if self.after is None else "new"
        if self.before == self.after:
            return "the same"
        if self.sigmas is None:
            return "not known: no uncertainty"
        return "changed" if abs(self.sigmas) >= CHANGED else "within its uncertainty"


def compare(a: Mapping[str, Any], b: Mapping[str, Any]) -> tuple[ChangedNumber, ...]:
    """Return what two runs say of the same modes and parameters, in the order of the first."""
    return (
        *_paired(_modes(a, "frequency_hz"), _modes(b, "frequency_hz"), "Hz"),
        *_paired(_modes(a, "damping_ratio"), _modes(b, "damping_ratio"), "-"),
        *_parameters(a, b),
    )


_Value = tuple[float, float | None]
"""A number and the standard deviation of its logarithm."""


def _paired(a: Mapping[str, _Value], b: Mapping[str, _Value], unit: str) -> Iterable[ChangedNumber]:
    return [change(name, unit, a.get(name), b.get(name)) for name in dict.fromkeys((*a, *b))]


def change(what: str, unit: str, before: _Value | None, after: _Value | None) -> ChangedNumber:
    """Return one number in two runs.

    >>> change("f", "Hz", (0.2, 0.003), (0.21, 0.004)).sigmas
    9.758...
    """
    if before is None or after is None:
        return ChangedNumber(what, unit, before and before[0], after and after[0], None, None)
    (x, s), (y, t) = before, after
    moved = log(y / x) if x > 0.0 and y > 0.0 else None
    spread = None if s is None or t is None else hypot(s, t)
    return ChangedNumber(what, unit, x, y, moved, moved / spread if moved is not None and spread else None)


def _modes(document: Mapping[str, Any], quantity: str) -> dict[str, _Value]:
    std = {"frequency_hz": "frequency_std_hz", "damping_ratio": "damping_ratio_std"}[quantity]
    found = {}
    for m in document.get("modes", []):
        value = m.get(quantity)
        if value:
            known = m.get(std)
            name = quantity.removesuffix("_hz").replace("_", " ")
            found[f"{name} of {m['label']}"] = (float(value), None if known is None else known / value)
    return found


def _parameters(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterable[ChangedNumber]:
    """Return the ground under the law that the second run recommends, else under its first that both have."""
    laws = [{u["law"]: u for u in document.get("updates", [])} for document in (a, b)]
    wanted = (b.get("answers") or {}).get("law")
    law = (
        wanted
        if wanted in laws[0] and wanted in laws[1]
        else next((n for n in laws[1] if n in laws[0]), None)
    )
    if law is None:
        return []
    before, after = ({name: _known(p) for name, p in one[law]["parameters"].items()} for one in laws)
    units = {name: p.get("unit", "") for one in laws for name, p in one[law]["parameters"].items()}
    return [
        change(f"{name} ({law})", units[name], before.get(name), after.get(name))
        for name in dict.fromkeys((*before, *after))
    ]


def _known(p: Mapping[str, Any]) -> _Value:
    """Return a parameter's median, else its best fit, and the standard deviation of its logarithm."""
    value = float(p.get("median") or p["value"])
    return value, Span(value, *(p.get("interval_90") or ())).log_std
