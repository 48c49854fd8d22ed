"""Symmetric jackets, whose pairs have no axes of their own: a soft foot chooses them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.soil import family
from jackettwin.structure import PointMass, Rayleigh, assemble
from jackettwin.updating import (
    Direction,
    ErrorModel,
    PairDirection,
    Residuals,
    SupportModel,
    Target,
    Tolerance,
    ToleranceDirections,
    joint,
    objection,
    support_model,
)

DECK = Path(__file__).parents[2] / "qualify" / "decks" / "four_legs.yaml"
THETA = np.array([9e8, 0.08])
PAIRS = ((1, 2), (4, 5))
FALL = 0.1


def symmetric(tie: str, feet: float = 1.0) -> tuple[SupportModel, np.ndarray]:
    """Return a jacket with its rotor on the axis, and θ where the first foot has a share of its stiffness."""
    structure = read_structure(DECK)
    body = PointMass(structure.top_node, 5.5e5, (0.0, 0.0, 2.9), (1e8, 1e8, 1e8, 0.0, 0.0, 0.0))
    model = support_model(
        assemble(structure.with_masses((body,))),
        family=family("maxwell-3"),
        rayleigh=Rayleigh.minimum(0.0055, 0.2),
        tie=tie,
        bounds={"k": (1e8, 5e10), "loss_factor": (0.005, 0.5)},
        highest_mode=7,
    )
    theta = np.tile(THETA, len(model.parameters) // 2)
    theta[0] *= feet
    return model, theta


@pytest.fixture(scope="module")
def model() -> SupportModel:
    return symmetric("all")[0]


def softer(fall: float) -> tuple[Direction, ...]:
    """Return each foot softened by a share."""
    one = Tolerance("weak_leg", "one foot softer", fall, "-", "a test", "look")
    return tuple(Direction(one, feet=np.tile(row[:, None], 6)) for row in -fall * np.eye(4))


def measured(share: float) -> tuple[dict[int, complex], tuple[PairDirection, ...]]:
    """Return the poles of both bending pairs where the first foot is softer, lower ones first, and axes."""
    legs, theta = symmetric("per-leg", share)
    motion = np.zeros((1, 2, legs.assembly.n_dof))
    for axis, dof in enumerate(legs.assembly.dofs(legs.assembly.structure.top_node)[:2]):
        motion[0, axis, dof] = 1.0
    poles, pairs = {}, []
    for pair in PAIRS:
        found = legs.predict_many(theta[None], pair, slopes=False)
        order = np.argsort(np.abs(found.poles[0]))
        poles |= dict(zip(pair, found.poles[0, order], strict=True))
        low = found.shapes[0, order[0]]
        x, y = (motion @ legs.condensed.expand(found.poles[0, order[0]], low))[0]
        angle = 0.5 * np.arctan2(2.0 * (x * np.conj(y)).real, abs(x) ** 2 - abs(y) ** 2)
        f = np.abs(found.poles[0])
        pairs.append(PairDirection(pair, angle, np.radians(3.0), abs(f[1] - f[0]) / f.mean(), motion))
    return poles, tuple(pairs)


def errors(model: SupportModel, each: tuple[Direction, ...], pairs: tuple[PairDirection, ...]) -> ErrorModel:
    own = ToleranceDirections(model.assembly, model.condensed, each, 1)
    return ErrorModel(own, {}, 0.003, 0.07, pairs=pairs)


def test_a_soft_foot_parts_a_symmetric_pair_along_the_diagonal(model: SupportModel) -> None:
    """Both pairs, against a model whose feet have their own springs; on the solver's axes nothing parts."""
    share = 1.0 - FALL
    poles, pairs = measured(share)
    modes = tuple(poles)
    found = model.predict_many(THETA[None], modes, slopes=False)
    exact = np.log(np.abs(list(poles.values())) / np.abs(found.poles[0]))
    on_axes = errors(model, softer(FALL), pairs).shifts(found)[0, 0, :, 0]
    # second order in a softening by a tenth
    np.testing.assert_allclose(on_axes, exact, rtol=0.1, atol=2e-5)
    assert exact[0] < 5.0 * exact[1] < 0.0
    blind = errors(model, softer(FALL), ()).shifts(found)[0, 0, :, 0]
    assert abs(blind[0] - blind[1]) < 0.7 * abs(exact[0] - exact[1])


def test_the_soft_foot_is_the_explanation(model: SupportModel) -> None:
    """Half of one foot: the split of the pairs was explained by inertia and masses of the rotor."""
    poles, pairs = measured(0.5)
    targets = []
    for mode, pole in poles.items():
        f, zeta = abs(pole) / (2.0 * np.pi), -pole.real / abs(pole)
        targets.append(Target(mode, f, 0.002 * f, zeta, 0.1 * zeta))
    structure = model.assembly.structure
    heavy = structure.with_masses(
        tuple(replace(m, mass_kg=1.015 * m.mass_kg) for m in structure.masses)
    )  # fmt: skip
    mass = assemble(heavy).mass - model.assembly.mass
    rna = Direction(Tolerance("rna_mass", "mass of the rotor", 0.015, "-", "a test", "weigh"), mass=mass)
    problem = joint(
        model, {"": (Residuals(tuple(targets), False), {})}, error_model=errors(model, (rna,), pairs)
    )
    found = objection(problem, np.log(THETA), suspects=softer(0.3), pairs=pairs)
    assert found is not None and found.objects
    first = found.explanations[0]
    assert first.tolerance.name == "weak_leg"
    # to first order: half the stiffness doubles the flexibility, as its whole loss would by this slope
    assert 0.4 < first.size < 1.2
