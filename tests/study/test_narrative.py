"""What a run takes for granted: choices of modelling, open tolerances and settled ones."""

from __future__ import annotations

from dataclasses import replace
from math import expm1

import numpy as np

from jackettwin.study.narrative import tolerance_assumptions
from jackettwin.study.scrutiny import Scrutiny
from jackettwin.twin import read_twin
from jackettwin.twin.config import TwinTolerances
from jackettwin.updating import Influence, Tolerance


def _influence(name: str, effect: list[float]) -> Influence:
    tolerance = Tolerance(name, f"the {name}", 0.015, "-", "a source", "weigh it")
    return Influence(tolerance, 0.0, 1.0, np.array(effect), np.ones(len(effect)), ())


def test_what_moves_the_answer_most_comes_first_and_settled_ones_last() -> None:
    config = replace(
        read_twin("thesis_table_6_1"), tolerances=TwinTolerances({"growth": 0.0, "rna_arm": 0.1})
    )
    s = Scrutiny(None, (_influence("tower", [0.01, 0.0]), _influence("rna_mass", [-0.2, 0.05])))
    heavy, stiff, grown = tolerance_assumptions(config, s, ("k", "c"))
    assert [one.key for one in (heavy, stiff, grown)] == [
        "tolerances.rna_mass",
        "tolerances.tower",
        "tolerances.growth",
    ]
    assert [one.confirmed for one in (heavy, stiff, grown)] == [False, False, True]
    # one standard deviation more multiplies k by exp(−0.2)
    assert heavy.moves == {"k": expm1(-0.2), "c": expm1(0.05)}
    assert heavy.value == "the rna_mass, known to 1.5 % (σ)"
    assert heavy.settled_by == "weigh it" and not grown.moves


def test_without_a_posterior_nothing_is_said_to_move() -> None:
    assert tolerance_assumptions(read_twin("thesis_table_6_1"), None, ()) == ()
