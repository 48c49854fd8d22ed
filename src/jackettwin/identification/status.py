"""Status of a spectral peak: mode, doubtful mode, or no mode.

Every status except ``OK`` comes with findings that give the reasons;
their codes are in :mod:`jackettwin.findings`.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from jackettwin.findings import Finding


class ModeStatus(StrEnum):
    """Status of a reported mode. Members are strings: ``mode.status == "ok"`` works."""

    OK = "ok"
    """A mode by all criteria: frequency and damping are known to their intervals."""
    DAMPING_UNKNOWN = "damping unknown"
    """A mode of known frequency, whose damping the record does not determine."""
    UNCHECKED = "unchecked"
    """A mode by the poles or peaks of a method whose modes are not checked against tones, waves and noise."""
    DOUBTFUL = "doubtful"
    """Possibly a mode; the reasons state the objections."""
    WAVE = "not a mode: wave"
    """A peak of wave forces that the structure follows."""
    TONE = "not a mode: tone"
    """A steady or drifting tone: a machine, or blades passing the tower."""
    ELECTRICAL = "not a mode: electrical"
    """A tone at the frequency of the mains or an alias of it."""
    LOCAL = "not a mode: local"
    """Motion of one sensor alone: its mount, its cable, a member or a handrail."""
    NOISE = "not a mode: noise"
    """Poles that fit noise."""

    @property
    def severity(self) -> int:
        """Rank of the status: 0 for ``OK``, higher for more severe ones."""
        return STATUSES.index(self)

    @property
    def is_a_mode(self) -> bool:
        """Whether it may be a mode at all."""
        return self.severity <= ModeStatus.DOUBTFUL.severity


STATUSES = tuple(ModeStatus)
"""All statuses by severity."""


def worse(one: ModeStatus, other: ModeStatus) -> ModeStatus:
    """Return the more severe of two statuses.

    Examples
    --------
    >>> worse(ModeStatus.OK, ModeStatus.DOUBTFUL).value
    'doubtful'
    """
    return max(one, other, key=lambda status: status.severity)


def sentence(reasons: Iterable[Finding]) -> str | None:
    """Return the findings as one text, None if there are none."""
    return "; ".join(finding.text for finding in reasons) or None
