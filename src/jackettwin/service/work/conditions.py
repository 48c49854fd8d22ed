"""Storing conditions of the site, and queueing affected records for observation."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from datetime import datetime, timedelta
from typing import TYPE_CHECKING

from sqlalchemy import Connection

from jackettwin.store import assets, people, records, streams, work

if TYPE_CHECKING:
    from jackettwin.service.context import Place

Values = Mapping[datetime, float | str | None]


def add_conditions(
    connection: Connection,
    place: Place,
    asset: str,
    values: Mapping[str, Values],
    by: str,
) -> tuple[int, int]:
    """Store conditions; return the numbers of new or changed ones and of records to observe again.

    Unchanged conditions have no effect.
    """
    people.note_down(connection, by, "conditions", f"{asset}: {', '.join(values)}", "ok", place.now())
    changed: set[datetime] = set()
    count = 0
    for name, given in values.items():
        new = streams.put_conditions(connection, asset, name, given)
        changed |= new
        count += len(new)
    if not changed:
        return 0, 0
    return count, _observe_again(connection, place, asset, changed)


def _observe_again(connection: Connection, place: Place, asset: str, changed: set[datetime]) -> int:
    """Queue the records that overlap the interval of a changed condition."""
    since, until = min(changed) - timedelta(days=1), max(changed) + streams.INTERVAL
    adopted, again = assets.found_version(connection, asset), 0
    starts = sorted(changed)
    for record in records.all_with_samples(connection, asset, since, until):
        end = record.start_utc + timedelta(seconds=record.duration_s)
        first = bisect_right(starts, record.start_utc - streams.INTERVAL)
        if first < len(starts) and starts[first] < end:
            jobs = work.jobs_of(connection, asset, record.record_id)
            known = [job.id for job in jobs if job.version >= adopted.version]
            again += any([work.renew(connection, number, place.now()) for number in known])
            if not jobs:  # forgotten since they ended long ago
                work.enqueue(connection, adopted, record.record_id, place.now())
                again += 1
    return again
