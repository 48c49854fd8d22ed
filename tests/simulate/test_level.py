"""Levels beside OpenFAST's: a closed form, and the page that the ratios come from."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import t

from jackettwin.intervals import NORMAL_90
from jackettwin.simulate import read_scenario, simulate
from jackettwin.simulate.level import (
    BESIDE_OPENFAST,
    BETWEEN,
    FIRST,
    FLANK,
    RECORDS,
    SECOND,
    band_rms,
    operating_levels,
)

PAGE = Path(__file__).parents[2] / "docs" / "verification" / "response_level.md"
TITLES = {
    FIRST: "the first pair",
    BETWEEN: "between the modes",
    SECOND: "the second pair",
    FLANK: "the lower flank of the second pair",
}


def test_the_ratios_are_those_of_the_page() -> None:
    """The page is what qualify/response_level.py measured."""
    page = PAGE.read_text(encoding="utf-8")
    for (band, direction), ratio in BESIDE_OPENFAST.items():
        side = direction.replace("_", "-")
        table = re.search(rf"{TITLES[band]}, {side}\*\*.*?\*\*([\d.]+)\*\* ± ([\d.]+)", page, re.DOTALL)
        assert table is not None
        assert ratio.mean == pytest.approx(float(table[1]), abs=0.005)
        assert ratio.std == pytest.approx(float(table[2]), abs=0.005)


def test_a_sine_has_its_root_mean_square() -> None:
    """Amplitude a gives a/√2 inside its band and nothing outside."""
    x = 3.0 * np.sin(2.0 * np.pi * 0.2 * np.arange(6000) * 0.05)
    assert band_rms(x, 0.05, (0.15, 0.25)) == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-12)
    assert band_rms(x, 0.05, (0.3, 0.6)) < 1e-12


def test_an_interval_is_students_of_seven_records() -> None:
    ratio = BESIDE_OPENFAST[FIRST, "fore_aft"]
    low, high = np.log(ratio.interval_90)
    assert 0.5 * (low + high) == pytest.approx(np.log(ratio.mean), abs=1e-12)
    assert high - low == pytest.approx(2.0 * t(RECORDS - 1).ppf(0.95) * ratio.std / ratio.mean, rel=1e-3)


def test_a_record_says_which_level_to_expect(scenario_file) -> None:
    clock = {"duration_s": 120.0, "step_s": 0.05}
    wind = {"speed_m_s": 12.0, "seed": 1}
    keys = {"foundation": "jacket15_records", "wind": wind, "rotor": {"state": "parked"}, "time": clock}
    metadata = simulate(read_scenario(scenario_file(**keys))).record.metadata
    found = {(level["band"], level["direction"]): level for level in metadata["levels"]}
    assert set(found) == set(BESIDE_OPENFAST)
    assert metadata["levels_beyond_comparison"] == []
    for key, level in found.items():
        assert level["ratio_to_openfast"] == BESIDE_OPENFAST[key].mean
        low, high = level["ratio_interval_90"]
        assert low < level["ratio_to_openfast"] < high


def test_what_was_not_compared_is_said(scenario_file) -> None:
    clock = {"duration_s": 60.0, "step_s": 0.05}
    wind = {"speed_m_s": 25.0, "seed": 1, "piece_m": 20, "yaw_deg": 10}
    sea = {"type": "jonswap", "hs_m": 2.0, "tp_s": 8.0}
    keys = {"foundation": "jacket15_records", "wind": wind, "rotor": {"state": "idling"}, "waves": sea}
    metadata = simulate(read_scenario(scenario_file(**keys, time=clock))).record.metadata
    assert all(level["ratio_to_openfast"] is None for level in metadata["levels"])
    said = " ".join(metadata["levels_beyond_comparison"])
    for word in ("not parked", "8 to 16 m/s", "grid", "askew", "waves"):
        assert word in said


def test_an_operating_rotor_s_level_follows_from_its_damping(scenario_file) -> None:
    """√(ζ of `operation` / ζ here); e^(1.645 · ½ · 0.2) wide fore-aft, by the page of operation."""
    keys = {"rotor": {"state": "operating"}, "wind": {"speed_m_s": 12.0, "seed": 1}, "support": "clamped"}
    scenario = read_scenario(scenario_file(**keys))
    found = operating_levels(scenario, {"fore_aft_1": 0.16, "side_side_1": 0.01})
    fore_aft = found["fore_aft"]
    assert 0.06 < fore_aft.expected_damping_ratio < 0.14  # bending blades: 11.9 % on jacket15's feet
    assert fore_aft.ratio == pytest.approx(np.sqrt(fore_aft.expected_damping_ratio / 0.16), rel=1e-12)
    low, high = fore_aft.ratio_interval_90
    assert (
        high / fore_aft.ratio == pytest.approx(fore_aft.ratio / low) == pytest.approx(np.exp(0.1 * NORMAL_90))
    )
    parked = read_scenario(scenario_file(wind={"speed_m_s": 12.0, "seed": 1}))
    assert operating_levels(parked, {"fore_aft_1": 0.16}) == {}
