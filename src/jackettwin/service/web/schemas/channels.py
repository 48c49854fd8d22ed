"""Schemas of alert channels; secrets are only in requests, never in responses."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from jackettwin.service.alerts.broker import Topic
from jackettwin.service.alerts.mail import MailServer
from jackettwin.service.alerts.rules import ChannelRule
from jackettwin.service.alerts.webhook import Hook
from jackettwin.service.web import names

Secret = Annotated[str, Field(min_length=1, max_length=1024, pattern=r"^[^\x00-\x1f\x7f]*$")]
"""A secret in one line."""
Certificates = Annotated[
    str, Field(max_length=100_000, description="CA certificates in PEM that verify the other side.")
]


class MailIn(MailServer):
    """A channel for e-mail."""

    kind: Literal["mail"]
    password: Secret | None = None
    ca: Certificates | None = None


class WebhookIn(Hook):
    """A channel that posts to an HTTP address, signed if there is a secret."""

    kind: Literal["webhook"]
    url: Secret
    secret: Secret | None = None
    ca: Certificates | None = None


class MqttIn(Topic):
    """A channel through an MQTT broker."""

    kind: Literal["mqtt"]
    password: Secret | None = None
    ca: Certificates | None = None


class NewChannel(BaseModel):
    """A channel to add, and its rules; by default for every alarm."""

    name: str = Field(pattern=names.ASSET)
    channel: Annotated[MailIn | WebhookIn | MqttIn, Field(discriminator="kind")]
    rules: list[ChannelRule] = Field(default=[ChannelRule()], min_length=1, max_length=100)


class ChannelOut(BaseModel):
    """A channel: its destination without secrets, and its rules."""

    id: str
    kind: Literal["mail", "webhook", "mqtt"]
    about: str
    from_file: bool = Field(
        description="Whether it is in the server's alerts file, where only it can be changed."
    )
    rules: list[ChannelRule]


class Delivery(BaseModel):
    """Whether a message was accepted, and the reason if not."""

    delivered: bool
    problem: str | None = None
