"""Identification of one record as JSON data, with keys on which users' scripts rely."""

from __future__ import annotations

from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING, Any

from jackettwin.identification.decays.relaxations import FALSE_ALARMS, POWER, ReleaseRelaxations
from jackettwin.identification.picks import plain_picks
from jackettwin.identification.status import ModeStatus

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jackettwin.arrays import ComplexArray
    from jackettwin.identification.comparison import Comparison
    from jackettwin.identification.estimate import Identification, ModalEstimate, Stabilisation
    from jackettwin.identification.relaxation_limits import AmbientLimits
    from jackettwin.records import Channel


def identification_document(
    found: Identification,
    quality: Mapping[str, Any],
    conditions: Mapping[str, Any],
    compared: Comparison | None = None,
) -> dict[str, Any]:
    """Return the modes of one record, rejected poles, the settings used and the record's quality."""
    names = [channel.name for channel in found.channels]
    return {
        "records": list(found.records),
        "modes": [
            {**mode_document(mode, names), "poles": poles_document(found.stabilisation, k)}
            for k, mode in enumerate(found.modes)
        ],
        "rejected": [{**asdict(one), "status": one.status.value} for one in found.rejected],
        "settings": {**asdict(found.settings), "orders": list(found.settings.orders)},
        "real_poles": [
            {
                "rate_rad_s": pole.rate_rad_s,
                "rate_std_rad_s": pole.rate_std_rad_s,
                "rate_interval_90": pole.rate_interval_90,
                "time_constant_s": pole.time_constant_s,
                "order_share": pole.order_share,
                "mode_shape": shape_document(pole.mode_shape, names),
            }
            for pole in found.real_poles
        ],
        "picks": plain_picks(found.picks),
        "duration_s": found.duration_s,
        "quality": dict(quality),
        "warnings": list(found.warnings),
        "findings": [finding.document for finding in found.findings],
        "notes": [str(f) for f in (*found.notes, *found.findings) if f.severity == "info"],
        **({} if compared is None else {"methods": _comparison_document(compared)}),
        "conditions": dict(conditions),
        "channels": channels_document(found.channels),
    }


def channels_document(channels: Sequence[Channel]) -> dict[str, Any]:
    """Return quantity, position and direction of the channels of a mode shape, by name."""
    return {
        c.name: {
            "quantity": c.quantity,
            "unit": c.unit,
            "height_m": c.height_m,
            "node": c.node,
            "direction": list(c.direction),
        }
        for c in channels
    }


def limits_document(found: ReleaseRelaxations | AmbientLimits) -> dict[str, Any]:
    """Return the relaxations that would be detected in a record with 95 % power."""
    if isinstance(found, ReleaseRelaxations):
        names = [channel.name for channel in found.channels]
        return {
            "kind": "release",
            "power": POWER,
            "false_alarms": FALSE_ALARMS,
            "release_s": found.release_s,
            "amplitude": None if found.pole is None else dict(zip(names, found.amplitude, strict=True)),
            "limits": [
                {"rate_rad_s": one.rate_rad_s, "amplitude": dict(zip(names, one.amplitude, strict=True))}
                for one in found.limits
            ],
        }
    return {
        "kind": "ambient",
        "power": POWER,
        "band_rad_s": [found.lowest_rate_rad_s, found.highest_rate_rad_s],
        "rms": dict(zip(found.channels, found.rms, strict=True)),
        "limits": [
            {**asdict(one), "rms_share": one.rms_share if isfinite(one.rms_share) else None}
            for one in found.limits
        ],
    }


def mode_document(m: ModalEstimate, channels: Sequence[str] | None) -> dict[str, Any]:
    """Return one identified mode; shapes are [real, imaginary] per channel, omitted without channels."""
    known, interval = m.status != ModeStatus.DAMPING_UNKNOWN, m.damping_ratio_interval_90
    bound = (None, None) if m.cramer_rao_log_std is None else map(float, m.cramer_rao_log_std)
    frequency_bound, damping_bound = bound
    document: dict[str, Any] = {
        "frequency_hz": m.frequency_hz,
        "frequency_std_hz": m.frequency_std_hz,
        "damping_ratio": m.damping_ratio if known else None,
        "damping_ratio_std": m.damping_ratio_std if known else None,
        "frequency_interval_90": m.frequency_interval_90,
        "damping_ratio_interval_90": interval if known else None,
        "damping_ratio_at_most": None if known or interval is None else interval[1],
        "mpc": m.mpc,
        "method": m.method,
        "status": m.status.value,
        "status_reason": m.status_reason,
        "status_codes": [finding.code for finding in m.reasons],
        "unrefined": None if m.unrefined is None else mode_document(m.unrefined, None),
        "log_covariance": None if m.log_covariance is None else m.log_covariance.tolist(),
        "least_relative_std": {
            "damping_ratio_long_data": m.damping_ratio_cov_limit,
            "frequency_cramer_rao": frequency_bound,
            "damping_ratio_cramer_rao": damping_bound,
        },
    }
    if channels is not None:
        document["mode_shape"] = shape_document(m.mode_shape, channels)
        raw = m.mode_shape_unaligned
        document["mode_shape_unaligned"] = None if raw is None else shape_document(raw, channels)
    return document


def poles_document(poles: Stabilisation, mode: int) -> dict[str, float | int] | None:
    """Return number, mean and scatter over the model orders of a mode's poles, None where it has none.

    The scatter is that of one record over its models, not the uncertainty of the mode.

    Parameters
    ----------
    mode : int
        Its number in ``Stabilisation.cluster``.
    """
    own = poles.cluster == mode
    if not own.any():
        return None
    f, zeta = poles.frequency_hz[own], poles.damping_ratio[own]
    return {
        "count": int(own.sum()),
        "frequency_mean_hz": float(f.mean()),
        "frequency_scatter_hz": float(f.std()),
        "damping_ratio_mean": float(zeta.mean()),
        "damping_ratio_scatter": float(zeta.std()),
    }


def shape_document(shape: ComplexArray, channels: Sequence[str]) -> dict[str, list[float]]:
    """Return a shape as [real, imaginary] per channel."""
    return {name: [float(v.real), float(v.imag)] for name, v in zip(channels, shape, strict=True)}


def _comparison_document(compared: Comparison) -> dict[str, Any]:
    """Return the estimates of each method for the modes of the reference, null where there is none."""
    names = [channel.name for channel in compared.reference.channels]
    return {
        "modes": {
            method: [None if m is None else mode_document(m, names) for m in modes]
            for method, modes in compared.modes.items()
        },
        "refused": dict(compared.refused),
    }
