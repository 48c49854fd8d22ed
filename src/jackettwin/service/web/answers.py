"""Responses of the API from the store."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from math import log
from operator import attrgetter
from typing import TYPE_CHECKING, Any, TypeVar

from fastapi import Path
from sqlalchemy import Connection

from jackettwin.errors import InputError
from jackettwin.service import workers
from jackettwin.service.intake.examination import profile
from jackettwin.service.web.schemas.assets import ChangeOut, ComparisonOut
from jackettwin.service.web.schemas.common import Page
from jackettwin.service.web.schemas.drawings import ColourOut, StructureOut
from jackettwin.service.web.schemas.findings import ActOut, FindingOut
from jackettwin.service.web.schemas.modes import KnownParameter, ModeOut, TwinOut
from jackettwin.service.web.schemas.supports import SupportsOut
from jackettwin.store import assets, handling, results
from jackettwin.store.records import read_cursor, write_cursor
from jackettwin.version import __version__

if TYPE_CHECKING:
    from jackettwin.service.context import Service

T = TypeVar("T")
F = TypeVar("F", bound=FindingOut)
RowNumber = Path(ge=1, le=2**53)
"""Number of a row within the exact integers of JavaScript."""


def _row(cursor: str | None) -> int | None:
    if cursor is None:
        return None
    place = read_cursor(cursor)
    if len(place) != 1 or not isinstance(place[0], int) or not 0 <= place[0] < 2**53:
        raise InputError("not a cursor of this list", field="cursor", value=cursor[:40])
    return place[0]


def modes(
    connection: Connection,
    version: assets.Version,
    label: str | None,
    since: datetime | None,
    until: datetime | None,
    cursor: str | None,
    limit: int,
    state: str | None,
    least_known: bool = False,
    record: str | None = None,
) -> Page[ModeOut]:
    """Return a page of modes through time, or the modes that are known least, which have one page only."""
    chosen: dict[str, Any] = {
        "label": label,
        "since": since,
        "until": until,
        "after": _row(cursor),
        "limit": limit + 1,
        "state": state,
        "least_known": least_known,
        "record_id": record,
    }
    rows = results.list_modes(connection, version.asset, version.model_hash, **chosen)
    reasons = {} if record is None else _reasons(connection, version, record)

    def made(row: Mapping[str, Any]) -> ModeOut:
        nearest = min(reasons, key=lambda f: abs(f - row["frequency_hz"]), default=0.0)  # it is rounded
        return _mode_out({**row, "reason": reasons.get(nearest)})

    return _page(rows[:limit] if least_known else rows, limit, made)


def _reasons(connection: Connection, version: assets.Version, record: str) -> dict[float, str | None]:
    """Return what is said against each mode of a record, by its frequency; empty once that is forgotten."""
    seen = results.find_observation(connection, version.asset, record, version.model_hash)
    return {} if seen is None or not seen.document else workers.engine.said_of_modes(seen.document)


def coloured_by_life(drawn: StructureOut, welds: Sequence[Mapping[str, Any]]) -> StructureOut:
    """Return a structure with the life and the damage of each member's worst weld; as it is without any.

    A weld belongs to the member on whose side it is: the chord's or the brace's; around a tube both are it.
    Of welds beyond the ranges of their factors nothing is certain: they colour nothing.
    """
    worst: dict[str, Mapping[str, Any]] = {}
    for weld in (one for one in welds if not one["beyond_validity"]):
        name = weld["brace" if weld["side"] == "brace" else "chord"]
        if name not in worst or weld["rate_per_year"] > worst[name]["rate_per_year"]:
            worst[name] = weld
    own = [worst.get(text.partition("<br>")[0].partition(" (")[0]) for text in drawn.text]
    if not any(own):
        return drawn
    shown: dict[tuple[str, str], Callable[[Mapping[str, Any]], float | None]] = {
        ("life left, worst weld", "years"): lambda weld: weld["remaining_years"]["p50"],
        ("damage a year, worst weld", "-"): lambda weld: weld["rate_per_year"] or None,
    }
    more = [
        ColourOut(
            name=name, unit=unit, log=True, from_zero=False,
            values=[None if weld is None else value(weld) for weld in own],
        )
        for (name, unit), value in shown.items()
    ]  # fmt: skip
    return drawn.model_copy(update={"quantities": [*drawn.quantities, *more]})


def _page(rows: list[Mapping[str, Any]], limit: int, made: Callable[[Mapping[str, Any]], T]) -> Page[T]:
    """Return a page of rows; an extra row shows that there is a next page."""
    more = write_cursor(rows[limit - 1]["id"]) if len(rows) > limit else None
    return Page(items=[made(row) for row in rows[:limit]], next_cursor=more)


def _mode_out(row: Mapping[str, Any]) -> ModeOut:
    low, high = row["damping_ratio_low_90"], row["damping_ratio_high_90"]
    known = {name: row[name] for name in ModeOut.model_fields if name in row}
    return ModeOut(**known, damping_ratio_interval_90=None if low is None or high is None else (low, high))


def findings(
    connection: Connection,
    version: assets.Version,
    severity: str | None,
    cursor: str | None,
    limit: int,
    kind: type[F],
) -> Page[F]:
    """Return a page of findings with their status, newest first."""
    chosen: dict[str, Any] = {"severity": severity, "before": _row(cursor), "limit": limit + 1}
    rows = results.list_findings(connection, version.asset, version.model_hash, **chosen)
    handled = handling.handled(connection, version.asset)
    return _page(rows, limit, lambda row: finding_out(row, handled, kind))


def finding_out(row: Mapping[str, Any], handled: handling.Handled, kind: type[F]) -> F:
    """Return a finding in the form of the API."""
    standing, named = handled.standing(row), kind.model_fields
    noted, closed = standing.acknowledged, standing.closed
    known = {
        **row,
        "acknowledged_by": noted and noted.by,
        "acknowledged_utc": noted and noted.time_utc,
        "comment": noted and noted.comment,
        "assigned_to": standing.assigned_to,
        "muted_until_utc": standing.muted_until_utc,
        "closed_by": closed and closed.by,
        "closed_utc": closed and closed.time_utc,
        "close_reason": closed and closed.comment,
    }
    if "history" in named:
        known["history"] = [ActOut.model_validate(act, from_attributes=True) for act in handled.history(row)]
    return kind(**{name: known[name] for name in named})


def twin(
    connection: Connection, service: Service, version: assets.Version, at: datetime | None = None
) -> TwinOut:
    """Return the state of a twin at a time, from the states of its days."""
    last = None if at is None else f"{at.astimezone(UTC):%Y-%m-%d}"
    model = profile(connection, service, version.asset, version.version)
    told = service.days.told(connection, version, model, last)
    known = workers.engine.knowledge(model, told.sums)
    if at is None:
        known["parameters"] = results.find_supports(connection, version.asset, version.version)
    return TwinOut(
        asset=version.asset,
        version=version.version,
        model_hash=version.model_hash,
        code_version=__version__,
        state_hash=told.state_hash,
        days=told.days,
        recent_modes=workers.engine.knowledge(model, told.recent)["modes"],
        **known,
    )


def supports(connection: Connection, version: assets.Version) -> SupportsOut:
    """Return the stiffness of the supports on each day, the last one first."""
    found = results.find_stiffness(connection, version.asset, version.version)
    days = found.pop("days", [])[::-1]
    return SupportsOut(asset=version.asset, version=version.version, days=days, **found)


def compared(
    connection: Connection, service: Service, adopted: assets.Version, other: assets.Version
) -> ComparisonOut:
    """Return the comparison of the adopted version with another one on the same records."""
    mine, theirs = twin(connection, service, adopted), twin(connection, service, other)
    changes = []
    for name, unit, value in (
        ("frequency_hz", "Hz", attrgetter("frequency_hz", "frequency_std_hz")),
        ("damping_ratio", "-", attrgetter("damping_ratio", "damping_ratio_std")),
    ):
        before, after = ({m.label: value(m) for m in known.modes} for known in (mine, theirs))
        changes += [
            _change(f"{label} {name}", unit, before.get(label), after.get(label))
            for label in {**before, **after}
        ]
    before, after = (_logarithms(known.parameters.parameters) for known in (mine, theirs))
    units = {name: p.unit for known in (mine, theirs) for name, p in known.parameters.parameters.items()}
    changes += [_change(f"ln {name}", units[name], before.get(name), after.get(name)) for name in units]
    return ComparisonOut(adopted=mine, other=theirs, changes=changes)


def _logarithms(parameters: Mapping[str, KnownParameter]) -> dict[str, tuple[float, float | None]]:
    """Return the logarithm of every parameter's median with the standard deviation from its 90 % interval."""
    from jackettwin.intervals import NORMAL_90

    found = {}
    for name, known in parameters.items():
        span = known.interval_90
        std = None if span is None else log(span[1] / span[0]) / (2.0 * NORMAL_90)
        found[name] = (log(known.median), std)
    return found


def _change(
    quantity: str,
    unit: str,
    before: tuple[float, float | None] | None,
    after: tuple[float, float | None] | None,
) -> ChangeOut:
    """Return a quantity of two versions, and their difference in standard deviations of the adopted one."""
    if before is None or after is None:
        return ChangeOut(quantity=quantity, unit=unit, adopted=before and before[0], other=after and after[0])
    difference = after[0] - before[0]
    sure = before[1] or after[1]
    return ChangeOut(
        quantity=quantity,
        unit=unit,
        adopted=before[0],
        other=after[0],
        difference=difference,
        in_standard_deviations=difference / sure if sure else None,
    )
