"""Many identified records as plain JSON data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from jackettwin.errors import InputError
from jackettwin.identification import FusedIdentification, FusedMode, fuse
from jackettwin.identification.convergence import convergence
from jackettwin.identification.picks import plain_picks
from jackettwin.twin.document import identification_document
from jackettwin.twin.groups import Group, grouped
from jackettwin.twin.many import Failed, Seen


def many_document(seen: Sequence[Seen], failed: Sequence[Failed]) -> dict[str, Any]:
    """Return the document of ``jackettwin identify`` for several records: fused, by group, one by one."""
    warnings: list[str] = []
    found = [one.identification for one in seen]
    try:
        fused, groups = fuse(found), grouped(seen)
    except InputError as error:
        # loggers of different sensors: each stands for itself
        fused, groups = None, ()
        warnings.append(f"not fused: {error}")
    names = [] if fused is None else [channel.name for channel in fused.channels]
    modes = [] if fused is None else fused.modes
    return {
        "modes": [
            {
                **fused_mode_document(mode, names),
                "convergence": [asdict(step) for step in convergence(found, mode)],
            }
            for mode in modes
        ],
        "groups": [_group_document(group, seen) for group in groups],
        "records": [
            {**identification_document(one.identification, one.quality), "conditions": one.conditions}
            for one in seen
        ],
        "rejected": [
            {
                "record": one.identification.records[0],
                "frequency_hz": r.frequency_hz,
                "damping_ratio": r.damping_ratio,
                "reason": r.reason,
            }
            for one in seen
            for r in one.identification.rejected
        ],
        "quality": [
            {"record": one.identification.records[0], "score": one.quality.get("score")} for one in seen
        ],
        "picks": [pick for one in seen for pick in plain_picks(one.identification.picks)],
        "failed": [asdict(one) for one in failed],
        "duration_s": sum(one.duration_s for one in found),
        "warnings": [*warnings, *([] if fused is None else fused.warnings)],
    }


def fused_mode_document(mode: FusedMode, channels: Sequence[str]) -> dict[str, Any]:
    """Return one fused mode; the scatter is that between records beyond their own uncertainty."""
    return {
        "frequency_hz": mode.frequency_hz,
        "frequency_std_hz": mode.frequency_std_hz,
        "damping_ratio": mode.damping_ratio,
        "damping_ratio_std": mode.damping_ratio_std,
        "frequency_interval_95": mode.frequency_interval_95,
        "damping_ratio_interval_95": mode.damping_ratio_interval_95,
        "relative_scatter_frequency": mode.scatter_frequency,
        "relative_scatter_damping_ratio": mode.scatter_damping_ratio,
        "records_with_mode": len(mode.records),
        "mode_shape": {
            name: [float(v.real), float(v.imag)]
            for name, v in zip(channels, mode.mode_shape, strict=True)
            if v == v
        },
    }


def _group_document(group: Group, seen: Sequence[Seen]) -> dict[str, Any]:
    fused: FusedIdentification = group.fused
    names = [channel.name for channel in fused.channels]
    return {
        "wind_speed_m_s": group.wind_speed_m_s,
        "yaw_deg": group.yaw_deg,
        "state": group.state,
        "records": [seen[i].identification.records[0] for i in group.records],
        "duration_s": fused.duration_s,
        "modes": [fused_mode_document(mode, names) for mode in fused.modes],
    }
