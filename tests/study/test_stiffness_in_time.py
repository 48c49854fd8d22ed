"""The stiffness through time, on seasons made by other means: coverage, a step, going on, and closed forms.

A small form of ``qualify/stiffness_in_time.py``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from common.stiffness_histories import MODES, History, history, modes_table
from observations import estimate, observation

from jackettwin.change import Days
from jackettwin.files import StoredSchema
from jackettwin.soil import family
from jackettwin.study.in_time.stiffness import Reference, Sensitivity, StiffnessLevel, level_of, sensitivity
from jackettwin.study.in_time.track import LEARNT_DAYS, STEP_DAYS, StiffnessTrack, Tracked, resumed
from jackettwin.twin import TwinModel, TwinState, advance, empty_state, read_twin, twin_model
from jackettwin.updating import Residuals, SupportModel, Target, single, support_model
from jackettwin.watching import Mixture, after_row

Table = tuple[np.ndarray, np.ndarray, np.ndarray]
LOSS = 0.1


@pytest.fixture(scope="module")
def model() -> TwinModel:
    return twin_model(replace(read_twin("thesis_table_6_1"), targets=()))


@pytest.fixture(scope="module")
def supports(model: TwinModel) -> SupportModel:
    steel = read_twin("thesis_table_6_1").rayleigh
    return support_model(model.structure, family=family("maxwell-3"), rayleigh=steel, highest_mode=6)


@pytest.fixture(scope="module")
def table(supports: SupportModel) -> Table:
    near = supports.predict(np.array([4e8, LOSS]), MODES)
    return modes_table(lambda ln_k: supports.predict(np.array([np.exp(ln_k), LOSS]), MODES, near=near).poles)


@pytest.fixture(scope="module")
def about(supports: SupportModel) -> Sensitivity:
    targets = tuple(Target(mode, 1.0, 0.1, None, None) for mode in MODES)
    found = sensitivity(single(supports, Residuals(targets, False)), np.log([2e9, LOSS]), [0], MODES)
    assert found is not None
    return found


def state_of(h: History, model: TwinModel) -> TwinState:
    state = empty_state(model)
    for i, (start, modes, beside) in enumerate(h.records()):
        shown = {m: estimate(f, zeta, s, t) for m, (f, s, zeta, t) in modes.items()}
        seen = observation(shown, start, name=str(i), model_hash=model.model_hash, conditions=beside)
        state, _ = advance(state, seen)
    return state


def asked(n: int) -> bool:
    """Return whether all records together are asked after so many days."""
    return n in (1, 2, 3, 4, 6, 8, 11, 15, 20, 26, 34, 45, 59, 77, 100, 130, 169, 220, 286)


def test_frequencies_follow_one_curve(supports: SupportModel, about: Sensitivity) -> None:
    """Half as stiff or twice: within 4 % of the model's own change, mode by mode."""
    near = supports.predict(np.array([2e9, LOSS]), MODES)
    for x in (np.log(0.5), np.log(0.85), np.log(2.0)):
        there = supports.predict(np.array([2e9 * np.exp(x), LOSS]), MODES, near=near)
        moved = np.log(np.abs(there.poles) / np.abs(near.poles))
        h = -np.expm1(-about.bend * x) / about.bend
        # one bend for all modes, which the curves of the second pair have a little less of
        np.testing.assert_allclose(about.slopes * h, moved[[MODES.index(m) for m in about.modes]], rtol=0.04)


def test_a_level_is_the_stiffness_that_it_stands_for() -> None:
    """With one draw and one normal, quantiles are those of e^{h⁻¹}: at a = 1, 1/(1 − ℓ).

    The draw is of the ground at the reference, −0.1 below the first day's level. There the slope is 1; so
    ln k was higher by −ln 0.9 on the first day, and the slope 0.9.
    """
    about = Sensitivity((1,), np.array([0.01]), 1.0, np.log(2e9))
    one = Mixture(np.ones(1), np.array([-0.2]), np.array([1e-9]), np.array([-0.1]), np.array([1e-9]))
    found = level_of(one, Reference(np.full((1, 1), np.log(2e9))), about)
    np.testing.assert_allclose(found.relative, 1.0 / (1.0 + 0.2 / 0.9), rtol=1e-6)
    np.testing.assert_allclose(found.absolute[0], 2e9 / 1.1, rtol=1e-6)
    # both are one stiffness: the first day's is 2e9 / 0.9
    np.testing.assert_allclose(found.relative, np.array(found.absolute[0]) / (2e9 / 0.9), rtol=1e-6)
    # on ground half as soft, as much of a frequency's change means twice as much of the stiffness's
    stiffer = level_of(one, Reference(np.full((1, 1), np.log(4e9))), about)
    np.testing.assert_allclose(stiffer.relative, 1.0 / (1.0 + 0.2 / 0.4), rtol=1e-6)
    np.testing.assert_allclose(stiffer.absolute[0], 4e9 / 1.2, rtol=1e-6)
    # where nothing has moved yet, the reference is the first day
    still = Mixture(np.ones(1), np.array([-0.2]), np.array([1e-9]), np.array([-0.2]), np.array([1e-9]))
    np.testing.assert_allclose(level_of(still, REFERENCE_AT_2, about).relative, 1.0 / 1.2, rtol=1e-6)


REFERENCE_AT_2 = Reference(np.full((1, 1), np.log(2e9)))


@pytest.fixture(scope="module")
def stepped(model: TwinModel, table: Table, about: Sensitivity) -> tuple[History, TwinState, StiffnessTrack]:
    h = history(900, table, kind="step", days=330, k=2e9)
    state = state_of(h, model)
    return h, state, tracked(h, model, state, about, [])


def together(h: History, n: int) -> Reference:
    """Return what all records say together after so many days: the ground at its mean so far, to 2 %."""
    last = max(day for day in range(1, n + 1) if asked(day))
    mean = np.log(h.k) + np.mean(np.log(h.stiffness[:last]))
    return Reference(mean + 0.02 * np.linspace(-1.5, 1.5, 21)[:, None])


def gone_on(h: History, track: StiffnessTrack, n: int, date: str, about: Sensitivity) -> StiffnessTrack:
    """Return the track after day n of a history."""
    reference = together(h, n)
    return track.with_day(date, about, copied=asked(n)).with_changes(reference).moved(reference)


def tracked(
    h: History, model: TwinModel, state: TwinState, about: Sensitivity, found: list[StiffnessLevel]
) -> StiffnessTrack:
    track = StiffnessTrack(model, Days.of(state))
    for n, date in enumerate(state.days, start=1):
        track = gone_on(h, track, n, date, about)
        # what a later day takes again is bounded, whatever came before
        assert sum(rows.days.size for rows in track.window) < 2 * STEP_DAYS
        level = track.level(together(h, n))
        assert level is not None
        found.append(level)
    return track


def test_a_step_is_followed_within_twenty_records(
    stepped: tuple[History, TwinState, StiffnessTrack], model: TwinModel, about: Sensitivity
) -> None:
    h, state, track = stepped
    levels: list[StiffnessLevel] = []
    tracked(h, model, state, about, levels)
    low, _, high = levels[h.begun + 19].relative
    assert low < h.stiffness[h.begun + 19] < high < 1.0
    (change,) = [] if track.kept is None else track.kept.changes
    assert change.factor[0] < 0.85 < change.factor[2]
    start = state.days[list(state.days)[h.begun]].time_utc
    assert start is not None and change.days[0] - 1.0 <= start.timestamp() / 86400.0 <= change.days[2] + 1.0
    # the past is known better now: 15 % less from the day on, at once
    now = track.levels(together(h, h.days.size))
    before, after = (now[list(state.days)[h.begun + i]].relative for i in (-5, 5))
    assert before[0] < 1.0 < before[2] and after[2] < 0.9
    # of one history a 90 % interval misses once in ten times; three standard deviations do not
    assert abs(np.log(after[1] / 0.85)) < 3.0 * np.log(after[2] / after[0]) / 3.29


def test_going_on_is_the_same_as_all_at_once(
    stepped: tuple[History, TwinState, StiffnessTrack], model: TwinModel, about: Sensitivity
) -> None:
    """Bit for bit, through a file, before and after the window has moved."""
    h, state, whole = stepped
    dates, schema = list(state.days), StoredSchema("tracked", Tracked)
    for stop in (40, LEARNT_DAYS[-1] + STEP_DAYS - 5):
        part = StiffnessTrack(model, Days.of(state.until(dates[stop - 1])))
        for n, date in enumerate(dates[:stop], start=1):
            part = gone_on(h, part, n, date, about)
        stored = part.stored()
        assert stored is not None
        kept = schema.load(schema.dump(stored))
        track = resumed(model, Days.of(state), kept, dates[:stop])
        assert track.dates == tuple(dates[:stop])
        for n, date in enumerate(dates[stop:], start=stop + 1):
            track = gone_on(h, track, n, date, about)
        last = together(h, len(dates))
        assert track.level(last) == whole.level(last)
        assert track.levels(last) == whole.levels(last)


def test_days_that_changed_are_not_gone_on_from(
    stepped: tuple[History, TwinState, StiffnessTrack], model: TwinModel
) -> None:
    _, state, whole = stepped
    stored = whole.stored()
    assert stored is not None
    dates = list(state.days)
    late = replace(state, days={**state.days, dates[3]: state.days[dates[4]]})
    assert resumed(model, Days.of(late), stored, dates).dates == ()


def test_no_day_follows_more_than_two_months_again(
    stepped: tuple[History, TwinState, StiffnessTrack],
    model: TwinModel,
    about: Sensitivity,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Neither one on which conditions are learnt anew nor one on which the window moves."""
    h, state, _ = stepped
    counted: list[int] = []

    def counting(*given: object) -> object:
        counted.append(1)
        return after_row(*given)  # type: ignore[arg-type]

    monkeypatch.setattr("jackettwin.study.in_time.track.after_row", counting)
    followed, rows = StiffnessTrack(model, Days.of(state)), []
    for n, date in enumerate(list(state.days)[: 3 * STEP_DAYS + 1], start=1):
        counted.clear()
        followed = gone_on(h, followed, n, date, about)
        rows.append(len(counted))
    assert max(rows) <= 2 * STEP_DAYS + 1
    assert rows[max(LEARNT_DAYS) - 1] == max(LEARNT_DAYS) and rows[2 * STEP_DAYS - 1] > STEP_DAYS


@pytest.mark.parametrize("told", [True, False])
def test_intervals_hold_the_stiffness_of_the_day(
    model: TwinModel, table: Table, about: Sensitivity, told: bool
) -> None:
    """Of four histories of 150 days; far fewer independent errors than days, so the limits are wide."""
    held = []
    for seed, kind in enumerate(("steady", "step", "steady", "wander")):
        h = history(950 + seed, table, kind=kind, days=150, k=2e9, told=told)
        levels: list[StiffnessLevel] = []
        tracked(h, model, state_of(h, model), about, levels)
        low, _, high = np.array([level.relative for level in levels]).T
        held.append(np.mean((low <= h.stiffness) & (h.stiffness <= high)))
    assert 0.75 < np.mean(held) <= 0.995
