"""What a turbine's days say of its supports, whose damping it is, and the page on it, without a stand-in."""

from __future__ import annotations

import gzip
import json
from datetime import timedelta
from pathlib import Path

import numpy as np
import pytest
from tests.service.conftest import NOON
from tests.support.observations import estimate, observation

from jackettwin.service.web.schemas.drawings import ExploredOut
from jackettwin.service.web.schemas.life import LifeOut
from jackettwin.service.workers import engine, verdict
from jackettwin.service.workers.question import Question
from jackettwin.service.workers.tasks import know
from jackettwin.twin import OBSERVATION
from jackettwin.twin.life.sensed_damage import SensedDamage

TWIN = """structure: jacket15
gravity: true
damping: {rayleigh: {ratio: 0.0055, frequency_hz: 0.183}}
update: {laws: [kelvin-voigt], particles: 20, starts: 2, damping_of: all}
"""
MODES = {1: estimate(0.1755, 0.012, 2e-3, 0.1), 2: estimate(0.1785, 0.011, 2e-3, 0.1)}


def outcome_of(folder: Path, modes: dict) -> tuple[dict, str]:
    """Return what is kept of three records that show some modes, and the page on it."""
    (folder / engine.TWIN_FILE).write_text(TWIN)
    model = engine.load_twin(folder).model
    documents = []
    for k in range(3):
        made = observation(modes, NOON + timedelta(minutes=10 * k), name=f"r{k}")
        made = type(made)(**{**vars(made), "model_hash": model.model_hash})
        documents.append(json.dumps(OBSERVATION.dump(made)))
    folded = engine.advance_day(model, "2025-03-01", None, documents)
    asked = Question(
        "wtg", 1, str(folder), {"2025-03-01": "a"}, {"2025-03-01": folded.document}, tuple(documents[:2]),
        (3, 1800.0), of="it",
    )  # fmt: skip
    outcome = know(asked)
    assert outcome.page is not None and outcome.of == "it"
    return json.loads(outcome.document), gzip.decompress(outcome.page).decode()


def asked_of(folder: Path, modes: dict) -> tuple[dict, str]:
    """Return what is known of them, and the page on it."""
    document, page = outcome_of(folder, modes)
    return document["known"], page


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict, str]:
    return outcome_of(tmp_path_factory.mktemp("twin"), MODES)


@pytest.fixture(scope="module")
def answered(kept: tuple[dict, str]) -> tuple[dict, str]:
    return kept[0]["known"], kept[1]


@pytest.fixture(scope="module")
def told(kept: tuple[dict, str]) -> dict:
    return kept[0]


def test_what_no_ground_explains_has_no_interval(tmp_path: Path) -> None:
    """The report's headline and the answer of the API are one."""
    odd = {1: MODES[1], 2: estimate(0.30, 0.011, 2e-3, 0.1)}
    known, page = asked_of(tmp_path, odd)
    assert known["status"] == verdict.CANNOT_MEET
    assert {found["interval_90"] for found in known["parameters"].values()} == {None}
    assert "cannot reproduce the measurements on any ground" in page
    assert known["answers"][0]["answer"].startswith(
        "The model cannot reproduce the measurements on any ground"
    )


def test_parameters_have_intervals_and_units(answered: tuple[dict, str]) -> None:
    known, _ = answered
    assert (known["law"], known["records"]) == ("kelvin-voigt", 3)
    for found in known["parameters"].values():
        low, high = found["interval_90"]
        assert low < found["median"] < high
    assert {found["unit"] for found in known["parameters"].values()} == {"N/m", "N·s/m"}


def test_sources_make_up_the_damping(answered: tuple[dict, str]) -> None:
    known, _ = answered
    first = known["budget"][0]
    assert first["measured"]["value"] == pytest.approx(0.012, rel=0.05)
    total = sum(source["value"] for source in first["sources"].values())
    assert total == pytest.approx(0.012, rel=0.25)  # 10 % each of three records, and of the model
    assert first["sources"]["structure"]["value"] == pytest.approx(0.0055, rel=0.1)  # Rayleigh's, at 0.183 Hz


def test_a_softer_ground_slows_the_first_mode(answered: tuple[dict, str]) -> None:
    """By how much every parameter moves each mode: the steel has most of the stiffness."""
    known, _ = answered
    first = known["sensitivity"][0]
    assert first["mode"] in (1, 2) and first["label"] == known["budget"][0]["label"]
    assert set(first["frequency_sensitivity"]) == set(known["parameters"])
    assert 0.0 < first["frequency_sensitivity"]["k"] < 0.5
    assert first["damping_sensitivity"]["k"] < 0.0 < first["damping_sensitivity"]["c"]


def test_the_law_is_explored_around_the_medians(told: dict) -> None:
    """The cost rises far from the parameters, and every locus goes through the damping that is known."""
    found, known = ExploredOut(**told["together"]["known"]["explored"]), told["known"]
    assert "explored" not in known  # what the twin knows stays short
    at = {p.name: p.value for p in found.parameters}
    assert at == pytest.approx({name: p["median"] for name, p in known["parameters"].items()}, rel=1e-5)
    assert found.surface is not None
    assert (found.surface.x.parameter, found.surface.y.parameter) == ("k", "c")
    assert len(found.surface.cost) == len(found.surface.y.values)
    assert {len(row) for row in found.surface.cost} == {len(found.surface.x.values)}
    here = [curve.cost[curve.factor.index(1.0)] for curve in found.curves]
    assert here == pytest.approx([here[0]] * 2, rel=1e-5)  # of one and the same point
    assert found.surface.cost[0][0] > 10.0 * here[0] and found.surface.cost[0][-1] > 10.0 * here[0]
    first = known["sensitivity"][0]
    for locus in found.loci:
        (branch,) = (b for b in locus.branches if b.mode == first["mode"])
        assert branch.damping_ratio[locus.origin] == pytest.approx(first["damping_ratio"], rel=1e-5)
        assert len(branch.frequency_hz) == len(locus.values)


def test_the_page_is_of_all_records(answered: tuple[dict, str]) -> None:
    _, page = answered
    assert "3 records, 30 minutes" in page  # two of them are shown one by one


def test_without_a_day_nothing_is_known(tmp_path: Path) -> None:
    """All its records were superseded before it was asked."""
    outcome = know(Question("wtg", 1, str(tmp_path), {}, {}, of="it"))
    assert outcome is not None and outcome.of == "it"
    assert json.loads(outcome.document)["known"]["status"] == verdict.NO_MODE


def test_the_life_of_the_welds_goes_on_from_what_is_kept_as_if_all_days_were_sent(tmp_path: Path) -> None:
    """A second day, asked with and without what the first one left; findings and rows are equal."""
    (tmp_path / engine.TWIN_FILE).write_text(TWIN + "life: {years: 20}\n")
    model = engine.load_twin(tmp_path).model
    days = {}
    for k, date in enumerate(("2025-03-01", "2025-03-02")):
        made = observation(MODES, NOON + timedelta(days=k), name=f"r{k}")
        damage = SensedDamage(
            np.array([3, 8]), np.full((2, 8), 500 + 40 * k), np.array([5, 5]), np.array([9, 9]), 90
        )
        made = type(made)(**{**vars(made), "model_hash": model.model_hash, "damage": damage})
        days[date] = engine.advance_day(model, date, None, [json.dumps(OBSERVATION.dump(made))]).document

    def asked(dates: list[str], sent: list[str], kept: dict) -> dict:
        question = Question(
            "wtg", 1, str(tmp_path), {d: d for d in dates}, {d: days[d] for d in sent}, (),
            (len(dates), 600.0), kept=kept,
        )  # fmt: skip
        return json.loads(know(question).document)

    first = asked(["2025-03-01"], ["2025-03-01"], {})
    whole = asked([*days], [*days], {})
    rows, past, _ = verdict.lived(
        engine.load_twin(tmp_path), {d: d for d in days}, {"2025-03-02": days["2025-03-02"]}, whole["lived"]
    )
    assert rows == whole["life"] and past == whole["lived"]
    assert first["life"][0]["records"] == 1 and rows[0]["records"] == 2
    assert rows[0]["budget_per_year"] == pytest.approx(0.05)
    assert [LifeOut(**row, model_version=1).joint for row in rows]


def test_a_twin_that_does_not_ask_for_life_has_none(kept: tuple[dict, str]) -> None:
    assert kept[0]["life"] == [] and kept[0]["lived"] is None
