"""Many records together: their modes tracked once, then fused over all records and by group."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.errors import InputError
from jackettwin.identification import FusedIdentification, fused_records
from jackettwin.identification.many_records.tracking import follow
from jackettwin.study.many_records.groups import RecordGroup, group_key, grouped
from jackettwin.study.many_records.identify import Batch


@dataclass(frozen=True)
class FusedBatch:
    """Records of a batch, fused.

    Attributes
    ----------
    fused : FusedIdentification or None
        None if the records share no sensors, which ``warnings`` state.
    groups : of similar wind speed, yaw and state
    duration_s : of all records
    """

    fused: FusedIdentification | None
    groups: tuple[RecordGroup, ...]
    warnings: tuple[str, ...]
    duration_s: float


def fuse_batch(batch: Batch) -> FusedBatch:
    """Return the fused modes of a batch's records; each record is read once."""
    try:
        followed = follow((one.identification, group_key(one.conditions)) for one in batch)
    except InputError as error:
        alone = sum(one.identification.duration_s for one in batch)
        return FusedBatch(None, (), (f"not fused: {error}",), alone)
    fused = fused_records(followed)
    return FusedBatch(fused, grouped(followed), fused.warnings, fused.duration_s)
