"""The pair: a record is one observation, and observations are one state, in any order."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import reduce
from importlib.resources import files

import numpy as np
import pytest
from observations import estimate, observation
from tests.support.sightings import sightings

from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.identification import ModalEstimate
from jackettwin.identification.many_records.fusion import average as average_of_sightings
from jackettwin.identification.status import ModeStatus
from jackettwin.intervals import NORMAL_90, NORMAL_95
from jackettwin.records import Record, read_record
from jackettwin.response import Sensor
from jackettwin.twin import (
    OBSERVATION,
    STATE,
    Observation,
    TwinModel,
    TwinState,
    advance,
    advance_all,
    observe,
    read_twin,
    twin_model,
)
from jackettwin.twin.exact_sums import ModeTotal, average, of_day, of_estimate, plus
from jackettwin.twin.state import ALL

NOON = datetime(2025, 1, 1, 12, tzinfo=UTC)
MODES = {1: 0.18, 2: 0.183, 3: 0.55, 4: 0.74, 5: 0.80, 6: 1.2}
TRUE_STD = 0.003
"""By which frequencies scatter."""


def year(days: int, a_day: int, *, seed: int = 0, by_wind: bool = False) -> list[Observation]:
    """Return the observations of some days: six modes each, in winds and states that vary."""
    rng = np.random.default_rng(seed)
    seen, wind = [], 10.0
    for i in range(days * a_day):
        modes = {
            mode: estimate(
                f * np.exp(rng.normal(0.0, TRUE_STD)), 0.012 * np.exp(rng.normal(0.0, 0.2)), 4e-3, 0.2
            )
            for mode, f in MODES.items()
        }
        conditions: dict[str, float | str] = {"state": "parked" if i % 7 else "idling"}
        if by_wind:
            # weather that turns over in about a day
            wind += 0.01 * (10.0 - wind) + 0.6 * rng.standard_normal()
            conditions["mean_wind_speed_m_s"] = abs(wind)
        start = NOON + timedelta(days=i // a_day, seconds=600 * (i % a_day) - 12 * 3600)
        seen.append(observation(modes, start, name=f"r{i}", conditions=conditions))
    return seen


@pytest.fixture(scope="module")
def record() -> Record:
    return read_record(str(files("jackettwin") / "data" / "records" / "pile_U12_s301.parquet"))


@pytest.fixture(scope="module")
def model() -> TwinModel:
    return twin_model(read_twin("openfast_pile"))


@pytest.fixture(scope="module")
def seen(record: Record, model: TwinModel) -> Observation:
    return observe(record, model)


def test_an_observation_is_small_and_goes_through_files_and_processes(
    seen: Observation, model: TwinModel, record: Record
) -> None:
    text = json.dumps(OBSERVATION.dump(seen), allow_nan=False)
    assert len(text) < 40_000
    again = OBSERVATION.load(json.loads(text))
    assert json.dumps(OBSERVATION.dump(again), allow_nan=False) == text
    shipped = pickle.loads(pickle.dumps(model))
    assert shipped.model_hash == model.model_hash == seen.model_hash
    elsewhere = pickle.loads(pickle.dumps(observe(record, shipped)))
    assert json.dumps(OBSERVATION.dump(elsewhere)) == text


def test_what_was_found_in_a_record_is_coded(record: Record, model: TwinModel) -> None:
    data = record.data.copy()
    data[0, 1000:1200] = np.nan
    settings = model.identification.model_copy(update={"refine": False, "blocks": 0})
    quick = TwinModel("modes alone", identification=settings)
    found = {f.code: f for f in observe(replace(record, data=data), quick).findings}
    gaps = found["gaps"]
    assert (gaps.severity, gaps.subject) == ("info", record.channels[0].name)
    assert gaps.params["share"] == pytest.approx(200 / record.data.shape[1])
    assert gaps.text.startswith("0.")


def test_an_observation_names_the_modes_of_the_model(seen: Observation) -> None:
    assert {known.label for _, known in seen.modes.values()} >= {"side_side_1", "fore_aft_1", "fore_aft_2"}
    for estimated, known in seen.modes.values():
        assert known.mac >= 0.8
        assert 0.1 < estimated.frequency_hz < 5.0
    assert {s.channel for s in seen.sensors} == {c.name for c in seen.identification.channels}


def test_another_structure_or_setting_has_another_identity(model: TwinModel) -> None:
    assert model.assembly is not None
    stiffer = replace(model.assembly, stiffness=1.001 * model.assembly.stiffness)
    assert replace(model, assembly=stiffer).model_hash != model.model_hash
    noise = 1.0 + 1e-13 * np.sin(np.arange(stiffer.stiffness.nnz))  # another processor's
    scattered = replace(model.assembly, stiffness=model.assembly.stiffness.copy())
    scattered.stiffness.data *= noise
    assert replace(model, assembly=scattered).model_hash == model.model_hash
    rough = replace(model, identification=model.identification.model_copy(update={"max_order": 20}))
    assert rough.model_hash == model.model_hash
    assert rough.settings_hash("r") != model.settings_hash("r")


def test_any_order_and_any_repetition_give_the_same_state() -> None:
    observations = year(6, 5)
    first, _ = advance_all(TwinState("model"), observations)
    rng = np.random.default_rng(1)
    for _ in range(5):
        twice = [observations[i] for i in rng.permutation(np.repeat(np.arange(len(observations)), 2))]
        again, findings = advance_all(TwinState("model"), twice)
        assert again == first
        assert json.dumps(STATE.dump(again)) == json.dumps(STATE.dump(first))
        assert sum(f.code == "record_doubled" for f in findings) == len(observations)
    # a state that went through a file in the middle
    half, _ = advance_all(TwinState("model"), observations[::2])
    half = STATE.load(json.loads(json.dumps(STATE.dump(half))))
    whole, _ = advance_all(half, observations[1::2])
    assert whole.state_hash == first.state_hash


def test_a_state_as_of_a_day_is_the_state_of_that_day() -> None:
    observations = year(5, 3)
    state, _ = advance_all(TwinState("model"), observations)
    for n in range(1, 6):
        then, _ = advance_all(TwinState("model"), observations[: 3 * n])
        assert state.until(f"2025-01-0{n}") == then
    without, _ = advance_all(TwinState("model"), [*observations[:6], *observations[9:]])
    assert state.without_day("2025-01-03") == without


def test_what_is_worth_saying_of_an_observation() -> None:
    observations = year(3, 2)
    state, findings = advance_all(TwinState("model"), [*observations[:2], *observations[4:]])
    assert findings == ()
    _, (late,) = advance(state, observations[2])
    assert late.code == "record_late" and late.params == {"days": 1, "from": "2025-01-02"}
    assert observations[0].start_utc is not None
    shifted = observation(
        {1: estimate(0.2, 0.01)}, observations[0].start_utc + timedelta(seconds=60), name="other"
    )
    _, found = advance(state, shifted)
    assert "record_overlaps" in [f.code for f in found]
    with pytest.raises(InputError, match="another structure"):
        advance(state, replace(observations[2], model_hash="other"))


def test_what_is_no_mode_does_not_count() -> None:
    wave = replace(estimate(0.1, 0.05), status=ModeStatus.WAVE)
    state, _ = advance(TwinState("model"), observation({1: estimate(0.18, 0.01), 2: wave}, NOON))
    assert list(state.totals[ALL].modes) == [1]


def test_the_shape_that_is_kept_is_the_one_in_which_waves_lag() -> None:
    subspace = estimate(0.18, 0.01)
    refined = replace(subspace, mode_shape=np.array([1.1 + 0.0j]), unrefined=subspace)
    sensors = (Sensor("a", direction=(1.0, 0.0, 0.0), node="top"),)
    for mode in (subspace, refined):
        seen = observation({1: mode}, NOON, sensors=sensors)
        state, _ = advance(TwinState("model", with_shapes=True), seen)
        assert state.clearest["1"].shape == subspace.mode_shape


def test_a_year_of_a_turbine_is_five_megabytes_at_most() -> None:
    """Ten-minute records of six modes in two states and winds that vary: what six days add, times 61."""
    observations = year(12, 144, by_wind=True)
    half, _ = advance_all(TwinState("model", by_wind=True), observations[: 6 * 144])
    whole, _ = advance_all(half, observations[6 * 144 :])
    size = [len(json.dumps(STATE.dump(state), separators=(",", ":"))) for state in (half, whole)]
    assert size[0] + (size[1] - size[0]) * 359 / 6 < 5e6


def one_day_of(modes: list[ModalEstimate]) -> ModeTotal:
    """Return the total of records of ten minutes on one day."""
    return of_day(reduce(plus, (of_estimate(mode, 600.0) for mode in modes)))


def test_the_mean_is_that_of_the_sightings() -> None:
    """The same weights as the fusion of sightings where all are equally long, if they do not scatter."""
    rng = np.random.default_rng(3)
    # scatter below what the covariances state, so that neither mean is widened
    modes = [estimate(0.18 * np.exp(rng.normal(0.0, 1e-3)), 0.012, 4e-3, 0.3, rho=0.3) for _ in range(9)]
    total = one_day_of(modes)
    ours, theirs = average(total), average_of_sightings(sightings(modes, [600.0] * 9))
    # whole numbers of 2^-24 carry nine digits of these sums
    assert ours.frequency_hz == pytest.approx(theirs.frequency_hz, rel=1e-9)
    assert ours.damping_ratio == pytest.approx(theirs.damping_ratio, rel=1e-9)
    # a geometric mean of the claimed ratios for their median, at frequencies that differ by 1e-3
    assert ours.log_std == pytest.approx(theirs.log_std, rel=1e-4)
    assert ours.correlation == pytest.approx(0.3, rel=1e-6)


def test_days_that_lie_apart_widen_the_mean() -> None:
    """Thirty records a day for eight days whose tides differ: not 240 independent records."""
    rng = np.random.default_rng(4)
    total, record_std, day_std = ModeTotal(), 4e-3, 8e-3
    shifts = rng.normal(0.0, day_std, 8)
    for shift in shifts:
        one_day = [
            estimate(0.18 * np.exp(shift + rng.normal(0.0, record_std)), 0.012, 4e-3) for _ in range(30)
        ]
        total = plus(total, one_day_of(one_day))
    expected = shifts.std(ddof=1) / np.sqrt(8)
    # the spread of eight numbers, and of 30 records about each
    assert average(total).log_std[0] == pytest.approx(expected, rel=0.1)


def test_the_factor_of_birge_divides_by_the_degrees_of_freedom() -> None:
    """Two values ±a: their mean's deviation is a, whatever they state, and whatever scatters."""
    a, stated = 0.02, 4e-3
    low, high = (estimate(0.18 * np.exp(side * a), 0.012, stated) for side in (-1.0, 1.0))
    # χ² = 2a²/s² on one degree of freedom, times s²/2
    assert average(one_day_of([low, high])).log_std[0] == pytest.approx(a, rel=1e-6)
    # thirty records each day: χ² of the days 60a²/s² on one degree of freedom, times s²/60
    days = plus(one_day_of([low] * 30), one_day_of([high] * 30))
    assert average(days).log_std[0] == pytest.approx(a, rel=1e-6)


def test_a_mean_covers_the_truth_as_often_as_it_says() -> None:
    """95 % intervals of ln f over 400 sets of eight records that scatter as they say they do."""
    rng = np.random.default_rng(5)
    inside = 0
    for _ in range(400):
        modes = [estimate(0.18 * np.exp(rng.normal(0.0, 4e-3)), 0.012, 4e-3) for _ in range(8)]
        mean = average(one_day_of(modes))
        inside += abs(np.log(mean.frequency_hz / 0.18)) < 1.96 * mean.log_std[0]
    # the widening never narrows, so a little above 0.95; three standard deviations of 400 draws below
    assert inside / 400 > 0.95 - 3 * np.sqrt(0.95 * 0.05 / 400)
    assert inside / 400 < 0.995


def test_an_observation_of_the_version_before_is_read(seen: Observation) -> None:
    document = OBSERVATION.dump(seen)
    fault = {
        "fault": "sign",
        "text": "has the opposite sign of all parallel channels; sign changed",
        "channel": "a",
    }
    old = {
        **document,
        "schema_version": 1,
        "quality": {**document["quality"], "findings": [{**fault, "repaired": True, "params": {}}]},
        "findings": [{"code": "sign", "subject": "a", "params": {"text": fault["text"]}}],
    }
    now = OBSERVATION.load(old)
    assert [str(f) for f in now.findings] == [f"a: {fault['text']}"]
    assert now.findings[0].severity == "warning"
    assert now.quality["findings"][0]["subject"] == "a"


def test_sentences_of_an_older_identification_are_read_as_findings(seen: Observation) -> None:
    document = json.loads(json.dumps(OBSERVATION.dump(seen)))
    said = {"warnings": ["a: is constant; left out"], "notes": ["a pair was rotated"]}
    old = {**document, "schema_version": 3, "identification": {**document["identification"], **said}}
    now = OBSERVATION.load(old).identification
    assert now.warnings == (*said["warnings"],)
    assert [(f.severity, str(f)) for f in now.notes] == [("info", *said["notes"])]
    assert OBSERVATION.load({**document, "schema_version": 3}).findings == seen.findings


def test_intervals_of_95_percent_of_an_older_observation_are_read_as_90(seen: Observation) -> None:
    document = json.loads(json.dumps(OBSERVATION.dump(seen)))
    pairs = (("frequency_hz", "frequency_interval"), ("damping_ratio", "damping_ratio_interval"))
    for mode in document["identification"]["modes"]:
        for one in filter(None, (mode, mode.get("unrefined"))):
            for value, name in pairs:
                if ends := one.pop(f"{name}_90", None):
                    wider = [one[value] * (end / one[value]) ** (NORMAL_95 / NORMAL_90) for end in ends]
                    one[f"{name}_95"] = wider
    now = OBSERVATION.load({**document, "schema_version": 2})
    was, now_has = ([m.damping_ratio_interval_90 for m in o.identification.modes] for o in (seen, now))
    np.testing.assert_allclose(now_has, was, rtol=1e-12)


def test_documents_of_another_kind_or_version_are_refused(seen: Observation) -> None:
    document = OBSERVATION.dump(seen)
    with pytest.raises(InputError, match="another kind of document"):
        STATE.load(document)
    with pytest.raises(InputError, match=r"schema_version: unknown version.*allowed: 1 to 4"):
        OBSERVATION.load({**document, "schema_version": 99})
    with pytest.raises(InputError, match=r"identification\.modes\.0\.frequency_hz: not a number"):
        damaged = json.loads(json.dumps(document))
        damaged["identification"]["modes"][0]["frequency_hz"] = "fast"
        OBSERVATION.load(damaged)
    with pytest.raises(InputError, match="name: required key is missing"):
        OBSERVATION.load({k: v for k, v in document.items() if k != "name"})


def of_another_turbine(seen: Observation) -> Observation:
    """Return an observation none of whose modes is the model's."""
    finding = Finding("no_mode_of_the_model", params={"modes": len(seen.recognised)})
    return replace(
        seen, recognised=(None,) * len(seen.recognised), findings=(*seen.findings, finding), record_id="other"
    )


def test_a_record_of_another_structure_counts_nowhere() -> None:
    own = observation({1: estimate(0.2, 0.01)}, NOON, name="own")
    other = of_another_turbine(replace(own, name="other"))
    assert other.mismatched and not own.mismatched
    state, _ = advance(TwinState("model"), own)
    after, (said,) = advance(state, other)
    assert after is state
    assert (said.code, said.severity, said.subject) == ("record_mismatched", "warning", "other")
    # one without any mode, of a quiet hour, is no other turbine's
    quiet = replace(
        of_another_turbine(own), identification=replace(own.identification, modes=()), recognised=()
    )
    assert not quiet.mismatched
