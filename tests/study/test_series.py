"""A Prony series with as many branches as the data tell."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.soil import family, members
from jackettwin.structure import Rayleigh, assemble
from jackettwin.study import run_twin, update_document
from jackettwin.twin import read_twin
from jackettwin.updating import Residuals, SupportModel, Target, Update, series, single, support_model, update

OC4 = Path(__file__).parents[2] / "qualify" / "decks" / "oc4_jacket.dat"
MODES = (1, 2, 3, 4, 5)
ASSEMBLY = assemble(read_structure(OC4))


def model(law: str, *, informed: bool = False) -> SupportModel:
    steel = Rayleigh.minimum(0.005, 0.3)
    return support_model(ASSEMBLY, family=family(law), rayleigh=steel, highest_mode=5, informed=informed)


def planted(law: str, theta: list[float], *, spread: float | None) -> Residuals:
    """Frequencies and damping ratios of a law, exact, with relative standard deviations or none."""
    exact = model(law).exact_modes(np.array(theta), MODES)
    targets = tuple(
        Target(m, float(f), damping_ratio=float(z))
        if spread is None
        else Target(m, float(f), 0.1 * spread * float(f), float(z), spread * float(z))
        for m, f, z in zip(MODES, exact.frequency_hz, exact.damping_ratio, strict=True)
    )
    return Residuals(targets, relative=spread is None)


def chosen(law: str, theta: list[float], spread: float | None) -> tuple[Update, str]:
    data = planted(law, theta, spread=spread)
    return series(
        lambda name: update(single(model(name, informed=spread is not None), data), starts=4, sampled=False)
    )


@pytest.mark.parametrize(
    ("law", "theta", "spread", "found"),
    [
        ("zener", [5e8, 1e8, 3e8], None, "prony-1"),
        ("prony-2", [5e8, 0.2, 0.5, 0.3, 8.0], None, "prony-2"),
        # a loss known to a tenth does not tell two branches from one, known to a thousandth it does
        ("prony-2", [5e8, 0.2, 0.5, 0.3, 8.0], 0.3, "prony-1"),
        ("prony-2", [5e8, 0.2, 0.5, 0.3, 8.0], 0.001, "prony-2"),
    ],
)
def test_a_series_has_as_many_branches_as_the_data_tell(
    law: str, theta: list[float], spread: float | None, found: str
) -> None:
    fit, why = chosen(law, theta, spread)
    assert fit.law == found
    assert why.startswith("prony: ") and f"({found})" in why


def test_a_twin_names_the_series_that_its_data_chose() -> None:
    config = read_twin("thesis_table_6_1")
    config = replace(config, update=config.update.model_copy(update={"starts": 2}))
    result = run_twin(config, laws=("prony",), posteriors="none")
    (fit,) = result.updates
    assert fit.law in members(["prony"])
    document = update_document(result, 0)
    assert document["series"] in [one.value for one in result.assumptions]
    assert f"({fit.law})" in document["series"] or "the largest number tried" in document["series"]
    assert update_document(run_twin(config, laws=("zener",), posteriors="none"), 0)["series"] is None
