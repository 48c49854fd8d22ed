"""The record whose rotor bends: with the blades' own modes the ground is found, else it is not."""

import re
from dataclasses import replace
from importlib import resources
from pathlib import Path

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
    config = read_twin(path)
    quick = {"laws": ("maxwell-3",), "particles": 40, "starts": 3}
    return run_twin(replace(config, update=config.update.model_copy(update=quick)))


@pytest.mark.parametrize("bending", [True, False])
def test_the_ground_is_inside_its_interval_only_if_the_blades_bend(tmp_path: Path, bending: bool) -> None:
    """Vertical stiffness of the records' piles, by the program that holds the truth's formulas.

    OpenFAST's second bending modes stand at 0.82 and 0.85 Hz; a lumped rotor has them at 0.76 and 0.79 and
    lays the rest on the ground, which comes out four times too stiff.
    """
    _, support = read_foundation("jacket15_records").lumped(read_structure("jacket15"))
    truth = float(support.springs[0].matrix[2, 2])
    update = updated(tmp_path, bending=bending).updates[0]
    assert update.uncertainty is not None
    at = [parameter.name for parameter in update.problem.parameters].index("k_vertical")
    low, high = update.uncertainty.interval_90[at]
    assert (low < truth < high) == bending
