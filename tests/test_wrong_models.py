"""Twins whose model is wrong, in small: ``qualify/wrong_models.py`` plants a thousand."""

from __future__ import annotations

import numpy as np
from scipy.stats import binomtest
from wrong_models import held, twin

CASES = range(200, 212)
"""Twelve kinds of wrongness."""


def test_intervals_of_wrong_models_hold_the_truth_and_those_of_a_true_one_do_not() -> None:
    """A share that 91 % would give once in a hundred, on either side; least squares far below it."""
    found = [twin(case) for case in CASES]
    hits, of = held(found, "product")
    assert binomtest(hits, of, 0.91).pvalue > 0.01
    plain, of = held(found, "plain")
    assert binomtest(plain, of, 0.91, alternative="less").pvalue < 0.01
    width = np.median([r["product"]["length"][-2] for r in found])
    oracle = np.median([r["oracle"]["length"][-2] for r in found])
    assert np.exp(width) < 2.5 * np.exp(oracle)
