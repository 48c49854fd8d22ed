"""Candidate modes from clusters of poles, with their uncertainty and the objections to them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.findings import Finding
from jackettwin.identification.estimate import ModalEstimate, Rejected
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.identification.mode_shapes import aligned, mpc, mpd_rad, normalised
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.tones.drifting_tones import tones_at
from jackettwin.identification.tones.envelopes import is_steady_tone
from jackettwin.identification.tones.sinusoid import transform
from jackettwin.identification.tones.steady_tones import strongest_line, without_tones
from jackettwin.records import less_phase

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jackettwin.identification.estimate import Stabilisation
    from jackettwin.identification.selection.clustering import Cluster
    from jackettwin.identification.settings import IdentificationSettings
    from jackettwin.identification.tones.phase_track import PhaseTrack


MIN_ORDERS = 5
"""Fewest model orders in which a mode appears (0.4 of the orders if that is less)."""
TONE_OBJECTION = "steady tone: its envelope does not wander as that of a mode"
TONE_REACH = 6.0
"""Distance of a tone, in half bandwidths, within which it disturbs a mode."""
ORDER_REACH = 2.0
"""Distance of a rotor order, in half bandwidths, within which it disturbs a mode."""
MIN_ORDER_REACH = 0.015
"""Smallest such distance as a share of the frequency, since an estimated speed is uncertain at its limits."""
HALF_A_LINE = 0.5
"""Difference of two distances below which poles are equally near to a line, in lines."""
TONE_WIDENING = 2.0
"""Factor on the standard deviations of a mode that a tone disturbs."""


@dataclass(frozen=True)
class Tones:
    """Tones among the poles.

    Attributes
    ----------
    representatives : set of int
        Representative poles of the clusters that are tones.
    steady_hz : tuple of float
        Steady tones among them.
    drifting : tuple of PhaseTrack
        Drifting tones, including those subtracted before.
    clean : (n_channels, n_samples)
        Samples without the tones.
    """

    representatives: frozenset[int]
    steady_hz: tuple[float, ...]
    drifting: tuple[PhaseTrack, ...]
    clean: FloatArray


@dataclass(frozen=True)
class Candidate:
    """A cluster of poles, the mode it would be, and the objections to it.

    Attributes
    ----------
    objection : str or None
        Why it is not a mode.
    doubt : str or None
        Why it may not be a mode, unless the spectrum needs it.
    widening : (float, float)
        Factors on the standard deviations of ln f and ln ζ as a mode, for few blocks.
    """

    cluster: Cluster
    mode: ModalEstimate
    objection: str | None
    doubt: str | None
    widening: tuple[float, float] = (1.0, 1.0)

    @property
    def is_tone(self) -> bool:
        """Whether its envelope is that of a tone."""
        return self.objection == TONE_OBJECTION

    @property
    def rejected(self) -> Rejected:
        """The candidate with the reason it was left out."""
        reason = self.objection or self.doubt or ""
        status = ModeStatus.TONE if self.is_tone else ModeStatus.NOISE
        return Rejected(self.mode.frequency_hz, self.mode.damping_ratio, reason, status)


def candidates(
    poles: Stabilisation,
    found: list[Cluster],
    tones: Iterable[int],
    settings: IdentificationSettings,
    *,
    duration_s: float,
    n_orders: int,
) -> list[Candidate]:
    """Apply the hard criteria to every cluster.

    Parameters
    ----------
    tones : iterable of int
        Representative poles of clusters that are steady tones.
    """
    steady = set(tones)
    fewest = min(MIN_ORDERS, int(np.ceil(0.4 * n_orders)))
    out = []
    for cluster in found:
        mode = _mode(poles, cluster, duration_s)
        objection = _objection(cluster, mode, settings, fewest)
        if cluster.representative in steady:
            objection = TONE_OBJECTION
        wider = (1.0, 1.0) if poles.few_blocks is None else poles.few_blocks[cluster.representative]
        doubt = _doubt(cluster, mode, settings)
        out.append(Candidate(cluster, mode, objection, doubt, (float(wider[0]), float(wider[1]))))
    return out


def find_tones(
    poles: Stabilisation,
    found: list[Cluster],
    y: FloatArray,
    scale: FloatArray,
    sample_rate_hz: float,
    settings: IdentificationSettings,
    drifting: Iterable[PhaseTrack] = (),
) -> Tones:
    """Return the tones among the clusters.

    A drifting tone causes several poles; all poles that it crosses belong to it.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Samples divided by ``scale``.
    drifting : iterable of PhaseTrack
        Drifting tones already subtracted; their residuals cause poles too.
    """
    likely = [c.representative for c in found if c.order_share >= settings.min_order_share]
    f, zeta = poles.frequency_hz, poles.damping_ratio
    clean, lines, followed, steady = y, transform(y), list(drifting), []
    duration_s = y.shape[1] / sample_rate_hz
    k = -1
    while left := [n for n in sorted(likely) if n > k and not any(tone.passes(f[n]) for tone in followed)]:
        for k, track in zip(left, tones_at(lines, duration_s, f[left]), strict=True):
            if track is not None:
                followed.append(track)
                clean = less_phase(clean, track.phase(y.shape[1]))
            elif is_nearest(lines, duration_s, f[k], f[likely]) and is_steady_tone(
                lines, duration_s, f[k], zeta[k], poles.mode_shape[k] / scale
            ):
                steady.append(k)
                clean = without_tones(clean, sample_rate_hz, [f[k]])
            else:
                continue
            # the remaining clusters are tested on the samples without this tone
            lines = transform(clean)
            break
    passed = {k for k in likely if any(tone.passes(f[k]) for tone in followed)}
    return Tones(frozenset(passed.union(steady)), tuple(float(f[k]) for k in steady), tuple(followed), clean)


def is_nearest(lines: ComplexArray, duration_s: float, frequency_hz: float, all_hz: FloatArray) -> bool:
    """Tell whether no pole is nearer to the strongest line about a pole, which would be subtracted with it.

    Otherwise a pole beside a lightly damped mode would take the mode's steady line for its own.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Fourier transforms of the channels, from zero frequency.
    all_hz : (n_poles,)
    """
    strongest_hz = strongest_line(lines, frequency_hz * duration_s) / duration_s
    own, nearest = abs(strongest_hz - frequency_hz), np.abs(all_hz - strongest_hz).min()
    return bool(own < nearest + HALF_A_LINE / duration_s)


def beside_orders(mode: ModalEstimate, orders: Iterable[tuple[int, float, float]]) -> ModalEstimate:
    """Flag a mode whose frequency a rotor order crosses, or that may itself be a rotor order.

    Parameters
    ----------
    orders : iterable of (order, low, high)
    """
    f = mode.frequency_hz
    reach = max(ORDER_REACH * mode.damping_ratio, MIN_ORDER_REACH) * f
    for order, low, high in orders:
        if low - reach < f < high + reach:
            mode = mode.flagged(ModeStatus.DOUBTFUL, Finding("rotor_order_passes", params={"order": order}))
    return mode


def beside_tones(mode: ModalEstimate, tones_hz: Iterable[tuple[float, float]]) -> ModalEstimate:
    """Flag a mode near a tone, and widen its intervals.

    Parameters
    ----------
    tones_hz : iterable of (low, high)
        Ranges of the tones; low and high of a steady one are equal.
    """
    f = mode.frequency_hz
    reach = TONE_REACH * mode.damping_ratio * f
    near = [(low, high) for low, high in tones_hz if low - reach < f < high + reach]
    if not near:
        return mode
    low, high = near[0]
    tone = (
        Finding("steady_tone_near", params={"frequency_hz": low})
        if low == high
        else Finding("tone_passes", params={"low_hz": low, "high_hz": high})
    )
    mode = mode.flagged(ModeStatus.DOUBTFUL, tone)
    if mode.log_covariance is None:
        return mode
    return mode.with_covariance(TONE_WIDENING**2 * mode.log_covariance)


def _mode(poles: Stabilisation, cluster: Cluster, duration_s: float) -> ModalEstimate:
    """Return the representative pole with its uncertainty and the scatter over model orders combined.

    The result is at least the long-data limit, since blocks shorter than the decay time of a mode
    underestimate its scatter.
    """
    k = cluster.representative
    f, zeta = float(poles.frequency_hz[k]), float(poles.damping_ratio[k])
    shape = normalised(aligned(poles.mode_shape[k]))
    limits = long_data_limits(f, zeta, duration_s)
    mode = ModalEstimate(
        f,
        zeta,
        shape,
        float(mpc(shape)),
        float(mpd_rad(shape)),
        cluster.order_share,
        damping_ratio_cov_limit=float(limits[1]),
    )
    if poles.log_covariance is None or poles.mode_shape_std is None:
        return mode
    both = np.log([poles.frequency_hz[cluster.core], poles.damping_ratio[cluster.core]])
    covariance = poles.log_covariance[k] + np.cov(both, bias=True)
    lift = np.maximum(limits / np.sqrt(np.diag(covariance)), 1.0)
    mode = replace(mode, mode_shape_std=poles.mode_shape_std[k])
    return mode.with_covariance(covariance * np.outer(lift, lift))


def _objection(
    cluster: Cluster, mode: ModalEstimate, settings: IdentificationSettings, fewest: int
) -> str | None:
    """Return why a cluster is not a mode, or None."""
    if len(cluster.poles) < fewest:
        return f"in {len(cluster.poles)} model orders, {fewest} needed"
    if cluster.order_share < settings.min_order_share:
        return (
            f"in {cluster.order_share:.0%} of the model orders since it first appeared, "
            f"{settings.min_order_share:.0%} needed"
        )
    if mode.mpc < settings.min_mpc:
        return f"modal phase collinearity {mode.mpc:.2f} below {settings.min_mpc:g}"
    if mode.mpd_rad > settings.max_mpd_rad:
        return f"mean phase deviation {mode.mpd_rad:.2f} rad above {settings.max_mpd_rad:g}"
    return None


def _doubt(cluster: Cluster, mode: ModalEstimate, settings: IdentificationSettings) -> str | None:
    """Return why a cluster is doubtful, or None: its damping is too uncertain."""
    if cluster.damping_cov > settings.max_damping_cov:
        return (
            f"damping uncertain by {cluster.damping_cov:.0%}, at most {settings.max_damping_cov:.0%} allowed"
        )
    if mode.damping_ratio_cov_limit is None:
        return None
    excess = cluster.damping_cov / mode.damping_ratio_cov_limit
    if excess <= settings.max_damping_excess:
        return None
    return (
        f"damping {excess:.0f} times as uncertain as the record allows, "
        f"at most {settings.max_damping_excess:g} times accepted"
    )
