"""Rules of a server's alerts: channels, recipients and times."""

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
"""Largest age of findings other than alarms, as years of old records may be imported at once."""


Clock = Annotated[str, Field(pattern=r"^([01]\d|2[0-3]):[0-5]\d$")]


class QuietHours(Schema):
    """Quiet hours, at whose end the messages due within them are sent; alarms are sent at once."""

    begin: Clock
    """Time in ``zone``, as ``"22:00"``; ``end`` may be on the next day."""
    end: Clock
    zone: str = "UTC"
    also_alarms: bool = False
    """Whether alarms are also delayed."""

    @model_validator(mode="after")
    def _check(self) -> QuietHours:
        try:
            ZoneInfo(self.zone)
        except (ZoneInfoNotFoundError, ValueError, OSError):
            raise InputError(
                "no such time zone", field="zone", value=self.zone, allowed="e.g. UTC, Europe/Copenhagen"
            ) from None
        if self.begin == self.end:
            raise InputError("the quiet hours end when they begin", field="end", value=self.end)
        return self

    def after(self, moment: datetime) -> datetime:
        """Return the time itself, or the end of the quiet hours if it is within them."""
        here = moment.astimezone(ZoneInfo(self.zone))
        begin, end = time.fromisoformat(self.begin), time.fromisoformat(self.end)
        clock, over_night = here.time(), begin > end
        late, early = clock >= begin, clock < end
        if not (late or early if over_night else late and early):
            return moment
        day = here.date() + timedelta(days=1 if over_night and late else 0)
        return datetime.combine(day, end, tzinfo=ZoneInfo(self.zone)).astimezone(UTC)


class Escalation(Schema):
    """Channel for findings that nobody acknowledged."""

    channel: str
    after_minutes: float = Field(gt=0.0, le=100_000.0)


class ChannelRule(Schema):
    """Rule that sends selected findings through a channel."""

    severity: Literal["info", "warning", "alarm"] = "alarm"
    """Least severity that is sent."""
    assets: list[str] | None = None
    """Assets, and groups of them as ``@NAME``; default: all."""
    codes: list[str] | None = None
    """Codes of findings; default: all."""
    digest_minutes: int = Field(default=0, ge=0, le=10_080)
    """Length in minutes of intervals from midnight UTC whose findings form one message; 0: send at once."""
    quiet: QuietHours | None = None
    escalate: Escalation | None = None

    def tells(self, finding: Mapping[str, Any], assets: frozenset[str] | None) -> bool:
        """Return whether this rule, applied to these assets (None: all), selects a finding."""
        return (
            SEVERITIES.index(finding["severity"]) >= SEVERITIES.index(self.severity)
            and (assets is None or finding["asset"] in assets)
            and (self.codes is None or finding["code"] in self.codes)
        )

    def due(self, finding: Mapping[str, Any], now: datetime) -> datetime:
        """Return the time at which a present finding is due."""
        period = 60.0 * self.digest_minutes
        at = (
            now
            if not period
            else _EPOCH + timedelta(seconds=-((_EPOCH - now).total_seconds() // period) * period)
        )
        silent = self.quiet is not None and (finding["severity"] != "alarm" or self.quiet.also_alarms)
        return self.quiet.after(at) if silent and self.quiet is not None else at


class Rule(ChannelRule):
    """A rule of the alerts file, which names its channel."""

    channel: str


_EPOCH = datetime(2020, 1, 6, tzinfo=UTC)
"""Midnight of a Monday, from which the intervals of digests are counted."""


def is_fresh(finding: Mapping[str, Any], now: datetime) -> bool:
    """Return whether a finding is recent enough to send."""
    return finding["severity"] == "alarm" or bool(finding["time_utc"] > now - _FRESH)


class Alerts(Schema):
    """Alerts file: channels by name, and rules."""

    channels: dict[str, Annotated[AnyChannel, Field(discriminator="kind")]]
    rules: list[Rule]
    silent_hours: float | None = Field(default=6.0, gt=0.0, le=10_000.0)
    """Hours without a new record after which an asset raises an alarm; null for never."""
    address: str | None = None
    """Address of the server for users, as ``https://twin.example.org``, used for links in messages."""

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
                    "the name of a channel is too long", field="channels", value=name, allowed="64 characters"
                )
        return self


def read_alerts(path: Path) -> Alerts:
    """Read an alerts file, and check the settings and secrets of its channels.

    Raises
    ------
    InputError
        If it, or a file that it names, is not valid; the error names file, field, value and allowed values.
    """
    found = validate(Alerts, read_mapping(path, what="alerts file"), file=path)
    for name, channel in found.channels.items():
        try:
            channel.check(path.parent)
        except InputError as error:
            raise error.at(file=path, field=f"channels.{name}") from None
    return found
