"""The modes that a scenario states against those of its whole model, on five structures in water."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.optimize import linear_sum_assignment

from jackettwin.response.modes.modal import damped_modes
from jackettwin.response.modes.own_damping import own_damping
from jackettwin.response.reduction import FREQUENCY_ERROR
from jackettwin.response.system import build_system
from jackettwin.simulate import read_scenario
from jackettwin.simulate.motion.model import BAND_HZ, build_model, true_modes

ROOT = Path(__file__).parents[2]
SMALL = {
    "sea_level_z_m": 12.0,
    "jacket": {
        "lattice": {
            "legs": 3,
            "bays": 2,
            "base_width_m": 6.0,
            "top_width_m": 3.0,
            "height_m": 15.0,
            "leg_diameter_m": 0.4,
            "leg_thickness_bottom_m": 0.016,
            "leg_thickness_top_m": 0.012,
            "brace": {"outer_diameter_m": 0.25, "thickness_m": 0.008},
        },
        "transition_piece": {
            "top_z_m": 17.0,
            "tube": {"outer_diameter_m": 0.5, "thickness_m": 0.02},
            "column": {"outer_diameter_m": 1.5, "thickness_m": 0.02},
        },
        "tower": {
            "height_m": 22.0,
            "elements": 6,
            "bottom": {"outer_diameter_m": 1.5, "thickness_m": 0.012},
            "top": {"outer_diameter_m": 1.0, "thickness_m": 0.01},
        },
        "rna": {
            "mass_kg": 8000.0,
            "cg_offset_m": [0.0, 0.0, 0.5],
            "inertia_about_cg_kg_m2": [6e4, 4e4, 4e4, 0.0, 0.0, 0.0],
        },
    },
}
"""A small asset: five modes below the band, where a basis of a fixed frequency has few shapes."""
CASES = {
    "OC4 jacket": (ROOT / "qualify/decks/oc4_jacket.dat", 50.0, "kelvin-voigt:k=6e8,c=1.2e7"),
    "OC3 tripod": (ROOT / "qualify/decks/oc3_tripod.dat", 45.0, "kelvin-voigt:k=6e8,c=1.2e7"),
    "three legs": (ROOT / "examples/three_leg_jacket.yaml", 45.0, "kelvin-voigt:k=6e8,c=1.2e7"),
    "jacket15": ("jacket15", 72.0, "zener:k0=2.62e9,k1=8.65e8,c=9.99e9"),
    "small": ("small.yaml", 12.0, "kelvin-voigt:k=5e7,c=1e6"),
}


@pytest.fixture(params=CASES)
def case(request: pytest.FixtureRequest, scenario_file, tmp_path: Path):
    structure, depth, support = CASES[request.param]
    (tmp_path / "small.yaml").write_text(yaml.safe_dump(SMALL))
    growth = [{"top_z_m": 0.0, "bottom_z_m": -0.8 * depth, "thickness_m": 0.05}]
    water = {"depth_m": depth, "marine_growth": growth}

    def write(**damping) -> Path:
        return scenario_file(
            structure=str(structure), support=support, water=water, gravity=True, damping=damping
        )

    return write


def test_true_modes_are_those_of_the_whole_model(case) -> None:
    """Every mode below 5 Hz: |λ| to 1e-3, damping to a hundredth of itself.

    The basis is chosen for the undamped frequencies; a dashpot moves shapes, so that twice that is allowed.
    """
    scenario = read_scenario(case(rayleigh={"ratio": 0.005, "frequency_hz": 0.3}))
    model = build_model(scenario)
    asset, modes = scenario.asset, true_modes(model, below_hz=BAND_HZ)
    own = own_damping(model.assembly, asset.rayleigh)
    system = build_system(model.assembly, asset.support, rayleigh=asset.rayleigh, spread=own)
    # modes near the edge may fall on either side of it
    whole = damped_modes(system, below_hz=1.01 * BAND_HZ)
    f, zeta = np.array([(m.frequency_hz, m.damping_ratio) for m in modes]).T
    there = (whole.frequency_hz < 0.99 * BAND_HZ) & (whole.damping_ratio < 0.45)
    assert f.size >= np.count_nonzero(there) >= 4
    apart = np.abs(f[:, None] / whole.frequency_hz - 1.0) + np.abs(zeta[:, None] - whole.damping_ratio)
    mine, theirs = linear_sum_assignment(apart)
    np.testing.assert_allclose(f[mine], whole.frequency_hz[theirs], rtol=2.0 * FREQUENCY_ERROR)
    np.testing.assert_allclose(zeta[mine], whole.damping_ratio[theirs], rtol=0.01)


def test_coupled_damping_is_that_of_every_mode(case) -> None:
    """The steel gives all modes what it gives the first two, within a twentieth, third bending included.

    The two are tuned each for itself and the others have their mean; soil couples them a little.
    """
    ratio = 0.05
    modes = true_modes(build_model(read_scenario(case(coupled=ratio))), below_hz=BAND_HZ)
    first = [m for m in modes if m.label in ("fore_aft_1", "side_side_1")]
    assert [m.damping_ratio for m in first] == pytest.approx([ratio, ratio], abs=1e-6)
    steel = np.mean([m.damping_by_source["structure"] for m in first])
    found = [m.damping_by_source["structure"] for m in modes if m.damping_ratio < 0.2]
    assert found == pytest.approx([steel] * len(found), rel=0.05)
