"""χ² of a best fit against its degrees of freedom, on draws of a known truth."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.updating import Problem, Residuals, SupportModel, Target, single
from jackettwin.updating.data.misfit import misfit
from jackettwin.updating.search.solutions import search

TRUTH = np.array([2.5e9, 7.6e8])
F_STD, ZETA_STD = 0.005, 0.1


@pytest.fixture
def model(models: dict[str, SupportModel]) -> SupportModel:
    return models["kelvin-voigt"]


def drawn(model: SupportModel, rng: np.random.Generator, shift: float = 0.0) -> Problem:
    """Return data that are the model's own, scattered as they say; ``shift`` moves the first mode."""
    targets = []
    for mode in (1, 2, 4):
        pole = model.predict(TRUTH, (mode,)).poles[0]
        f, zeta = abs(pole) / (2.0 * np.pi), -pole.real / abs(pole)
        moved = f * np.exp(rng.normal(0.0, F_STD) + (shift if mode == 1 else 0.0))
        scattered = zeta * np.exp(rng.normal(0.0, ZETA_STD))
        targets.append(Target(mode, moved, F_STD * moved, scattered, ZETA_STD * scattered))
    return single(model, Residuals(tuple(targets), relative=False))


def probability(problem: Problem) -> float:
    found = misfit(problem, search(problem, starts=2, seed=0).solutions[0].theta)
    assert found is not None
    assert found.freedom == 6 - 2
    return found.probability


def test_the_probability_is_uniform_if_the_model_is_true(model: SupportModel) -> None:
    """Below one half it is in 4 to 20 of 24 draws (binomial, 99.9 %), and never below 1e-4 (99.8 %)."""
    rng = np.random.default_rng(0)
    found = [probability(drawn(model, rng)) for _ in range(24)]
    assert 4 <= sum(p < 0.5 for p in found) <= 20
    assert min(found) > 1e-4


def test_a_shifted_mode_is_no_chance(model: SupportModel) -> None:
    """8 % are sixteen standard deviations, of which two stiffnesses cannot take up half."""
    assert probability(drawn(model, np.random.default_rng(0), shift=-0.08)) < 1e-3


def test_relative_errors_have_no_scale(model: SupportModel, table_6_1: Residuals) -> None:
    assert misfit(single(model, table_6_1), TRUTH) is None
