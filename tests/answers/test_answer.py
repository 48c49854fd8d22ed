"""The answers of a run on targets whose truth is the model's own: Kelvin–Voigt feet of 2.5e9 N/m."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.answers import Answers, Span, answer
from jackettwin.answers.fit import moved_by
from jackettwin.answers.ground_average import averaged_ground
from jackettwin.answers.next_steps import next_steps, records_for
from jackettwin.answers.result import NORMAL_90
from jackettwin.cli.update import _modes as modes_of_terminal
from jackettwin.decks import read_structure
from jackettwin.report.tables.answers import modes_table
from jackettwin.report.tables.numbers import words
from jackettwin.response.modes.labels import mode_kinds, mode_labels
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, assemble
from jackettwin.study import TwinResult
from jackettwin.study.document import update_document
from jackettwin.study.measurements import MeasuredMode
from jackettwin.updating import (
    Residuals,
    Target,
    law_probability,
    numbered_modes,
    single,
    support_model,
    update,
)
from jackettwin.updating.law_choice import approximate_probability, likely, recommended

TARGETS = (
    Target(1, 0.1819, 0.0008, 0.0107, 0.0004),
    Target(2, 0.1838, 0.0008, 0.0107, 0.0004),
    Target(4, 0.7362, 0.004, 0.0270, 0.001),
)
PRIOR = {"k": (2.0e9, 0.5)}


@pytest.fixture(scope="module")
def result() -> TwinResult:
    assembly = assemble(read_structure("jacket15"))
    numbered = numbered_modes(assembly, 8)
    labels = mode_labels(mode_kinds(assembly, numbered.shapes, numbered.frequency_hz))
    updates = []
    for law in ("maxwell-3", "kelvin-voigt"):
        model = support_model(
            assembly,
            family=family(law),
            rayleigh=Rayleigh.minimum(0.01, 0.1832),
            bounds={"k": (5e8, 2e10)},
            priors=PRIOR,
        )
        problem = single(model, Residuals(TARGETS, relative=False))
        updates.append(update(problem, starts=2, particles=60))
    measured = tuple(
        MeasuredMode(
            t.mode, labels[t.mode - 1], t.frequency_hz, t.frequency_std_hz, t.damping_ratio,
            t.damping_ratio_std, None, None, True, True,
        )
        for t in TARGETS
    )  # fmt: skip
    return TwinResult(
        name="t", assembly=assembly, sensors=(), numbered=numbered, labels=labels,
        observations=(), shown=None,
        measured=measured, updates=tuple(updates), excess=((), ()), assumptions=(), warnings=(),
        rotor_speed_hz=(5.0 / 60.0, 7.56 / 60.0),
    )  # fmt: skip


@pytest.fixture(scope="module")
def answers(result: TwinResult) -> Answers:
    return answer(result)


def test_a_span_is_symmetric_in_the_logarithm() -> None:
    span = Span.of(2.0, 0.1)
    assert span is not None and span.low is not None and span.high is not None
    assert span.low * span.high == pytest.approx(4.0)
    assert span.log_std == pytest.approx(0.05)
    assert np.log(span.high / span.value) == pytest.approx(NORMAL_90 * 0.05)
    assert Span.of(None, 0.1) is None


def test_margins_are_positive_outside_and_negative_inside(answers: Answers, result: TwinResult) -> None:
    by = {(c.label, c.order): c for c in answers.clearances}
    first = by["side_side_1", "1P"]
    # the lower end of the interval against the upper end of the band
    low = 0.1819 * np.exp(-NORMAL_90 * 0.0008 / 0.1819)
    assert first.margin == pytest.approx(low / (7.56 / 60.0) - 1.0)
    assert by["side_side_1", "3P"].margin > 0.0
    inside = answer(replace(result, rotor_speed_hz=(0.15, 0.2)))
    assert next(c for c in inside.clearances if c.order == "1P").margin < 0.0


def test_a_prior_is_shown_by_its_interval_of_90_percent(answers: Answers) -> None:
    """A log-normal prior of median m and deviation s holds 90 % between m e^{∓1.645 s}."""
    (k,) = [g for g in answers.ground if g.name == "k"]
    median, log_std = PRIOR["k"]
    factor = np.exp(1.6449 * log_std)
    assert k.before is not None
    assert (k.before.low, k.before.high) == pytest.approx((median / factor, median * factor), rel=1e-4)


def test_the_design_is_what_the_prior_allows(answers: Answers) -> None:
    """A stiffer prior gives a higher design; rigid feet are its limit."""
    for mode in answers.modes:
        assert (
            mode.design_hz is not None and mode.design_hz.low is not None and mode.design_hz.high is not None
        )
        assert mode.design_hz.low < mode.design_hz.value < mode.design_hz.high < mode.rigid_hz
        assert mode.as_designed


def test_sources_add_up_to_the_model(answers: Answers, result: TwinResult) -> None:
    """To its damping as told, to rounding; that is near what it damps at the medians of the parameters."""
    u = recommended(result.updates)
    assert u is not None and u.uncertainty is not None
    theta = u.problem.vectors(np.log(u.uncertainty.median)[None], u.problem.states[0])[0]
    exact = u.model.exact_modes(theta, u.shown)
    for i, mode in enumerate(answers.modes):
        assert set(mode.sources) == {"structure", "soil"}
        whole = sum(span.value for span in mode.sources.values())
        assert mode.model_damping is not None and whole == pytest.approx(mode.model_damping.value, rel=1e-9)
        # medians of 60 draws a chain: a tenth of the interval's 10 %
        assert whole == pytest.approx(float(exact.damping_ratio[i]), rel=0.01)


def test_the_approximate_probability_is_near_the_sampled_one(result: TwinResult) -> None:
    """Laplace's evidence of nearly normal posteriors is within a factor of two (ln 2) of the sampled one."""
    exact = law_probability(result.updates)
    about = approximate_probability(result.updates)
    assert exact is not None
    assert sum(about.values()) == pytest.approx(1.0)
    odds = [np.log(p["maxwell-3"] / p["kelvin-voigt"]) for p in (exact, about)]
    assert odds[0] == pytest.approx(odds[1], abs=np.log(2.0))


def test_the_first_law_stays_unless_another_is_ten_times_as_probable(result: TwinResult) -> None:
    maxwell, voigt = result.updates
    chosen = likely(result.updates)
    odds = approximate_probability(result.updates)
    assert chosen is (maxwell if odds["maxwell-3"] >= 0.1 * odds["kelvin-voigt"] else voigt)
    # targets of a dashpot: the second pair loses more than a constant loss factor gives it
    assert odds["kelvin-voigt"] > odds["maxwell-3"]
    assert likely((voigt, maxwell)) is voigt


def test_further_measurements_never_widen_what_is_known(answers: Answers) -> None:
    now = {g.name: g.factor for g in answers.ground}
    for step in answers.next_steps:
        for name, factor in step.factors.items():
            assert 1.0 <= factor <= (now[name] or np.inf) * (1.0 + 1e-9)


def test_the_second_bending_tells_more_of_the_ground_s_damping_than_torsion(result: TwinResult) -> None:
    """Torsion hardly moves the feet (2e-4 a ln k); the second bending's damping is mostly the ground's."""
    model = result.updates[1].problem.model
    alone = update(single(model, Residuals(TARGETS[:2], relative=False)), starts=2, particles=60)
    found = {
        step.what: step.factors["c"]
        for step in next_steps(alone, result.measured[:2], ["c"], result.labels, days=0.0)
    }
    assert found["second_bending"] < 0.9 * found["torsion"]
    # what was measured and not fitted comes first, and narrows as the fit of it does
    first = next_steps(alone, result.measured, ["k"], result.labels, days=0.0)[0]
    assert (first.what, first.modes) == ("modes", (4,))
    with_f4 = (*TARGETS[:2], replace(TARGETS[2], damping_ratio=None, damping_ratio_std=None))
    fitted = update(single(model, Residuals(with_f4, relative=False)), starts=2, particles=60)
    assert alone.uncertainty is not None and fitted.uncertainty is not None
    before, after = (u.uncertainty.verdicts[0].interval_factor for u in (alone, fitted))
    # a fifth of the logarithm: the expectation is at draws of the wider posterior
    assert np.log(first.factors["k"]) == pytest.approx(np.log(after), rel=0.2)
    assert np.log(after) < 0.8 * np.log(before)


def test_the_number_of_records_goes_with_the_square_of_the_precision(result: TwinResult) -> None:
    m = replace(result.measured[0], damping_ratio=0.01, damping_ratio_std=0.005)
    coarse, fine = (records_for([m], 4, p)[m.label] for p in (0.4, 0.2))
    assert fine == pytest.approx(4 * coarse, abs=4)
    assert records_for([m], 4, 10.0) == {}


def test_without_standard_deviations_nothing_is_called_known(result: TwinResult) -> None:
    bare = replace(
        result, updates=tuple(replace(u, fit=replace(u.fit, uncertainty=None)) for u in result.updates)
    )
    found = answer(bare)
    assert {g.verdict for g in found.ground} == {""}
    assert found.next_steps == ()


def test_what_an_error_of_the_model_does_to_the_ground_is_told(result: TwinResult) -> None:
    """Planted: the same feet, measured as a model 0.3 % too high would have it, fitted again.

    To first order: the step is 0.14 in ln k, of which its square, 2 %, is the second. Three hundredths more
    of either sign would be another sensitivity.
    """
    u = result.updates[1]
    wrong = tuple(replace(t, frequency_hz=(t.frequency_hz or 0.0) * np.exp(-0.003)) for t in TARGETS)
    again = update(single(u.problem.model, Residuals(wrong, relative=False)), starts=2, particles=60)
    moved = moved_by(u, 0.003)
    names = [p.name for p in u.problem.parameters]
    for name, change in zip(names, np.log(again.best.theta / u.best.theta), strict=True):
        assert moved[name] == pytest.approx(change, abs=0.03)
    assert moved["k"] < -0.1  # a model that is too stiff is brought down by the feet
    fit = answer(result).fit
    assert fit is not None and abs(fit.moved["k"]) > abs(moved["k"])


def test_a_model_that_cannot_meet_its_data_makes_nothing_known(result: TwinResult) -> None:
    """No ground lowers the first mode by a tenth and leaves the fourth: 1 % is far too little an error."""
    u = result.updates[0]
    wrong = (replace(TARGETS[0], frequency_hz=0.165, frequency_std_hz=0.0017), *TARGETS[1:])
    bad = update(single(u.problem.model, Residuals(wrong, relative=False)), starts=2, particles=60)
    measured = (replace(result.measured[0], frequency_hz=0.165), *result.measured[1:])
    found = answer(replace(result, updates=(bad,), measured=measured))
    assert answer(result).fits and answer(result).fit is not None
    assert found.fit is not None and not found.fit.fits
    assert found.fit.freedom == 6 + 1 - 2  # six values, one prior, two parameters
    assert list(found.fit.off)[0] == "side_side_1" and found.fit.off["side_side_1"] > 0.03
    assert found.fit.cover is not None and 0.01 < found.fit.cover < 0.1
    assert {g.verdict for g in found.ground} <= {"weak", "unidentified"}
    assert found.next_steps == ()


def test_a_quantity_has_one_central_value(answers: Answers, result: TwinResult) -> None:
    """Page, terminal and JSON told 0.7454, 0.743 and 0.7426 Hz of one mode: best fits beside medians."""
    index, u = next((i, u) for i, u in enumerate(result.updates) if u.law == answers.law)
    assert u.uncertainty is not None
    document = update_document(result, index)
    told = {m["mode"]: m for m in document["modes"]}
    page = {row[0]: row for row in modes_table(answers, result).rows}
    terminal = {row[1]: row for row in modes_of_terminal(result.measured, u).rows}
    for m, one in zip(result.measured, answers.modes, strict=True):
        assert one.model_hz is not None and one.model_damping is not None
        assert told[m.mode]["frequency_hz"] == pytest.approx(one.model_hz.value, rel=1e-12)
        assert told[m.mode]["damping_ratio"] == pytest.approx(one.model_damping.value, rel=1e-12)
        assert f"{one.model_hz.value:.4f}" in str(page[words(m.label)][5])
        assert terminal[words(m.label)][3] == f"{one.model_hz.value:.4f}"
    for g in answers.ground:
        said = document["parameters"][g.name]
        assert said["value"] == said["median"] == pytest.approx(g.value.value, rel=1e-12)


def test_laws_of_comparable_probability_give_one_stiffness(result: TwinResult) -> None:
    """Of a law with a fixed shape k and loss factor are Re D and Im D/Re D at the first pinned frequency."""
    first, second = result.updates
    assert first.uncertainty is not None and second.uncertainty is not None
    both = averaged_ground(result.updates, {first.law: 0.7, second.law: 0.3})
    assert [one.name for one in both] == ["k", "loss_factor"]
    assert both[0].laws == (first.law, second.law)
    omega = 2.0 * np.pi * both[0].frequency_hz
    k, loss = np.exp(first.uncertainty.log_theta).T
    static, c = np.exp(second.uncertainty.log_theta).T
    for one, own, other in zip(both, (k, loss), (static, c * omega / static), strict=True):
        draws = np.concatenate([np.resize(own, 7000), np.resize(other, 3000)])
        low, middle, high = np.quantile(draws, [0.05, 0.5, 0.95])
        # thinned draws: the ends are known to a tenth of their distance
        slack = 0.1 * np.log(high / low)
        assert one.value.low is not None and one.value.high is not None
        np.testing.assert_allclose(
            np.log([one.value.low, one.value.value, one.value.high]), np.log([low, middle, high]), atol=slack
        )
    assert averaged_ground(result.updates, {first.law: 0.95, second.law: 0.05}) == ()
    assert averaged_ground(result.updates, {}) == ()
