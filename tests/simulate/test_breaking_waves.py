"""Waves that break: the limit on both sides, what slams, what is left out of the loads."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from jackettwin.loads import Coefficients, highest_wave, slam_per_length, wave_number
from jackettwin.loads.sea.given_kinematics import Kinematics
from jackettwin.loads.sea.given_waves import Elevation
from jackettwin.simulate.breaking_waves import breaking_document
from jackettwin.simulate.scenario.sea import Sea, sea_warnings
from jackettwin.structure import STEEL, Member, Reaction, Section, Structure

TUBE, LEG = Section(0.6, 0.02), Section(3.0, 0.05)
DEPTH, PERIOD = 20.0, 9.0


@pytest.fixture
def frame() -> Structure:
    """Two legs, joined by a beam 1 m above still water and by one 8 m above it."""
    nodes, members = {}, []
    for side, x in (("left", 0.0), ("right", 15.0)):
        levels = {"foot": -DEPTH, "low": 1.0, "high": 8.0}
        nodes |= {f"{side} {name}": (x, 0.0, z) for name, z in levels.items()}
        for a, b in (("foot", "low"), ("low", "high")):
            members.append(Member(f"{side} {b}", f"{side} {a}", f"{side} {b}", LEG, LEG, STEEL))
    for name in ("low", "high"):
        members.append(Member(f"{name} beam", f"left {name}", f"right {name}", TUBE, TUBE, STEEL))
    return Structure(
        "frame", nodes, tuple(members), reactions=(Reaction("left foot"), Reaction("right foot"))
    )


def sea(height_m: float, waves: str = "airy") -> Sea:
    return Sea(DEPTH, Coefficients(), waves=waves, height_m=height_m, period_s=PERIOD)


def limit() -> float:
    return highest_wave(2.0 * pi / float(wave_number(2.0 * pi / PERIOD, DEPTH)), DEPTH)


@pytest.mark.parametrize(("share", "breaks"), [(0.99, False), (1.01, True)])
def test_limit_on_both_sides(frame: Structure, share: float, breaks: bool) -> None:
    found = breaking_document(sea(share * limit()), frame)
    assert found is not None
    assert found["limit_m"] == pytest.approx(limit())
    assert found["breaks"] is breaks
    assert (found["impact"] is not None) is breaks
    assert any("break" in text for text in sea_warnings(sea(share * limit()), frame)) is breaks


def test_random_waves_are_judged_by_their_highest(frame: Structure) -> None:
    """1.86 Hs: the most probable highest of a thousand."""
    for Hs, breaks in ((0.99 * limit() / 1.8585, False), (1.01 * limit() / 1.8585, True)):
        one = sea(Hs, "jonswap")
        found = breaking_document(one, frame)
        assert found is not None
        assert found["breaks"] is breaks
        assert any("highest waves" in text for text in sea_warnings(one, frame)) is breaks


def test_surface_rises_past_a_level_as_linear_waves_do(frame: Structure) -> None:
    """η = a cos ωt: |dη/dt| at η = z is ω√(a² − z²)."""
    found = breaking_document(sea(6.0), frame)
    assert found is not None
    (row,) = found["slammed"]
    assert row["member"] == "low beam"
    speed = 2.0 * pi / PERIOD * (3.0**2 - 1.0**2) ** 0.5
    assert row["speed_m_s"] == pytest.approx(speed)
    assert row["force_n_m"] == pytest.approx(slam_per_length(speed, 0.6, density_kg_m3=1025.0))


def test_levels_count_from_still_water(frame: Structure) -> None:
    raised = replace(frame, sea_level_z_m=7.5)
    found = breaking_document(sea(6.0), raised)
    assert found is not None
    assert [row["member"] for row in found["slammed"]] == ["high beam"]


def test_calm_water_does_not_break(frame: Structure) -> None:
    assert breaking_document(replace(sea(0.0), waves=None), frame) is None


def test_given_water_slams_at_its_own_speed(frame: Structure) -> None:
    """η = 3 sin ωt rises past 1 m at ω√(9 − 1); given kinematics by their own vertical velocity there."""
    omega, amplitude = 2.0 * pi / PERIOD, 3.0
    t = np.arange(0.0, 90.0, 0.02)
    eta = amplitude * np.sin(omega * t)
    elevation = Elevation(t, eta)
    given = replace(sea(6.0, "elevation"), elevation=elevation)
    (row,) = breaking_document(given, frame)["slammed"]
    assert row["member"] == "low beam"
    assert row["speed_m_s"] == pytest.approx(omega * np.sqrt(8.0), rel=1e-3)
    assert row["force_n_m"] == pytest.approx(slam_per_length(row["speed_m_s"], 0.6, density_kg_m3=1025.0))
    up = 0.5 * omega * amplitude * np.cos(omega * t)
    velocity = np.stack([np.zeros((t.size, 2)), np.stack([0.0 * up, up], axis=1)], axis=2)
    # at the upper level the whole, at the lower none: 1 m is half way
    moving = Kinematics(elevation, np.array([-3.0, 5.0]), velocity, np.zeros_like(velocity))
    (row,) = breaking_document(replace(given, waves="kinematics", kinematics=moving), frame)["slammed"]
    assert row["speed_m_s"] == pytest.approx(0.25 * omega * np.sqrt(8.0), rel=1e-3)
    # water that stays below, or only falls, slams nothing
    for low in (0.9 * eta / amplitude, np.linspace(2.0, -2.0, t.size)):
        still = replace(given, elevation=Elevation(t, low))
        assert breaking_document(still, frame)["slammed"] == []
