"""Symmetric structures: pairs of equal modes are followed together, named by the axes, and none is lost."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.response.condensation.newton import refined
from jackettwin.response.condensation.numbered_modes import NumberedModes, Status
from jackettwin.response.modes.labels import mode_kinds, mode_labels
from jackettwin.response.modes.modal import UndampedModes, damped_modes
from jackettwin.soil import family
from jackettwin.structure import Assembly, Rayleigh, assemble
from jackettwin.updating import SupportModel, numbered_modes, support_model

JACKET = """
name: symmetric
sea_level_z_m: 50.0
jacket:
  lattice:
    legs: {legs}
    bays: 2
    base_width_m: 12.0
    top_width_m: 8.0
    height_m: 60.0
    leg_diameter_m: 1.2
    leg_thickness_bottom_m: 0.05
    leg_thickness_top_m: 0.035
    brace: {{outer_diameter_m: 0.8, thickness_m: 0.02}}
    mud_braces: true
  transition_piece:
    top_z_m: 65.0
    tube: {{outer_diameter_m: 1.2, thickness_m: 0.04}}
    column: {{outer_diameter_m: 5.6, thickness_m: 0.06}}
  tower:
    height_m: 68.0
    elements: 4
    bottom: {{outer_diameter_m: 5.6, thickness_m: 0.032}}
    top: {{outer_diameter_m: 4.0, thickness_m: 0.030}}
  rna:
    mass_kg: 350000.0
    cg_offset_m: [{offset}, 0.0, 1.9]
    inertia_about_cg_kg_m2: [2.5e7, 2.5e7, 2.5e7, 0.0, 0.0, 0.0]
"""
STEEL = Rayleigh.minimum(0.005, 0.3)
OFFSETS = (0.0, 1e-3, 0.03, 1.0)


def jacket(folder: Path, *, legs: int = 4, offset: float = 0.0, **options: object) -> Assembly:
    path = folder / f"jacket_{legs}_{offset}.yaml"
    path.write_text(JACKET.format(legs=legs, offset=offset))
    return assemble(read_structure(path), **options)  # type: ignore[arg-type]


def model_of(assembly: Assembly, law: str = "kelvin-voigt", tie: str = "all") -> SupportModel:
    return support_model(assembly, family=family(law), rayleigh=STEEL, tie=tie, highest_mode=5)


def walk(
    model: SupportModel, rng: np.random.Generator, steps: int
) -> list[tuple[NumberedModes, NumberedModes]]:
    """Return warm and cold results along a random walk inside the bounds, a tenth of their width a step.

    On the softest third of supports, modes veer into each other and a name is a matter of the way.
    """
    low, high = (np.log([getattr(p, side) for p in model.parameters]) for side in ("low", "high"))
    low = low + 0.35 * (high - low)
    z = low + (high - low) * rng.uniform(0.2, 0.8, low.size)
    near, results = model.predict_many(np.exp(z[None]), (1, 2, 4, 5)), []
    for _ in range(steps):
        z = np.clip(z + 0.1 * (high - low) * rng.standard_normal(low.size) / np.sqrt(low.size), low, high)
        warm = model.predict_many(np.exp(z[None]), (1, 2, 4, 5), near=near, slopes=False)
        results.append((warm, model.predict_many(np.exp(z[None]), (1, 2, 4, 5), slopes=False)))
        near = results[-1][1]
    return results


@pytest.mark.parametrize("law", ["kelvin-voigt", "springpot"])
@pytest.mark.parametrize(("legs", "offset"), [*((4, offset) for offset in OFFSETS), (3, 0.0)])
def test_warm_starts_end_where_cold_ones_do(
    tmp_path: Path, rng: np.random.Generator, legs: int, offset: float, law: str
) -> None:
    results = walk(model_of(jacket(tmp_path, legs=legs, offset=offset), law), rng, 12)
    warm = [found.status[0] == Status.NEIGHBOUR for found, _ in results]
    # steps of a tenth of seven decades: one may be too long
    assert sum(warm) >= len(warm) - 1
    for found, cold in results:
        assert cold.status[0] == Status.CERTIFIED
        np.testing.assert_allclose(found.poles, cold.poles, rtol=1e-8)


def test_a_pair_is_found_whatever_the_legs_do(tmp_path: Path, rng: np.random.Generator) -> None:
    for found, cold in walk(model_of(jacket(tmp_path), tie="per-leg"), rng, 10):
        pairs = (np.sort_complex(one.poles[0]) for one in (found, cold))
        np.testing.assert_allclose(*pairs, rtol=1e-8)


@pytest.mark.parametrize("legs", [3, 4])
def test_no_mode_is_missed(tmp_path: Path, rng: np.random.Generator, legs: int) -> None:
    """Poles of random supports, locked dampers among them, are those of the full model."""
    model = model_of(jacket(tmp_path, legs=legs))
    low, high = (np.log([getattr(p, side) for p in model.parameters]) for side in ("low", "high"))
    for theta in np.exp(low + (high - low) * rng.random((6, low.size))):
        found = model.predict_many(theta[None], (1, 2, 3, 4, 5), slopes=False)
        full = damped_modes(model.system(theta), below_hz=model.condensed.radius / (2.0 * np.pi)).eigenvalues
        known = found.poles[0][~np.isnan(found.poles[0])]
        for pole in known:
            # as often in the full model as among the numbered ones
            again = np.abs(known - pole) <= 1e-7 * abs(pole)
            assert np.count_nonzero(np.abs(full - pole) <= 1e-7 * abs(pole)) >= again.sum()
        assert found.status[0] == Status.CERTIFIED


def test_slopes_of_a_pair_are_differences(tmp_path: Path) -> None:
    model = model_of(jacket(tmp_path), "zener")
    theta = np.array([6e8, 1.2e7, 4e8])
    here = model.predict_many(theta[None], (1, 2), shape_slopes=True)
    assert abs(here.poles[0, 0] - here.poles[0, 1]) <= 1e-9 * abs(here.poles[0, 0])
    assert np.isfinite(here.shape_slopes).all()
    for j in range(3):
        up, down = (theta * np.exp(step * np.eye(3)[j]) for step in (1e-4, -1e-4))
        poles = [model.predict_many(t[None], (1, 2), near=here, slopes=False).poles[0] for t in (up, down)]
        # the square of the step, and rounding over it
        np.testing.assert_allclose(here.slopes[0, :, j], (poles[0] - poles[1]) / 2e-4, rtol=1e-5, atol=1e-7)


def test_slopes_of_a_pair_that_parts_add_up(tmp_path: Path) -> None:
    """One leg alone parts the pair; the mean of its poles stays differentiable."""
    model = model_of(jacket(tmp_path), tie="per-leg")
    theta = np.tile([6e8, 1.2e7], 4)
    here = model.predict_many(theta[None], (1, 2))
    step = 1e-4
    for j in range(2):
        up, down = (theta * np.exp(sign * step * np.eye(8)[j]) for sign in (1.0, -1.0))
        sums = [model.predict_many(t[None], (1, 2), slopes=False).poles[0].sum() for t in (up, down)]
        np.testing.assert_allclose(here.slopes[0, :, j].sum(), (sums[0] - sums[1]) / (2.0 * step), rtol=1e-4)


def test_one_of_a_pair_is_enough_to_follow(tmp_path: Path) -> None:
    model = model_of(jacket(tmp_path))
    near = model.predict_many(np.array([[6e8, 1.2e7]]), (2,), shape_slopes=True)
    warm = model.predict_many(np.array([[9e8, 1.0e7]]), (2,), near=near, shape_slopes=True)
    assert warm.status[0] == Status.NEIGHBOUR
    assert np.isfinite(warm.shape_slopes).all()


@pytest.mark.parametrize("legs", [3, 4])
def test_names_do_not_depend_on_mesh_or_weight(tmp_path: Path, legs: int) -> None:
    for options in ({}, {"gravity": True}, {"subdivide": 2}):
        modes, labels = named(jacket(tmp_path, legs=legs, **options))
        assert labels[:2] == ("fore_aft_1", "side_side_1")
        assert labels[3:5] == ("fore_aft_2", "side_side_2")
        np.testing.assert_allclose(modes.omega[1], modes.omega[0], rtol=1e-6)


def named(assembly: Assembly) -> tuple[UndampedModes, tuple[str, ...]]:
    modes = numbered_modes(assembly, 5)
    return modes, mode_labels(mode_kinds(assembly, modes.shapes, modes.frequency_hz))


def test_a_pair_between_the_axes_has_two_names(tmp_path: Path) -> None:
    assembly = jacket(tmp_path)
    modes = numbered_modes(assembly, 2)
    for angle in (0.2, 0.25 * np.pi, 1.3):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        kinds = mode_kinds(assembly, modes.shapes @ turn, modes.frequency_hz)
        assert sorted(kinds) == ["fore_aft", "side_side"]


def test_turned_pairs_keep_their_modal_mass(tmp_path: Path) -> None:
    assembly = jacket(tmp_path, legs=3)
    modes = numbered_modes(assembly, 5)
    np.testing.assert_allclose(modes.shapes.T @ (assembly.mass @ modes.shapes), np.eye(5), atol=1e-8)


def test_a_cluster_of_more_than_two_is_refined_together(tmp_path: Path, rng: np.random.Generator) -> None:
    """The second bending pair and the torsion, a fifth apart, as one cluster: each pole is found once."""
    model = model_of(jacket(tmp_path))
    known = model.predict_many(np.array([[6e8, 1.2e7]]), (3, 4, 5), slopes=False)
    values, vectors = known.poles.copy(), known.shapes.copy()
    values *= 1.0 + 0.01 * rng.standard_normal(values.shape)
    vectors += 0.01 * rng.standard_normal(vectors.shape)
    one_family = np.zeros(3, dtype=np.intp)
    assert refined(model.condensed, known.rows, known.rayleigh, one_family, values, vectors, 0.3).all()
    np.testing.assert_allclose(np.sort_complex(values), np.sort_complex(known.poles), rtol=1e-9)
    # by themselves, two starts of the pair may end in the same shape; together they span the plane
    assert np.linalg.matrix_rank(vectors[0], tol=1e-6) == 3
