"""A run's result as plain JSON data: the keys users script against."""

from __future__ import annotations

from typing import Any

from jackettwin.identification import Identification, ModalEstimate
from jackettwin.twin.observe import Observation
from jackettwin.twin.result import MeasuredMode, TwinResult
from jackettwin.twin.truth import truth_document
from jackettwin.updating import Update
from jackettwin.updating.budget import SOURCES, beyond_literature, damping_budget
from jackettwin.updating.update import log_covariance
from jackettwin.version import __version__


def run_document(result: TwinResult, *, report: str | None) -> dict[str, Any]:
    """Return the document of ``jackettwin run``."""
    return {
        "name": result.name,
        "modes": [_measured(m) for m in result.measured],
        "updates": [update_document(result, i) for i in range(len(result.updates))],
        "identification": [
            observation_document(seen, names)
            for seen, names in zip(result.observations, result.names, strict=True)
        ],
        "unpaired_modes": [mode_document(e, None) for e in result.unpaired],
        "assumptions": list(result.assumptions),
        "warnings": list(result.warnings),
        "truth": truth_document(result),
        "report": report,
        "code_version": __version__,
    }


def update_document(result: TwinResult, index: int) -> dict[str, Any]:
    """Return the document of one law of ``jackettwin update``."""
    u = result.updates[index]
    names = [p.name for p in u.model.parameters]
    stds = (
        [None] * len(names)
        if u.log_std is None
        else [float(v * s) for v, s in zip(u.best.theta, u.log_std, strict=True)]
    )
    return {
        "law": u.law,
        "parameters": {
            name: {"value": float(value), "std": std, "interval_90": interval, "unit": p.unit}
            for name, p, value, std, interval in zip(
                names, u.model.parameters, u.best.theta, stds, u.interval_90(), strict=True
            )
        },
        "modes": _compared(result.measured, u),
        "solutions": [
            {
                "parameters": dict(zip(names, map(float, s.theta), strict=True)),
                "cost": s.cost,
                "locked_damper": s.locked_damper,
                "frequency_hz": s.frequency_hz,
                "undamped_frequency_hz": s.undamped_hz,
                "damping_ratio": s.damping_ratio,
                "at_bound": list(s.at_bound),
                "starts_that_ended_here": s.found,
            }
            for s in u.solutions
        ],
        "identifiability": dict(zip(names, u.identifiability(), strict=True)),
        "log_evidence": None,
        "damping_budget": _budget(result.measured, u),
        "real_poles_rad_s": u.modes.damped.real_poles,
        "reference_frequency_hz": u.model.reference_hz,
        "unexplained_damping": [
            {
                "label": e.label,
                "measured_damping_ratio": e.measured,
                "measured_damping_ratio_std": e.measured_std,
                "damping_ratio": e.model,
                "excess": e.measured - e.model,
                "explained": e.explained,
            }
            for e in result.excess[index]
        ],
    }


def _measured(m: MeasuredMode) -> dict[str, Any]:
    return {
        "mode": m.mode,
        "label": m.label,
        "frequency_hz": m.frequency_hz,
        "frequency_std_hz": m.frequency_std_hz,
        "damping_ratio": m.damping_ratio,
        "damping_ratio_std": m.damping_ratio_std,
        "mac": m.mac,
        "fits_frequency": m.fits_frequency,
        "fits_damping": m.fits_damping,
    }


def _budget(measured: tuple[MeasuredMode, ...], u: Update) -> list[dict[str, Any]]:
    """Return each mode's damping ratio by source; water is not modelled, so its part is not known."""
    covariance = None if u.residuals.relative else log_covariance(u.model, u.residuals, u.best.theta)
    budget = damping_budget(u.model, u.best.theta, u.residuals.modes, log_covariance=covariance)
    intervals = budget.share_interval_90
    return [
        {
            "label": m.label,
            "damping_ratio": {**dict(zip(SOURCES, budget.damping_ratio[i], strict=True)), "water": None},
            "beyond_literature": beyond_literature(
                m.label, dict(zip(SOURCES, map(float, budget.damping_ratio[i]), strict=True))
            ),
            "share": {**dict(zip(SOURCES, budget.share[i], strict=True)), "water": None},
            "share_interval_90": None
            if intervals is None
            else {**dict(zip(SOURCES, intervals[i].tolist(), strict=True)), "water": None},
        }
        for i, m in enumerate(measured)
    ]


def _compared(measured: tuple[MeasuredMode, ...], u: Update) -> list[dict[str, Any]]:
    return [
        {
            "mode": m.mode,
            "label": m.label,
            "measured_frequency_hz": m.frequency_hz,
            "frequency_hz": float(f),
            "undamped_frequency_hz": float(undamped),
            "measured_damping_ratio": m.damping_ratio,
            "damping_ratio": float(zeta),
        }
        for m, f, undamped, zeta in zip(
            measured, u.modes.frequency_hz, u.modes.undamped_hz, u.modes.damping_ratio, strict=True
        )
    ]


def observation_document(seen: Observation, labels: tuple[str, ...] | None = None) -> dict[str, Any]:
    """Return the document of one record of ``jackettwin identify``, with the model's labels if given."""
    document = identification_document(seen.identification, seen.quality.summary())
    if labels is not None:
        for mode, label in zip(document["modes"], labels, strict=True):
            mode["label"] = label or None
    return document | {"conditions": dict(seen.record.conditions)}


def identification_document(found: Identification, quality: dict[str, Any]) -> dict[str, Any]:
    """Return the modes of one record, what was rejected, the settings used and the record's quality."""
    names = [channel.name for channel in found.channels]
    s = found.settings
    return {
        "records": list(found.records),
        "modes": [mode_document(m, names) for m in found.modes],
        "rejected": [
            {"frequency_hz": r.frequency_hz, "damping_ratio": r.damping_ratio, "reason": r.reason}
            for r in found.rejected
        ],
        "settings": {
            "lowest_frequency_hz": s.lowest_frequency_hz,
            "highest_frequency_hz": s.highest_frequency_hz,
            "sample_rate_hz": s.sample_rate_hz,
            "block_rows": s.block_rows,
            "lag_window_s": s.lag_window_s,
            "orders": list(s.orders),
        },
        "duration_s": found.duration_s,
        "quality": quality,
        "warnings": list(found.warnings),
    }


def mode_document(m: ModalEstimate, channels: list[str] | None) -> dict[str, Any]:
    """Return one identified mode; shapes as [real, imaginary] a channel."""
    document: dict[str, Any] = {
        "frequency_hz": m.frequency_hz,
        "frequency_std_hz": m.frequency_std_hz,
        "damping_ratio": m.damping_ratio,
        "damping_ratio_std": m.damping_ratio_std,
        "frequency_interval_95": m.frequency_interval_95,
        "damping_ratio_interval_95": m.damping_ratio_interval_95,
        "mpc": m.mpc,
        "method": m.method,
        "status": m.status,
    }
    if channels is not None:
        document["mode_shape"] = {
            name: [float(v.real), float(v.imag)] for name, v in zip(channels, m.mode_shape, strict=True)
        }
    return document
