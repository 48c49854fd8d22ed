"""A twin followed day after day: what is known grows, a run goes on where the last one stopped."""

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from observations import observation

from jackettwin.change import Days
from jackettwin.errors import InputError, NumericalError
from jackettwin.files import write_json
from jackettwin.identification import ModalEstimate, RealPole
from jackettwin.progress import CallbackProgress, Progress
from jackettwin.records.readers.channels import FileDefaults
from jackettwin.report.figures.follow import parameters_through_time
from jackettwin.report.pages.follow import build_follow_page
from jackettwin.response.sensors import Sensor
from jackettwin.soil import family
from jackettwin.study.follow import follow, follow_days, follow_observations
from jackettwin.study.follow_result import FOLLOWED, Followed, follow_document, read_followed
from jackettwin.study.in_time.question import question_of
from jackettwin.study.in_time.slope import MOST_SPANS, spans_of
from jackettwin.study.in_time.track import SuddenChange
from jackettwin.twin import Observation, TwinConfig, TwinModel, read_twin, twin_model
from jackettwin.updating import Problem, SupportModel, support_model, update

follow_module = import_module("jackettwin.study.follow")
MODES, TRUTH = (1, 2, 4), np.array([3e9, 0.1])
F_STD, ZETA_STD = 5e-4, 0.1
NOON = datetime(2025, 1, 1, 12, tzinfo=UTC)


@pytest.fixture(scope="module")
def config() -> TwinConfig:
    twin = read_twin("thesis_table_6_1")
    changed = {
        "laws": ("maxwell-3",),
        "particles": 40,
        "bounds": {"k": (5e8, 2e10), "loss_factor": (0.01, 0.5)},
        "damping_of": "all",
        "weighting": "auto",
    }
    settings = twin.update.model_copy(update=changed)
    return replace(twin, targets=(), update=settings)


@pytest.fixture(scope="module")
def model(config: TwinConfig) -> TwinModel:
    return twin_model(config)


@pytest.fixture(scope="module")
def records(config: TwinConfig, model: TwinModel) -> list[Observation]:
    """Two records a day for three days, of stiffness that falls by a tenth a day."""
    supports = support_model(
        model.structure, family=family("maxwell-3"), rayleigh=config.rayleigh, highest_mode=5
    )
    rng = np.random.default_rng(5)
    seen = []
    for i in range(6):
        poles = supports.predict(TRUTH * np.array([0.9 ** (i // 2), 1.0]), MODES).poles
        modes = {}
        for mode, pole in zip(MODES, poles, strict=True):
            true = np.log([abs(pole) / 2 / np.pi, -pole.real / abs(pole)])
            f, zeta = np.exp(rng.normal(true, [F_STD, ZETA_STD]))
            covariance = np.diag([F_STD**2, ZETA_STD**2])
            modes[mode] = ModalEstimate(
                f, zeta, np.ones(1, complex), 1.0, 0.0, 1.0, log_covariance=covariance
            )
        time = NOON + timedelta(days=i // 2, hours=i % 2)
        seen.append(observation(modes, time, name=f"record_{i}", model_hash=model.model_hash))
    return seen


@pytest.fixture(scope="module")
def followed(config: TwinConfig, model: TwinModel, records: list[Observation]) -> Followed:
    return follow_observations(config, model, records)


def test_records_of_a_day_count_together(followed: Followed) -> None:
    assert [(day.date, day.records, day.status) for day in followed.days] == [
        (f"2025-01-0{i}", 2, "ok") for i in (1, 2, 3)
    ]
    np.testing.assert_allclose(followed.days_since_first, [0.0, 1.0, 2.0])


def test_the_drift_is_found_and_said(followed: Followed) -> None:
    assert followed.drift is not None and followed.drift.detected
    # a planted slope of ln 0.9 a day; three standard deviations are one in four hundred
    assert followed.drift.slope_per_day == pytest.approx(np.log(0.9), abs=3.0 * followed.drift.std_per_day)
    assert followed.statement.startswith("Falling: stiffness changes by -")


def test_going_on_from_yesterday_is_the_same_as_all_at_once(
    config: TwinConfig, model: TwinModel, records: list[Observation], followed: Followed, tmp_path: Path
) -> None:
    yesterday = follow_observations(config, model, records[:4])
    write_json(follow_document(yesterday), tmp_path / "followed.json")
    today = follow_observations(config, model, records[4:], prior=read_followed(tmp_path / "followed.json"))
    # bit for bit: the file keeps every digit, and what is up to date is not estimated again
    assert today.state == followed.state
    assert today.days == followed.days
    json.dumps(follow_document(today), allow_nan=False)


def test_days_one_by_one_are_those_all_at_once(
    config: TwinConfig, model: TwinModel, followed: Followed
) -> None:
    """As a service asks: with sums of days alone, and what is gone on from through a file."""
    state = followed.state
    dates, kept = list(state.days), None
    for n in range(1, len(dates) + 1):
        same = 0 if kept is None else len(kept.days)
        before = follow_module.empty_state(model) if kept is None else kept.state
        every = Days.of(state.until(dates[n - 1]))
        kept, now = follow_days(config, model, every, before, same=same, prior=kept)
        assert now.days == followed.days[:n]
        if kept is not None:
            assert kept.days == followed.days[: n - 1] and kept.smoothed == {}
            kept = FOLLOWED.load(json.loads(json.dumps(FOLLOWED.dump(kept))))
    assert (now.smoothed, now.ahead) == (followed.smoothed, followed.ahead)
    assert FOLLOWED.dump(now)["pooled"] == FOLLOWED.dump(followed)["pooled"]


def test_a_late_record_renews_its_day_and_those_after(
    config: TwinConfig, model: TwinModel, records: list[Observation], followed: Followed
) -> None:
    without = follow_observations(config, model, [*records[:3], *records[4:]])
    steps: list[str] = []
    late = follow_observations(
        config, model, records[3:4], prior=without, progress=CallbackProgress(steps.append)
    )
    assert steps == ["update after 2025-01-02", "update after 2025-01-03"]
    assert late.state == followed.state and late.days == followed.days
    assert any("older than 1 days" in line for line in late.warnings)


def test_the_same_record_twice_is_one_record_and_said(
    config: TwinConfig, model: TwinModel, records: list[Observation], followed: Followed
) -> None:
    twice = follow_observations(config, model, [*records, *records])
    assert twice.state == followed.state and twice.days == followed.days
    assert sum("are used once" in line for line in twice.warnings) == 6


def test_a_posterior_that_does_not_converge_is_a_status(
    config: TwinConfig, model: TwinModel, records: list[Observation], monkeypatch: pytest.MonkeyPatch
) -> None:
    def apart(*_: object, **__: object) -> object:
        raise NumericalError("the posterior did not converge: R-hat 1.30 (k)")

    monkeypatch.setattr(update_module(), "sample_posterior", apart)
    (day,) = follow_observations(config, model, records[:2]).days
    assert day.status.startswith("the posterior did not converge")
    low, high = day.interval_90["k"]
    assert low < TRUTH[0] < high


def update_module():  # type: ignore[no-untyped-def]
    """The module, which its package hides behind the function of the same name."""
    import sys

    assert callable(update)
    return sys.modules["jackettwin.updating.update"]


def test_the_posterior_of_a_thousand_days_costs_that_of_ten(
    config: TwinConfig, model: TwinModel, records: list[Observation], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In evaluations of the model; climbing a ladder rung by rung took 1.8 times as many."""
    counted = SupportModel.predict_many
    taken = {10: 0, 1000: 0}
    state = follow_module.empty_state(model)
    question = None
    for i in range(1000):
        shown = records[i % 2]
        state, _ = follow_module.advance(
            state, replace(shown, start_utc=NOON + timedelta(days=i), record_id=f"r{i:04d}")
        )
        if i + 1 in taken:
            question = question or question_of(config, model, state, None)

            def counting(
                self: SupportModel, theta: np.ndarray, *args: Any, day: int = i + 1, **options: Any
            ) -> Any:
                taken[day] += len(theta)
                return counted(self, theta, *args, **options)

            monkeypatch.setattr(SupportModel, "predict_many", counting)
            assert question.pooled(state).status == "ok"
    assert taken[1000] <= 1.2 * taken[10]


def test_many_days_cost_what_ten_do(model: TwinModel, records: list[Observation]) -> None:
    """The drift of a hundred days is fitted to spans of days, as many as of ten or fewer."""
    state = follow_module.empty_state(model)
    for i in range(100):
        shown = records[i % 6]
        state, _ = follow_module.advance(
            state, replace(shown, start_utc=NOON + timedelta(days=i), record_id=f"r{i:03d}")
        )
    spans = spans_of(state)
    assert 5 <= len(spans) <= MOST_SPANS
    assert sum(len(span.days) for span in spans) == 100


def test_of_a_drift_too_short_to_be_seen_nothing_is_said(followed: Followed) -> None:
    """Over some hours the interval of a daily change is thousands of per cent: no number to quote."""
    drift = followed.drift
    assert drift is not None
    blind = replace(drift, z=np.zeros_like(drift.z), covariance=np.eye(len(drift.z)))
    assert "would not reveal even a doubling a day" in replace(followed, drift=blind).statement


def test_a_sudden_change_lies_after_the_last_estimate_before_it(followed: Followed) -> None:
    """Estimated once a month, nobody knows the day: the sentence names the month."""
    change = SuddenChange(0.99, (20203.0,) * 3, (0.87, 0.91, 0.97))  # days since 1970: 2025-04-25
    one, track = followed.days[0], SimpleNamespace(changes=(change,))

    def said(*dates: str) -> str:
        days = tuple(replace(one, date=d, time_utc=datetime.fromisoformat(f"{d}T12:00Z"),
                             relative=(0.8, 0.9, 1.0)) for d in dates)  # fmt: skip
        return replace(followed, days=days, track=track).stiffness_statement  # type: ignore[arg-type]

    monthly = said("2025-02-24", "2025-03-26", "2025-04-25")
    assert monthly.startswith("The stiffness fell by 9 % between 2025-03-26 and 2025-04-25, 90 % interval")
    daily = said("2025-04-23", "2025-04-24", "2025-04-25")
    assert daily.startswith("The stiffness fell by 9 % on 2025-04-25, 90 % interval -13 to -3 %.")


def test_what_cannot_be_followed(
    config: TwinConfig, model: TwinModel, records: list[Observation], followed: Followed, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match="another law, structure"):
        follow_observations(config, model, records[5:], law="zener", prior=followed)
    with pytest.raises(InputError, match="no new records"):
        follow(config)
    with pytest.raises(InputError, match="without a start"):
        follow_observations(config, model, [replace(records[0], start_utc=None)])
    undated = tmp_path / "clockless.csv"
    undated.write_text("x [m/s^2]\n" + "0.1\n-0.1\n" * 300)
    with (
        pytest.MonkeyPatch.context() as patch,
        pytest.raises(InputError, match=r"clockless\.csv.*without a start"),
    ):
        patch.setattr(
            import_module("jackettwin.twin.observe_files"), "observe", None
        )  # nothing is identified in it
        follow(replace(config, records=(undated,), defaults=FileDefaults(sample_rate_hz=10.0)))
    relative = replace(config, update=config.update.model_copy(update={"weighting": "relative"}))
    with pytest.raises(InputError, match="needs a standard deviation"):
        follow_observations(relative, model, records)


def test_a_file_that_is_no_prior(tmp_path: Path) -> None:
    path = tmp_path / "followed.json"
    path.write_text("{")
    with pytest.raises(InputError, match="not a JSON document"):
        read_followed(path)
    path.write_text("{}")
    with pytest.raises(InputError, match="required key is missing"):
        read_followed(path)


def test_one_day_alone_has_a_date_and_whole_numbers_on_its_axes(followed: Followed) -> None:
    """Its loss factor of 0.21 stood at a tick that said "2", above an axis without a date."""
    layout = parameters_through_time(replace(followed, days=followed.days[:1], drift=None), ["k"]).layout
    midnight = followed.days[0].time_utc.replace(hour=0, minute=0, second=0, microsecond=0)
    first, last = layout.xaxis.range
    assert first < midnight < last or first < midnight + timedelta(days=1) < last
    assert layout.yaxis.tickformat


def test_the_page_shows_parameters_and_the_statement(followed: Followed, tmp_path: Path) -> None:
    text = build_follow_page(followed, tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Falling: stiffness changes by" in text
    assert "2025-01-03" in text
    assert "stiffness_through_time" in text and "others_through_time" in text


@pytest.fixture
def shaped(model: TwinModel, records: list[Observation]) -> list[Observation]:
    """The same records with shapes at two heights, the second's worse, and a relaxation in each."""
    x, y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    sensors = tuple(
        Sensor(f"{height:g}{axis}", direction, height_m=height)
        for height in (144.0, 77.0)
        for axis, direction in (("x", x), ("y", y))
    )
    motion = follow_motion(model, sensors)
    out = []
    for i, record in enumerate(records[:2]):
        modes = {
            mode: replace(shown, mode_shape=motion[:, mode - 1] + 0.1j * i)
            for mode, (shown, _) in record.modes.items()
        }
        pole = RealPole(3.3 + 0.1 * i, 0.3, (2.8, 4.0), np.full(4, 0.5 - 0.5j), 1.0)
        out.append(
            observation(
                modes, record.start_utc, name=record.name, model_hash=record.model_hash, sensors=sensors,
                real_poles=(pole,), mac=1.0 - 0.1 * i,
            )
        )  # fmt: skip
    return out


def follow_motion(model: TwinModel, sensors: tuple[Sensor, ...]) -> np.ndarray:
    from jackettwin.response.sensors import observation_matrix

    return np.asarray(observation_matrix(model.structure, sensors) @ model.modes.shapes)


def test_shapes_and_real_poles_are_followed_and_kept(
    config: TwinConfig,
    model: TwinModel,
    shaped: list[Observation],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each day's problem holds the clearest shapes so far, and after a file the same ones."""
    problems: list[Problem] = []

    def drawn(_: TwinConfig, problem: Problem, progress: Progress) -> tuple[np.ndarray, str]:
        problems.append(problem)
        return np.tile(np.log(TRUTH), (3, 1)), "ok"

    monkeypatch.setattr("jackettwin.study.in_time.question._draws", drawn)
    monkeypatch.setattr("jackettwin.study.in_time.question._draws_after", lambda *_: None)
    with_shapes = replace(
        config, update=config.update.model_copy(update={"mac_std": 0.02, "model_errors": ()})
    )
    keeping = replace(model, with_shapes=True)
    shaped = [replace(one, model_hash=keeping.model_hash) for one in shaped]
    first = follow_observations(with_shapes, keeping, shaped[:1], each="record")
    write_json(follow_document(first), tmp_path / "followed.json")
    again = read_followed(tmp_path / "followed.json")
    follow_observations(with_shapes, keeping, shaped[1:], each="record", prior=again)
    follow_observations(with_shapes, keeping, shaped, each="record")
    names = ["f1", "ζ1", "f2", "ζ2", "f4", "ζ4", "MAC1", "MAC2", "MAC4", "a1"]
    assert [problem.data_names for problem in problems] == [names] * 4
    states = [problem.states[0] for problem in problems]
    for state in states[1:]:
        for here, at_first in zip(state.shapes, states[0].shapes, strict=True):
            # the first record's are the clearest throughout; JSON keeps every digit
            np.testing.assert_array_equal(here.shape, at_first.shape)
    rates = [state.relaxations[0].rate for state in states]
    # whole numbers of 2^-24 keep nine digits of a rate
    assert rates[0] == rates[2] == pytest.approx(3.3, rel=1e-7) and rates[1] == rates[3] > rates[0]
    assert states[1].relaxations[0].shape is not None


def test_a_law_without_real_poles_cannot_follow_them(
    config: TwinConfig, model: TwinModel, shaped: list[Observation]
) -> None:
    with pytest.raises(InputError, match="no structure on this law has real poles"):
        follow_observations(config, model, shaped, law="springpot")
