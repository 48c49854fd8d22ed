r"""Fusion of the modes of many records into one estimate per mode.

Modes are tracked across records by shape and frequency, then averaged. Weights combine the uncertainty of
each record and the scatter between records (random effects; DerSimonian & Laird 1986):

.. math:: \hat\theta = \frac{\sum w_r \theta_r}{\sum w_r}, \quad w_r = \frac{1}{s_r^2 + \tau^2}

where θ is ln f, and ζ itself: each record's estimate is unbiased in ζ but not in ln ζ, and the mean of many
records would inherit that bias. The variance s_r² is evaluated at the *fused* damping: an estimate that
happens to be high also claims a small relative variance, so that its own weight would bias the mean upwards.

The mean of ζ uses the records in which the mode is ``OK``, that of f those in which it is at worst
``DAMPING_UNKNOWN``; if there are none, all records that contain the mode. If the decay time of a mode is
about the length of a record, all estimates of ζ have the same bias, and ζ is estimated from the likelihoods
of the records instead (``joint_damping.py``). The status of a fused mode is the median, or a worse one that
follows from changes of its frequency between records (``rotor_orders.py``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import stdtrit

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.many_records.joint_damping import joint_damping
from jackettwin.identification.many_records.rotor_orders import objections
from jackettwin.identification.many_records.setups import WEAK_CONNECTION, tie
from jackettwin.identification.many_records.tracking import Track, TrackedModes, follow
from jackettwin.identification.status import ModeStatus, sentence, worse
from jackettwin.intervals import NORMAL_90, log_interval_90

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Sequence

    from jackettwin.identification.estimate import Identification
    from jackettwin.identification.many_records.rotor_orders import NoMode
    from jackettwin.identification.many_records.sightings import Sightings
    from jackettwin.records import Channel


MIN_RECORD_SHARE = 0.3
"""Smallest share of the records in which a fused mode is found."""
MIN_SCATTER_SHARE = 1e-6
"""Share of scatter in the variance of a mean below which it counts as none."""


@dataclass(frozen=True)
class Average:
    """Frequency and damping of one mode over records.

    Attributes
    ----------
    log_std : (of ln f, of ln ζ)
        Of the mean.
    scatter : (of ln f, of ln ζ)
        Standard deviation between records in excess of their own uncertainty.
    correlation : float
        Correlation of ln f and ln ζ of the mean; scatter between records counts as uncorrelated.
    damping_ratio_likelihood_90 : (low, high) or None
        Interval of ζ if it is estimated from the likelihoods of the records.
    """

    frequency_hz: float
    damping_ratio: float
    log_std: tuple[float, float]
    scatter: tuple[float, float]
    damping_ratio_likelihood_90: tuple[float, float] | None = None
    correlation: float = 0.0

    @property
    def log_covariance(self) -> FloatArray:
        """Covariance (2, 2) of (ln f, ln ζ)."""
        std = np.array(self.log_std)
        return np.asarray(np.outer(std, std) * np.array([[1.0, self.correlation], [self.correlation, 1.0]]))

    @property
    def frequency_interval_90(self) -> tuple[float, float]:
        """On the logarithm of f."""
        return log_interval_90(self.frequency_hz, self.log_std[0])

    @property
    def damping_ratio_interval_90(self) -> tuple[float, float]:
        """By likelihood ratio if the records' likelihoods are known, otherwise on the logarithm of ζ."""
        return self.damping_ratio_likelihood_90 or log_interval_90(self.damping_ratio, self.log_std[1])


@dataclass(frozen=True)
class FusedMode:
    """A mode tracked through several records.

    Attributes
    ----------
    frequency_hz, damping_ratio : float
    frequency_std_hz, damping_ratio_std : float
        Of the mean.
    frequency_interval_90, damping_ratio_interval_90 : (low, high)
    log_covariance : (2, 2)
        Of (ln f, ln ζ).
    mode_shape : (n_channels,) complex
        Mean shape; NaN at a channel that no record with this mode has.
    scatter_frequency, scatter_damping_ratio : float
        Relative standard deviations of f and ζ between records in excess of the records' own uncertainty,
        due to wind, tide and temperature.
    sightings : Sightings
        Estimates of the mode in each record that contains it.
    objection : NoMode or None
        Objection that follows from changes of its frequency between records.
    """

    frequency_hz: float
    damping_ratio: float
    frequency_std_hz: float
    damping_ratio_std: float
    frequency_interval_90: tuple[float, float]
    damping_ratio_interval_90: tuple[float, float]
    log_covariance: FloatArray
    mode_shape: ComplexArray
    scatter_frequency: float
    scatter_damping_ratio: float
    sightings: Sightings
    objection: NoMode | None = None

    @property
    def status(self) -> ModeStatus:
        """Median status over the records that contain the mode, or a worse one by an objection."""
        own = self.sightings.status
        return own if self.objection is None else worse(own, self.objection.status)

    @property
    def status_reason(self) -> str | None:
        """Objection of all records together to the mode; None if there is none."""
        return None if self.objection is None else sentence([self.objection.reason])

    @property
    def uncertainty_known(self) -> bool:
        """Whether any record states an uncertainty; if none does, intervals are made of lower limits."""
        return bool(np.isfinite(self.sightings.log_covariance).any())

    @property
    def records_ok(self) -> int:
        """Number of records in which the mode is ``OK``."""
        return int(np.sum(self.sightings.severity == ModeStatus.OK.severity))


@dataclass(frozen=True)
class FusedIdentification:
    """Modes of many records, sorted by frequency."""

    records: tuple[str, ...]
    channels: tuple[Channel, ...]
    modes: tuple[FusedMode, ...]
    duration_s: float
    warnings: tuple[str, ...]


def fuse(identifications: Iterable[Identification]) -> FusedIdentification:
    """Fuse the modes of several records, each read once and not stored.

    Modes are tracked in the order of the records (``tracking``); shapes cover all channels (``setups``).

    Raises
    ------
    InputError
        If there is no record, records share no channel, or one name is used for different sensors.
    """
    return fused_records(follow((found, None) for found in identifications))


def fused_records(followed: TrackedModes, key: Hashable = None) -> FusedIdentification:
    """Return the modes fused over the records of one key, or over all records if it is None.

    A mode counts if it is found in ``MIN_RECORD_SHARE`` of them.
    """
    mine = np.array([key is None or own == key for own in followed.keys])
    keys = dict.fromkeys(followed.keys if key is None else [key])
    at_least = max(1, round(MIN_RECORD_SHARE * int(mine.sum())))
    parts = ((track, track.sightings()) for track in followed.tracks)
    kept = [(track, seen.at(mine[seen.record])) for track, seen in parts]
    against = objections([seen for _, seen in kept])
    modes = [
        replace(_fused_mode(track, seen, keys, followed), objection=against.get(k))
        for k, (track, seen) in enumerate(kept)
        if len(seen) >= at_least
    ]
    return FusedIdentification(
        records=tuple(name for name, own in zip(followed.records, mine, strict=True) if own),
        channels=followed.channels,
        modes=tuple(sorted(modes, key=lambda mode: mode.frequency_hz)),
        duration_s=float(followed.duration_s[mine].sum()),
        warnings=_warnings(followed, modes),
    )


def random_effects(values: FloatArray, variances: FloatArray) -> tuple[float, float, float]:
    """Return mean, variance of the mean and between-record variance τ² of independent estimates.

    The method is that of DerSimonian & Laird 1986. The variance of the mean follows Hartung & Knapp 2001,
    which keeps its coverage with few records; it is at least the fixed-effects variance. The one returned is
    that of a normal distribution with the 90 % interval of Student's t, whose degrees of freedom are n − 1
    over the share of the variance that is due to scatter. With a nominal 95 %, the mean of four records is
    held by 94 % if these scatter by five of their standard deviations, by 97 % if they do not (86 and 97 % by
    a normal one).

    Examples
    --------
    >>> import numpy as np
    >>> mean, variance, between = random_effects(np.array([1.0, 1.2]), np.array([0.02, 0.02]))
    >>> round(mean, 6), round(variance, 6), round(between, 6)
    (1.1, 0.01, 0.0)
    """
    n = len(values)
    weight = 1.0 / variances
    if n == 1:
        return float(values[0]), float(variances[0]), 0.0
    mean = weight @ values / weight.sum()
    excess = weight @ (values - mean) ** 2 - (n - 1)
    between = max(0.0, float(excess / (weight.sum() - weight @ weight / weight.sum())))
    weight = 1.0 / (variances + between)
    mean = weight @ values / weight.sum()
    fixed = 1.0 / weight.sum()
    spread = max(float(weight @ (values - mean) ** 2 / (n - 1) * fixed), float(fixed))
    share = max(1.0 - 1.0 / float(np.sum(1.0 / variances)) / spread, MIN_SCATTER_SHARE)
    wider = float(stdtrit((n - 1) / share, 0.95)) / NORMAL_90
    return float(mean), spread * wider**2, between


def average(seen: Sightings) -> Average:
    """Return the mean of one mode over records: ln f and ζ, with random effects.

    A record without variances is given the long-data limits.
    """
    of_f, of_zeta = map(seen.no_worse_than, (ModeStatus.DAMPING_UNKNOWN, ModeStatus.OK))
    zeta = float(np.mean(of_zeta.damping_ratio))
    for _ in range(3):
        relative = random_effects(of_zeta.damping_ratio / zeta, _variances(of_zeta, 1, zeta))
        zeta *= relative[0]
    own_f, own = _variances(of_f, 0, zeta), _variances(of_zeta, 1, zeta)
    mean_f, variance_f, between_f = random_effects(np.log(of_f.frequency_hz), own_f)
    within = 1.0 / np.sqrt(np.sum(1.0 / own_f) * np.sum(1.0 / own))
    joint = joint_damping(seen)
    if joint is not None:
        return Average(
            frequency_hz=float(np.exp(mean_f)),
            damping_ratio=joint.damping_ratio,
            log_std=(float(np.sqrt(variance_f)), joint.log_std),
            scatter=(float(np.sqrt(between_f)), joint.scatter),
            damping_ratio_likelihood_90=joint.interval_90,
        )
    return Average(
        frequency_hz=float(np.exp(mean_f)),
        damping_ratio=zeta,
        log_std=(float(np.sqrt(variance_f)), float(np.sqrt(relative[1]))),
        scatter=(float(np.sqrt(between_f)), float(np.sqrt(relative[2]))),
        correlation=_correlation(of_zeta) * float(within / np.sqrt(variance_f * relative[1])),
    )


def _correlation(seen: Sightings) -> float:
    """Return the correlation of ln f and ln ζ within a record, the median over those that state it."""
    c = seen.log_covariance
    known = (c[:, 0, 1] / np.sqrt(c[:, 0, 0] * c[:, 1, 1]))[np.isfinite(c[:, 0, 0])]
    return float(np.median(known)) if len(known) else 0.0


def _fused_mode(track: Track, seen: Sightings, keys: Iterable[Hashable], followed: TrackedModes) -> FusedMode:
    mean = average(seen)
    f, zeta = mean.frequency_hz, mean.damping_ratio
    return FusedMode(
        frequency_hz=f,
        damping_ratio=zeta,
        frequency_std_hz=float(f * mean.log_std[0]),
        damping_ratio_std=float(zeta * mean.log_std[1]),
        frequency_interval_90=mean.frequency_interval_90,
        damping_ratio_interval_90=mean.damping_ratio_interval_90,
        log_covariance=mean.log_covariance,
        mode_shape=track.shape(keys, len(followed.channels)),
        scatter_frequency=mean.scatter[0],
        scatter_damping_ratio=mean.scatter[1],
        sightings=seen,
    )


def _variances(seen: Sightings, which: int, zeta: float) -> FloatArray:
    """Return the variance of ln f (0) or ln ζ (1) of each record at the common damping.

    This is the information limit at the common damping times the ratio of claimed variance to limit.
    For ln f that ratio is the record's own, since its fit may be worse than others';
    for ln ζ it is the median, since the ratio correlates with the error.
    """
    cycles = 2.0 * np.pi * seen.frequency_hz * seen.duration_s
    limit = zeta / cycles if which == 0 else 1.0 / (zeta * cycles)
    own_zeta = seen.damping_ratio
    own_limit = own_zeta / cycles if which == 0 else 1.0 / (own_zeta * cycles)
    claimed = seen.log_covariance[:, which, which] / own_limit
    known = np.isfinite(claimed)
    typical = np.median(claimed[known]) if known.any() else 1.0
    return np.asarray(limit * (np.where(known, claimed, typical) if which == 0 else typical))


def _warnings(followed: TrackedModes, modes: Sequence[FusedMode]) -> tuple[str, ...]:
    """Warn if records have different channels, and on modes in which the shared sensors hardly move."""
    names = [c.name for c in followed.channels]
    if len(followed.shared) == len(names):
        return ()
    if not followed.shared:
        return (
            "records have different channels, none of which is in all: shapes are connected record by record",
        )
    at = np.array([names.index(name) for name in followed.shared], dtype=np.int64)
    loose = [mode.frequency_hz for mode in modes if tie(mode.mode_shape, at) < WEAK_CONNECTION]
    return (
        f"records have different channels: shapes are connected by {', '.join(followed.shared)}",
        *(
            f"{f:.4g} Hz: the shared sensors hardly move; the parts of the shape may not be consistent"
            for f in loose
        ),
    )
