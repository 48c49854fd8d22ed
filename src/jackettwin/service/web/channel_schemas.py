"""Channels of alerts as the API speaks of them: their secrets are sent in, and never told again."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from jackettwin.service.alerts.broker import Topic
from jackettwin.service.alerts.mail import MailServer
from jackettwin.service.alerts.rules import ChannelRule
from jackettwin.service.alerts.webhook import Hook

Secret = Annotated[str, Field(min_length=1, max_length=1024, pattern=r"^[^\x00-\x1f\x7f]*$")]
"""One line."""
Certificates = Annotated[
    str, Field(max_length=100_000, description="In PEM, by which the other side is known.")
]


class MailIn(MailServer):
    """Mail to people."""

    kind: Literal["mail"]
    password: Secret | None = None
    ca: Certificates | None = None


class WebhookIn(Hook):
    """Posts to an address of the web, signed with a secret if there is one."""

    kind: Literal["webhook"]
    url: Secret
    secret: Secret | None = None
    ca: Certificates | None = None


class MqttIn(Topic):
    """Messages to a broker."""

    kind: Literal["mqtt"]
    password: Secret | None = None
    ca: Certificates | None = None


class NewChannel(BaseModel):
    """A channel to add, and what is told through it; by default every alarm."""

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")
    channel: Annotated[MailIn | WebhookIn | MqttIn, Field(discriminator="kind")]
    rules: list[ChannelRule] = Field(default=[ChannelRule()], min_length=1, max_length=100)


class ChannelOut(BaseModel):
    """A channel: where it leads, without what is secret, and what is told through it."""

    id: str
    kind: Literal["mail", "webhook", "mqtt"]
    about: str
    from_file: bool = Field(description="Of the server's alerts file, which alone changes it.")
    rules: list[ChannelRule]


class Delivery(BaseModel):
    """Whether a message was taken, and if not, why."""

    delivered: bool
    problem: str | None = None
