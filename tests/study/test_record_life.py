"""The stress of a simulated jacket from eight accelerometers, through a twin on other feet.

``qualify/fatigue.py`` does it over states, seas, grounds and growths, with a twin that updates itself.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from numpy.testing import assert_allclose

from jackettwin.arrays import FloatArray
from jackettwin.decks import read_structure
from jackettwin.fatigue import count, equivalent_range
from jackettwin.response import Sensor, build_system, observation_matrix
from jackettwin.sensing import Weather, motion_from, readings_of, section_rows, sensed_model
from jackettwin.simulate import Scenario, read_scenario, simulate
from jackettwin.simulate.members import deflections
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.soil import read_support
from jackettwin.structure import Assembly, Rayleigh, assemble, section_forces
from jackettwin.study import readings_and_weather
from jackettwin.twin import read_twin

HEIGHTS_M = (144.0, 77.0, 41.0, 28.0)


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    path = tmp_path_factory.mktemp("jacket") / "parked.yaml"
    sensors = [
        {"channel": f"a{h:.0f}{axis}", "height_m": h, "direction": d, "noise": 3e-4}
        for h in HEIGHTS_M
        for axis, d in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
    ]
    scenario = {
        "structure": "jacket15",
        "support": "kelvin-voigt:k=1.2e9,c=2e7",
        "damping": {"rayleigh": {"ratio": 0.006, "frequency_hz": 0.3}},
        "water": {"depth_m": 72.0},
        "waves": {"type": "jonswap", "hs_m": 3.0, "tp_s": 8.0, "direction_deg": 30.0, "seed": 4},
        "wind": {"speed_m_s": 14.0, "turbulence": "B", "seed": 5},
        "rotor": {"data": "iea15", "state": "parked"},
        "time": {"duration_s": 300.0, "step_s": 0.05},
        "sensors": sensors,
    }
    path.write_text(yaml.safe_dump(scenario))
    return read_scenario(str(path))


@pytest.fixture(scope="module")
def truth(scenario: Scenario) -> FloatArray:
    """Both bending moments at the tower's base, (2, n): of the simulation, not of the estimator's model."""
    motion = simulate_motion(scenario)
    assembly = motion.model.assembly
    e = base(assembly)
    found = [section_forces(assembly, u, along=along) for u, along in deflections(scenario, motion)]
    return np.concatenate([[f.bending_y[:, e, 0], f.bending_z[:, e, 0]] for f in found], axis=1)


def base(assembly: Assembly) -> int:
    return [assembly.structure.members[m].name for m in assembly.mesh.member].index("tower_1")


def estimated(scenario: Scenario, sensors: tuple[Sensor, ...]) -> FloatArray:
    """Return both moments (2, n) by a twin on feet that are a third softer, with another damping."""
    assembly = assemble(scenario.asset.structure)
    support = read_support("kelvin-voigt:k=0.8e9,c=1e7", assembly.structure)
    system = build_system(assembly, support, rayleigh=Rayleigh.minimum(0.01, 0.3))
    record = simulate(scenario).record
    record = replace(record, data=record.data[: len(sensors)], channels=record.channels[: len(sensors)])
    weather = Weather.of(record.conditions, 72.0)
    assert weather.wave_period_s == pytest.approx(8.0)
    found = motion_from(sensed_model(system, weather), readings_of(record, sensors, assembly))
    rows = section_rows(found.model)
    e = base(assembly)
    return np.array([part[:, e, 0] @ found.mean().T for part in (rows.bending_y, rows.bending_z)])


def dels(moments: FloatArray) -> FloatArray:
    return np.array([equivalent_range(count(np.ascontiguousarray(row)), 4.0, 1.0) for row in moments])


def test_the_tower_base_is_known_through_wrong_feet(scenario: Scenario, truth: FloatArray) -> None:
    sensors = tuple(instrument.sensor for instrument in scenario.instruments)
    ratio = dels(estimated(scenario, sensors)) / dels(truth)
    # feet a third too soft put both first modes one per cent and the second ones some per cent too low
    assert ratio == pytest.approx([1.0, 1.0], abs=0.06)
    turned = tuple(replace(s, direction=tuple(-v for v in s.direction)) for s in sensors[2:4])
    # of the top pair alone the others leave no more than a twentieth
    wrong = dels(estimated(scenario, (*sensors[:2], *turned, *sensors[4:]))) / dels(truth)
    # two and a half times what sensors that point the right way may leave
    assert np.abs(wrong - 1.0).max() > 0.15


def test_channels_that_are_no_sensors_tell_the_weather(tmp_path: Path) -> None:
    """Temperature has no place, wind is the weather's; sensors point as the twin says."""
    twin, path = tmp_path / "twin.yaml", tmp_path / "record.csv"
    sensors = [
        {"channel": name, "height_m": 77.0, "direction": along}
        for name, along in (("b", [0, 1, 0]), ("a", [2, 0, 0]))
    ]
    twin.write_text(yaml.safe_dump({"structure": "jacket15", "sensors": sensors, "records": [path.name]}))
    t = np.arange(0.0, 60.0, 0.05)
    columns = [t, np.sin(t), np.cos(t), 9.0 + 0.0 * t, 12.0 + 0.0 * t]
    header = "time [s],a [m/s²],b [m/s²],air [°C],wind speed [m/s]"
    np.savetxt(path, np.stack(columns, axis=1), delimiter=",", header=header, comments="", fmt="%.9g")
    readings, weather = readings_and_weather(read_twin(twin), path)
    assert weather.wind_m_s == pytest.approx(12.0)
    assembly = assemble(read_structure("jacket15"))
    expected = observation_matrix(
        assembly, tuple(Sensor(n, d, height_m=77.0) for n, d in (("a", (1, 0, 0)), ("b", (0, 1, 0))))
    )
    assert_allclose(readings.rows, expected.toarray())
