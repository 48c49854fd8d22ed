"""Which clusters of poles are modes, with their uncertainty, and why the others are not."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jackettwin.identification.estimate import ModalEstimate, Rejected, Stabilisation
from jackettwin.identification.harmonics import is_tone
from jackettwin.identification.mac import aligned, mpc, mpd_rad, normalised

if TYPE_CHECKING:
    from jackettwin.identification.clustering import Cluster
    from jackettwin.identification.settings import IdentificationSettings

FloatArray = npt.NDArray[np.float64]

TONE_REACH = 6.0
"""A tone nearer than this many half bandwidths disturbs a mode …"""
TONE_WIDENING = 2.0
"""… whose standard deviations are multiplied by this."""


def select(
    poles: Stabilisation,
    found: list[Cluster],
    tones: dict[int, float],
    settings: IdentificationSettings,
    duration_s: float,
) -> tuple[tuple[ModalEstimate, ...], tuple[Rejected, ...], Stabilisation]:
    """Apply the hard criteria to the clusters; label the poles of those that pass."""
    modes: list[ModalEstimate] = []
    rejected: list[Rejected] = []
    label = poles.cluster.copy()
    for cluster in found:
        f, zeta = (float(x[cluster.representative]) for x in (poles.frequency_hz, poles.damping_ratio))
        shape = normalised(aligned(poles.mode_shape[cluster.representative]))
        reason = _reason(cluster, float(mpc(shape)), float(mpd_rad(shape)), settings)
        if cluster.representative in tones:
            reason = "steady tone: its envelope does not wander as that of a mode"
        if reason is not None:
            rejected.append(Rejected(f, zeta, reason))
            continue
        label[cluster.poles] = len(modes)
        bare = ModalEstimate(f, zeta, shape, float(mpc(shape)), float(mpd_rad(shape)), cluster.order_share)
        mode = _with_uncertainty(bare, poles, cluster, duration_s)
        modes.append(_beside_tones(mode, list(tones.values())))
    return tuple(modes), tuple(rejected), replace(poles, cluster=label)


def find_tones(
    poles: Stabilisation,
    found: list[Cluster],
    y: FloatArray,
    sample_rate_hz: float,
    settings: IdentificationSettings,
) -> dict[int, float]:
    """Return the frequencies of steady tones among the clusters, by representative pole."""
    candidates = [c.representative for c in found if c.order_share >= settings.min_order_share]
    return {
        k: float(poles.frequency_hz[k])
        for k in candidates
        if is_tone(y, sample_rate_hz, float(poles.frequency_hz[k]), poles.mode_shape[k])
    }


def _beside_tones(mode: ModalEstimate, tones_hz: list[float]) -> ModalEstimate:
    """Flag a mode near a tone, and widen what is said of its damping."""
    reach = TONE_REACH * mode.damping_ratio * mode.frequency_hz
    near = [f for f in tones_hz if abs(f - mode.frequency_hz) < reach]
    if not near:
        return mode
    mode = replace(mode, status=f"a steady tone at {near[0]:.4g} Hz is too near to trust the damping")
    if mode.log_covariance is None:
        return mode
    covariance = TONE_WIDENING**2 * mode.log_covariance
    std_f, std_zeta = np.sqrt(np.diag(covariance))
    return replace(
        mode,
        log_covariance=covariance,
        frequency_std_hz=float(mode.frequency_hz * std_f),
        damping_ratio_std=float(mode.damping_ratio * std_zeta),
        frequency_interval_95=_interval(mode.frequency_hz, std_f),
        damping_ratio_interval_95=_interval(mode.damping_ratio, std_zeta),
    )


def _with_uncertainty(
    mode: ModalEstimate, poles: Stabilisation, cluster: Cluster, duration_s: float
) -> ModalEstimate:
    """Add the uncertainty of the representative pole and the scatter over the model orders.

    Never below the long-data limits of Au 2014, ζ: 1/√(2πζfT), f: √(ζ/(2πfT)): blocks shorter than the
    memory of a mode underestimate its scatter.
    """
    f, zeta = mode.frequency_hz, mode.damping_ratio
    cycles = 2.0 * np.pi * f * duration_s
    limit = 1.0 / np.sqrt(zeta * cycles)
    mode = replace(mode, damping_ratio_cov_limit=float(limit))
    if poles.log_covariance is None or poles.mode_shape_std is None:
        return mode
    both = np.log([poles.frequency_hz[cluster.core], poles.damping_ratio[cluster.core]])
    covariance = poles.log_covariance[cluster.representative] + np.cov(both, bias=True)
    lift = np.sqrt(np.maximum(np.array([zeta / cycles, limit**2]) / np.diag(covariance), 1.0))
    covariance = covariance * np.outer(lift, lift)
    std_f, std_zeta = np.sqrt(np.diag(covariance))
    return replace(
        mode,
        log_covariance=covariance,
        frequency_std_hz=float(f * std_f),
        damping_ratio_std=float(zeta * std_zeta),
        frequency_interval_95=_interval(f, std_f),
        damping_ratio_interval_95=_interval(zeta, std_zeta),
        mode_shape_std=poles.mode_shape_std[cluster.representative],
    )


def _interval(centre: float, log_std: float) -> tuple[float, float]:
    factor = float(np.exp(1.96 * log_std))
    return centre / factor, centre * factor


def _reason(
    cluster: Cluster, collinearity: float, deviation: float, settings: IdentificationSettings
) -> str | None:
    """Return why a cluster is not a mode, or None."""
    if cluster.order_share < settings.min_order_share:
        return f"in {cluster.order_share:.0%} of the model orders, {settings.min_order_share:.0%} needed"
    if cluster.damping_cov > settings.max_damping_cov:
        return (
            f"damping uncertain by {cluster.damping_cov:.0%}, at most {settings.max_damping_cov:.0%} allowed"
        )
    if collinearity < settings.min_mpc:
        return f"modal phase collinearity {collinearity:.2f} below {settings.min_mpc:g}"
    if deviation > settings.max_mpd_rad:
        return f"mean phase deviation {deviation:.2f} rad above {settings.max_mpd_rad:g}"
    return None
