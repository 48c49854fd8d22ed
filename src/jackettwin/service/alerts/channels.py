"""Channels of alerts: each has its own module and kind, and a name in this line."""

from __future__ import annotations

from jackettwin.service.alerts.broker import Broker
from jackettwin.service.alerts.mail import Mail
from jackettwin.service.alerts.webhook import Webhook

AnyChannel = Mail | Webhook | Broker
