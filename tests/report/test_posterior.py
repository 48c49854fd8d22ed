"""The report of what is known, from targets with standard deviations."""

from collections.abc import Callable
from dataclasses import replace

import plotly.graph_objects as go
import pytest

from jackettwin.report import Plot
from jackettwin.report.page import Table
from jackettwin.report.section_posterior import what_is_known, whose_damping
from jackettwin.twin import TwinResult
from jackettwin.updating import Residuals, Target, family, single, support_model, update


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


def test_what_is_known_is_drawn_with_units(
    weighed: TwinResult, assert_units: Callable[[go.Figure], None]
) -> None:
    blocks = what_is_known(weighed) + whose_damping(weighed)
    plots = {b.name: b.figure for b in blocks if isinstance(b, Plot)}
    assert set(plots) == {"posterior", "profiles", "law_comparison", "damping_budget"}
    for figure in plots.values():
        assert_units(figure)
    # bars of the sources carry their intervals
    bars = [trace for trace in plots["damping_budget"].data if trace.type == "bar"]
    assert all(bar.error_y.array is not None for bar in bars)
    # no dashpot in the model: the rotor's part is not zero but not known
    assert [bar.name for bar in bars] == ["structure", "soil"]
    assert any("rotor, water" in b.caption for b in blocks if b.kind == "plot")
    assert sum(bar.y[0] for bar in plots["law_comparison"].data) == pytest.approx(100.0)


def test_verdicts_and_next_measurements_are_tabled(weighed: TwinResult) -> None:
    tables = [b for b in what_is_known(weighed) if isinstance(b, Table)]
    verdicts = [t for t in tables if "what the data tell" in t.caption]
    assert [len(t.rows) for t in verdicts] == [2, 2]
    assert all(row[1] in ("identified", "weak", "unidentified") for t in verdicts for row in t.rows)
    assert any("further measurement" in t.caption for t in tables)


def test_nothing_is_said_without_standard_deviations(targets_only: TwinResult) -> None:
    assert what_is_known(targets_only) == []
    assert [b.name for b in whose_damping(targets_only)] == ["damping_budget"]
