r"""Screening of reported peaks: each is a mode, a doubtful mode, or a peak of the forces.

Five criteria are applied, none of which alone separates a mode from noise, waves or a slope of the spectrum:

1. *second look*: a second subspace identification with a shorter lag window finds the same frequency and
shape;
2. *peak*: after the spatial filter of its shape against the surroundings,

   .. math:: P(f) = w^H \hat S(f)\, w, \qquad w = R^{-1}\phi,

   with R the mean spectral matrix of neighbouring lines, the power at the mode must exceed that of these
   lines (like a peak of FDD, whose singular values however follow the strongest motion);
3. *shape*: it must be nearly real, unless a close mode shares its plane;
4. *time*: the motion must be present as long as that of the other modes; a tone that ends, or an impact, is
   present in one part of the record only;
5. *forces*: the peak must not be a peak of the forces, that is, as broad as a wave spectrum in the range of
the
   sea, or of a shape that combines those of neighbouring modes (``neighbours.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.findings import Finding
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.preparation.spectra import densities
from jackettwin.identification.selection.neighbours import (
    apart,
    combinations_of_neighbours,
    identified_twice,
    share_in_span,
)
from jackettwin.identification.selection.one_sensor import MIN_OTHER_SENSORS, of_one_sensor
from jackettwin.identification.selection.peaks import (
    clear_peaks_hz,
    contrast,
    second_shape,
    share_of_one_part,
)
from jackettwin.identification.selection.second_look import SAME_SHAPE, SecondLook, second_look, seen_again
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.tones.sinusoid import transform
from jackettwin.intervals import NORMAL_95
from jackettwin.records import channel_axes, comparable_channels, knows_rotor_speed

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jackettwin.identification.estimate import ModalEstimate
    from jackettwin.identification.preparation.prepared_record import PreparedRecord

Verdict = tuple[ModeStatus, Finding]

MIN_SECOND_LOOK_SHARE = 0.4
"""Share of the orders of the second look, from the first that contains the mode, that must contain it."""
MIN_MPC = 0.5
"""Smallest collinearity of a shape that is not doubtful, unless another mode is close."""
CLOSE_DISTANCE = 2.0
"""Distance over the sum of half bandwidths within which modes are close:
one record determines the plane of a close pair, not the shapes in it."""
MIN_CONTRAST = 6.0
"""Smallest ratio of the power at the peak to the neighbouring power, if there are enough sensors to suppress
the other modes or the peak is in the range of sea forces. A single mode has 17: its mean power is π/4 of the
peak within its half bandwidth and 0.05 of the peak between 2.5 and 8 half bandwidths. At a ratio of 6, a
tenth of the power at the peak is not due to the mode. Sea peaks between the modes of simulated jackets have 2
to 6; of 530 modes of random systems with four or more sensors, 1 in 70 has less than 6."""
BROAD_IN_SEA, BROAD_CONTRAST = 0.02, 12.0
"""Damping ratio above which a peak in the range of sea forces needs a ratio of at least the second value,
since force peaks are broad. None of 180 modes of simulated jackets with such damping has less; sea peaks have
6 to 9."""
MIN_CONTRAST_ELSEWHERE = 1.5
"""Smallest ratio of the power at the peak to the neighbouring power in all other cases."""
MIN_CONTRAST_STD = 3.0
"""Smallest excess of that ratio over 1, in standard deviations."""
SEA_BAND_HZ = (0.04, 0.4)
"""Frequency range in which waves may have power."""
BROAD_DAMPING = 0.04
"""Damping ratio above which a peak is as broad as a wave spectrum: JONSWAP with γ = 3.3,
transferred to acceleration, is identified with 5 to 10 %."""
BROAD_ELSEWHERE = 8.0
"""The same ratio of a peak as broad, at any frequency, with any number of sensors: of 61 true modes above 4 %
in 180 to 600 s, two to four sensors, three have less (7.4 and 7.7 in 180 s, 1.5 beside a force peak); of 42
force peaks two have more and no other doubt."""
NO_SEA_CONTRAST = 10.0
"""The same ratio where no sea is stated: of 24 first modes of 5 % damping the least has 11."""
FIRST_MODES, FOLLOWED_SHARE = 2.5, 0.7
"""Largest ratio of frequencies, and least share of a shape in the span of the modes within it, from which a
broad peak may be that of waves that the structure follows in the shape of its first modes. A first mode that
the air damps is the only one of its shape there."""
TOP_OF_SEA = 0.25
"""Relative distance from 1/Tp within which a broad peak is attributed to the sea."""
BESIDE_SEA = 0.1
"""Relative distance from 1/Tp within which a peak is doubtful if it may be twice as broad as
``BROAD_DAMPING``."""
SEAS_FORCES = (0.75, 4.0)
"""Range of the frequencies of sea forces, in multiples of 1/Tp."""
MAX_CLEAR_DAMPING = 0.10
"""Damping ratio above which every mode is doubtful."""
MAX_POSSIBLE_DAMPING = 0.15
"""Damping ratio that the damping of a mode must not reach unless its peak is as clear as above: too few decay
times were seen to tell a mode from a hump of the forces' spectrum."""
SAME_PEAK_MAC = 0.9
"""MAC above which two close modes in enough sensors are one peak identified twice:
modes of equal frequency move in different shapes."""
ONE_SENSOR_SHARE = 0.98
"""Share of one channel in a shape, in units of each channel's motion,
above which the motion is of one sensor."""
MIN_SENSORS = 4
"""Fewest channels for the criteria on shapes."""
ONE_PART_SHARE = 0.75
"""Share of a mode's power in two neighbouring tenths of the record above which it belongs to one part of it:
modes of random systems have 0.2 to 0.6, the third order of a rotor that stops after thirty of 600 s 0.9."""
MAX_KNOWN_FREQUENCY_STD = 0.03
"""Largest relative standard deviation of a known frequency."""
MIN_ORDER_SHARE = 0.7
"""Share of the model orders, in both looks, that must contain a mode of unknown damping."""
MIN_RESTORED_CONTRAST, MIN_RESTORED_CONTRAST_STD = 3.0, 8.0
"""Smallest contrast, and its standard deviations, of a mode of unknown damping: a record has dozens of such
candidates, few of which are modes. Those that fit noise have 0.7 to 1.7 with up to 4 standard deviations;
modes that are doubtful because of their damping have 4 to 40."""
MAX_LOG_DAMPING_STD = 1.0
"""Standard deviation of ln ζ above which damping is unknown."""
OUTSIDE_PEAK, BESIDE_PEAK = 1.5, 4.0
"""Range of distances from a mode, in half bandwidths, where a second clear peak may have been merged with
it."""
LINES_OF_A_PEAK = 8.0
"""Smallest half bandwidth used for this range, in lines of the record; it is the width of a Welch line."""
SECOND_SHARE, SECOND_EXCESS = 0.02, 2.0
"""Power of a second shape at a mode alone, over that of the first and over chance, above which there may be
two modes. Seven pairs 0.4 to 1.2 % apart that 90 to 180 s show as one have 0.04 to 0.26 and 2.3 to 40; of 24
single modes none has more than 0.0005, and six have more than 2.2."""
PERIODS = ("tp_s", "wave_tp_s", "wave_peak_period_s", "peak_period_s", "Tp", "wave_period_s")
"""Names of the peak period of the sea among a record's conditions."""
MIN_DAMPING_CYCLES = 1.5
"""2πζfT below which a peak is hardly broader than a line."""


@dataclass(frozen=True)
class Evidence:
    """Data for the five criteria.

    Attributes
    ----------
    looks : tuple of SecondLook
        Second looks at all frequencies, and at those of each further band.
    lines : (n_channels, n_lines)
        Fourier transforms of the channels, in single precision.
    scale : (n_channels,)
        Standard deviations by which the channels were divided.
    duration_s : float
    peak_of_sea_hz : float or None
        1/Tp if the conditions state it.
    band_hz : (low, high)
        Band of interest.
    comparable : (n_channels, n_channels)
        Channels that may show the same motion: a silent one, without any clear peak, shows none.
    peaks_hz : tuple of float
        Clear peaks of any channel.
    sensors : bool
        Whether channels are sensors. If they are principal components, a mode may move a single one.
    speed_known : bool
        Whether the speed of a rotor is measured or stated: where its orders are is then known.
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
    speed_known: bool = False

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
    ready: PreparedRecord,
    conditions: Mapping[str, Any],
    *,
    looks: Sequence[SecondLook] = (),
    sensors: bool = True,
) -> Evidence:
    """Gather the data by which modes are judged.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Samples without tones, divided by the channels' scale; NaN marks a missing sample.
    conditions : mapping
        Conditions of the record; ``wave_period_s`` or another of ``PERIODS`` is the peak period of the sea
        [s].
    looks : sequence of SecondLook
        Second looks at further bands in which modes were sought.
    sensors : bool
        Whether the channels are sensors, not components of many sensors.
    """
    spectrum = densities(y, ready.settings.sample_rate_hz)
    peaks = [clear_peaks_hz(spectrum.frequencies_hz, row[None]) for row in spectrum.density]
    moving = np.array([len(own) > 0 for own in peaks])
    comparable = comparable_channels(channel_axes(ready.channels)) & np.outer(moving, moving)
    periods = [conditions[key] for key in PERIODS if isinstance(conditions.get(key), int | float)]
    return Evidence(
        looks=(second_look(y, ready), *looks),
        lines=transform(y, np.complex64),
        scale=ready.scale,
        duration_s=y.shape[1] / ready.settings.sample_rate_hz,
        peak_of_sea_hz=1.0 / periods[0] if periods and periods[0] > 0.0 else None,
        band_hz=(ready.settings.lowest_frequency_hz, ready.settings.highest_frequency_hz),
        peaks_hz=tuple(sorted({f for own in peaks for f in own})),
        comparable=comparable | np.eye(len(moving), dtype=np.bool_),
        sensors=sensors,
        speed_known=knows_rotor_speed(conditions),
    )


def screen(
    modes: Sequence[ModalEstimate], known: Evidence, *, beside: Sequence[ModalEstimate] = ()
) -> list[ModalEstimate]:
    """Return the modes with their statuses, including those found not to be modes.

    Parameters
    ----------
    beside : sequence of ModalEstimate
        Further modes, which are not judged but may be the other member of a pair.
    """
    judged = [_judged(mode, [m for m in (*modes, *beside) if m is not mode], known) for mode in modes]
    for i in combinations_of_neighbours(judged, known.scale, CLOSE_DISTANCE, known.comparable):
        judged[i] = judged[i].flagged(ModeStatus.DOUBTFUL, Finding("shape_of_neighbours"))
    for i in identified_twice(judged, known.scale, CLOSE_DISTANCE, known.comparable):
        judged[i] = judged[i].flagged(ModeStatus.DOUBTFUL, Finding("shape_twice"))
    for i, share in _of_one_part(judged, known).items():
        judged[i] = judged[i].flagged(ModeStatus.DOUBTFUL, Finding("one_part", params={"share": share}))
    if known.sensors and len(known.scale) >= MIN_SENSORS:
        for i, share in of_one_sensor(judged, known.scale, known.comparable, CLOSE_DISTANCE).items():
            judged[i] = judged[i].flagged(
                ModeStatus.DOUBTFUL, Finding("sensor_beside", params={"share": share})
            )
    return judged


def _of_one_part(modes: Sequence[ModalEstimate], known: Evidence) -> dict[int, float]:
    """Return the modes present in one part of the record only, although the others are present throughout."""
    shares = np.array(
        [share_of_one_part(known.lines, known.duration_s, m, m.mode_shape / known.scale) for m in modes]
    )
    return {
        i: float(share)
        for i, share in enumerate(shares)
        if share > ONE_PART_SHARE
        and np.median(np.delete(shares, i) if len(shares) > 1 else 0.0) < ONE_PART_SHARE
    }


def perhaps_two(modes: Sequence[ModalEstimate], known: Evidence) -> list[Finding]:
    """Report modes that are not doubtful, without a close one, at which the sensors move in two shapes."""
    out = []
    for mode in modes:
        close = any(apart(mode, other) < CLOSE_DISTANCE for other in modes if other is not mode)
        if close or mode.status.severity > ModeStatus.DAMPING_UNKNOWN.severity:
            continue
        share, excess = second_shape(known.lines, known.duration_s, mode, mode.mode_shape / known.scale)
        if share > SECOND_SHARE and excess > SECOND_EXCESS:
            where = {"frequency_hz": mode.frequency_hz, "share": share}
            out.append(Finding("perhaps_two", params=where))
    return out


def worth_keeping(mode: ModalEstimate, others: Sequence[ModalEstimate], known: Evidence) -> bool:
    """Tell whether a candidate of unknown damping is a mode of known frequency."""
    std = mode.frequency_std_hz
    if std is None or std > MAX_KNOWN_FREQUENCY_STD * mode.frequency_hz or mode.order_share < MIN_ORDER_SHARE:
        return False
    if mode.mpc < MIN_MPC or any(_same(mode, other, known.scale) for other in others):
        return False
    ratio, excess = contrast(known.lines, known.duration_s, mode, mode.mode_shape / known.scale)
    again = seen_again(known.looks, mode, ())
    return ratio > MIN_RESTORED_CONTRAST and excess > MIN_RESTORED_CONTRAST_STD and again >= MIN_ORDER_SHARE


def with_unknown_damping(mode: ModalEstimate) -> ModalEstimate:
    """Return a mode of known frequency with the status that its damping is unknown."""
    std = float("inf") if mode.log_covariance is None else float(np.sqrt(mode.log_covariance[1, 1]))
    return mode.flagged(ModeStatus.DAMPING_UNKNOWN, Finding("damping_unknown", params={"log_std": std}))


def _same(mode: ModalEstimate, other: ModalEstimate, scale: FloatArray) -> bool:
    alike = float(mac(mode.mode_shape / scale, other.mode_shape / scale)) > SAME_SHAPE
    return alike and apart(mode, other) < CLOSE_DISTANCE


def _judged(mode: ModalEstimate, others: Sequence[ModalEstimate], known: Evidence) -> ModalEstimate:
    close = [m for m in others if apart(mode, m) < CLOSE_DISTANCE]
    for status, finding in (
        *_forces(mode, close, others, known),
        *_shape(mode, close, known),
        *_agreement(mode, close, known),
        *_damping(mode, known),
        *_two_peaks(mode, others, known),
    ):
        mode = mode.flagged(status, finding)
    return mode


def _forces(
    mode: ModalEstimate, close: Sequence[ModalEstimate], others: Sequence[ModalEstimate], known: Evidence
) -> Iterator[Verdict]:
    peak_hz = known.peak_of_sea_hz
    f, zeta = mode.frequency_hz, mode.damping_ratio
    percent = {"damping_percent": 100.0 * zeta}
    lighter = sum(m.damping_ratio < BROAD_DAMPING for m in close)
    if peak_hz is not None and abs(f / peak_hz - 1.0) < TOP_OF_SEA and zeta > BROAD_DAMPING:
        status = ModeStatus.DOUBTFUL if lighter else ModeStatus.WAVE
        yield status, Finding("follows_the_sea", params={**percent, "period_s": 1.0 / peak_hz})
    elif (
        peak_hz is not None and abs(f / peak_hz - 1.0) < BESIDE_SEA and _may_reach(mode, 2.0 * BROAD_DAMPING)
    ):
        yield ModeStatus.DOUBTFUL, Finding("follows_the_sea", params={**percent, "period_s": 1.0 / peak_hz})
    elif peak_hz is None and SEA_BAND_HZ[0] < f < SEA_BAND_HZ[1] and zeta > BROAD_DAMPING:
        # aerodynamic damping may make one of a pair broad, but not a third mode beside two
        if lighter != 1 and _may_be_waves(mode, others, known):
            yield ModeStatus.DOUBTFUL, Finding("broad_as_waves", params=percent)
    hardly_known = zeta > BROAD_DAMPING and _may_reach(mode, MAX_POSSIBLE_DAMPING)
    if zeta > MAX_CLEAR_DAMPING or (hardly_known and not _clear(mode, known)):
        yield ModeStatus.DOUBTFUL, Finding("broad", params=percent)


def _may_be_waves(mode: ModalEstimate, others: Sequence[ModalEstimate], known: Evidence) -> bool:
    """Tell whether a broad peak is no clear one, or moves in the shape of other first modes.

    A close mode as broad as it is the other member of its pair.
    """
    if not _clear(mode, known):
        return True
    shape = mode.mode_shape / known.scale
    first = [
        m.mode_shape / known.scale
        for m in others
        if 1.0 / FIRST_MODES < m.frequency_hz / mode.frequency_hz < FIRST_MODES
        and (m.damping_ratio < BROAD_DAMPING or apart(mode, m) > CLOSE_DISTANCE)
    ]
    return bool(first) and share_in_span(shape, first)[0] > FOLLOWED_SHARE


def _clear(mode: ModalEstimate, known: Evidence) -> bool:
    """Tell whether a broad peak stands out of its sides as that of a mode that the air damps."""
    ratio, _ = contrast(known.lines, known.duration_s, mode, mode.mode_shape / known.scale)
    return ratio >= NO_SEA_CONTRAST


def _may_reach(mode: ModalEstimate, damping_ratio: float) -> bool:
    """Tell whether a mode's damping may reach a value: in one of 40 cases, by chance."""
    std = mode.damping_ratio_std
    return std is not None and mode.damping_ratio * exp(NORMAL_95 * std / mode.damping_ratio) > damping_ratio


def _shape(mode: ModalEstimate, close: Sequence[ModalEstimate], known: Evidence) -> Iterator[Verdict]:
    if mode.mpc < MIN_MPC and not close:
        yield ModeStatus.DOUBTFUL, Finding("complex_shape", params={"mpc": mode.mpc})
    scale = known.scale
    if len(scale) < MIN_SENSORS:
        return
    own = mode.mode_shape / scale
    twins = [m for m in close if float(mac(own, m.mode_shape / scale)) > SAME_PEAK_MAC]
    if any(_less_of_a_peak(mode, twin, known) for twin in twins):
        yield ModeStatus.DOUBTFUL, Finding("shape_twice")


def _less_of_a_peak(mode: ModalEstimate, other: ModalEstimate, known: Evidence) -> bool:
    """Tell whether a mode is the duplicate of another of the same shape: the one of lower contrast is."""
    ratio, theirs = (
        contrast(known.lines, known.duration_s, m, m.mode_shape / known.scale)[0] for m in (mode, other)
    )
    return ratio <= theirs


def _agreement(mode: ModalEstimate, close: Sequence[ModalEstimate], known: Evidence) -> Iterator[Verdict]:
    again = seen_again(known.looks, mode, close)
    if again < MIN_SECOND_LOOK_SHARE:
        yield ModeStatus.DOUBTFUL, Finding("one_method", params={"share": again})
    shape = mode.mode_shape / known.scale
    ratio, excess = contrast(known.lines, known.duration_s, mode, shape)
    in_sea = known.in_sea(mode.frequency_hz)
    least = MIN_CONTRAST if in_sea or len(shape) >= MIN_SENSORS else MIN_CONTRAST_ELSEWHERE
    if in_sea and mode.damping_ratio > BROAD_IN_SEA:
        least = BROAD_CONTRAST
    elif mode.damping_ratio > BROAD_DAMPING:
        least = max(least, BROAD_ELSEWHERE)
    if ratio < least or excess < MIN_CONTRAST_STD:
        yield ModeStatus.DOUBTFUL, Finding("no_peak", params={"ratio": ratio})
    yield from _one_sensor(mode, shape, known)


def _two_peaks(mode: ModalEstimate, others: Sequence[ModalEstimate], known: Evidence) -> Iterator[Verdict]:
    """Flag a mode without a fit that has a second clear peak, which belongs to no other mode.

    With one channel, two modes that have few cycles in a short lag window are hardly separated:
    one pole, broader than either, represents both.
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
    """Flag motion of one sensor; it is no mode if sensors that could measure it too show no peak."""
    share = np.abs(shape) ** 2 / np.sum(np.abs(shape) ** 2)
    if not known.sensors or len(share) < MIN_SENSORS or share.max() <= ONE_SENSOR_SHARE:
        return
    others = known.comparable[share.argmax()] & (np.arange(len(share)) != share.argmax())
    if others.sum() < MIN_OTHER_SENSORS:
        return
    ratio, excess = contrast(known.lines[others], known.duration_s, mode, shape[others])
    seen = ratio > MIN_CONTRAST_ELSEWHERE and excess > MIN_CONTRAST_STD
    status = ModeStatus.DOUBTFUL if seen else ModeStatus.LOCAL
    yield status, Finding("one_sensor", params={"share": float(share.max())})


def _damping(mode: ModalEstimate, known: Evidence) -> Iterator[Verdict]:
    """Flag unknown damping: its standard deviation is large, or the peak is a single line."""
    if mode.log_covariance is None:
        return
    if 2.0 * np.pi * mode.damping_ratio * mode.frequency_hz * known.duration_s < MIN_DAMPING_CYCLES:
        yield ModeStatus.DAMPING_UNKNOWN, Finding("narrow_as_a_line")
    std = float(np.sqrt(mode.log_covariance[1, 1]))
    if std > MAX_LOG_DAMPING_STD:
        yield ModeStatus.DAMPING_UNKNOWN, Finding("damping_unknown", params={"log_std": std})
