"""Stiffness of a turbine's ground on each day, as in ``jackettwin follow``.

It continues from a stored result up to the last day but one, since the last day still grows.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from itertools import takewhile
from typing import Any

from jackettwin.change import Days
from jackettwin.files import StoredSchema
from jackettwin.service.workers import engine
from jackettwin.study import Followed, follow_days
from jackettwin.twin import UNDATED, Day, empty_state
from jackettwin.version import __version__


@dataclass(frozen=True)
class FollowedPast:
    """A twin followed through past days.

    Attributes
    ----------
    days : {date: identity}
        All past days.
    window : the day before those that are evaluated again with later ones; empty before the first
    followed : result to continue from
    code_version : of the code that made it; another version evaluates all days again
    """

    days: dict[str, str]
    window: str
    followed: Followed
    code_version: str


FOLLOWED_PAST = StoredSchema("followed_past", FollowedPast)
"""Format of the stored result."""


def days_needed(kept: Mapping[str, Any] | None, identities: Mapping[str, str]) -> str | None:
    """Return the day after which days are needed to continue from a stored result; None if all are."""
    if kept is None or kept["code_version"] != __version__:
        return None
    known = len(kept["days"])
    unchanged = _same(kept["days"], identities) == known < len(_dated(identities))
    return str(kept["window"]) if unchanged else None


def followed(
    twin: engine.Twin,
    kept: Mapping[str, Any] | None,
    identities: Mapping[str, str],
    documents: Mapping[str, str],
) -> tuple[Followed, Mapping[str, Any] | None]:
    """Return the estimates of the supports after each day, and the part to store.

    Parameters
    ----------
    documents : {day: document}
        Of the days that :func:`days_needed` asks for, or of all.

    Raises
    ------
    KeyError
        If a needed day has no document, as after a change or when conditions are learnt anew.
    """

    @cache
    def load(day: str) -> Day:
        return engine.DAY.load(json.loads(documents[day])).of_operations(twin.config.operation.may_update)

    every = Days(_dated(identities), load)
    dates = list(every.identities)
    known = None if kept is None or kept["code_version"] != __version__ else FOLLOWED_PAST.load(kept)
    same = min(0 if known is None else _same(known.days, identities), len(dates) - 1)
    if known is not None and same == len(known.days):
        before = known.followed.state
    else:
        before = empty_state(twin.model)
        for day in dates[:same]:
            before = replace(before.with_day(day, load(day)), days={})
    past, now = follow_days(
        twin.config, twin.model, every, before, same=same, prior=None if known is None else known.followed
    )
    if past is None or (known is not None and same == len(known.days) == len(dates) - 1):
        return now, kept
    whole = FollowedPast(
        {day: every.identities[day] for day in dates[:-1]}, past.window_begins_after, past, __version__
    )
    return now, FOLLOWED_PAST.dump(whole)


def _dated(identities: Mapping[str, str]) -> dict[str, str]:
    return {day: identity for day, identity in identities.items() if day != UNDATED}


def _same(known: Mapping[str, str], identities: Mapping[str, str]) -> int:
    """Return the number of unchanged first days."""
    pairs = zip(known.items(), _dated(identities).items(), strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))
