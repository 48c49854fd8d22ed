"""Modes picked manually or from an earlier run, which can be saved, edited and reused.

A pick is a pole of the stabilisation diagram. Every result lists the picks that reproduce it. Picks replace
the criteria on clusters of poles; the limits on the band and on damping uncertainty still apply.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jackettwin.errors import InputError

_KEYS: dict[str, tuple[tuple[type, ...], str]] = {
    "frequency_hz": ((int, float), "a frequency > 0 Hz"),
    "order": ((int,), "a model order, or null"),
    "record": ((str,), "the name of a record, or null"),
    "doubtful": ((bool,), "true or false"),
}
_SHOWN_NAMES = 5
_NEEDED = ("frequency_hz", "doubtful")


@dataclass(frozen=True)
class Pick:
    """One pole of the stabilisation diagram.

    Attributes
    ----------
    frequency_hz : float
        Frequency; the nearest pole is used.
    order : int or None
        Model order; with None the clustering selects it.
    record : str or None
        Name of the record in which it was picked; None means every record.
    doubtful : bool
        Whether the mode is accepted only if the spectrum needs it, as for a doubtful candidate.
    """

    frequency_hz: float
    order: int | None = None
    record: str | None = None
    doubtful: bool = False


def parse_picks(data: Any) -> tuple[Pick, ...]:
    """Return the picks of a selection file or of a result: a list, or a mapping with the key ``picks``.

    Raises
    ------
    InputError
        If it is neither, or an entry is wrong; the error names the entry.

    Examples
    --------
    >>> parse_picks({"picks": [{"frequency_hz": 0.31, "order": 20}]})
    (Pick(frequency_hz=0.31, order=20, record=None, doubtful=False),)
    """
    entries = data.get("picks") if isinstance(data, Mapping) else data
    if not isinstance(entries, Sequence) or isinstance(entries, str) or not entries:
        raise InputError(
            "holds no picks",
            field="picks",
            value=entries,
            allowed="a list of {frequency_hz, order, record}",
            remedy="take the key picks from a result of jackettwin identify --json",
        )
    return tuple(_pick(entry, f"picks[{i}]") for i, entry in enumerate(entries))


def plain_picks(picks: Sequence[Pick]) -> list[dict[str, Any]]:
    """Return picks as JSON data for ``parse_picks``."""
    return [dict(vars(pick)) for pick in picks]


def of_record(picks: Sequence[Pick], name: str) -> tuple[Pick, ...]:
    """Return the picks that concern a record."""
    return tuple(pick for pick in picks if pick.record in (None, name))


def refuse_strangers(picks: Sequence[Pick], names: Sequence[str]) -> None:
    """Raise an error if no pick concerns the records, since a misspelt name would silently have no effect.

    Raises
    ------
    InputError
        If all picks name absent records.
    """
    if picks and not any(of_record(picks, name) for name in names):
        named = sorted({pick.record for pick in picks if pick.record is not None})
        raise InputError(
            "no pick concerns these records",
            field="picks.record",
            value=", ".join(named),
            allowed=", ".join(names[:_SHOWN_NAMES]) + (", …" if len(names) > _SHOWN_NAMES else ""),
            remedy="name a record, or null for every one",
        )


def _pick(entry: Any, field: str) -> Pick:
    if not isinstance(entry, Mapping):
        raise InputError("is not a pick", field=field, value=entry, allowed="{frequency_hz, order, record}")
    unknown = set(entry) - set(_KEYS)
    if unknown:
        raise InputError("unknown key", field=f"{field}.{min(unknown)}", allowed=", ".join(_KEYS))
    for name, (kinds, allowed) in _KEYS.items():
        value = entry.get(name)
        wrong = not isinstance(value, kinds) or isinstance(value, bool) != (bool in kinds)
        if (name in entry or name == "frequency_hz") and wrong and (value is not None or name in _NEEDED):
            raise InputError("is wrong", field=f"{field}.{name}", value=value, allowed=allowed)
    pick = Pick(**{**entry, "frequency_hz": float(entry["frequency_hz"])})
    if not 0.0 < pick.frequency_hz < np.inf:
        raise InputError(
            "is wrong", field=f"{field}.frequency_hz", value=pick.frequency_hz, allowed="a frequency > 0 Hz"
        )
    return pick
