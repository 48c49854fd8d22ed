"""A twin followed day after day: what is known grows, a run goes on where the last one stopped."""

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.files import write_json
from jackettwin.identification import ModalEstimate
from jackettwin.report.follow_page import build_follow_page
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.structure import Assembly
from jackettwin.twin import TwinConfig, follow, read_twin
from jackettwin.twin.assembled import assembled
from jackettwin.twin.config import GivenRelaxation
from jackettwin.twin.follow import follow_modes, follow_twin
from jackettwin.twin.follow_document import follow_document, read_followed
from jackettwin.twin.followed import Followed, RecordModes
from jackettwin.twin.measure import Sighting
from jackettwin.updating import Problem, family, numbered_modes, support_model

MODES, TRUTH = (1, 2, 4), np.array([3e9, 0.1])
F_STD, ZETA_STD = 5e-4, 0.1
NOON = datetime(2025, 1, 1, 12, tzinfo=UTC)


@pytest.fixture(scope="module")
def config() -> TwinConfig:
    twin = read_twin("thesis_table_6_1")
    update = replace(
        twin.update,
        laws=("maxwell-3",),
        particles=40,
        bounds={"k": (5e8, 2e10), "loss_factor": (0.01, 0.5)},
        damping_of="all",
        weighting="auto",
    )
    return replace(twin, targets=(), update=update)


@pytest.fixture(scope="module")
def assembly(config: TwinConfig) -> Assembly:
    return assembled(config)


@pytest.fixture(scope="module")
def records(config: TwinConfig, assembly: Assembly) -> list[RecordModes]:
    """Two records a day for three days, of stiffness that falls by a tenth a day."""
    model = support_model(assembly, family=family("maxwell-3"), rayleigh=config.rayleigh, highest_mode=5)
    rng = np.random.default_rng(5)
    seen = []
    for i in range(6):
        time = NOON + timedelta(days=i // 2, hours=i % 2)
        sightings = {}
        for mode, pole in zip(
            MODES, model.predict(TRUTH * np.array([0.9 ** (i // 2), 1.0]), MODES).poles, strict=True
        ):
            f, zeta = np.exp(
                rng.normal(np.log([abs(pole) / 2 / np.pi, -pole.real / abs(pole)]), [F_STD, ZETA_STD])
            )
            estimate = ModalEstimate(
                f, zeta, np.ones(1, complex), 1.0, 0.0, 1.0, log_covariance=np.diag([F_STD**2, ZETA_STD**2])
            )
            sightings[mode] = Sighting(estimate, 1.0, 600.0)
        seen.append(RecordModes(f"record_{i}", time, sightings))
    return seen


@pytest.fixture(scope="module")
def followed(config: TwinConfig, assembly: Assembly, records: list[RecordModes]) -> Followed:
    return follow_modes(config, assembly, records)


def test_records_of_a_day_count_together(followed: Followed) -> None:
    assert [[r.name for r in day.records] for day in followed.days] == [
        [f"record_{2 * i}", f"record_{2 * i + 1}"] for i in range(3)
    ]
    np.testing.assert_allclose(followed.days_since_first, [0.0, 1.0, 2.0])


def test_the_drift_is_found_and_said(followed: Followed) -> None:
    assert followed.drift is not None and followed.drift.detected
    # a planted slope of ln 0.9 a day; three standard deviations are one in four hundred
    assert followed.drift.slope_per_day == pytest.approx(np.log(0.9), abs=3.0 * followed.drift.std_per_day)
    assert followed.statement.startswith("Falling: k changes by -")


def test_going_on_from_yesterday_is_the_same_as_all_at_once(
    config: TwinConfig, assembly: Assembly, records: list[RecordModes], followed: Followed, tmp_path: Path
) -> None:
    yesterday = replace(followed, days=followed.days[:2])
    write_json(follow_document(yesterday), tmp_path / "followed.json")
    today = follow_modes(config, assembly, records[4:], prior=read_followed(tmp_path / "followed.json"))
    for name, interval in followed.days[-1].interval_90.items():
        # draws that start from covariances rounded on their way through the file
        assert today.days[-1].interval_90[name] == pytest.approx(interval, rel=1e-3)
    assert today.drift is not None and followed.drift is not None
    # both descents end within their tolerance
    assert today.drift.slope_per_day == pytest.approx(followed.drift.slope_per_day, rel=1e-4)
    json.dumps(follow_document(today), allow_nan=False)


def test_what_cannot_be_followed(
    config: TwinConfig, assembly: Assembly, records: list[RecordModes], followed: Followed
) -> None:
    with pytest.raises(InputError, match="precedes the last day"):
        follow_modes(config, assembly, records[:1], prior=followed)
    with pytest.raises(InputError, match="another law, structure"):
        follow_modes(
            config, assembly, records[5:], law="zener", prior=replace(followed, days=followed.days[:2])
        )
    with pytest.raises(InputError, match="no new records"):
        follow_twin(config)
    relative = replace(config, update=replace(config.update, weighting="relative"))
    with pytest.raises(InputError, match="needs a standard deviation"):
        follow_modes(relative, assembly, records)


def test_a_file_that_is_no_prior(tmp_path: Path) -> None:
    path = tmp_path / "followed.json"
    path.write_text("{")
    with pytest.raises(InputError, match="not a JSON document"):
        read_followed(path)
    path.write_text("{}")
    with pytest.raises(InputError, match="required key is missing"):
        read_followed(path)


def test_the_page_shows_parameters_and_the_statement(followed: Followed, tmp_path: Path) -> None:
    text = build_follow_page(followed, tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Falling: k changes by" in text
    assert "2025-01-03" in text
    assert "parameters_through_time" in text


@pytest.fixture
def shaped(config: TwinConfig, assembly: Assembly, records: list[RecordModes]) -> list[RecordModes]:
    """The same records with shapes at two heights, the second's worse, and a relaxation in each."""
    x, y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    sensors = tuple(
        Sensor(f"{height:g}{axis}", direction, height_m=height)
        for height in (144.0, 77.0)
        for axis, direction in (("x", x), ("y", y))
    )
    names = tuple(sensor.channel for sensor in sensors)
    numbered = numbered_modes(assembly, max(MODES))
    motion = observation_matrix(assembly, sensors) @ numbered.shapes
    turned = []
    for i, record in enumerate(records[:2]):
        sightings = {
            mode: replace(
                seen,
                estimate=replace(seen.estimate, mode_shape=motion[:, mode - 1] + 0.1j * i),
                mac=1.0 - 0.1 * i,
                channels=names,
            )
            for mode, seen in record.sightings.items()
        }
        relaxation = GivenRelaxation(3.3 + 0.1 * i, 0.3, dict.fromkeys(names, 0.5 - 0.5j))
        turned.append(replace(record, sightings=sightings, sensors=sensors, relaxations=(relaxation,)))
    return turned


def test_shapes_and_real_poles_are_followed_and_kept(
    config: TwinConfig,
    assembly: Assembly,
    shaped: list[RecordModes],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each day's problem holds the clearest shapes so far, and after a file the same ones."""
    problems: list[Problem] = []

    def sampled(problem: Problem, **_: object) -> object:
        problems.append(problem)
        d = len(problem.parameters)
        return SimpleNamespace(log_theta=np.zeros((3, d)), interval=lambda: np.ones((d, 2)))

    monkeypatch.setattr(follow, "sample_posterior", sampled)
    with_shapes = replace(config, update=replace(config.update, mac_std=0.02, model_errors=()))
    first = follow_modes(with_shapes, assembly, shaped[:1], each="record")
    write_json(follow_document(first), tmp_path / "followed.json")
    again = read_followed(tmp_path / "followed.json")
    follow_modes(with_shapes, assembly, shaped[1:], each="record", prior=again)
    follow_modes(with_shapes, assembly, shaped, each="record")
    names = ["f1", "ζ1", "f2", "ζ2", "f4", "ζ4", "MAC1", "MAC2", "MAC4", "a1"]
    assert [problem.data_names for problem in problems] == [names] * 4
    states = [problem.states[0] for problem in problems]
    for state in states[1:]:
        for here, at_first in zip(state.shapes, states[0].shapes, strict=True):
            # the first record's are the clearest throughout; JSON keeps every digit
            np.testing.assert_array_equal(here.shape, at_first.shape)
    rates = [state.relaxations[0].rate for state in states]
    assert rates[0] == rates[2] == pytest.approx(3.3) and rates[1] == rates[3] > rates[0]
    assert states[1].relaxations[0].shape is not None


def test_a_law_without_real_poles_cannot_follow_them(
    config: TwinConfig, assembly: Assembly, shaped: list[RecordModes]
) -> None:
    with pytest.raises(InputError, match="no structure on this law has real poles"):
        follow_modes(config, assembly, shaped, law="springpot")
