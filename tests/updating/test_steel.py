"""Staged refinement of the steel (thesis section 5.4)."""

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.updating import Factor, RefinementStage, fit_stage, only_parts, refine


def test_planted_factors_come_back() -> None:
    structure = read_structure("jacket15")
    planted = structure.with_material("tower", youngs_modulus=1.1).with_material("jacket", density=0.8)
    factors = (Factor("tower", "youngs_modulus"), Factor("jacket", "density"))
    truth = fit_stage(planted, (Factor("tower", "density"),), {1: 0.19}).before_hz
    # the frequencies of the planted structure are the targets
    target = dict(zip((1, 2, 3, 4, 5), _frequencies(planted), strict=True))
    assert truth[0] == pytest.approx(target[1])
    fit = fit_stage(structure, factors, target)
    assert fit.factors["tower.youngs_modulus"] == pytest.approx(1.1, rel=1e-5)
    assert fit.factors["jacket.density"] == pytest.approx(0.8, rel=1e-5)
    np.testing.assert_allclose(fit.after_hz, fit.target_hz, rtol=1e-7)


def test_the_jacket_alone_meets_the_first_pair_of_table_5_2() -> None:
    jacket = only_parts(read_structure("jacket15"), ("jacket",))
    fit = fit_stage(jacket, (Factor("jacket", "density"),), {1: 0.901, 2: 0.901})
    assert np.abs(fit.after_hz / fit.target_hz - 1).max() < np.abs(fit.before_hz / fit.target_hz - 1).max()


def test_more_factors_than_frequencies() -> None:
    with pytest.raises(InputError, match="more factors than frequencies"):
        fit_stage(
            read_structure("jacket15"), (Factor("tower", "density"), Factor("jacket", "density")), {1: 0.18}
        )


def test_unknown_part() -> None:
    with pytest.raises(InputError, match="no such part .got 'monopile'"):
        only_parts(read_structure("jacket15"), ("monopile",))


def test_parts_that_do_not_stand_together_are_refused_before_any_stage_is_fitted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fitted: list[object] = []
    monkeypatch.setattr("jackettwin.updating.refinement.fit_stage", lambda *given, **_: fitted.append(given))
    factor = Factor("tower", "density", tolerance=0.1)
    stages = RefinementStage((), {1: 0.18}, (factor,)), RefinementStage(("jacket", "tower"), {1: 0.18}, ())
    message = r"stages\.1\.parts: .* every foot .got \['jacket', 'tower'\].; they leave out transition_piece"
    with pytest.raises(InputError, match=message):
        refine(read_structure("jacket15"), stages)
    assert not fitted


def _frequencies(structure) -> np.ndarray:
    from jackettwin.structure import assemble
    from jackettwin.updating import numbered_modes

    return numbered_modes(assemble(structure), 5).frequency_hz


def test_slopes_are_those_of_the_frequencies() -> None:
    """φᵀ(∂K − ω²∂M)φ/2ω² against central differences of the residuals, walls and offsets included."""
    from jackettwin.updating.refinement import _Problem

    factors = (
        Factor("jacket", "wall_thickness"),
        Factor("tower", "density"),
        Factor("rna", "cg_shift_z_m", -3.0, 3.0, of="body"),
        Factor("transition_piece", "added_mass_kg", tolerance=2e5),
    )
    targets = {1: 0.18, 3: 0.57, 4: 0.75}
    problem = _Problem(read_structure("jacket15"), factors, targets, 0.01, gravity=True, own_feet=False)
    z = np.array([0.05, -0.1, 0.3, 0.7])
    J = problem.jacobian(z)
    for j, step in enumerate(np.eye(4) * 1e-3):
        slope = (problem.residuals(z + step) - problem.residuals(z - step)) / 2e-3
        np.testing.assert_allclose(J[:, j], slope, rtol=2e-5, atol=2e-5)  # differences to second order


def test_a_tolerance_decides_between_what_frequencies_cannot_tell_apart() -> None:
    """With one frequency and equal tolerances each modulus moves as its share of the strain energy."""
    structure = read_structure("jacket15")
    f = _frequencies(structure)
    parts = ("jacket", "transition_piece", "tower")
    stiff = tuple(Factor(p, "youngs_modulus", tolerance=0.02) for p in parts)
    fit = fit_stage(structure, stiff, {1: 1.002 * f[0]}, frequency_std=1e-6)
    moved = np.log([fit.factors[s.name] for s in stiff])
    share = np.array([fit_share(structure, p) for p in parts])
    np.testing.assert_allclose(moved / moved[-1], share / share[-1], rtol=0.01)  # shares move by 0.5 %
    assert fit.after_hz[0] == pytest.approx(1.002 * f[0], rel=1e-4)
    assert all(0.0 < fit.std[s.name] <= 0.02 * (1 + 1e-9) for s in stiff)


def fit_share(structure, part: str) -> float:
    """Return the share of a part in the strain energy of the first mode, ∂ln ω²/∂ln E."""
    stiffer = np.log(_frequencies(structure.with_material(part, youngs_modulus=1.001))[0])
    softer = np.log(_frequencies(structure.with_material(part, youngs_modulus=0.999))[0])
    return float((stiffer - softer) / 0.001)


def test_what_frequencies_do_not_tell_keeps_its_tolerance_in_its_own_unit() -> None:
    factors = (
        Factor("tower", "density", tolerance=0.03),
        Factor("transition_piece", "added_mass_kg", tolerance=2e5),
        Factor("rna", "cg_shift_z_m", tolerance=0.5, of="body"),
    )
    fit = fit_stage(read_structure("jacket15"), factors, {1: 0.18}, frequency_std=1e3)
    assert list(fit.std.values()) == pytest.approx([0.03, 2e5, 0.5], rel=1e-6)


def test_changes_of_all_stages_make_the_refined_structure() -> None:
    """Factors of stages are multiplied and additions are summed, whichever stage changed what."""
    structure = read_structure("jacket15")
    f = _frequencies(structure)
    density = Factor("jacket", "density", tolerance=0.1)
    heavier = Factor("transition_piece", "added_mass_kg", -4e5, 4e5, tolerance=1e5)
    stages = tuple(
        RefinementStage((), {1: share * f[0], 3: share * f[2]}, (density, heavier)) for share in (0.99, 0.97)
    )
    found = refine(structure, stages)
    again = structure
    for factor, value in found.changes:
        again = factor.on(again, value)
    np.testing.assert_allclose(_frequencies(again), _frequencies(found.structure), rtol=1e-9)
    first, second = (stage.factors["jacket.density"] for stage in found.stages)
    assert abs(np.log(first)) > 1e-4 and abs(np.log(second)) > 1e-4
    values = {factor.name: value for factor, value in found.changes}
    assert values["jacket.density"] == pytest.approx(first * second)
