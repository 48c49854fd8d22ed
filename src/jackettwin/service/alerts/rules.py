"""Who is told what, and when: the alerts file of a server."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime, time, timedelta
from pathlib import Path
from typing import Annotated, Any, Literal
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from pydantic import Field, model_validator

from jackettwin.errors import InputError, look_up
from jackettwin.files import Schema, read_mapping, validate
from jackettwin.findings import CATALOGUE
from jackettwin.service.alerts.channels import AnyChannel

SEVERITIES = ("info", "warning", "alarm")
_FRESH = timedelta(days=7)
"""A finding that is no alarm is not told of a day longer ago: records of years may be sent at once."""


Clock = Annotated[str, Field(pattern=r"^([01]\d|2[0-3]):[0-5]\d$")]


class QuietHours(Schema):
    """When nobody is to be woken: what is due then is told afterwards, but for alarms."""

    begin: Clock
    """By the clock of ``zone``, as ``"22:00"``; ``end`` may be on the next day."""
    end: Clock
    zone: str = "UTC"
    also_alarms: bool = False
    """Whether alarms wait, too."""

    @model_validator(mode="after")
    def _check(self) -> QuietHours:
        try:
            ZoneInfo(self.zone)
        except (ZoneInfoNotFoundError, ValueError, OSError):
            raise InputError(
                "no such time zone", field="zone", value=self.zone, allowed="e.g. UTC, Europe/Copenhagen"
            ) from None
        if self.begin == self.end:
            raise InputError("quiet hours that end when they begin are none", field="end", value=self.end)
        return self

    def after(self, moment: datetime) -> datetime:
        """Return the moment itself, or when the quiet hours end that it lies in."""
        here = moment.astimezone(ZoneInfo(self.zone))
        begin, end = time.fromisoformat(self.begin), time.fromisoformat(self.end)
        clock, over_night = here.time(), begin > end
        late, early = clock >= begin, clock < end
        if not (late or early if over_night else late and early):
            return moment
        day = here.date() + timedelta(days=1 if over_night and late else 0)
        return datetime.combine(day, end, tzinfo=ZoneInfo(self.zone)).astimezone(UTC)


class Escalation(Schema):
    """Whom to tell what nobody took note of."""

    channel: str
    after_minutes: float = Field(gt=0.0, le=100_000.0)


class ChannelRule(Schema):
    """Which findings are told through a channel, and when."""

    severity: Literal["info", "warning", "alarm"] = "alarm"
    """The least that is told."""
    assets: list[str] | None = None
    """Assets, and groups of them as ``@NAME``; without it all."""
    codes: list[str] | None = None
    """Codes of findings; without it all."""
    digest_minutes: int = Field(default=0, ge=0, le=10_080)
    """All of so many minutes, counted from midnight UTC, is one message; 0 for at once."""
    quiet: QuietHours | None = None
    escalate: Escalation | None = None

    def tells(self, finding: Mapping[str, Any], assets: frozenset[str] | None) -> bool:
        """Tell whether a finding is one of this rule's, which names these assets; None for all."""
        return (
            SEVERITIES.index(finding["severity"]) >= SEVERITIES.index(self.severity)
            and (assets is None or finding["asset"] in assets)
            and (self.codes is None or finding["code"] in self.codes)
        )

    def due(self, finding: Mapping[str, Any], now: datetime) -> datetime:
        """Return when a finding of now is to be told."""
        period = 60.0 * self.digest_minutes
        at = (
            now
            if not period
            else _EPOCH + timedelta(seconds=-((_EPOCH - now).total_seconds() // period) * period)
        )
        silent = self.quiet is not None and (finding["severity"] != "alarm" or self.quiet.also_alarms)
        return self.quiet.after(at) if silent and self.quiet is not None else at


class Rule(ChannelRule):
    """A rule of the alerts file, which says whose it is."""

    channel: str


_EPOCH = datetime(2020, 1, 6, tzinfo=UTC)
"""A Monday's midnight, from which the periods of digests are counted."""


def is_fresh(finding: Mapping[str, Any], now: datetime) -> bool:
    """Tell whether a finding is worth telling now."""
    return finding["severity"] == "alarm" or bool(finding["time_utc"] > now - _FRESH)


class Alerts(Schema):
    """The alerts file: channels by name, rules on what goes where."""

    channels: dict[str, Annotated[AnyChannel, Field(discriminator="kind")]]
    rules: list[Rule]
    silent_hours: float | None = Field(default=6.0, gt=0.0, le=10_000.0)
    """Hours without a new record after which an asset that sends none is an alarm; null for never."""
    address: str | None = None
    """Of the server as people reach it, ``https://twin.example.org``: messages then link to its pages."""

    @model_validator(mode="after")
    def _check(self) -> Alerts:
        for k, rule in enumerate(self.rules):
            look_up(self.channels, rule.channel, "channel", field=f"rules.{k}.channel")
            if rule.escalate is not None:
                look_up(self.channels, rule.escalate.channel, "channel", field=f"rules.{k}.escalate.channel")
            for code in rule.codes or ():
                if code not in CATALOGUE:
                    look_up(CATALOGUE, code, "code of a finding", field=f"rules.{k}.codes")
        for name in self.channels:
            if len(name) > 64:
                raise InputError(
                    "a name of a channel is too long", field="channels", value=name, allowed="64 characters"
                )
        return self


def read_alerts(path: Path) -> Alerts:
    """Return an alerts file, whose channels have read their secrets.

    Raises
    ------
    InputError
        If it, or a file that it names, is not what it must be: names file, field, value and what is allowed.
    """
    found = validate(Alerts, read_mapping(path, what="alerts file"), file=path)
    for name, channel in found.channels.items():
        try:
            channel.check(path.parent)
        except InputError as error:
            raise error.at(file=path, field=f"channels.{name}") from None
    return found
