"""The page on many records: what it draws is what was fused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from tests.support.sightings import sightings

from jackettwin.identification import fuse
from jackettwin.identification.estimate import ModalEstimate
from jackettwin.identification.many_records.fusion import FusedMode
from jackettwin.report.figures.tracks import MOST_POINTS, tracks
from jackettwin.report.pages.many_records import build_many_page
from jackettwin.study.many_records.summary import FusedBatch
from jackettwin.twin.observe_files import Failed


def seen_often(n: int) -> FusedMode:
    """Return a mode of 1 Hz and 1 % that swings by a tenth over the records."""
    f = 1.0 + 0.1 * np.sin(np.linspace(0.0, 2.0 * np.pi, n))
    one = np.diag([0.01**2, 0.2**2])
    estimates = [ModalEstimate(v, 0.01, np.ones(1, complex), 1.0, 0.0, 1.0).with_covariance(one) for v in f]
    return FusedMode(
        1.0, 0.01, 0.001, 1e-4, (0.99, 1.01), (0.009, 0.011), one, np.ones(1, complex), 0.0, 0.0,
        sightings(estimates, [600.0] * n),
    )  # fmt: skip


def test_every_record_is_drawn_with_its_interval() -> None:
    mode = seen_often(5)
    f, zeta = tracks([("mode_1", mode)], [f"r{i}" for i in range(5)]).data
    np.testing.assert_allclose(f.y, mode.sightings.frequency_hz)
    np.testing.assert_allclose(zeta.y, 1.0)  # %
    np.testing.assert_allclose(zeta.error_y.array, np.exp(stats.norm.ppf(0.95) * 0.2) - 1.0, rtol=1e-6)
    assert list(f.customdata) == ["r0", "r1", "r2", "r3", "r4"]


def test_a_year_is_drawn_as_medians_that_still_show_the_swing() -> None:
    n = 20 * MOST_POINTS
    f, _ = tracks([("mode_1", seen_often(n))], [f"r{i}" for i in range(n)]).data
    assert len(f.x) == MOST_POINTS // 2
    assert max(f.y) == pytest.approx(1.1, abs=1e-4)
    assert f.customdata[0] == "r0 to r39"


def test_page_names_modes_failures_and_warnings(identifications, tmp_path: Path) -> None:
    fused = fuse(identifications)
    together = FusedBatch(fused, (), ("beware",), fused.duration_s)
    path = build_many_page(together, (Failed("r9.csv", "no such file"),), tmp_path / "many.html")
    text = path.read_text(encoding="utf-8")
    for said in ("mode 1", "beware", "r9.csv", "no such file", f"{fused.modes[0].frequency_hz:.4f}"):
        assert said in text


def test_records_that_cannot_be_fused_still_have_a_page(tmp_path: Path) -> None:
    path = build_many_page(
        FusedBatch(None, (), ("not fused: other sensors",), 600.0), (), tmp_path / "m.html"
    )
    assert "other sensors" in path.read_text(encoding="utf-8")
