"""Modes chosen by hand, or kept from an earlier run: a selection that can be saved, edited and replayed.

A pick is a pole of the stabilisation diagram. Every result lists the picks that lead to it. Picks replace the
criteria on clusters of poles; the limits on the band and on the uncertainty of the damping stay.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.errors import InputError

if TYPE_CHECKING:
    from jackettwin.identification.clustering import Cluster
    from jackettwin.identification.estimate import Stabilisation
    from jackettwin.identification.selection import Candidate

REACH = 0.02
"""Largest relative distance of a picked frequency from a pole."""

_KEYS: dict[str, tuple[tuple[type, ...], str]] = {
    "frequency_hz": ((int, float), "a frequency > 0 Hz"),
    "order": ((int,), "a model order, or null"),
    "record": ((str,), "the name of a record, or null"),
    "doubtful": ((bool,), "true or false"),
}
_NEEDED = ("frequency_hz", "doubtful")


@dataclass(frozen=True)
class Pick:
    """One pole of the stabilisation diagram.

    Attributes
    ----------
    frequency_hz : float
        The nearest pole is meant.
    order : int or None
        Of the model order; None leaves the order to the clustering.
    record : str or None
        Name of the record it was picked in; None means every record.
    doubtful : bool
        Whether the mode counts only if the spectrum needs it, as for a candidate in doubt.
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
        If it is neither, or an entry is wrong; names the entry.

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
    """Return picks as JSON data that ``parse_picks`` reads back."""
    return [dict(vars(pick)) for pick in picks]


def of_record(picks: Sequence[Pick], name: str) -> tuple[Pick, ...]:
    """Return the picks that concern a record."""
    return tuple(pick for pick in picks if pick.record in (None, name))


def picked_clusters(poles: Stabilisation, found: Sequence[Cluster], picks: Sequence[Pick]) -> list[Cluster]:
    """Return for every pick the cluster of its pole, which then speaks for the cluster.

    Raises
    ------
    InputError
        If there is no pole near a pick, two picks mean one pole, or the pole belongs to no mode.
    """
    out: dict[int, Cluster] = {}
    for pick in picks:
        k = _pole(poles, found, pick)
        if k in out:
            raise InputError(
                "two picks mean one pole",
                field="picks",
                value=pick.frequency_hz,
                allowed=f"a pole once, here that at {poles.frequency_hz[k]:.6g} Hz",
                remedy="remove one of them",
            )
        cluster = next((c for c in found if k in c.poles), None)
        if cluster is None:
            raise InputError(
                "the picked pole is alone",
                field="picks",
                value=pick.frequency_hz,
                allowed="poles that appear in other model orders as well",
                remedy="pick a pole of a column in the stabilisation diagram",
            )
        out[k] = replace(cluster, representative=k)
    return list(out.values())


def with_verdicts(picks: Sequence[Pick], judged: Sequence[Candidate]) -> list[Candidate]:
    """Return the candidates as the picks want them: no objection, and doubt only where it is said."""
    return [
        replace(c, objection=None, doubt=(c.doubt or "doubtful by the picks") if pick.doubtful else None)
        for pick, c in zip(picks, judged, strict=True)
    ]


def _pole(poles: Stabilisation, found: Sequence[Cluster], pick: Pick) -> int:
    """Return the position of the pole meant by a pick."""
    if pick.order is None:
        among = np.array([c.representative for c in found], dtype=np.int64)
    else:
        among = np.flatnonzero(poles.order == pick.order)
    away = np.abs(poles.frequency_hz[among] / pick.frequency_hz - 1.0)
    if not len(away) or away.min() > REACH:
        orders = sorted(set(poles.order.tolist()))
        raise InputError(
            "no pole near the pick" + ("" if pick.order is None else f" in order {pick.order}"),
            field="picks",
            value=pick.frequency_hz,
            allowed=f"within {REACH:.0%} of a pole; orders {orders[0]} to {orders[-1]}" if orders else "none",
            remedy=f"the nearest is at {poles.frequency_hz[among[np.argmin(away)]]:.6g} Hz"
            if len(away)
            else "use the settings the picks were made with",
        )
    return int(among[np.argmin(away)])


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
