"""A file of hours, identified whole from pieces, gives what its samples in one give."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, examine_file
from jackettwin.identification.long_record import read_whole
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record, write_record

QUICK = IdentificationSettings(blocks=0, refine=False)
F = np.array([0.2, 1.1, 8.0])


@pytest.fixture(scope="module")
def record() -> Record:
    """Return 80 minutes of three modes, one of them above the band."""
    shapes = np.array([[1.0, 0.5], [-0.5, 1.0], [0.8, 0.7]])
    system = ModalSystem(F, np.full(3, 0.01), shapes, np.diag([1.0, 0.5, 0.1]))
    return simulate(system, np.random.default_rng(3), duration_s=4800.0, sample_rate_hz=25.0)


def test_the_modes_are_those_of_the_samples_in_one(record: Record, tmp_path: Path) -> None:
    damaged = record.data.copy()
    damaged[0, [33_000, 70_000]] = 50.0 * damaged.std()  # two spikes, which the filter would smear
    path = tmp_path / "hours.parquet"
    write_record(replace(record, data=damaged, name="hours"), path)
    whole, inone = (examine_file(path, QUICK, whole=w) for w in (True, False))
    assert whole.record.sample_rate_hz < 13.0
    assert whole.record.duration_s == pytest.approx(record.duration_s, abs=0.2)
    f, other = (np.array([m.frequency_hz for m in s.identification.modes]) for s in (whole, inone))
    for true in F[:2]:  # a quick look finds others, too
        near, same = (x[np.argmin(np.abs(x - true))] for x in (f, other))
        assert near == pytest.approx(true, rel=5e-3)
        assert near == pytest.approx(same, rel=5e-4)
    (note,) = [note.text for note in whole.identification.notes if note.code == "peaks_above_band"]
    assert float(note.split("peak: ")[1].split(" Hz")[0]) == pytest.approx(F[2], rel=0.01)
    (spikes,) = [f for f in whole.quality.findings if f.code == "spikes"]
    assert spikes.params["share"] == pytest.approx(2 / record.data.shape[1], rel=1e-6)


def test_short_files_and_files_without_a_peak_are_read_as_they_are(
    record: Record, rng: np.random.Generator, tmp_path: Path
) -> None:
    path = tmp_path / "short.parquet"
    write_record(replace(record, data=record.data[:, :15_000]), path)
    assert read_whole(path, QUICK) is None
    write_record(replace(record, data=rng.standard_normal(record.data.shape)), path)
    assert read_whole(path, QUICK) is None
