"""``water`` and ``sea`` of a twin file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from observations import observation

from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import Coefficients
from jackettwin.loads.members.water import Water
from jackettwin.loads.sea.waves import SeaState
from jackettwin.soil import family
from jackettwin.study.fit_data import residuals, target_modes
from jackettwin.study.problem import UpdateEvidence, law_problem
from jackettwin.study.rotor import RotorDamping
from jackettwin.twin import TwinState, advance_all, read_twin
from jackettwin.twin.config import assembled
from jackettwin.twin.state import ALL
from jackettwin.twin.water import WaterConfig, in_the_records_sea, water_effects
from jackettwin.updating import support_model
from jackettwin.updating.budget import damping_budget
from jackettwin.updating.nuisance_parameters import NuisanceParameters

TWIN = """
structure: jacket15
water: {{drag: 0.8, marine_growth: [{{top_z_m: 0, bottom_z_m: -40, thickness_m: 0.1}}], adds_mass: {adds}}}
{sea}
targets:
  - {{mode: 1, frequency_hz: 0.18, frequency_std_hz: 0.001, damping_ratio: 0.012, damping_ratio_std: 0.003}}
update: {{water: [water_mass, water_damping], priors: {{water_damping: {{median: 1.2, log_std: 0.3}}}}}}
"""


def twin(folder: Path, *, adds: str = "false", sea: str = "sea: {hs_m: 2.0, tp_s: 7.0}"):  # type: ignore[no-untyped-def]
    path = folder / "twin.yaml"
    path.write_text(TWIN.format(adds=adds, sea=sea))
    config = read_twin(path)
    assembly = assembled(config)
    states = {"": (residuals(config, target_modes(config, ("side_side_1",) * 12, pinned_hz=np.ones(12))), {})}
    return config, UpdateEvidence(assembly, None, states, RotorDamping({}, {}))


def test_factors_follow_the_law_with_their_priors(tmp_path: Path) -> None:
    problem = law_problem(*twin(tmp_path), "maxwell-3")
    assert [p.name for p in problem.parameters] == ["k", "loss_factor", "water_mass", "water_damping"]
    assert [(p.median, p.log_std) for p in problem.parameters[2:]] == [(1.0, 0.2), (1.2, 0.3)]


def test_water_that_the_structure_leaves_out_comes_to_its_mass(tmp_path: Path) -> None:
    (_, without), (_, with_it) = twin(tmp_path), twin(tmp_path, adds="true")
    across = with_it.assembly.mass - without.assembly.mass
    push = np.zeros(with_it.assembly.n_dof)
    for node in with_it.assembly.structure.nodes:
        push[with_it.assembly.dofs(node)[0]] = 1.0
    # growth and water that move with legs and braces of this jacket: a fifth to two thirds of 3578 t
    assert 0.7e6 < push @ (across @ push) < 2.4e6


def test_a_factor_without_water_or_sea_is_refused(tmp_path: Path) -> None:
    config, evidence = twin(tmp_path, sea="")
    with pytest.raises(InputError, match="needs sea"):
        law_problem(config, evidence, "maxwell-3")
    with pytest.raises(InputError, match="needs water"):
        law_problem(replace(config, water=None), evidence, "maxwell-3")


def test_the_records_sea_is_the_mean_of_all(tmp_path: Path) -> None:
    config, _ = twin(tmp_path, sea="")
    seas: list[dict[str, float]] = [{"wave_height_m": h, "wave_period_s": 8.0} for h in (1.0, 2.0)]

    def waves(conditions: list[dict[str, float]]) -> tuple[float, float] | None:
        seen = [observation({}, None, name=f"r{i}", conditions=c) for i, c in enumerate(conditions)]
        return advance_all(TwinState("model"), seen)[0].totals[ALL].conditions.waves

    water = in_the_records_sea(config.water, waves(seas))
    assert water is not None and water.sea is not None
    assert (water.sea.Hs, water.sea.Tp) == (1.5, 8.0)
    assert in_the_records_sea(config.water, waves([seas[0], {}])) == config.water


def test_the_share_of_water_is_that_of_the_simulated_record() -> None:
    """`jackettwin simulate known_feet --json`, true_modes: drag in ten minutes of random waves."""
    config = read_twin("simulated")
    assembly = assembled(config)
    water = WaterConfig(72.0, Coefficients(), Water(), adds_mass=False, sea=SeaState(2.0, 8.0))
    drag = water_effects(water, assembly, ("water_damping",))
    model = support_model(
        assembly,
        family=family("kelvin-voigt"),
        rayleigh=config.rayleigh,
        nuisance=NuisanceParameters((), matrices=drag),
        highest_mode=5,
    )
    budget = damping_budget(model, np.array([2.5e9, 7.6e8, 1.0]), (1, 2, 3, 4, 5))
    # one random sea of ten minutes: 2 % of its velocity
    simulated = [4.12e-6, 4.35e-6, 5.27e-5, 3.048e-4, 3.660e-4]
    np.testing.assert_allclose(budget.damping_ratio[:, 3], simulated, rtol=0.05)
