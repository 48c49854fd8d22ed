"""Sea and rotor make peaks between the modes of simulated jackets; none of them is called ok.

``qualify/simulated_jackets.py`` does the same over many jackets, seas, winds and states.
"""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from jackettwin.identification import IdentificationSettings, examine
from jackettwin.records import Record
from jackettwin.simulate import read_scenario, simulate

EXAMPLE = Path(__file__).parents[2] / "examples" / "three_leg_jacket.yaml"
SEA = {"type": "jonswap", "spreading": 10}
CASES = {
    # forces of waves that fit the distance of the legs: peaks at 0.31 and 0.74 Hz, modes at 0.23 and 0.94 Hz
    "sea": {
        "structure": str(EXAMPLE),
        "support": "kelvin-voigt:k=1e9,c=1.3e7",
        "water": {"depth_m": 45.0},
        "waves": {**SEA, "hs_m": 1.7, "tp_s": 5.15, "direction_deg": 39.5, "seed": 43910},
        "wind": {"speed_m_s": 9.3, "turbulence": "C", "seed": 203241},
        "rotor": {"data": "none"},
    },
    # blades that turn through gusts: broad peaks at 3P = 0.378 and 6P = 0.756 Hz
    "rotor": {
        "structure": "jacket15",
        "support": "kelvin-voigt:k=1.35e9,c=1.5e7",
        "water": {"depth_m": 72.0},
        "waves": {**SEA, "hs_m": 3.5, "tp_s": 8.1, "direction_deg": 93.0, "seed": 5},
        "wind": {"speed_m_s": 15.5, "turbulence": "C", "seed": 7},
        "rotor": {"data": "iea15", "state": "operating"},
    },
}
LEVELS_M = {"sea": (119.0, 70.0), "rotor": (144.0, 95.0)}


@pytest.mark.parametrize("case", list(CASES))
def test_what_is_called_ok_is_a_mode(case: str, tmp_path: Path) -> None:
    scenario = {
        **CASES[case],
        "gravity": True,
        "damping": {"rayleigh": {"ratio": 0.005, "frequency_hz": 0.3}},
        "time": {"duration_s": 600.0},
        "sensors": [
            {"channel": f"acc_{h:.0f}_{axis}", "height_m": h, "direction": d, "noise": 1e-3}
            for h in LEVELS_M[case]
            for axis, d in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
        ],
    }
    path = tmp_path / "scenario.yaml"
    path.write_text(yaml.safe_dump(scenario))
    only_modes_are_ok(simulate(read_scenario(str(path))).record)


def test_what_is_called_ok_of_the_shipped_parked_turbine_is_a_mode() -> None:
    """The sea makes a broad peak at 0.43 Hz, and the second pair was told three times."""
    ok = only_modes_are_ok(simulate(read_scenario("parked")).record)
    assert sum(0.7 < f < 0.8 for f in ok) <= 2


def only_modes_are_ok(record: Record) -> list[float]:
    """Return the frequencies of what is called ok [Hz], all near one of the structure's."""
    true = [mode["frequency_hz"] for mode in record.metadata["true_modes"]]
    ok = [
        m.frequency_hz
        for m in examine(record, IdentificationSettings()).identification.modes
        if m.status == "ok" and m.frequency_hz < 2.5
    ]
    apart = {round(f, 4): min(abs(f / t - 1.0) for t in true) for f in ok}
    assert max(apart.values()) < 0.03, apart
    assert len(ok) >= 2
    return ok
