"""Modes through time in bins: extremes and medians, read in one pass without holding the rows.

Ten years of a turbine are two million rows. Extremes and medians of its past days are therefore kept, and
bins of a day or longer are made of them; other days, as one to which a record was added, are read by row.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from itertools import groupby, pairwise
from statistics import median
from typing import TYPE_CHECKING, Any

from sqlalchemy import (
    Float,
    Select,
    case,
    cast,
    delete,
    extract,
    func,
    insert,
    literal,
    select,
    union_all,
)

from jackettwin.store.records import between, of_state
from jackettwin.store.tables import mode_days, modes

if TYPE_CHECKING:
    from sqlalchemy import Connection

_BATCH = 5_000
"""Rows that are taken from the database at once."""
DAY_S = 86_400
_LONG = timedelta(days=100)
"""Length of time from which bins are not shorter than a day, if days are kept."""
_MOST_GAPS = 200
"""Number of stretches without kept days above which every row is read; a statement has few hundred parts."""
_AT_ONCE = 31
"""Number of days that are kept in one transaction, as after an upgrade."""
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)

Stretch = tuple[datetime | None, datetime | None]


@dataclass
class Extremes:
    """Least value, median and greatest value of each bin; None where no row has one."""

    min: list[float | None] = field(default_factory=list)
    median: list[float | None] = field(default_factory=list)
    max: list[float | None] = field(default_factory=list)

    def add(self, low: Sequence[Any], middle: Sequence[Any], high: Sequence[Any]) -> None:
        """Append the next bin, from the least values, medians and greatest values of its parts."""
        known = [value for value in middle if value is not None]
        self.min.append(min((value for value in low if value is not None), default=None))
        self.median.append(median(known) if known else None)
        self.max.append(max((value for value in high if value is not None), default=None))


@dataclass
class ModeBins:
    """One mode in bins of equal length of time; bins without a row are left out.

    ``time_s`` is the start of each bin in seconds after ``start_utc``, ``count`` the number of its rows,
    and ``simulated`` the number of rows of all bins that nobody measured.
    """

    label: str
    start_utc: datetime
    bin_s: float
    time_s: list[float] = field(default_factory=list)
    count: list[int] = field(default_factory=list)
    frequency_hz: Extremes = field(default_factory=Extremes)
    damping_ratio: Extremes = field(default_factory=Extremes)
    simulated: int = 0

    def add(self, number: float, parts: Iterable[tuple[Any, ...]]) -> None:
        """Append a bin of rows or days."""
        _, _, count, simulated, *values = zip(*parts, strict=True)
        self.time_s.append(number * self.bin_s)
        self.count.append(sum(count))
        self.frequency_hz.add(*values[:3])
        self.damping_ratio.add(*values[3:])
        self.simulated += sum(simulated)


def modes_in_bins(
    connection: Connection,
    asset: str,
    model_hash: str,
    points: int,
    *,
    label: str | None = None,
    since: datetime | None = None,
    until: datetime | None = None,
    state: str | None = None,
) -> Iterator[ModeBins]:
    """Yield each mode, or one, in at most ``points`` bins from one time until before another.

    Without these times the bins extend over all rows. All modes have the same bins. A kept day is in the
    bin of its noon, and the median of a bin of kept days is that of their medians. No more rows than those of
    a bin and of a batch are held.
    """
    labels = _labels(connection, asset) if label is None else [label]
    rows = select(modes).filter_by(asset=asset, model_hash=model_hash)
    rows = of_state(rows, modes.c.record_id, asset, state)
    days = select(mode_days).filter_by(asset=asset, model_hash=model_hash)
    days = days.where(mode_days.c.label.in_(labels))
    kept = [] if state is not None else _kept_between(connection, days, since, until)
    first, last = _span(connection, rows, labels, kept, since, until)
    rows = rows.where(modes.c.label.in_(labels))
    if first is None or last is None:
        return
    start = first.replace(microsecond=0)
    bin_s = (last - start).total_seconds() / points or 1.0
    if kept and last - start >= _LONG:
        bin_s = max(bin_s, DAY_S)
    if bin_s < DAY_S or len(_between_kept(kept, since, until)) > _MOST_GAPS:
        kept = []
    begin = start.timestamp()
    parts = _parts(connection, rows, days, kept, since, until)
    for name, own in groupby(parts, lambda part: part[0]):
        bins = ModeBins(name, start, bin_s)
        for number, inside in groupby(own, lambda part: min((part[1] - begin) // bin_s, points - 1)):
            bins.add(number, inside)
        yield bins


def keep_days(connection: Connection, asset: str, model_hash: str, before: datetime) -> None:
    """Keep extremes and medians of the days before that of a time, of at most some of them at once."""
    today = (before - _EPOCH).days
    days = select(mode_days).filter_by(asset=asset, model_hash=model_hash)
    last = connection.scalar(days.with_only_columns(func.max(mode_days.c.day)))
    if last is not None and last >= today - 1:
        return
    rows = select(modes).filter_by(asset=asset, model_hash=model_hash)
    since, labels = None if last is None else _midnight(last + 1), _labels(connection, asset)
    first, _ = _ends(connection, rows, labels, since, _midnight(today))
    rows = rows.where(modes.c.label.in_(labels))
    if first is None:
        return
    of = (first - _EPOCH).days
    until = _midnight(min(today, of + _AT_ONCE))
    parts = _parts(connection, rows, days, [], _midnight(of), until)
    made = []
    for (name, day), inside in groupby(parts, lambda part: (part[0], int(part[1] // DAY_S))):
        one = ModeBins(name, _midnight(day), DAY_S)
        one.add(0.0, inside)
        row = {"asset": asset, "model_hash": model_hash, "day": day, "label": name}
        row |= {"count": one.count[0], "simulated": one.simulated}
        for what in ("min", "median", "max"):
            (row[f"frequency_{what}_hz"],) = getattr(one.frequency_hz, what)
            (row[f"damping_ratio_{what}"],) = getattr(one.damping_ratio, what)
        made.append(row)
    connection.execute(insert(mode_days), made)


def forget_day(connection: Connection, asset: str, model_hash: str, time: datetime) -> None:
    """Delete what is kept of the day of a time, whose rows change."""
    day = (time - _EPOCH).days
    connection.execute(delete(mode_days).filter_by(asset=asset, model_hash=model_hash, day=day))


def _midnight(day: int) -> datetime:
    return _EPOCH + timedelta(days=day)


def _kept_between(
    connection: Connection, days: Select[Any], since: datetime | None, until: datetime | None
) -> list[int]:
    """Return the kept days that lie between two times as a whole."""
    day = mode_days.c.day
    found = connection.scalars(days.with_only_columns(day).distinct().order_by(day))
    return [
        one
        for one in found
        if (since is None or _midnight(one) >= since) and (until is None or _midnight(one + 1) <= until)
    ]


def _labels(connection: Connection, asset: str) -> list[str]:
    """Return the labels of an asset's modes, each by one step in the index."""
    found, next_one = [], select(func.min(modes.c.label)).filter_by(asset=asset)
    label = connection.scalar(next_one)
    while label is not None:
        found.append(label)
        label = connection.scalar(next_one.where(modes.c.label > label))
    return found


def _span(
    connection: Connection,
    rows: Select[Any],
    labels: Sequence[str],
    kept: Sequence[int],
    since: datetime | None,
    until: datetime | None,
) -> Stretch:
    """Return the first and the last time of rows and kept days, unless they are given."""
    if since is not None and until is not None:
        return since, until
    stretches = _between_kept(kept, since, until)
    first, _ = _ends(connection, rows, labels, *stretches[0])
    _, last = _ends(connection, rows, labels, *stretches[-1])
    if kept:
        first, last = first or _midnight(kept[0]), last or _midnight(kept[-1] + 1)
    return since or first, until or last


def _ends(
    connection: Connection,
    rows: Select[Any],
    labels: Sequence[str],
    since: datetime | None,
    until: datetime | None,
) -> Stretch:
    """Return the times of the first and the last row of a stretch, None without one.

    Of each label these are the ends of the index.
    """
    time, found = modes.c.time_utc, []
    for label in labels:
        own = between(rows.where(modes.c.label == label), time, since, until).with_only_columns(time).limit(1)
        found += [connection.scalar(own.order_by(time)), connection.scalar(own.order_by(time.desc()))]
    known = [one for one in found if one is not None]
    return min(known, default=None), max(known, default=None)


def _between_kept(kept: Sequence[int], since: datetime | None, until: datetime | None) -> list[Stretch]:
    """Return the stretches of time between two times without kept days, whose rows are read."""
    if not kept:
        return [(since, until)]
    gaps = [(_midnight(a + 1), _midnight(b)) for a, b in pairwise(kept) if b > a + 1]
    return [(since, _midnight(kept[0])), *gaps, (_midnight(kept[-1] + 1), until)]


def _parts(
    connection: Connection,
    rows: Select[Any],
    days: Select[Any],
    kept: Sequence[int],
    since: datetime | None,
    until: datetime | None,
) -> Iterator[tuple[Any, ...]]:
    """Yield rows and kept days by label and time.

    Of each: label, seconds since 1970, number of rows, of those simulated, then least value, median and
    greatest value of frequency [Hz] and damping ratio. The database counts the seconds: to make a time of
    each row takes longer than all else.
    """
    at_s = cast(extract("epoch", modes.c.time_utc), Float).label("at_s")
    simulated = case((modes.c.status == "simulated", 1), else_=0)
    f, zeta = modes.c.frequency_hz, modes.c.damping_ratio
    columns = (modes.c.label.label("label"), at_s, literal(1), simulated, f, f, f, zeta, zeta, zeta)
    stretches = _between_kept(kept, since, until)
    pieces = [between(rows, modes.c.time_utc, *ends).with_only_columns(*columns) for ends in stretches]
    if kept:
        c = mode_days.c
        noon = cast(c.day, Float) * DAY_S + DAY_S / 2
        of_days = days.where(c.day >= kept[0], c.day <= kept[-1]).with_only_columns(
            c.label, noon, c.count, c.simulated,
            c.frequency_min_hz, c.frequency_median_hz, c.frequency_max_hz,
            c.damping_ratio_min, c.damping_ratio_median, c.damping_ratio_max,
        )  # fmt: skip
        pieces.append(of_days)
    query: Any = union_all(*pieces) if kept else pieces[0]
    order = ("label", "at_s") if kept else (modes.c.label, modes.c.time_utc)
    found = connection.execute(query.order_by(*order), execution_options={"yield_per": _BATCH})
    for batch in found.partitions():
        yield from map(tuple, batch)
