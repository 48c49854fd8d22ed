"""What is drawn of a record beside its samples: densities through time, singular values, motion, faults."""

from __future__ import annotations

import json
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from tests.service.conftest import NOON, description, quick, record_file, turn, upload

from jackettwin.records import Channel, Record, assess, read_record
from jackettwin.service.answer_cache import AnswerCache
from jackettwin.service.context import Service
from jackettwin.service.web.answers import coloured_by_life
from jackettwin.service.web.schemas.drawings import StructureOut
from jackettwin.service.web.signals import spectra, spectrogram
from jackettwin.service.workers import engine, record_views
from jackettwin.store import Packet, open_database, read_waveform, reading, streams, write_waveform, writing
from jackettwin.store.tables import records

RATE = 20.0
SHIPPED = Path(engine.__file__).parents[2] / "data" / "records" / "pile_U12_s301.parquet"


def record(data: np.ndarray) -> Record:
    channels = tuple(Channel(f"c{i}", "acceleration", "m/s^2") for i in range(len(data)))
    return Record(data, RATE, channels, start_utc=NOON)


def test_a_spectrogram_follows_a_tone_and_its_level(rng: np.random.Generator) -> None:
    """A sine of amplitude 1 moves from 0.5 to 1.0 Hz at half time; a segment's density integrates to ½."""
    t = np.arange(12_000) / RATE
    tone = np.where(t < 300.0, np.sin(2 * np.pi * 0.5 * t), np.sin(2 * np.pi * 1.0 * t))
    found = spectrogram(record(tone[None]), None, 2.0, 60.0)
    power = 10.0 ** (np.array(found.level_db, float) / 10.0)
    peak = np.array(found.frequency_hz)[power.argmax(axis=1)]
    start = np.array(found.time_s)
    assert (peak[start + 60.0 < 300.0] == 0.5).all() and (peak[start > 300.0] == 1.0).all()
    # levels are rounded to 0.1 dB: 1.2 % of power
    np.testing.assert_allclose(power[0].sum() * found.frequency_hz[0], 0.5, rtol=0.012)


def test_a_segment_without_samples_has_no_level() -> None:
    data = np.sin(np.arange(12_000))[None]
    data[0, :2400] = np.nan
    found = spectrogram(record(data), "c0", 2.0, 60.0)
    assert found.level_db[0] == [None] * len(found.frequency_hz) and None not in found.level_db[-1]


def test_two_forces_have_two_singular_values(rng: np.random.Generator) -> None:
    """Three channels of two independent noises of variance 1 and 4 (densities 0.1 and 0.4 per Hz), turned."""
    force = rng.standard_normal((2, 120_000)) * [[1.0], [2.0]]
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0][:, :2]
    found = np.array(spectra(record(turn @ force)).singular_values)
    level = found[:, 5:-5].mean(axis=1)
    # the mean of 199 segments parts them: 2 % of scatter, and a bias of the same size away from each other
    np.testing.assert_allclose(level[:2], [0.4, 0.1], rtol=0.06)
    assert level[2] < 1e-9


def test_the_singular_values_are_of_one_unit() -> None:
    data = np.random.default_rng(1).standard_normal((2, 4000))
    mixed = Record(data, RATE, (Channel("a", "acceleration", "m/s^2"), Channel("b", "tilt", "rad")))
    alone = Record(data[:1], RATE, mixed.channels[:1])
    assert spectra(mixed).singular_values == spectra(alone).singular_values


def test_faults_are_told_where_they_are(tmp_path: Path, rng: np.random.Generator) -> None:
    """A gap from 100 to 110 s, and a spike of 80 standard deviations at 300 s."""
    data = rng.standard_normal((2, 12_000))
    data[0, 2000:2200] = np.nan
    data[1, 6000] = 80.0
    write_waveform(record(data), tmp_path / "r")
    found = record_views.stretches("", str(tmp_path / "r"))
    gap, spike = (s for s in found if s["code"] in ("gap", "left_out"))
    assert gap == {"channel": "c0", "code": "gap", "text": "no samples", "from_s": 100.0, "to_s": 109.95}
    assert spike["channel"] == "c1" and spike["from_s"] <= 300.0 <= spike["to_s"] < 301.0
    assert "spike" in spike["text"]


def test_a_record_moves_its_structure(tmp_path: Path) -> None:
    """Its largest motion is a parked tower's in 12 m/s, and what is sent is scaled by it."""
    twin = Path(engine.__file__).parents[2] / "data" / "twins" / "openfast_pile.yaml"
    (tmp_path / engine.TWIN_FILE).write_bytes(twin.read_bytes())
    shipped = read_record(SHIPPED)
    write_waveform(shipped, tmp_path / "r")
    found = record_views.motion(str(tmp_path), str(tmp_path / "r"), 60.0)
    q, shapes = np.array(found["q"]), np.array(found["shapes"])
    assert q.shape == (600, len(shapes)) and not found["cyclic"]
    moved = np.abs(q @ shapes).max() * found["largest_m"]
    np.testing.assert_allclose(moved, found["largest_m"], rtol=1e-3)  # shapes and q are rounded
    assert 0.01 < found["largest_m"] < 2.0


def test_packets_are_handed_on_once(tmp_path: Path) -> None:
    database = open_database(f"sqlite:///{tmp_path / 'd.sqlite'}")
    packets = [Packet("a", "x", NOON + timedelta(seconds=k), RATE, np.arange(3.0) + k) for k in range(3)]
    with writing(database) as connection:
        streams.add_packets(connection, packets[:1], NOON)
    with reading(database) as connection:
        last, none = streams.packets_after(connection, "a", None)
    with writing(database) as connection:
        streams.add_packets(connection, packets[1:], NOON)
        streams.add_packets(connection, [Packet("b", "x", NOON, RATE, np.arange(3.0))], NOON)
    with reading(database) as connection:
        last, new = streams.packets_after(connection, "a", last)
        again = streams.packets_after(connection, "a", last)
    assert none == [] and [p.t0_utc for p in new] == [p.t0_utc for p in packets[1:]]
    assert again == (last, [])
    database.dispose()


def test_what_examination_set_aside_is_found_once(
    client: TestClient, service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who looks again is told the same, without a worker, and by what was observed, also after a restart.

    A gap of samples 800 to 899, at 20 Hz; of samples that were deleted nothing is told.
    """
    gapped = {"file": ("r.parquet", record_file(samples=2000, gap=(800, 900)))}
    sent = client.post("/api/v1/assets/wtg/records", files=gapped, data={"description": description()})
    given = sent.json()["record_id"]
    asked, submit = [], service.cluster.submit
    monkeypatch.setattr(
        service.cluster, "submit", lambda task, *more, **how: asked.append(task) or submit(task, *more, **how)
    )
    first, again = (client.get(f"/api/v1/records/{given}/stretches").json() for _ in range(2))
    assert first == again
    assert asked == [record_views.stretches]

    def observed(model: Any, waveform: Path, *more: Any) -> engine.ObservationRows:
        seen, quality = quick(model, waveform, *more), assess(read_waveform(waveform)).summary()
        return seen._replace(document=json.dumps({**json.loads(seen.document), "quality": quality}))

    monkeypatch.setattr(engine, "observed", observed)
    turn(service, 2)
    service.answers = AnswerCache()
    asked.clear()
    assert client.get(f"/api/v1/records/{given}/stretches").json() == first
    assert asked == []
    (gap,) = (one for one in first["items"] if one["code"] == "gap")
    assert (gap["channel"], gap["from_s"], gap["to_s"]) == ("acc_top_x", 40.0, 44.95)
    with writing(service.database) as connection:
        connection.execute(records.update().values(waveform=None))
    assert client.get(f"/api/v1/records/{given}/stretches").status_code == 404


@pytest.mark.parametrize("what", ["spectrogram", "motion", "stretches"])
def test_what_was_deleted_is_not_there(client: TestClient, what: str) -> None:
    assert client.get(f"/api/v1/records/{'0' * 24}/{what}").status_code == 404


def test_modes_are_asked_for_by_state_of_operation(client: TestClient, service: Service) -> None:
    """By the first word of it, in rows and in bins alike; a wildcard of the database is a letter."""
    states = ("parked, pitch 90 deg", "idling", "parked")
    uploaded = [
        upload(client, k, conditions={"state": state}).json()["record_id"] for k, state in enumerate(states)
    ]
    turn(service, 3)
    modes = "/api/v1/assets/wtg/modes"

    def count(state: str) -> tuple[int, int]:
        rows = client.get(modes, params={"state": state, "label": "mode_1"}).json()["items"]
        bins = client.get(f"{modes}/bins", params={"state": state, "label": "mode_1"}).json()["items"]
        return len(rows), sum(sum(one["count"]) for one in bins)

    assert [count(state) for state in ("parked", "idling", "operating", "%")] == [
        (2, 2),
        (1, 1),
        (0, 0),
        (0, 0),
    ]
    own = client.get(modes, params={"record": uploaded[1]}).json()["items"]
    assert len(own) == 2 and {row["record_id"] for row in own} == {uploaded[1]}


def test_members_are_coloured_by_the_worst_weld_of_their_side() -> None:
    """Of two welds on a leg the faster counts; doubtful ones do not; without any there is no colour."""
    drawn = StructureOut(text=["leg (jacket)<br>D 1 m", "brace (jacket)<br>D 1 m", "tower<br>D 6 m"])
    left = {"remaining_years": {"p50": 40.0}, "beyond_validity": []}
    welds = [
        {"chord": "leg", "brace": "brace", "side": "chord", "rate_per_year": 0.01, **left},
        {"chord": "leg", "brace": "other", "side": "chord", "rate_per_year": 0.02, **left},
        {"chord": "tower", "brace": "tower", "side": "tube", "rate_per_year": 0.03, **left},
        {
            "chord": "leg",
            "brace": "brace",
            "side": "brace",
            "rate_per_year": 9.0,
            **left,
            "beyond_validity": ["τ"],
        },
    ]
    life, damage = coloured_by_life(drawn, welds).quantities
    assert life.values == [40.0, None, 40.0] and damage.values == [0.02, None, 0.03]
    assert coloured_by_life(drawn, []) is drawn
