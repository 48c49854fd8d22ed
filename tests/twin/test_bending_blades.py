"""The record whose rotor bends: with the blades' own modes the model on the true ground comes near it."""

import re
from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.soil.foundation import read_foundation
from jackettwin.study import TwinResult, run_twin
from jackettwin.twin import read_twin

DATA = Path(str(resources.files("jackettwin") / "data"))
RECORD = DATA / "records" / "pile_flexible_U12_s202.parquet"


def updated(folder: Path, *, bending: bool) -> TwinResult:
    """Run the shipped twin on that record alone, its blades bending or lumped, one law and few draws."""
    text = (DATA / "twins" / "openfast_pile.yaml").read_text(encoding="utf-8")
    text = re.sub(r"records:\n(  - .*\n)+", f"records: [{RECORD}]\n", text)
    if bending:
        text = text.replace("beam: euler", "  blades: {rotor: iea15, pitch_deg: 90}\nbeam: euler")
    path = folder / "twin.yaml"
    path.write_text(text, encoding="utf-8")
    config = replace(read_twin(path), life=None)
    quick = {"laws": ("maxwell-3",), "particles": 40, "starts": 3}
    return run_twin(replace(config, update=config.update.model_copy(update=quick)))


@pytest.mark.parametrize("bending", [True, False])
def test_on_the_true_ground_only_bending_blades_give_what_was_measured(tmp_path: Path, bending: bool) -> None:
    """Stiffness of the records' piles, by the program that holds the truth's formulas.

    OpenFAST's torsion stands at 0.53 Hz and its second bending at 0.82 and 0.85 Hz; on the true ground a
    lumped rotor has them at 0.65, 0.75 and 0.77 Hz.
    """
    _, support = read_foundation("jacket15_records").lumped(read_structure("jacket15"))
    foot = support.springs[0].node  # the ground and the pile's steel: two springs
    truth = sum(spring.matrix for spring in support.springs if spring.node == foot)
    # axially a pile on elastic ground, EA λ (t + r)/(1 + r t) with t = tanh λL, r = k_tip/(EA λ)
    assert truth[2, 2] == pytest.approx(4.098e9, rel=1e-3)
    update = updated(tmp_path, bending=bending).updates[0]
    assert update.uncertainty is not None
    names, z = [p.name for p in update.problem.parameters], np.log(update.uncertainty.median)
    horizontal, vertical = names.index("k_horizontal"), names.index("k_vertical")
    z[[horizontal, vertical]] = np.log([truth[0, 0], truth[2, 2]])
    problem = update.problem
    known = {t.mode: t.frequency_hz for t in problem.states[0].residuals.targets if t.frequency_hz}
    # the first pair is 2 % low in this record with either rotor
    high = tuple(mode for mode, f in known.items() if f > 0.3 and mode <= 5)
    poles = problem.model.predict_many(problem.vectors(z[None], problem.states[0]), high, slopes=False).poles
    away = np.abs(np.abs(poles[0]) / (2.0 * np.pi * np.array([known[mode] for mode in high])) - 1.0)
    assert high and (away.max() < 0.02 if bending else away.min() > 0.05)
    if bending:
        low, upper = update.uncertainty.interval_90[vertical]
        assert low < truth[2, 2] < upper
