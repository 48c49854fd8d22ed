"""What a peak of the spectrum is taken for: a mode, one to doubt, or no mode at all.

Every status but ``OK`` comes with findings that say why; the codes are in :mod:`jackettwin.findings`.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from jackettwin.findings import Finding


class ModeStatus(StrEnum):
    """What is thought of a reported mode. A member is a string: ``mode.status == "ok"`` works."""

    OK = "ok"
    """A mode, by everything that was asked: frequency and damping lie in their intervals."""
    DAMPING_UNKNOWN = "damping unknown"
    """A mode whose frequency is known to its interval; the record does not tell its damping."""
    DOUBTFUL = "doubtful"
    """It may be a mode; the reasons say what speaks against it."""
    WAVE = "not a mode: wave"
    """A peak of the forces of waves, which the structure follows."""
    TONE = "not a mode: tone"
    """A line, or a line that drifts: a machine or the passing of blades."""
    ELECTRICAL = "not a mode: electrical"
    """A line at the frequency of the mains, or its alias."""
    LOCAL = "not a mode: local"
    """One sensor alone moves: its mount, its cable, a member or a handrail."""
    NOISE = "not a mode: noise"
    """Poles that fit what is left of the noise."""

    @property
    def severity(self) -> int:
        """Rank of the status: 0 of ``OK``, and more of what forbids more."""
        return STATUSES.index(self)

    @property
    def is_a_mode(self) -> bool:
        """Whether it may be a mode at all."""
        return self.severity <= ModeStatus.DOUBTFUL.severity


STATUSES = tuple(ModeStatus)
"""All statuses by severity."""


def worse(one: ModeStatus, other: ModeStatus) -> ModeStatus:
    """Return the status that forbids more.

    Examples
    --------
    >>> worse(ModeStatus.OK, ModeStatus.DOUBTFUL).value
    'doubtful'
    """
    return max(one, other, key=lambda status: status.severity)


def sentence(reasons: Iterable[Finding]) -> str | None:
    """Return the findings as one text, None if there are none."""
    return "; ".join(finding.text for finding in reasons) or None
