"""Alerts by e-mail."""

from __future__ import annotations

import smtplib
import ssl
from email.message import EmailMessage
from email.utils import formatdate, parseaddr
from pathlib import Path
from typing import Literal

from pydantic import Field

from jackettwin.errors import require
from jackettwin.files import Schema
from jackettwin.service.alerts.notice import NotDelivered, Notice
from jackettwin.service.credentials import secret_in, tls_context

_TIMEOUT_S = 20.0
_PORTS = {"starttls": 587, "tls": 465, "none": 25}


class MailServer(Schema):
    """An SMTP server, and the recipients."""

    host: str = Field(min_length=1)
    port: int | None = Field(default=None, ge=1, le=65535)
    """Default: 587 with STARTTLS, 465 with TLS, 25 without."""
    security: Literal["starttls", "tls", "none"] = "starttls"
    user: str | None = None
    sender: str
    to: list[str] = Field(min_length=1, max_length=100)


class Mail(MailServer):
    """A mail channel with secrets in files."""

    kind: Literal["mail", "email"]
    ca: Path | None = None
    """CA certificates that verify the server; default: those of the system."""
    password_file: Path | None = None
    """File whose first line is the user's password; a relative path starts at the alerts file."""

    @property
    def about(self) -> str:
        """Its destination, without secrets."""
        return f"{', '.join(self.to)} by {self.host}"

    def check(self, folder: Path) -> None:
        """Raise an error on settings with which no message could be sent.

        Raises
        ------
        InputError
            If an address is not valid, a password would travel unencrypted, or a file cannot be read.
        """
        for field, address in [("sender", self.sender), *((f"to.{k}", one) for k, one in enumerate(self.to))]:
            plain = parseaddr(address)[1]
            require(
                plain.count("@") == 1 and all(plain.split("@")) and address.isprintable(),
                "not an e-mail address",
                field=field,
                value=address,
                allowed="NAME@HOST",
            )
        require(
            self.user is None or self.security != "none",
            "a password would travel unencrypted",
            field="security",
            value=self.security,
            allowed="starttls, tls",
        )
        require(
            (self.user is None) == (self.password_file is None),
            "user and password_file must be given together",
            field="password_file" if self.password_file is None else "user",
            remedy="give both or neither",
        )
        secret_in(folder, self.password_file, "password_file")
        if self.ca is not None:
            tls_context(self.ca and folder / self.ca)

    def send(self, notice: Notice, folder: Path) -> None:
        """Send a message.

        Raises
        ------
        OSError, NotDelivered
            If it was not accepted.
        """
        message = self._written(notice)
        port = self.port or _PORTS[self.security]
        context = None if self.security == "none" else tls_context(self.ca and folder / self.ca)
        try:
            with self._connected(port, context) as server:
                if self.security == "starttls":
                    server.starttls(context=context)
                if self.user is not None:
                    server.login(self.user, secret_in(folder, self.password_file, "password_file") or "")
                refused = server.send_message(message)
        except smtplib.SMTPException as error:
            raise NotDelivered(f"the mail server refuses it: {error}") from None
        if refused:
            raise NotDelivered(f"the mail server refuses {', '.join(refused)}")

    def _connected(self, port: int, context: ssl.SSLContext | None) -> smtplib.SMTP:
        if self.security == "tls":
            return smtplib.SMTP_SSL(self.host, port, timeout=_TIMEOUT_S, context=context)
        return smtplib.SMTP(self.host, port, timeout=_TIMEOUT_S)

    def _written(self, notice: Notice) -> EmailMessage:
        message = EmailMessage()
        message["From"], message["To"] = self.sender, ", ".join(self.to)
        message["Subject"] = f"[jackettwin] {notice.title}"
        message["Date"] = formatdate()
        message["Message-ID"] = f"<{notice.id}@{parseaddr(self.sender)[1].partition('@')[2]}>"
        message["Auto-Submitted"] = "auto-generated"
        if notice.severity == "alarm":
            message["Importance"] = "high"
        message.set_content("\n".join(notice.lines) + "\n")
        return message
