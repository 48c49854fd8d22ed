"""Alerts by signed HTTP requests in the formats of chats and alert managers."""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal
from urllib.parse import urlsplit

import httpx

from jackettwin.errors import require
from jackettwin.files import Schema
from jackettwin.service.alerts.notice import NotDelivered, Notice, said
from jackettwin.service.credentials import secret_in, tls_context

_TIMEOUT_S = 15.0


def _plain(notice: Notice) -> dict[str, Any]:
    """Return the findings unchanged."""
    return {"id": notice.id, "title": notice.title, "findings": [dict(f) for f in notice.findings]}


def _slack(notice: Notice) -> dict[str, Any]:
    """Return a message of an incoming webhook of Slack, with its three special characters escaped."""
    escaped = ("\n".join(notice.lines)).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return {"text": escaped}


def _teams(notice: Notice) -> dict[str, Any]:
    """Return a message with an adaptive card, for a workflow of Teams."""
    colour = {"alarm": "Attention", "warning": "Warning", "info": "Default"}[notice.severity]
    title = {"type": "TextBlock", "text": notice.title, "wrap": True, "weight": "Bolder", "color": colour}
    body = [title, *({"type": "TextBlock", "text": line, "wrap": True} for line in notice.lines)]
    card = {
        "$schema": "http://adaptivecards.io/schemas/adaptive-card.json",
        "type": "AdaptiveCard",
        "version": "1.4",
        "body": body,
    }
    kind = "application/vnd.microsoft.card.adaptive"
    return {"type": "message", "attachments": [{"contentType": kind, "contentUrl": None, "content": card}]}


def _alertmanager(notice: Notice) -> dict[str, Any]:
    """Return a body as Alertmanager sends to its receivers, version 4."""
    alerts = [_alert(notice, finding) for finding in notice.findings]
    common = {
        name: value
        for name, value in alerts[0]["labels"].items()
        if all(alert["labels"].get(name) == value for alert in alerts)
    }
    return {
        "version": "4",
        "groupKey": notice.id,
        "truncatedAlerts": 0,
        "status": "firing",
        "receiver": "jackettwin",
        "groupLabels": {},
        "commonLabels": common,
        "commonAnnotations": {},
        "externalURL": notice.address or "",
        "alerts": alerts,
    }


def _alert(notice: Notice, finding: Mapping[str, Any]) -> dict[str, Any]:
    severity = {"alarm": "critical"}.get(finding["severity"], finding["severity"])
    labels = {"alertname": finding["code"], "severity": severity, "asset": finding["asset"]}
    return {
        "status": "firing",
        "labels": {**labels, **({"subject": finding["subject"]} if finding["subject"] else {})},
        "annotations": {"summary": said(finding)},
        "startsAt": finding["time_utc"],
        "endsAt": "0001-01-01T00:00:00Z",
        "generatorURL": notice.page(finding["asset"]) or "",
        "fingerprint": hashlib.sha256(finding["key"].encode()).hexdigest()[:16],
    }


SHAPES: dict[str, Callable[[Notice], dict[str, Any]]] = {
    "plain": _plain,
    "slack": _slack,
    "teams": _teams,
    "alertmanager": _alertmanager,
}
"""Functions that make the body, by format."""


class Hook(Schema):
    """An HTTP address that receives messages by POST, and their format."""

    url: str | None = None
    shape: Literal["plain", "slack", "teams", "alertmanager"] = "plain"


class Webhook(Hook):
    """A webhook with secrets in files."""

    kind: Literal["webhook"]
    url_file: Path | None = None
    """File whose first line is the address, since addresses of Slack and Teams are secret."""
    secret_file: Path | None = None
    """File whose first line is the signing secret; a secret in base64 has the prefix ``whsec_``."""
    ca: Path | None = None
    """CA certificates that verify the other side; default: those of the system."""

    @property
    def about(self) -> str:
        """Its destination, without secrets."""
        known = "a secret address" if self.url is None else urlsplit(self.url).hostname
        return f"{known} as {self.shape}"

    def check(self, folder: Path) -> None:
        """Raise an error on settings with which no message could be sent.

        Raises
        ------
        InputError
            If the address is not valid, or a file cannot be read.
        """
        require(
            (self.url is None) != (self.url_file is None),
            "either url or url_file is needed",
            field="url",
            remedy="give either",
        )
        place = urlsplit(self._url(folder))
        require(
            place.scheme in ("http", "https") and place.hostname,
            "not an HTTP address",
            field="url" if self.url_file is None else "url_file",
            value=self.url,
            allowed="https://HOST/PATH",
        )
        key = secret_in(folder, self.secret_file, "secret_file")
        if key is not None:
            signing_key(key)
        if self.ca is not None:
            tls_context(self.ca and folder / self.ca)

    def send(self, notice: Notice, folder: Path) -> None:
        """Post a message.

        Raises
        ------
        httpx.HTTPError, NotDelivered
            If it was not accepted.
        """
        body = json.dumps(SHAPES[self.shape](notice), ensure_ascii=False).encode()
        headers = {"Content-Type": "application/json", "webhook-id": notice.id}
        key = secret_in(folder, self.secret_file, "secret_file")
        if key is not None:
            stamp = int(time.time())
            signature = signed(signing_key(key), notice.id, stamp, body)
            headers |= {"webhook-timestamp": str(stamp), "webhook-signature": signature}
        with httpx.Client(
            timeout=_TIMEOUT_S, verify=tls_context(self.ca and folder / self.ca), trust_env=False
        ) as client:
            answer = client.post(self._url(folder), content=body, headers=headers)
        if not answer.is_success:
            raise NotDelivered(f"the other side returns status {answer.status_code}")

    def _url(self, folder: Path) -> str:
        return self.url or secret_in(folder, self.url_file, "url_file") or ""


def signed(key: bytes, message_id: str, stamp: int, body: bytes) -> str:
    r"""Return the signature of a message.

    .. math:: \mathrm{base64}\bigl(\mathrm{HMAC}_\mathrm{SHA256}(key,\ id \| . \| stamp \| . \| body)\bigr)

    Source: Standard Webhooks 1.0.0, "Signature scheme". The stamp is in seconds since 1970.

    >>> signed(b"key", "msg", 0, b"{}")[:3]
    'v1,'
    """
    content = f"{message_id}.{stamp}.".encode() + body
    return "v1," + base64.b64encode(hmac.digest(key, content, "sha256")).decode()


def signing_key(secret: str) -> bytes:
    """Return the bytes of a secret, decoded from base64 after ``whsec_``, otherwise unchanged.

    Raises
    ------
    InputError
        If it is not base64 after ``whsec_``.
    """
    prefix, found, coded = secret.partition("whsec_")
    if prefix or not found:
        return secret.encode()
    try:
        return base64.b64decode(coded, validate=True)
    except ValueError:
        require(False, "not base64 after whsec_", field="secret_file", remedy="copy the secret again")
        raise
