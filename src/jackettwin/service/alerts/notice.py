"""A message to people with findings as sentences."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

MOST_LINES = 50
"""Largest number of findings that a message lists; of further ones it gives the number."""


class NotDelivered(Exception):
    """The other side was reached but did not accept the message."""


@dataclass(frozen=True)
class Notice:
    """A message through a channel.

    Attributes
    ----------
    findings : as plain values, oldest first: asset, code, severity, subject, text, day, time_utc, key, and
        ``unanswered_minutes`` if nobody acknowledged it for so long
    address : of the server for users, or None
    """

    findings: Sequence[Mapping[str, Any]]
    address: str | None = None

    @property
    def id(self) -> str:
        """Identity of the message, the same if the same findings are sent again after a restart."""
        keys = sorted(f"{f['key']} {f.get('unanswered_minutes', '')}" for f in self.findings)
        return hashlib.sha256("\n".join(keys).encode()).hexdigest()[:32]

    @property
    def severity(self) -> str:
        """The highest severity of its findings."""
        found = {finding["severity"] for finding in self.findings}
        return next(name for name in ("alarm", "warning", "info") if name in found)

    @property
    def title(self) -> str:
        """One line on its subject."""
        assets = sorted({finding["asset"] for finding in self.findings})
        of = ", ".join(assets[:3]) + (f" and {len(assets) - 3} more" if len(assets) > 3 else "")
        if len(self.findings) == 1:
            finding = self.findings[0]
            return _line(f"{finding['severity'].upper()} {of}: {said(finding)}", 120)
        counts = Counter(finding["severity"] for finding in self.findings)
        words = [
            f"{counts[s]} {s}{'s' if counts[s] > 1 and s != 'info' else ''}" for s in _ORDER if counts[s]
        ]
        return _line(f"{', '.join(words)} of {of}", 120)

    @property
    def lines(self) -> list[str]:
        """A line for each finding, and a link."""
        told = [self._told(finding) for finding in self.findings[:MOST_LINES]]
        left = len(self.findings) - MOST_LINES
        return [*told, f"… and {left} more"] if left > 0 else told

    def page(self, asset: str) -> str | None:
        """Return the address of an asset's page, if it is known."""
        return None if self.address is None else f"{self.address.rstrip('/')}/assets/{asset}"

    def _told(self, finding: Mapping[str, Any]) -> str:
        page = self.page(finding["asset"])
        waited = finding.get("unanswered_minutes")
        parts = [
            f"{finding['severity'].upper()} {finding['asset']} {finding['day']}: {said(finding)}",
            "" if waited is None else f" (nobody acknowledged it for {waited:g} minutes)",
            "" if page is None else f" {page}",
        ]
        return _line("".join(parts), 1000)


_ORDER = ("alarm", "warning", "info")


def said(finding: Mapping[str, Any]) -> str:
    """Return the sentence of a finding, with its subject."""
    subject = finding["subject"]
    return f"{subject}: {finding['text']}" if subject else str(finding["text"])


def _line(text: str, most: int) -> str:
    """Return a text as one line, since names from outside must not contain a line break."""
    one = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return one if len(one) <= most else one[: most - 1] + "…"
