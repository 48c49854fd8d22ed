"""One message to people: findings in plain words."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

MOST_LINES = 50
"""Findings that a message says one by one; of more it says how many."""


class NotDelivered(Exception):
    """The other side was reached, and did not take the message."""


@dataclass(frozen=True)
class Notice:
    """What is told at once through a channel.

    Attributes
    ----------
    findings : in plain values, oldest first: asset, code, severity, subject, text, day, time_utc, key, and
        ``unanswered_minutes`` of one that nobody took note of for so long
    address : of the server as people reach it, or None
    """

    findings: Sequence[Mapping[str, Any]]
    address: str | None = None

    @property
    def id(self) -> str:
        """What the message is known by: the same findings, sent again after a death, are the same message."""
        keys = sorted(f"{f['key']} {f.get('unanswered_minutes', '')}" for f in self.findings)
        return hashlib.sha256("\n".join(keys).encode()).hexdigest()[:32]

    @property
    def severity(self) -> str:
        """The worst of its findings."""
        found = {finding["severity"] for finding in self.findings}
        return next(name for name in ("alarm", "warning", "info") if name in found)

    @property
    def title(self) -> str:
        """What it is about, in a line."""
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
        """Its findings, a line each, and where to look."""
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
            "" if waited is None else f" (nobody took note of it for {waited:g} minutes)",
            "" if page is None else f" {page}",
        ]
        return _line("".join(parts), 1000)


_ORDER = ("alarm", "warning", "info")


def said(finding: Mapping[str, Any]) -> str:
    """Return the sentence of a finding, with its subject."""
    subject = finding["subject"]
    return f"{subject}: {finding['text']}" if subject else str(finding["text"])


def _line(text: str, most: int) -> str:
    """Return a text as one line: what strangers name things must not begin another one."""
    one = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return one if len(one) <= most else one[: most - 1] + "…"
