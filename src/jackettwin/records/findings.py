"""What is worth saying about a channel, in plain words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jackettwin import findings
from jackettwin.findings import CATALOGUE

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
class Finding:
    """One fault: where, which, in a sentence, and whether ``repair`` removes it.

    ``fault`` is one of ``empty``, ``dead``, ``weak``, ``gaps``, ``spikes``, ``outliers``, ``clipped``,
    ``stuck``, ``changed``, ``held``, ``drift``, ``unsteady``, ``sign``, ``unit``, ``unreadable``,
    ``clock``, ``file``;
    ``channel`` is None if it concerns the record.
    """

    fault: str
    text: str
    channel: str | None = None
    repaired: bool = False
    params: Mapping[str, findings.Value] = field(default_factory=dict)

    @property
    def coded(self) -> findings.Finding:
        """The same as every other package states its findings: code, severity, subject and parameters."""
        return findings.Finding(self.fault, self.channel, {"text": self.text, **self.params})


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
        yield Finding("empty", f"{q.gap_share:.0%} of the samples are missing; left out", name, True)
        return
    if q.dead:
        yield Finding("dead", "does not vary at all; left out", name, True)
        return
    if q.gap_share > 0.0:
        text = f"{q.gap_share:.2%} of the samples are missing, at most {q.longest_gap_s:.3g} s in a row"
        yield Finding("gaps", text, name, params={"share": q.gap_share, "longest_s": q.longest_gap_s})
    if outliers:
        text = f"{q.spike_share:.1%} of the samples stand out, too many to be spikes; kept"
        yield Finding("outliers", text, name, params={"share": q.spike_share})
    elif q.spike_share > 0.0:
        yield Finding(
            "spikes", f"{q.spike_share:.3%} of the samples are spikes; declared missing", name, True
        )
    yield from _signal_findings(channel, q)
    yield from _sign_findings(name, sign)


def _signal_findings(channel: Channel, q: ChannelQuality) -> Iterator[Finding]:
    """Yield what the sensor's range, its reading and its zero did."""
    name = q.name
    if q.clipped_share > 0.0:
        # Kept: the covariances of a clipped Gaussian signal keep their shape (Bussgang 1952), those of
        # one with gaps at its peaks do not.
        text = f"{q.clipped_share:.2%} of the samples are at the range's end; kept, amplitudes are too small"
        yield Finding("clipped", text, name, params={"share": q.clipped_share})
    if q.stuck_share > 0.0:
        text = f"reading is frozen for {q.stuck_share:.2%} of the time; declared missing"
        yield Finding("stuck", text, name, True, {"share": q.stuck_share})
    if q.hold_length > 1:
        text = f"every value is repeated {q.hold_length} times: the sensor is read at a lower rate and lags"
        yield Finding("held", text, name, params={"times": q.hold_length})
    if q.quantiser_steps > COARSE_STEPS:
        sentence = CATALOGUE["coarse_quantiser"].sentence
        yield Finding(
            "coarse_quantiser",
            sentence.format(steps=q.quantiser_steps),
            name,
            params={"steps": q.quantiser_steps},
        )
    if _drifts(channel, q):
        text = f"drifts over {q.drift_ratio:.1f} times the rms of its vibration; slow part removed"
        yield Finding("drift", text, name, True, {"ratio": q.drift_ratio})
    if q.unsteadiness > UNSTEADY_RATIO:
        text = f"is {q.unsteadiness:.3g} times stronger in one tenth of the record than usual: not stationary"
        yield Finding("unsteady", text, name, params={"ratio": q.unsteadiness})


def _sign_findings(name: str, sign: bool | None) -> Iterator[Finding]:
    if sign is True:
        yield Finding("sign", "moves against all parallel channels; sign turned", name, True)
    elif sign is False:
        text = "moves against a parallel channel, and nothing says which of them is wrong; kept"
        yield Finding("sign", text, name)


def _drifts(channel: Channel, q: ChannelQuality) -> bool:
    """Tell drift from the quasi-static response, which displacement, strain and tilt really have."""
    return channel.quantity in ("acceleration", "velocity") and q.drift_ratio > DRIFT_RATIO
