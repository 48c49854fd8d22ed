"""Whatever a text file says, its reader refuses it with an error of ours or reads it; nothing else leaves."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from mutated_text import mutated

from jackettwin.change.modal_table import read_modal_table
from jackettwin.decks import read_structure
from jackettwin.decks.blade_files import read_elastodyn_blade, read_flexible_rotor
from jackettwin.errors import JackettwinError
from jackettwin.loads.aerodynamics.turbine_files import read_rotor
from jackettwin.loads.members.hydrodyn_deck import read_hydrodyn
from jackettwin.loads.sea.given_waves import read_elevation
from jackettwin.records import read_record
from jackettwin.simulate.scenario.files import read_scenario
from jackettwin.simulate.scenario.sets import read_set
from jackettwin.soil.files import read_support
from jackettwin.soil.foundation import read_foundation
from jackettwin.structure import Section, Structure
from jackettwin.structure.model import STEEL, Member, Reaction
from jackettwin.study.refinement import read_refinement
from jackettwin.twin import read_twin
from jackettwin.twin.targets_table import read_targets_table

ROOT = Path(__file__).parents[1]
SHIPPED, PUBLIC = ROOT / "src/jackettwin/data", ROOT / "tests/data"
TUBE = Section(1.0, 0.02)
FRAME = Structure(
    "frame",
    {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.0, 40.0), "c": (8.0, 0.0, 10.0), "d": (0.0, 0.0, 10.0)},
    tuple(
        Member(name, *ends, TUBE, TUBE, STEEL) for name, ends in (("leg", "ab"), ("brace", "cd"), ("x", "ca"))
    ),
    reactions=(Reaction("a"),),
    sea_level_z_m=30.0,
)
TIME_S = 0.05 * np.arange(100)

SUPPORT = """supports:
  - nodes: [a]
    stiffness: [1e8, 2e8, 3e8]
    law: {type: kelvin-voigt, tau_s: 0.02}
  - nodes: [a]
    stiffness: [1e8, 1e8, 1e9, 1e10, 1e10, 1e9]
    law: {type: maxwell, g0: 0.8, branches: [{g: 0.4, tau_s: 0.1}]}
"""
BLADE = """------- ELASTODYN INDIVIDUAL BLADE INPUT FILE -----
3   NBlInpSt    - Number of blade input stations (-)
0.48  BldFlDmp(1) - Blade flap mode #1 structural damping (%)
1   AdjBlMs     - Factor
---------------------- DISTRIBUTED BLADE PROPERTIES ----------------------------
    BlFract      PitchAxis      StrcTwst       BMassDen        FlpStff        EdgStff
      (-)           (-)          (deg)          (kg/m)         (Nm^2)         (Nm^2)
0.0 0.25 13.3 678.9 18110.0E6 18113.6E6
0.5 0.25 5.0 300.0 1000.0E6 3000.0E6
1.0 0.25 0.1 10.3 0.17E6 5.01E6
"""
TURBINE = """------- ELASTODYN INPUT FILE -----
3   NumBl - Number of blades
63  TipRad - Tip radius
1.5 HubRad - Hub radius
-5.0 OverHang
1.96 Twr2Shft
-5 ShftTilt
0 BlPitch(1)
-2.5 PreCone(1)
"blade.dat" BldFile(1)
"""
TWIN = """structure: jacket15
sensors:
  - {channel: a, height_m: 140.0, direction: [1, 0, 0]}
  - {channel: b, height_m: 77.0, direction: [0, 1, 0]}
targets:
  - mode: 1
    frequency_hz: 0.18
    frequency_std_hz: 0.001
    mode_shape: {a: 1.0, b: [0.3, 0.1]}
  - {frequency_hz: 0.74}
  - {rate_rad_s: 0.5, rate_std_rad_s: 0.1}
update: {mac_std: 0.02, starts: 3, laws: [zener], bounds: {k0: [1e8, 1e10]}}
"""
SETTINGS = """structure: jacket15
support: {tie: per-leg, shared: [c]}
records: [a.parquet]
identification: {max_order: 40}
"""
SIGNALS = "time [s];acc_top_x [m/s2];acc_top_y [m/s2]\n" + "".join(
    f"{t:.2f};{np.sin(t):.5f};{np.cos(t):.5f}\n" for t in TIME_S
)
MODES = """mode;frequency [Hz];std [Hz];damping [%]
1st FA;0,1819;0,0010;1,27
SS1;0,1838 ± 0,001;;
torsion;0,79;;
"""
HISTORY = "time,label,frequency_hz,damping_ratio,wind_speed\n" + "".join(
    f"2025-01-{1 + k:02d}T06:00:00Z,fore_aft_1,{0.18 + 1e-4 * k:.4f},0.01,{5 + k % 7}\n" for k in range(20)
)
WAVES = "time eta\n(s) (m)\n" + "".join(f"{t:.2f} {np.sin(t):.4f}\n" for t in TIME_S)


def _shipped(name: str) -> str:
    return (SHIPPED / name).read_text(encoding="utf-8")


READERS: dict[str, tuple[str, str, Callable[[Path], Any], int]] = {
    "structure.yaml": (
        (ROOT / "examples/three_leg_jacket.yaml").read_text(),
        "structure",
        read_structure,
        60,
    ),
    "hydrodyn.dat": (
        (PUBLIC / "hydrodyn/members.dat").read_text(),
        "HydroDyn",
        lambda path: read_hydrodyn(path, FRAME, density_kg_m3=1025.0),
        60,
    ),
    "blade.dat": (BLADE, "ElastoDyn's blade", lambda path: read_elastodyn_blade(path, length=60.0), 80),
    "turbine.dat": (TURBINE, "ElastoDyn", read_flexible_rotor, 60),
    "rotor.yaml": (_shipped("rotors/iea15.yaml"), "windIO", read_rotor, 3),
    "blades.yaml": (_shipped("rotors/iea15.yaml"), "windIO's blades", read_flexible_rotor, 3),
    "foundation.yaml": (_shipped("foundations/jacket15_records.yaml"), "soil", read_foundation, 60),
    "support.yaml": (SUPPORT, "supports", lambda path: read_support(path, FRAME), 80),
    "signals.csv": (SIGNALS, "record", read_record, 60),
    "twin.yaml": (TWIN, "twin", read_twin, 40),
    "settings.yaml": (SETTINGS, "twin of records", read_twin, 40),
    "modes.csv": (MODES, "targets", read_targets_table, 80),
    "history.csv": (HISTORY, "modes through time", read_modal_table, 40),
    "scenario.yaml": (_shipped("scenarios/parked.yaml"), "scenario", read_scenario, 6),
    "set.yaml": (_shipped("sets/demo.yaml"), "set", read_set, 40),
    "waves.csv": (WAVES, "elevation", read_elevation, 40),
    "refine.yaml": ((ROOT / "examples/refine_jacket15.yaml").read_text(), "refinement", read_refinement, 40),
}
"""File name: (a good text, what it is, its reader, how many mutations a few seconds allow)."""


@pytest.mark.parametrize("name", READERS)
def test_no_error_but_ours_leaves_a_reader(name: str, tmp_path: Path) -> None:
    text, _, read, examples = READERS[name]
    (tmp_path / "blade.dat").write_text(BLADE)
    path = tmp_path / name

    @settings(max_examples=examples, deadline=None, suppress_health_check=list(HealthCheck), database=None)
    @given(seed=st.integers(0, 2**31))
    def mutate(seed: int) -> None:
        path.write_bytes(mutated(text, random.Random(seed)))
        try:
            read(path)
        except JackettwinError as error:
            assert str(error)

    path.write_text(text, encoding="utf-8")
    read(path)  # as it stands, it is read
    mutate()
