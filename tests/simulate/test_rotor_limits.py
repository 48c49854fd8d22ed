"""Rotors that fit the asset, rotors that do not, and none."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads import read_rotor
from jackettwin.loads.aerodynamics.rotor import rotor_loads
from jackettwin.loads.aerodynamics.wind import TOWER_DRAG
from jackettwin.simulate import loads_document, read_scenario, simulate
from jackettwin.simulate.scenario.air import likely_factor, lowest_tip, rotor_notes

WIND = "structure: jacket15\nsupport: pinned\nwind: {speed_m_s: 12, turbulence: none, shear: 0.0}\n"
BRIEF = "time: {duration_s: 10, step_s: 0.05}\n"


@pytest.fixture
def written(tmp_path: Path) -> Callable[[str], Path]:
    def write(text: str) -> Path:
        path = tmp_path / "scenario.yaml"
        path.write_text(WIND + BRIEF + text, encoding="utf-8")
        return path

    return write


def test_the_lowest_tip_of_a_turn_is_the_lowest_of_all_stands() -> None:
    """And without tilt, cone and prebend it is one radius under the hub."""
    rotor, _ = read_rotor("iea15")
    stands = [lowest_tip(rotor, np.pi / 2, azimuth=float(psi)) for psi in np.linspace(0.0, 2.0, 2001)]
    # 1e-3 rad of azimuth are 120 m · (1e-3)²/2 of height
    assert lowest_tip(rotor, np.pi / 2, azimuth=None) == pytest.approx(min(stands), abs=1e-3)
    straight = replace(
        rotor, tilt=0.0, cone=0.0, blade=replace(rotor.blade, prebend=np.zeros_like(rotor.blade.z))
    )
    assert lowest_tip(straight, 0.0, azimuth=None) == pytest.approx(rotor.hub_height - straight.radius)
    assert lowest_tip(straight, 0.0, azimuth=np.pi) == pytest.approx(rotor.hub_height - straight.radius)
    assert lowest_tip(straight, 0.0, azimuth=0.0) == pytest.approx(rotor.hub_height - 0.5 * straight.radius)


@pytest.mark.parametrize("rotor", ["azimuth_deg: 60", "state: idling", "state: operating"])
def test_tips_in_the_water_are_refused(written: Callable[[str], Path], rotor: str) -> None:
    """A turbine of 107 m under a rotor of 120 m; parked with one blade up it just stands clear."""
    path = written(f"rotor: {{data: iea15, {rotor}}}\n")
    low = path.with_name("low.yaml")
    low.write_text(LOW, encoding="utf-8")
    path.write_text(path.read_text().replace("jacket15", "low.yaml"), encoding="utf-8")
    with pytest.raises(InputError, match="a blade tip touches the water"):
        read_scenario(path)
    path.write_text(path.read_text().replace(rotor, "azimuth_deg: 0"), encoding="utf-8")
    assert read_scenario(path).turbine is not None


def test_wind_on_the_tower_alone(written: Callable[[str], Path]) -> None:
    """Drag of a steady wind on a cylinder of mean diameter: ½ρ C_D D L u² (within the taper's share)."""
    path = written("rotor: {data: none}\n")
    scenario = read_scenario(path)
    assert scenario.turbine is None
    assert scenario.air is not None
    assert scenario.air.wind.hub_height_m == pytest.approx(144.0)
    document = loads_document(scenario)
    assert document["warnings"] == []
    tower = [m for m in scenario.asset.structure.members if m.part == "tower"]
    nodes = scenario.asset.structure.nodes
    area = sum(
        0.5
        * (m.section_start.outer_diameter_m + m.section_end.outer_diameter_m)
        * (nodes[m.end][2] - nodes[m.start][2])
        for m in tower
    )
    assert document["force_n"]["x"]["mean"] == pytest.approx(
        0.5 * 1.225 * TOWER_DRAG * area * 12.0**2, rel=0.01
    )
    record = simulate(scenario).record
    assert record.conditions["rotor"] is None
    assert np.isfinite(record.data).all()


def test_a_rotor_nobody_chose_is_named(written: Callable[[str], Path]) -> None:
    assert "the wind blows on iea15, parked" in loads_document(read_scenario(written("")))["warnings"][0]
    assert loads_document(read_scenario(written("rotor: {data: iea15}\n")))["warnings"] == []


@pytest.mark.parametrize(("mass_kg", "radius_m", "rtol"), [(350e3, 63.0, 0.005), (674e3, 89.2, 0.09)])
def test_a_rotor_nobody_chose_fits_the_mass_on_the_tower(
    mass_kg: float, radius_m: float, rtol: float
) -> None:
    """NREL 5 MW (Jonkman et al. 2009, NREL/TP-500-38060) and DTU 10 MW (Bak et al. 2013, DTU I-0092)."""
    rotor, control = read_rotor("iea15")
    factor = likely_factor(mass_kg)
    assert rotor.scaled(factor).radius == pytest.approx(radius_m, rel=rtol)
    tip_speed = rotor.radius * control.highest_speed_rad_s
    assert rotor.scaled(factor).radius * control.scaled(factor).highest_speed_rad_s == pytest.approx(
        tip_speed
    )
    assert likely_factor(809e3) == likely_factor(0.0) == 1.0


def test_loads_of_a_scaled_rotor_are_those_of_a_similar_one() -> None:
    """Forces grow with the area, moments with the volume; a shaft at the same tip speed turns slower."""
    rotor, _ = read_rotor("iea15")
    own = {"wind": np.array([9.0, 3.0, 0.5]), "pitch": 0.3, "azimuth": 0.4}
    large = rotor_loads(rotor, **own, rotor_speed=0.6)
    small = rotor_loads(rotor.scaled(0.5), **own, rotor_speed=1.2)
    np.testing.assert_allclose(small, large * np.repeat([0.25, 0.125], 3), rtol=1e-12)


@pytest.mark.parametrize("state", ["parked", "idling"])
def test_a_small_structure_gets_a_small_rotor_and_says_so(written: Callable[[str], Path], state: str) -> None:
    path = written(f"rotor: {{state: {state}}}\n")
    path.with_name("low.yaml").write_text(
        LOW + "rna: {mass_kg: 350000.0, cg_offset_m: [-2, 0, 2]}\n", encoding="utf-8"
    )
    path.write_text(path.read_text().replace("jacket15", "low.yaml"), encoding="utf-8")
    scenario = read_scenario(path)
    (note,) = loads_document(scenario)["warnings"]
    assert f"iea15 × 0.52, {state}, scaled by (mass of rotor and nacelle / 948 t)^0.65, radius 63.0 m" in note
    assert scenario.turbine is not None and scenario.turbine.rotor.radius == pytest.approx(63.0, rel=0.005)


@pytest.mark.parametrize(
    ("speed", "state", "said"), [(26, "operating", 1), (12, "operating", 0), (26, "idling", 0)]
)
def test_production_beyond_cut_out_is_named(
    written: Callable[[str], Path], speed: int, state: str, said: int
) -> None:
    path = written(f"rotor: {{data: iea15, state: {state}}}\n")
    path.write_text(path.read_text().replace("speed_m_s: 12", f"speed_m_s: {speed}"), encoding="utf-8")
    scenario = read_scenario(path)
    notes = rotor_notes(scenario.air, scenario.turbine)
    assert len(notes) == said
    assert all("cut-in and cut-out of 3 and 25 m/s" in note for note in notes)


def test_no_rotor_has_no_state(written: Callable[[str], Path]) -> None:
    with pytest.raises(InputError, match=r"rotor\.state: there is no rotor"):
        read_scenario(written("rotor: {data: none, state: operating}\n"))


LOW = """
sections: {tube: {outer_diameter_m: 6.0, thickness_m: 0.06}}
nodes: {a: [0, 0, -20], b: [0, 0, 105]}
members: [{nodes: [a, b], section: tube, part: tower}]
reaction_nodes: [a]
"""
