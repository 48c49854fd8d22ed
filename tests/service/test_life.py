"""The life of welds by a real record, from its upload to the answer."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from tests.service.conftest import turn

from jackettwin.records import read_record
from jackettwin.service.context import Service
from jackettwin.service.web.catalogue import add_text_version
from jackettwin.service.workers import engine
from jackettwin.study.life.asset_life import asset_life
from jackettwin.study.life.life_so_far import LifeSoFar
from jackettwin.twin import TwinState, advance_all, observe, read_twin, twin_model

DATA = Path(str(files("jackettwin"))) / "data"
RECORD, TWIN = DATA / "records/pile_U12_s301.parquet", (DATA / "twins/openfast_pile.yaml").read_text()
OBSERVED = engine.observed
"""The identification itself, which other tests stand in for."""


def test_the_damage_of_a_real_record_is_answered(
    service: Service, client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The welds, rates and intervals of the command's own functions; a copy and a rebuild add nothing."""
    monkeypatch.setattr(engine, "observed", OBSERVED)
    head, _, rest = TWIN.partition("records:")
    text = head + rest[rest.index("tolerances:") :]
    add_text_version(service, "pile", text, {}, "test")
    sent = {
        "files": {"file": ("r.parquet", RECORD.read_bytes())},
        "data": {"description": RECORD.with_suffix(".json").read_text()},
    }
    assert client.post("/api/v1/assets/pile/records", **sent).status_code == 202
    turn(service, 6)
    told = client.get("/api/v1/assets/pile/life").json()["items"]
    assert len(told) == 20 and all(row["records"] == 1 for row in told)
    assert sum(row["side"] == "tube" for row in told) == 4
    order = [(bool(row["beyond_validity"]), row["life_years"]) for row in told]
    assert order == sorted(order) and told[0]["life_years"] > 0.0
    model = twin_model(read_twin("openfast_pile"))
    seen = observe(read_record(RECORD), model)
    state, _ = advance_all(TwinState(model.model_hash), [seen])
    (day,) = state.days.values()
    assert model.stress is not None
    direct = asset_life(
        model.stress, LifeSoFar().plus("2025-01-01", day, model.stress.settings.budget)
    ).rows()
    assert {(r["joint"], r["brace"], r["side"]) for r in told} == {
        (r["joint"], r["brace"], r["side"]) for r in direct
    }
    # samples are stored to a ten-thousandth of their steps
    assert [r["rate_per_year"] for r in told] == pytest.approx([r["rate_per_year"] for r in direct], rel=0.1)
    short, first = client.get("/api/v1/assets/pile").json(), told[0]["remaining_years"]
    assert short["remaining_years"] == first["p50"]
    assert short["remaining_years_interval_90"] == [first["p05"], first["p95"]]
    for row in told:
        low, high = row["damage_interval_90"]
        assert low < high and sum(row["variance_shares"].values()) == pytest.approx(1.0, abs=1e-5)
    assert client.post("/api/v1/assets/pile/records", **sent).status_code == 200
    turn(service, 3)
    assert client.get("/api/v1/assets/pile/life").json()["items"] == told
