"""Differences between two runs in terms of their uncertainty, from their ``result.json``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import hypot, log, sqrt
from typing import Any

from jackettwin.answers.result import Span

HASHES = "SHA-256 of "
"""How a run's provenance names the content of its files."""
CHANGED = 2.0
"""Standard deviations of the difference from which a change is called one: by chance once in twenty."""
_NO_OTHER_DATA = 0.01
"""Share of both uncertainties below which nothing is left of that of the difference."""


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
    same_data : bool
        Whether both are of the same records, so that chance does not part them.
    """

    what: str
    unit: str
    before: float | None
    after: float | None
    log_change: float | None
    sigmas: float | None
    same_data: bool = False

    @property
    def verdict(self) -> str:
        """``changed``, ``the same``, ``gone``, ``new``, or that nobody can tell."""
        if self.before is None or self.after is None:
            return "gone" if self.after is None else "new"
        if self.before == self.after:
            return "the same"
        if self.same_data:
            return "by other inputs: the records are the same"
        if self.sigmas is None:
            return "not known: no uncertainty"
        return "changed" if abs(self.sigmas) >= CHANGED else "within its uncertainty"


@dataclass(frozen=True)
class ChangedInput:
    """An input that two runs do not share; None where a run does not have it."""

    what: str
    before: str | float | None
    after: str | float | None


def changed_inputs(a: Mapping[str, Any], b: Mapping[str, Any]) -> tuple[ChangedInput, ...]:
    """Return every input that differs, by name and value: of the twin, records, the version of the code.

    What a run assumed is said by the inputs that it follows from, and by itself where a run does not tell
    them; so is the content of the twin file.
    """
    mine, theirs = (document.get("inputs") or {} for document in (a, b))
    found = _differing(mine, theirs) if mine and theirs else []
    told = bool(mine and theirs)
    files = [_records(document) if told else _hashes(document) for document in (a, b)]
    found += _differing(*({name.removeprefix(HASHES): h for name, h in one.items()} for one in files))
    if not found or not told:
        said = [[_assumed(one) for one in document.get("assumptions") or ()] for document in (a, b)]
        found += [ChangedInput("assumption", one, None) for one in said[0] if one not in said[1]]
        found += [ChangedInput("assumption", None, one) for one in said[1] if one not in said[0]]
    versions = [document.get("code_version") for document in (a, b)]
    if versions[0] != versions[1]:
        found.append(ChangedInput("jackettwin", *versions))
    return tuple(found)


def _assumed(one: str | Mapping[str, Any]) -> str:
    """Return an assumption in words; results of older versions have nothing else."""
    return one if isinstance(one, str) else str(one["value"])


def _differing(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[ChangedInput]:
    return [
        ChangedInput(name, before.get(name), after.get(name))
        for name in dict.fromkeys((*before, *after))
        if before.get(name) != after.get(name)
    ]


def _records(document: Mapping[str, Any]) -> dict[str, str]:
    """Return the identity of each record by its file's name."""
    return {name: h for name, h in _hashes(document).items() if not name.endswith((".yaml", ".yml"))}


def _hashes(document: Mapping[str, Any]) -> dict[str, str]:
    made = document.get("provenance") or {}
    return {name: str(value) for name, value in made.items() if name.startswith(HASHES)}


def shared_records(a: Mapping[str, Any], b: Mapping[str, Any]) -> float:
    """Return the correlation that two means have by the records that both are of: n/√(n_a n_b).

    Records of about one length weigh alike. It is 0 where runs do not tell their records.
    """
    mine, theirs = (set(_records(document).values()) for document in (a, b))
    return len(mine & theirs) / sqrt(len(mine) * len(theirs)) if mine and theirs else 0.0


def compare(a: Mapping[str, Any], b: Mapping[str, Any]) -> tuple[ChangedNumber, ...]:
    """Return what two runs say of the same modes and parameters, in the order of the first.

    The errors of records that both runs have are the same, and cancel.
    """
    shared = shared_records(a, b)
    return (
        *_paired(_modes(a, "frequency_hz"), _modes(b, "frequency_hz"), "Hz", shared),
        *_paired(_modes(a, "damping_ratio"), _modes(b, "damping_ratio"), "-", shared),
        *_parameters(a, b, shared),
    )


_Value = tuple[float, float | None]
"""A number and the standard deviation of its logarithm."""


def _paired(
    a: Mapping[str, _Value], b: Mapping[str, _Value], unit: str, shared: float
) -> Iterable[ChangedNumber]:
    return [change(name, unit, a.get(name), b.get(name), shared) for name in dict.fromkeys((*a, *b))]


def change(
    what: str, unit: str, before: _Value | None, after: _Value | None, shared: float = 0.0
) -> ChangedNumber:
    """Return one number in two runs, whose errors have a correlation by what the runs share.

    >>> change("f", "Hz", (0.2, 0.003), (0.21, 0.004)).sigmas
    9.758...
    """
    if before is None or after is None:
        return ChangedNumber(what, unit, before and before[0], after and after[0], None, None)
    (x, s), (y, t) = before, after
    moved = log(y / x) if x > 0.0 and y > 0.0 else None
    spread = None if s is None or t is None else sqrt(max(s * s + t * t - 2.0 * shared * s * t, 0.0))
    if spread is not None and spread < _NO_OTHER_DATA * hypot(s or 0.0, t or 0.0):
        spread = None
    sigmas = moved / spread if moved is not None and spread else None
    return ChangedNumber(what, unit, x, y, moved, sigmas, shared > 1.0 - 1e-9)


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


def _parameters(a: Mapping[str, Any], b: Mapping[str, Any], shared: float) -> Iterable[ChangedNumber]:
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
        change(f"{name} ({law})", units[name], before.get(name), after.get(name), shared)
        for name in dict.fromkeys((*before, *after))
    ]


def _known(p: Mapping[str, Any]) -> _Value:
    """Return a parameter's median, else its best fit, and the standard deviation of its logarithm."""
    value = float(p.get("median") or p["value"])
    return value, Span(value, *(p.get("interval_90") or ())).log_std
