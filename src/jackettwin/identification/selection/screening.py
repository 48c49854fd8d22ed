r"""What a reported peak is taken for: a mode, one to doubt, or the forces.

Five things are asked of a mode, none of which alone tells it from noise, waves or a slope of the spectrum:

1. a *second look*: subspace identification again, with a shorter lag window, finds the same
   frequency and shape;
2. a *peak*: seen through the filter that its shape makes against everything around,

   .. math:: P(f) = w^H \hat S(f)\, w, \qquad w = R^{-1}\phi,

   R the mean spectral matrix beside the mode, the power at the mode stands out of that beside it (the peak of
   FDD, without its singular values, which follow whatever is loudest);
3. a *shape* that is nearly real, unless a close mode shares its plane;
4. to be there all the *time* that the others are: a tone that ends, or a blow, is of one part of the record;
5. not to be *forces*: as broad as a wave spectrum, where waves are; or a peak of forces that is seen through
   the modes beside it (``neighbours.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.findings import Finding
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.preparation.spectra import welch
from jackettwin.identification.selection.neighbours import apart, of_neighbours, told_twice
from jackettwin.identification.selection.one_sensor import FEWEST_PEERS, of_one_sensor
from jackettwin.identification.selection.peaks import clear_peaks_hz, contrast, share_of_one_part
from jackettwin.identification.selection.second_look import SAME_SHAPE, SecondLook, second_look, seen_again
from jackettwin.identification.status import ModeStatus
from jackettwin.records.clocks.another_time import may_be_compared

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jackettwin.identification.estimate import ModalEstimate
    from jackettwin.identification.preparation.prepared import Prepared
    from jackettwin.identification.selection.second_look import QuietBand

Verdict = tuple[ModeStatus, Finding]

SEEN_AGAIN = 0.4
"""Share of the orders of the second look, from the first that holds the mode on, that must hold it."""
LEAST_MPC = 0.5
"""Shapes less collinear than this are doubted …"""
CLOSE = 2.0
"""… unless another mode is nearer than so many of their half bandwidths together: one record determines the
plane of a close pair, not the shapes in it."""
LEAST_CONTRAST = 6.0
"""Least power at the peak over that beside it, where there are sensors enough to keep the other modes out,
and where the sea has forces. A mode alone has 17: π/4 of its peak within its half bandwidth, 0.05 of it
between 2.5 and 8 of them; with 6, a tenth of the power at the peak is not the mode's. Peaks that the sea
makes between the modes of simulated jackets have 2 to 6; of 530 modes of random systems, in four sensors and
more, 1 in 70 less …"""
BROAD_IN_SEA, BROAD_CONTRAST = 0.02, 12.0
"""Damping ratio from which, where the sea has forces, a peak must stand out twice as clearly, as forces are
broad. Of 180 modes of simulated jackets there none so broad has less; peaks of the sea have 6 to 9."""
LEAST_SEEN = 1.5
"""… elsewhere this much …"""
LEAST_CONTRAST_STD = 3.0
"""… and the least number of standard deviations by which it exceeds it."""
WAVES_HZ = (0.04, 0.4)
"""Where seas have their power."""
BROAD = 0.04
"""Damping ratio from which a peak is as broad as a wave spectrum: that of JONSWAP with γ = 3.3, times the
transfer to acceleration, is identified with 5 to 10 %."""
TOP_OF_SEA = 0.25
"""Relative distance from 1/Tp within which a broad peak is the sea's."""
BESIDE_SEA = 0.1
"""Relative distance from 1/Tp within which a peak that may be twice as broad as ``BROAD`` is doubted."""
SEAS_FORCES = (0.75, 4.0)
"""Where a sea has forces, in multiples of 1/Tp."""
TOO_BROAD = 0.10
"""Damping ratio from which nothing is called a mode without doubt."""
TWICE = 0.9
"""MAC of two close modes, in enough sensors, from which they are one peak told twice: modes of one frequency
move in different shapes."""
ONE_SENSOR = 0.98
"""Share of a shape, in units of each channel's motion, from which it is of one sensor …"""
ENOUGH_SENSORS = 4
"""… of so many at least."""
ONE_PART = 0.75
"""Share of a mode's power in two neighbouring tenths of the record from which it is of one part: modes of
random systems have 0.2 to 0.6, the third order of a rotor that stops after thirty of 600 s 0.9."""
KNOWN_FREQUENCY = 0.03
"""Standard deviation of a frequency, relative, up to which it is called known."""
STEADY = 0.7
"""Share of the model orders, of either look, that must hold a mode whose damping is not known."""
KEPT_CONTRAST, KEPT_CONTRAST_STD = 3.0, 8.0
"""Contrast asked of it: there are dozens of such candidates in a record, few of them modes. Those that fit
noise have 0.7 to 1.7 with up to 4 standard deviations, modes that were doubted for their damping 4 to 40."""
UNKNOWN_DAMPING = 1.0
"""Standard deviation of ln ζ above which damping is called unknown."""
OUTSIDE_PEAK, BESIDE_PEAK = 1.5, 4.0
"""Half bandwidths from a mode between which a second clear peak may be told with it as one …"""
LINES_OF_A_PEAK = 8.0
"""… and least half bandwidth, in lines of the record: the spectrum's are as wide."""
PERIODS = ("tp_s", "wave_tp_s", "wave_peak_period_s", "peak_period_s", "Tp", "wave_period_s")
"""Names of the peak period of the sea among a record's conditions."""
NARROW = 1.5
"""2πζfT below which a peak is hardly broader than a line."""


@dataclass(frozen=True)
class Evidence:
    """What the five questions are answered from.

    Attributes
    ----------
    looks : tuple of SecondLook
        At all frequencies, and at those of each further band.
    lines : (n_channels, n_lines)
    scale : (n_channels,)
        By which the channels were divided.
    duration_s : float
    peak_of_sea_hz : float or None
        1/Tp where the conditions say it.
    band_hz : (low, high)
        Of interest.
    comparable : (n_channels, n_channels)
        Which channels may show the same motion.
    peaks_hz : tuple of float
        Clear peaks of any channel.
    sensors : bool
        Whether channels are sensors: a mode may well move one component of many alone.
    """

    looks: tuple[SecondLook, ...]
    lines: ComplexArray
    scale: FloatArray
    duration_s: float
    peak_of_sea_hz: float | None
    band_hz: tuple[float, float]
    comparable: BoolArray
    peaks_hz: tuple[float, ...]
    sensors: bool = True

    def in_sea(self, frequency_hz: float) -> bool:
        """Whether the sea, where its period is stated, has forces at a frequency."""
        low, high = SEAS_FORCES
        peak = self.peak_of_sea_hz
        return peak is not None and low * peak < frequency_hz < high * peak

    def inside(self, frequency_hz: float) -> bool:
        """Whether a frequency lies in the band of interest."""
        return self.band_hz[0] < frequency_hz < self.band_hz[1]


def evidence(
    y: FloatArray,
    ready: Prepared,
    conditions: Mapping[str, Any],
    *,
    bands: Sequence[QuietBand] = (),
    sensors: bool = True,
) -> Evidence:
    """Gather what modes are judged by.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Without tones, divided by the channels' scale; NaN marks a missing sample.
    conditions : mapping
        Of the record; ``wave_period_s`` or another of ``PERIODS`` is the peak period of the sea [s].
    bands : sequence of QuietBand
        Where modes were sought once more.
    sensors : bool
        Whether the channels are sensors, not what dozens of them say together.
    """
    periods = [conditions[key] for key in PERIODS if isinstance(conditions.get(key), int | float)]
    return Evidence(
        looks=(
            second_look(y, ready),
            *(second_look(band.ready.y, band.ready, band.taken_hz) for band in bands),
        ),
        lines=np.asarray(np.fft.rfft(np.nan_to_num(y), axis=1)),
        scale=ready.scale,
        duration_s=y.shape[1] / ready.settings.sample_rate_hz,
        peak_of_sea_hz=1.0 / periods[0] if periods and periods[0] > 0.0 else None,
        band_hz=(ready.settings.lowest_frequency_hz, ready.settings.highest_frequency_hz),
        peaks_hz=_peaks_hz(y, ready.settings.sample_rate_hz),
        comparable=may_be_compared([c.direction for c in ready.channels], len(y)),
        sensors=sensors,
    )


def _peaks_hz(y: FloatArray, sample_rate_hz: float) -> tuple[float, ...]:
    spectrum = welch(y, sample_rate_hz)
    return tuple(clear_peaks_hz(spectrum.frequencies_hz, spectrum.density))


def screened(modes: Sequence[ModalEstimate], known: Evidence) -> list[ModalEstimate]:
    """Return the modes with their statuses; some are not modes."""
    judged = [_judged(mode, [m for m in modes if m is not mode], known) for mode in modes]
    for i in of_neighbours(judged, known.scale, CLOSE):
        judged[i] = judged[i].flagged(ModeStatus.DOUBTFUL, Finding("shape_of_neighbours"))
    for i in told_twice(judged, known.scale, CLOSE):
        judged[i] = judged[i].flagged(ModeStatus.DOUBTFUL, Finding("shape_twice"))
    for i, share in _of_one_part(judged, known).items():
        judged[i] = judged[i].flagged(ModeStatus.DOUBTFUL, Finding("one_part", params={"share": share}))
    if known.sensors and len(known.scale) >= ENOUGH_SENSORS:
        for i, share in of_one_sensor(judged, known.scale, known.comparable, CLOSE).items():
            judged[i] = judged[i].flagged(
                ModeStatus.DOUBTFUL, Finding("sensor_beside", params={"share": share})
            )
    return judged


def _of_one_part(modes: Sequence[ModalEstimate], known: Evidence) -> dict[int, float]:
    """Return which modes are seen in one part of the record only, though the others are seen in all of it."""
    shares = np.array(
        [share_of_one_part(known.lines, known.duration_s, m, m.mode_shape / known.scale) for m in modes]
    )
    return {
        i: float(share)
        for i, share in enumerate(shares)
        if share > ONE_PART and np.median(np.delete(shares, i) if len(shares) > 1 else 0.0) < ONE_PART
    }


def worth_keeping(mode: ModalEstimate, others: Sequence[ModalEstimate], known: Evidence) -> bool:
    """Tell whether a candidate whose damping is hardly known is a mode whose frequency is."""
    std = mode.frequency_std_hz
    if std is None or std > KNOWN_FREQUENCY * mode.frequency_hz or mode.order_share < STEADY:
        return False
    if mode.mpc < LEAST_MPC or any(_same(mode, other, known.scale) for other in others):
        return False
    ratio, excess = contrast(known.lines, known.duration_s, mode, mode.mode_shape / known.scale)
    again = seen_again(known.looks, mode, ())
    return ratio > KEPT_CONTRAST and excess > KEPT_CONTRAST_STD and again >= STEADY


def rescued(mode: ModalEstimate) -> ModalEstimate:
    """Return a mode of known frequency with the status that says what is not known of it."""
    std = float("inf") if mode.log_covariance is None else float(np.sqrt(mode.log_covariance[1, 1]))
    return mode.flagged(ModeStatus.DAMPING_UNKNOWN, Finding("damping_unknown", params={"log_std": std}))


def _same(mode: ModalEstimate, other: ModalEstimate, scale: FloatArray) -> bool:
    alike = float(mac(mode.mode_shape / scale, other.mode_shape / scale)) > SAME_SHAPE
    return alike and apart(mode, other) < CLOSE


def _judged(mode: ModalEstimate, others: Sequence[ModalEstimate], known: Evidence) -> ModalEstimate:
    close = [m for m in others if apart(mode, m) < CLOSE]
    for status, finding in (
        *_forces(mode, close, known.peak_of_sea_hz),
        *_shape(mode, close, known.scale),
        *_agreement(mode, close, known),
        *_damping(mode, known),
        *_two_peaks(mode, others, known),
    ):
        mode = mode.flagged(status, finding)
    return mode


def _forces(mode: ModalEstimate, close: Sequence[ModalEstimate], peak_hz: float | None) -> Iterator[Verdict]:
    f, zeta = mode.frequency_hz, mode.damping_ratio
    percent = {"damping_percent": 100.0 * zeta}
    lighter = sum(m.damping_ratio < BROAD for m in close)
    if peak_hz is not None and abs(f / peak_hz - 1.0) < TOP_OF_SEA and zeta > BROAD:
        status = ModeStatus.DOUBTFUL if lighter else ModeStatus.WAVE
        yield status, Finding("follows_the_sea", params={**percent, "period_s": 1.0 / peak_hz})
    elif peak_hz is not None and abs(f / peak_hz - 1.0) < BESIDE_SEA and _may_reach(mode, 2.0 * BROAD):
        yield ModeStatus.DOUBTFUL, Finding("follows_the_sea", params={**percent, "period_s": 1.0 / peak_hz})
    elif peak_hz is None and WAVES_HZ[0] < f < WAVES_HZ[1] and zeta > BROAD:
        # the air may damp one of a pair so much more than the other, never a third beside two
        if lighter != 1:
            yield ModeStatus.DOUBTFUL, Finding("broad_as_waves", params=percent)
    if zeta > TOO_BROAD:
        yield ModeStatus.DOUBTFUL, Finding("broad", params=percent)


def _may_reach(mode: ModalEstimate, damping_ratio: float) -> bool:
    """Whether the interval of a mode's damping holds so much."""
    interval = mode.damping_ratio_interval_95
    return interval is not None and interval[1] > damping_ratio


def _shape(mode: ModalEstimate, close: Sequence[ModalEstimate], scale: FloatArray) -> Iterator[Verdict]:
    if mode.mpc < LEAST_MPC and not close:
        yield ModeStatus.DOUBTFUL, Finding("complex_shape", params={"mpc": mode.mpc})
    share = np.abs(mode.mode_shape / scale) ** 2
    share = share / share.sum()
    if len(share) < ENOUGH_SENSORS:
        return
    if any(float(mac(mode.mode_shape / scale, m.mode_shape / scale)) > TWICE for m in close):
        yield ModeStatus.DOUBTFUL, Finding("shape_twice")


def _agreement(mode: ModalEstimate, close: Sequence[ModalEstimate], known: Evidence) -> Iterator[Verdict]:
    again = seen_again(known.looks, mode, close)
    if again < SEEN_AGAIN:
        yield ModeStatus.DOUBTFUL, Finding("one_method", params={"share": again})
    shape = mode.mode_shape / known.scale
    ratio, excess = contrast(known.lines, known.duration_s, mode, shape)
    in_sea = known.in_sea(mode.frequency_hz)
    least = LEAST_CONTRAST if in_sea or len(shape) >= ENOUGH_SENSORS else LEAST_SEEN
    if in_sea and mode.damping_ratio > BROAD_IN_SEA:
        least = BROAD_CONTRAST
    if ratio < least or excess < LEAST_CONTRAST_STD:
        yield ModeStatus.DOUBTFUL, Finding("no_peak", params={"ratio": ratio})
    yield from _one_sensor(mode, shape, known)


def _two_peaks(mode: ModalEstimate, others: Sequence[ModalEstimate], known: Evidence) -> Iterator[Verdict]:
    """Tell of a mode that no fit describes whether it has a second clear peak, which is of no other mode.

    A channel alone hardly parts two modes that a short lag window holds few cycles of: one pole, broader than
    either, stands for both.
    """
    if mode.unrefined is not None:
        return
    line = 1.0 / known.duration_s
    for peak in known.peaks_hz:
        own, *theirs = (
            abs(peak - m.frequency_hz) / max(m.damping_ratio * m.frequency_hz, LINES_OF_A_PEAK * line)
            for m in (mode, *others)
        )
        if OUTSIDE_PEAK < own < BESIDE_PEAK and min(theirs, default=np.inf) > OUTSIDE_PEAK:
            yield ModeStatus.DOUBTFUL, Finding("second_peak", params={"frequency_hz": peak})
            return


def _one_sensor(mode: ModalEstimate, shape: ComplexArray, known: Evidence) -> Iterator[Verdict]:
    """Tell what moves one sensor alone: no mode where the others, which could see it, show no peak."""
    share = np.abs(shape) ** 2 / np.sum(np.abs(shape) ** 2)
    if not known.sensors or len(share) < ENOUGH_SENSORS or share.max() <= ONE_SENSOR:
        return
    others = known.comparable[share.argmax()] & (np.arange(len(share)) != share.argmax())
    if others.sum() < FEWEST_PEERS:
        return
    ratio, excess = contrast(known.lines[others], known.duration_s, mode, shape[others])
    seen = ratio > LEAST_SEEN and excess > LEAST_CONTRAST_STD
    status = ModeStatus.DOUBTFUL if seen else ModeStatus.LOCAL
    yield status, Finding("one_sensor", params={"share": float(share.max())})


def _damping(mode: ModalEstimate, known: Evidence) -> Iterator[Verdict]:
    """Say where damping is not known: by its own standard deviation, or as the peak is a line."""
    if mode.log_covariance is None:
        return
    if 2.0 * np.pi * mode.damping_ratio * mode.frequency_hz * known.duration_s < NARROW:
        yield ModeStatus.DAMPING_UNKNOWN, Finding("narrow_as_a_line")
    std = float(np.sqrt(mode.log_covariance[1, 1]))
    if std > UNKNOWN_DAMPING:
        yield ModeStatus.DAMPING_UNKNOWN, Finding("damping_unknown", params={"log_std": std})
