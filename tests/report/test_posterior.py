"""The report of what is known, from targets with standard deviations."""

from collections.abc import Callable
from dataclasses import replace

import plotly.graph_objects as go
import pytest

from jackettwin.answers import answer
from jackettwin.report import Plot
from jackettwin.report.sections.appendix import posterior
from jackettwin.report.tables import answers as tables_answers
from jackettwin.soil import family
from jackettwin.study import TwinResult
from jackettwin.updating import Residuals, Target, single, support_model, update


@pytest.fixture(scope="module")
def weighed(targets_only: TwinResult) -> TwinResult:
    """Two laws fitted to targets with standard deviations."""
    old = targets_only.updates[0]
    targets = (
        Target(1, 0.1819, 0.0008, 0.0127, 0.004), Target(2, 0.1838, 0.0008), Target(4, 0.7362, 0.004),
    )  # fmt: skip
    bounds = {"k": (1e9, 1e10), "loss_factor": (1e-2, 0.5), "c": (1e7, 1e10)}
    updates = []
    for law in ("maxwell-3", "kelvin-voigt"):
        own = {p.name for p in family(law).parameters}
        model = support_model(
            targets_only.assembly,
            family=family(law),
            rayleigh=old.model.rayleigh,
            bounds={k: v for k, v in bounds.items() if k in own},
        )
        updates.append(update(single(model, Residuals(targets, relative=False)), starts=2, particles=40))
    return replace(targets_only, updates=tuple(updates), excess=((), ()))


def test_the_posterior_is_drawn_with_units(
    weighed: TwinResult, assert_units: Callable[[go.Figure], None]
) -> None:
    plots = {b.name: b.figure for b in posterior(weighed) if isinstance(b, Plot)}
    assert set(plots) == {"correlation", "profiles"}
    for figure in plots.values():
        assert_units(figure)


def test_verdicts_laws_and_next_measurements_are_tabled(weighed: TwinResult) -> None:
    answers = answer(weighed)
    ground = tables_answers.ground_table(answers)
    assert [row[1] for row in ground.rows] and {row[1] for row in ground.rows} <= {
        "known",
        "known roughly",
        "not known",
    }
    laws = tables_answers.laws_table(answers)
    assert sum(float(row[2]) for row in laws.rows) == pytest.approx(100.0, abs=1.0)  # whole per cents
    assert [row[1] for row in laws.rows].count("recommended") == 1
    # nothing of a rotor in the model: no column says it is zero
    columns = [c.split("\n")[0] for c in tables_answers.budget_table(answers).columns]
    assert columns[:5] == ["mode", "measured", "model", "steel", "ground"]
    assert set(columns[5:]) <= {"unexplained"}


def test_without_standard_deviations_there_is_no_posterior(targets_only: TwinResult) -> None:
    assert posterior(targets_only) == []
    assert {row[1] for row in tables_answers.ground_table(answer(targets_only)).rows} == {"–"}
