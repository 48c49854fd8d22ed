"""Which level to expect of OpenFAST: closed forms of the scatter, and the page that the ratios come from."""

import re
from pathlib import Path

import numpy as np
import pytest

from jackettwin.simulate import read_scenario, simulate
from jackettwin.simulate.level import BESIDE_OPENFAST, BETWEEN, FIRST, band_rms, expected

PAGE = Path(__file__).parents[2] / "docs" / "verification" / "response_level.md"
TITLES = {FIRST: "the first pair", BETWEEN: "between the modes"}


def test_the_ratios_are_those_of_the_page() -> None:
    """The page is what qualify/response_level.py measured."""
    page = PAGE.read_text(encoding="utf-8")
    for (band, direction), ratio in BESIDE_OPENFAST.items():
        side = direction.replace("_", "-")
        table = re.search(rf"{TITLES[band]}, {side}\*\*.*?\*\*([\d.]+)\*\* ± ([\d.]+)", page, re.DOTALL)
        assert table is not None
        assert ratio.mean == pytest.approx(float(table[1]), abs=0.005)
        assert ratio.std == pytest.approx(float(table[2]) / float(table[1]), abs=0.006)


def test_a_sine_has_its_root_mean_square() -> None:
    """Amplitude a gives a/√2 inside its band and nothing outside."""
    x = 3.0 * np.sin(2.0 * np.pi * 0.2 * np.arange(6000) * 0.05)
    assert band_rms(x, 0.05, (0.15, 0.25)) == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-12)
    assert band_rms(x, 0.05, (0.3, 0.6)) < 1e-12


def test_two_records_scatter_as_the_interval_says() -> None:
    """A mode of 1.5 % under white noise, 0.18 Hz, 600 s: nine of ten pairs of records within the interval.

    The interval is centred by the ratio; 1000 pairs count to ±1.5 % (two standard deviations of a share).
    """
    rng, T, step = np.random.default_rng(1), 600.0, 0.5
    f, f0, zeta = np.fft.rfftfreq(1200, step), 0.18, 0.015
    H = f**2 / (f0**2 - f**2 + 2j * zeta * f0 * f)
    noise = rng.standard_normal((2, 1000, f.size)) + 1j * rng.standard_normal((2, 1000, f.size))
    x = np.fft.irfft(H * noise, n=1200)
    here, there = ([band_rms(row, step, (0.8 * f0, 1.2 * f0)) for row in rows] for rows in (x[0], x[1]))
    ratio = BESIDE_OPENFAST[FIRST, "fore_aft"].mean
    limits = [expected(ratio * a, FIRST, "fore_aft", 2.0 * np.pi * zeta * f0 * T) for a in here]
    inside = np.mean([low < b < high for (low, high), b in zip(limits, there, strict=True)])
    # the ratio's own uncertainty (8 %) widens the interval beyond the scatter of two records (31 %)
    assert 0.89 < inside < 0.945


def test_a_record_says_which_level_to_expect(scenario_file) -> None:
    clock = {"duration_s": 120.0, "step_s": 0.05}
    wind = {"speed_m_s": 12.0, "seed": 1}
    keys = {"foundation": "jacket15_records", "wind": wind, "rotor": {"state": "parked"}, "time": clock}
    metadata = simulate(read_scenario(scenario_file(**keys))).record.metadata
    found = {(level["band"], level["direction"]): level for level in metadata["levels"]}
    assert set(found) == set(BESIDE_OPENFAST)
    assert metadata["levels_beyond_comparison"] == []
    for key, level in found.items():
        low, high = level["openfast_m_s2"]
        assert low < level["rms_m_s2"] / BESIDE_OPENFAST[key].mean < high
    first, between = (found[band, "fore_aft"]["openfast_m_s2"] for band in (FIRST, BETWEEN))
    assert first[1] / first[0] > between[1] / between[0]


def test_what_was_not_compared_is_said(scenario_file) -> None:
    clock = {"duration_s": 60.0, "step_s": 0.05}
    wind = {"speed_m_s": 25.0, "seed": 1, "piece_m": 20, "yaw_deg": 10}
    sea = {"type": "jonswap", "hs_m": 2.0, "tp_s": 8.0}
    keys = {"foundation": "jacket15_records", "wind": wind, "rotor": {"state": "idling"}, "waves": sea}
    metadata = simulate(read_scenario(scenario_file(**keys, time=clock))).record.metadata
    said = " ".join(metadata["levels_beyond_comparison"])
    for word in ("not parked", "8 to 16 m/s", "grid", "askew", "waves"):
        assert word in said
