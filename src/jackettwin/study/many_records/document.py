"""Many identified records as plain JSON data; lists that grow with their number are streamed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from jackettwin.files import Streamed, named
from jackettwin.identification import (
    FusedIdentification,
    FusedMode,
    channels_document,
    convergence,
    identification_document,
)
from jackettwin.identification.picks import plain_picks
from jackettwin.study.document import MODAL
from jackettwin.study.many_records.groups import RecordGroup
from jackettwin.study.many_records.identify import Batch
from jackettwin.study.many_records.summary import FusedBatch


def many_document(batch: Batch, together: FusedBatch) -> dict[str, Any]:
    """Return the document of ``jackettwin identify`` for several records: fused, by group, and each record.

    ``records``, ``rejected``, ``quality`` and ``picks`` are ``Streamed``.
    """
    return {
        "modes": [] if together.fused is None else _modes(together.fused),
        "groups": [_group_document(group) for group in together.groups],
        "records": Streamed(lambda: _records(batch)),
        "rejected": Streamed(lambda: _rejected(batch)),
        "quality": Streamed(
            lambda: (
                {"record": one.identification.records[0], "score": one.quality.get("score")} for one in batch
            )
        ),
        "picks": Streamed(lambda: (pick for one in batch for pick in plain_picks(one.identification.picks))),
        "failed": [asdict(one) for one in batch.failed],
        "records_identified": len(batch),
        "duration_s": together.duration_s,
        "channels": {} if together.fused is None else channels_document(together.fused.channels),
        "warnings": [*map(str, batch.findings), *together.warnings],
    }


def _modes(fused: FusedIdentification) -> list[dict[str, Any]]:
    names = [channel.name for channel in fused.channels]
    return [
        {
            **fused_mode_document(mode, names),
            "convergence": [asdict(step) for step in convergence(mode)] if mode.uncertainty_known else [],
        }
        for mode in fused.modes
    ]


def _records(batch: Batch) -> Iterator[dict[str, Any]]:
    for one in batch:
        yield identification_document(one.identification, one.quality, one.conditions)


def _rejected(batch: Batch) -> Iterator[dict[str, Any]]:
    for one in batch:
        for r in one.identification.rejected:
            rejected = named(r, "frequency_hz", "damping_ratio", "reason", "status")
            yield {"record": one.identification.records[0], **rejected}


def fused_mode_document(mode: FusedMode, channels: Sequence[str]) -> dict[str, Any]:
    """Return one fused mode; the scatter is that between records in excess of their uncertainty.

    Where no record states its uncertainty, intervals and scatter are None.
    """
    numbers = {
        **named(mode, *MODAL, "frequency_interval_90", "damping_ratio_interval_90"),
        "relative_scatter_frequency": mode.scatter_frequency,
        "relative_scatter_damping_ratio": mode.scatter_damping_ratio,
    }
    known = ("frequency_hz", "damping_ratio")
    return {
        **{k: v if mode.uncertainty_known or k in known else None for k, v in numbers.items()},
        "status": mode.status.value,
        "status_reason": mode.status_reason,
        "records_with_mode": len(mode.sightings),
        "records_ok": mode.records_ok,
        "mode_shape": {
            name: [float(v.real), float(v.imag)]
            for name, v in zip(channels, mode.mode_shape, strict=True)
            if v == v
        },
    }


def _group_document(group: RecordGroup) -> dict[str, Any]:
    fused: FusedIdentification = group.fused
    names = [channel.name for channel in fused.channels]
    return {
        "wind_speed_m_s": group.wind_speed_m_s,
        "yaw_deg": group.yaw_deg,
        "state": group.state,
        "records": list(fused.records),
        "duration_s": fused.duration_s,
        "modes": [fused_mode_document(mode, names) for mode in fused.modes],
    }
