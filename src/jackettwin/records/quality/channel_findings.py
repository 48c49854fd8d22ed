"""What is worth saying about a channel, in plain words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jackettwin.findings import Finding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jackettwin.records.record import Channel

DRIFT_RATIO = 3.0
"""Range of the slow part over the rms of the rest, beyond which it is drift."""
UNSTEADY_RATIO = 4.0
"""Rms of the loudest part over the median of all, beyond which a record is not stationary: a light tower
under steady forces reaches 2, in turbulence as well."""
COARSE_STEPS = 0.7
"""Step of a reading over the rms of the vibration, beyond which rounding is not white noise of step²/12: a
Gaussian signal allows a step of its standard deviation (Widrow & Kollár 2008), others less."""


@dataclass(frozen=True)
class ChannelQuality:
    """What was measured about one channel; shares are of all samples."""

    name: str
    score: float
    dead: bool
    gap_share: float
    longest_gap_s: float
    spike_share: float
    clipped_share: float
    stuck_share: float
    changed_share: float
    hold_length: int
    drift_ratio: float
    unsteadiness: float
    swapped_sign: bool
    quantiser_steps: float = 0.0
    """Step of the reading over the rms of the vibration; 0 if it is fine."""


def channel_findings(
    channel: Channel, q: ChannelQuality, *, empty: bool, outliers: bool, sign: bool | None
) -> Iterator[Finding]:
    """Yield what is worth saying about one channel."""
    name = q.name
    if empty:
        yield Finding("empty", name, {"share": q.gap_share}, repaired=True)
        return
    if q.dead:
        yield Finding("dead", name, repaired=True)
        return
    if q.gap_share > 0.0:
        yield Finding("gaps", name, {"share": q.gap_share, "longest_s": q.longest_gap_s})
    if outliers:
        yield Finding("outliers", name, {"share": q.spike_share})
    elif q.spike_share > 0.0:
        yield Finding("spikes", name, {"share": q.spike_share}, repaired=True)
    yield from _signal_findings(channel, q)
    if sign is not None:
        yield Finding("sign_turned" if sign else "sign_unclear", name, repaired=sign)


def _signal_findings(channel: Channel, q: ChannelQuality) -> Iterator[Finding]:
    """Yield what the sensor's range, its reading and its zero did."""
    name = q.name
    if q.clipped_share > 0.0:
        # Kept: the covariances of a clipped Gaussian signal keep their shape (Bussgang 1952), those of
        # one with gaps at its peaks do not.
        yield Finding("clipped", name, {"share": q.clipped_share})
    if q.stuck_share > 0.0:
        yield Finding("stuck", name, {"share": q.stuck_share}, repaired=True)
    if q.hold_length > 1:
        yield Finding("held", name, {"times": q.hold_length})
    if q.quantiser_steps > COARSE_STEPS:
        yield Finding("coarse_quantiser", name, {"steps": q.quantiser_steps})
    if _drifts(channel, q):
        yield Finding("drift", name, {"ratio": q.drift_ratio}, repaired=True)
    if q.unsteadiness > UNSTEADY_RATIO:
        yield Finding("unsteady", name, {"ratio": q.unsteadiness})


def _drifts(channel: Channel, q: ChannelQuality) -> bool:
    """Tell drift from the quasi-static response, which displacement, strain and tilt really have."""
    return channel.quantity in ("acceleration", "velocity") and q.drift_ratio > DRIFT_RATIO
