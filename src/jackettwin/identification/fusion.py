r"""One estimate from many records.

Modes are tracked across records by shape and frequency, then averaged. Weights hold the uncertainty of each
record and the scatter between records (random effects; DerSimonian & Laird 1986):

.. math:: \hat\theta = \frac{\sum w_r \theta_r}{\sum w_r}, \quad w_r = \frac{1}{s_r^2 + \tau^2}

θ is ln f, and ζ itself: estimates of a record are unbiased in ζ, so their logarithms are not, and the mean
of many records would inherit it. The variance s_r² is taken at the *fused* damping: an estimate that
happens to be high also claims to be sharp, and weights of its own would pull the mean up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from jackettwin.errors import InputError
from jackettwin.identification.mac import mac
from jackettwin.identification.setups import WEAK_TIE, all_channels, merged_shape, tie

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import Identification, ModalEstimate
    from jackettwin.records import Channel

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

FREQUENCY_SCALE = 0.03
"""Relative change of frequency that counts as much as shapes at right angles."""
SHAPE_SLACK = 2.0
"""So many times the variance of two shapes may their 1 − MAC be without counting."""
SAME_MODE = 1.0
"""Largest distance, frequency and shape together, of one mode in two records."""
FEWEST_SHARE = 0.3
"""A fused mode must be found in this share of the records."""


@dataclass(frozen=True)
class Average:
    """Frequency and damping of one mode over records.

    Attributes
    ----------
    log_std : (of ln f, of ln ζ)
        Of the mean.
    scatter : (of ln f, of ln ζ)
        Between records, beyond their own uncertainty.
    correlation : float
        Of ln f and ln ζ of the mean; what scatters between records counts as independent.
    """

    frequency_hz: float
    damping_ratio: float
    log_std: tuple[float, float]
    scatter: tuple[float, float]
    correlation: float = 0.0

    @property
    def log_covariance(self) -> FloatArray:
        """Covariance (2, 2) of (ln f, ln ζ)."""
        std = np.array(self.log_std)
        return np.asarray(np.outer(std, std) * np.array([[1.0, self.correlation], [self.correlation, 1.0]]))


@dataclass(frozen=True)
class FusedMode:
    """A mode followed through several records.

    Attributes
    ----------
    frequency_hz, damping_ratio : float
    frequency_std_hz, damping_ratio_std : float
        Of the mean.
    frequency_interval_95, damping_ratio_interval_95 : (low, high)
    log_covariance : (2, 2)
        Of (ln f, ln ζ).
    mode_shape : (n_channels,) complex
        NaN at a channel that no record with this mode has.
    scatter_frequency, scatter_damping_ratio : float
        Between-record standard deviations of f and ζ, relative, beyond what the records' own uncertainty
        explains: wind, tide and temperature show here.
    records : tuple of int
        Positions of the records that hold the mode.
    members : tuple of ModalEstimate
        The mode in each of these records.
    """

    frequency_hz: float
    damping_ratio: float
    frequency_std_hz: float
    damping_ratio_std: float
    frequency_interval_95: tuple[float, float]
    damping_ratio_interval_95: tuple[float, float]
    log_covariance: FloatArray
    mode_shape: ComplexArray
    scatter_frequency: float
    scatter_damping_ratio: float
    records: tuple[int, ...]
    members: tuple[ModalEstimate, ...]


@dataclass(frozen=True)
class FusedIdentification:
    """Modes of many records, sorted by frequency."""

    records: tuple[str, ...]
    channels: tuple[Channel, ...]
    modes: tuple[FusedMode, ...]
    duration_s: float
    warnings: tuple[str, ...]


def fuse(identifications: Sequence[Identification]) -> FusedIdentification:
    """Fuse the modes of several records.

    Modes are recognised by the channels that all records share; shapes hold every channel (``setups``).

    Raises
    ------
    InputError
        If there is no record, records share no channel, or one name stands for different sensors.
    """
    if not identifications:
        raise InputError("nothing to fuse", field="records", allowed="at least one record")
    names = _common_channels(identifications)
    channels = all_channels(identifications)
    rows = [_rows(result, names) for result in identifications]
    tracks = _tracks(identifications, rows)
    fewest = max(1, round(FEWEST_SHARE * len(identifications)))
    kept = [track for track in tracks if len(track) >= fewest]
    modes = [_fused_mode(identifications, channels, names, track) for track in kept]
    return FusedIdentification(
        records=tuple(name for result in identifications for name in result.records),
        channels=channels,
        modes=tuple(sorted(modes, key=lambda mode: mode.frequency_hz)),
        duration_s=float(sum(result.duration_s for result in identifications)),
        warnings=_warnings(channels, names, modes),
    )


def random_effects(values: FloatArray, variances: FloatArray) -> tuple[float, float, float]:
    """Return mean, variance of the mean and between-record variance τ² of independent estimates.

    DerSimonian & Laird 1986; the variance of the mean follows Hartung & Knapp 2001, which keeps its
    coverage with few records and is never taken below the fixed-effects variance.

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
    spread = weight @ (values - mean) ** 2 / (n - 1) * fixed
    return float(mean), float(max(spread, fixed)), between


def _warnings(channels: Sequence[Channel], shared: list[str], modes: list[FusedMode]) -> tuple[str, ...]:
    """Say so if records hold different channels, and where those they share hardly move."""
    if len(shared) == len(channels):
        return ()
    at = _places(channels, shared)
    loose = [mode.frequency_hz for mode in modes if tie(mode.mode_shape, at) < WEAK_TIE]
    return (
        f"not every record has every channel: shapes are tied by {', '.join(shared)}",
        *(f"{f:.4g} Hz: the shared sensors hardly move; the parts of the shape may not fit" for f in loose),
    )


def _places(channels: Sequence[Channel], names: Sequence[str]) -> npt.NDArray[np.int64]:
    order = [c.name for c in channels]
    return np.array([order.index(name) for name in names], dtype=np.int64)


def average(members: Sequence[ModalEstimate], duration_s: FloatArray) -> Average:
    """Return the mean of one mode over records: ln f and ζ, with random effects.

    Parameters
    ----------
    members : sequence of ModalEstimate
        The mode in each record; one without a covariance takes the long-data limits.
    duration_s : (n_records,)
    """
    own_zeta = np.array([mode.damping_ratio for mode in members])
    zeta = float(np.mean(own_zeta))
    for _ in range(3):
        relative = random_effects(own_zeta / zeta, _variances(members, duration_s, 1, zeta))
        zeta *= relative[0]
    log_f = np.log([mode.frequency_hz for mode in members])
    own_f, own = (_variances(members, duration_s, which, zeta) for which in (0, 1))
    mean_f, variance_f, between_f = random_effects(log_f, own_f)
    within = 1.0 / np.sqrt(np.sum(1.0 / own_f) * np.sum(1.0 / own))
    return Average(
        frequency_hz=float(np.exp(mean_f)),
        damping_ratio=zeta,
        log_std=(float(np.sqrt(variance_f)), float(np.sqrt(relative[1]))),
        scatter=(float(np.sqrt(between_f)), float(np.sqrt(relative[2]))),
        correlation=_correlation(members) * float(within / np.sqrt(variance_f * relative[1])),
    )


def _correlation(members: Sequence[ModalEstimate]) -> float:
    """Return the correlation of ln f and ln ζ inside a record: the median over those that state it."""
    known = [m.log_covariance for m in members if m.log_covariance is not None]
    return float(np.median([c[0, 1] / np.sqrt(c[0, 0] * c[1, 1]) for c in known])) if known else 0.0


def _common_channels(identifications: Sequence[Identification]) -> list[str]:
    sets = [{c.name for c in result.channels} for result in identifications]
    common = set.intersection(*sets)
    if not common:
        raise InputError(
            "records share no channel",
            field="records",
            value=[result.records[0] for result in identifications],
            remedy="fuse records of the same sensors",
        )
    return [c.name for c in identifications[0].channels if c.name in common]


def _rows(result: Identification, names: list[str]) -> list[int]:
    order = [c.name for c in result.channels]
    return [order.index(name) for name in names]


def _tracks(identifications: Sequence[Identification], rows: list[list[int]]) -> list[dict[int, int]]:
    """Return for every track the mode it takes in each record.

    Records join one after the other, the one with most modes first. Within a record, modes go to tracks
    such that the sum of the distances is least, none twice, so that modes that cross keep their shapes.
    """
    tracks: list[dict[int, int]] = []
    order = sorted(range(len(identifications)), key=lambda r: -len(identifications[r].modes))
    for r in order:
        found = identifications[r].modes
        if not found:
            continue
        f = np.log([mode.frequency_hz for mode in found])
        shapes = np.array([mode.mode_shape[rows[r]] for mode in found])
        free = set(range(len(found)))
        if tracks:
            vague = np.array([_vagueness(mode) for mode in found])
            apart = np.array([_distance(identifications, rows, track, f, shapes, vague) for track in tracks])
            for t, m in zip(*linear_sum_assignment(np.minimum(apart, SAME_MODE)), strict=True):
                if apart[t, m] < SAME_MODE:
                    tracks[t][r] = int(m)
                    free.remove(int(m))
        tracks.extend({r: m} for m in sorted(free))
    return tracks


def _distance(
    identifications: Sequence[Identification],
    rows: list[list[int]],
    track: dict[int, int],
    f: FloatArray,
    shapes: ComplexArray,
    vague: FloatArray,
) -> FloatArray:
    """Return the distance of every mode of a record from the members of a track, medians over members.

    Inside a close pair the shapes of one record mix: so much of 1 − MAC as their own uncertainty explains
    does not count.
    """
    members = [identifications[r].modes[m] for r, m in track.items()]
    track_f = np.median(np.log([mode.frequency_hz for mode in members]))
    track_shapes = np.array([mode.mode_shape[rows[r]] for r, mode in zip(track, members, strict=True)])
    explained = SHAPE_SLACK * (vague[:, None] + [_vagueness(mode) for mode in members])
    unlike = np.median(np.maximum(1.0 - mac(shapes, track_shapes) - explained, 0.0), axis=1)
    return np.asarray(np.abs(f - track_f) / FREQUENCY_SCALE + unlike)


def _vagueness(mode: ModalEstimate) -> float:
    """Return the variance of a shape's entries over the square of its length."""
    if mode.mode_shape_std is None:
        return 0.0
    return float(np.sum(mode.mode_shape_std**2) / np.sum(np.abs(mode.mode_shape) ** 2))


def _fused_mode(
    identifications: Sequence[Identification],
    channels: Sequence[Channel],
    shared: list[str],
    track: dict[int, int],
) -> FusedMode:
    order = sorted(track)
    members = [identifications[r].modes[track[r]] for r in order]
    mean = average(members, np.array([identifications[r].duration_s for r in order]))
    f, zeta = mean.frequency_hz, mean.damping_ratio
    std_f, std_zeta = mean.log_std
    shape = merged_shape(
        [mode.mode_shape for mode in members],
        [_places(channels, [c.name for c in identifications[r].channels]) for r in order],
        _places(channels, shared),
        len(channels),
    )
    return FusedMode(
        frequency_hz=f,
        damping_ratio=zeta,
        frequency_std_hz=float(f * std_f),
        damping_ratio_std=float(zeta * std_zeta),
        frequency_interval_95=(f * float(np.exp(-1.96 * std_f)), f * float(np.exp(1.96 * std_f))),
        damping_ratio_interval_95=(
            zeta * float(np.exp(-1.96 * std_zeta)),
            zeta * float(np.exp(1.96 * std_zeta)),
        ),
        log_covariance=mean.log_covariance,
        mode_shape=shape,
        scatter_frequency=mean.scatter[0],
        scatter_damping_ratio=mean.scatter[1],
        records=tuple(order),
        members=tuple(members),
    )


def _variances(
    members: Sequence[ModalEstimate], duration_s: FloatArray, which: int, zeta: float
) -> FloatArray:
    """Return the variance of ln f (0) or ln ζ (1) of each member, were its damping the common one.

    The information limit at the common damping, inflated by the median ratio of claimed variance to limit.
    """
    f = np.array([mode.frequency_hz for mode in members])
    own_zeta = np.array([mode.damping_ratio for mode in members])
    cycles = 2.0 * np.pi * f * duration_s
    limit = zeta / cycles if which == 0 else 1.0 / (zeta * cycles)
    own_limit = own_zeta / cycles if which == 0 else 1.0 / (own_zeta * cycles)
    claimed = [
        mode.log_covariance[which, which] / own
        for mode, own in zip(members, own_limit, strict=True)
        if mode.log_covariance is not None
    ]
    return np.asarray(limit * (np.median(claimed) if claimed else 1.0))
