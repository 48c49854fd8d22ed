"""A service whose workers are this process, with a turbine whose records are observed in no time."""

from __future__ import annotations

import io
import json
import pickle
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi.testclient import TestClient
from scipy.signal import lfilter
from tests.service.alerting import Receiver
from tests.support.observations import estimate, observation

from jackettwin.service import ServiceSettings
from jackettwin.service.context import Service
from jackettwin.service.web import auth
from jackettwin.service.web.app import EXAMPLES, create_app
from jackettwin.service.web.catalogue import add_text_version
from jackettwin.service.work.dispatch import Dispatcher
from jackettwin.service.workers import engine, verdict
from jackettwin.store import open_database, people, read_waveform, sqlite_url, work, writing
from jackettwin.twin import OBSERVATION, TwinConfig, TwinModel, twin_model

TWIN = "structure: jacket15\n"
HERE = ("127.0.0.1", 50000)
"""Who is at the other end of a connection from this machine."""
PASSWORD = "three small words"
NOON = datetime(2025, 3, 1, 12, tzinfo=UTC)


class Done:
    """A future that is done."""

    key = "done"

    def __init__(self, value: Any = None, error: Exception | None = None) -> None:
        self._value, self._error = value, error
        self.status = "finished" if error is None else "error"

    def done(self) -> bool:
        return True

    def result(self, timeout: float | None = None) -> Any:
        if self._error is not None:
            raise self._error
        return self._value

    def exception(self, timeout: float | None = None) -> Exception | None:
        return self._error

    def add_done_callback(self, callback: Callable[[Any], None]) -> None:
        callback(self)


class Here:
    """Work that is done at once, in this process."""

    workers, restarts, reachable = 1, 0, True

    def submit(self, task: Callable[..., Any], *args: Any, priority: int = 0, study: bool = False) -> Done:
        try:
            return Done(task(*args))
        except Exception as error:
            return Done(error=error)

    def result(self, future: Any, limit_s: float) -> Any:
        return future.result()

    def has_begun(self, future: Any, ago_s: float = 0.0) -> bool:
        return ago_s == 0.0

    def end(self, future: Any) -> None:
        self.restarts += 1

    def forsaken(self, future: Any) -> bool:
        return False

    def mend(self) -> None:
        """Nothing to mend."""

    def close(self) -> None:
        """Nothing to stop."""


def quick(model: Any, waveform: Path, conditions: dict[str, Any], picks: Any = ()) -> engine.ObservationRows:
    """Stand in for the identification: two modes whose frequencies depend on the samples alone."""
    record = read_waveform(waveform)
    a, b = (0.18 + 1e-4 * float(np.nansum(record.data)) % 1e-3, 0.55)
    modes = {1: estimate(a, 0.012, 4e-3, 0.2), 3: estimate(b, 0.01, 4e-3, 0.2)}
    seen = replace(
        observation(modes, record.start_utc, name=record.name, conditions=dict(conditions)),
        record_id=waveform.stem,
        model_hash=model.model_hash,
    )
    rows = tuple(
        {
            "label": f"mode_{number}",
            "frequency_hz": mode.frequency_hz,
            "frequency_std_hz": mode.frequency_std_hz,
            "damping_ratio": mode.damping_ratio,
            "damping_ratio_std": mode.damping_ratio_std,
            "damping_ratio_low_90": 0.01,
            "damping_ratio_high_90": 0.02,
            "status": "ok",
        }
        for number, mode in modes.items()
    )
    return engine.ObservationRows(json.dumps(OBSERVATION.dump(seen)), rows, (), None)


def record_file(k: int = 0, *, samples: int = 200, gap: tuple[int, int] = (0, 0)) -> bytes:
    """Return a Parquet record of two channels with modes at 0.5 and 1.3 Hz; ``k`` chooses its samples.

    The first channel lacks those of a gap.
    """
    noise = np.random.default_rng(k).standard_normal((2, samples))
    data = 0.05 * noise + sum(mixed * resonator(f, noise[i]) for i, (f, mixed) in enumerate(SHAPES.items()))
    data[0, slice(*gap)] = np.nan
    buffer = io.BytesIO()
    pq.write_table(pa.table({"acc_top_x": data[0], "acc_top_y": data[1]}), buffer)
    return buffer.getvalue()


SHAPES = {0.5: np.array([[1.0], [0.3]]), 1.3: np.array([[-0.4], [1.0]])}
"""Of the modes at 0.5 and 1.3 Hz."""


def resonator(frequency_hz: float, force: np.ndarray) -> np.ndarray:
    """Return the response of an oscillator of 1.5 % damping to white noise at 20 Hz."""
    pole = np.exp((-0.015 + 1j) * 2 * np.pi * frequency_hz / 20.0)
    return np.asarray(lfilter([1.0 - abs(pole)], [1.0, -2 * pole.real, abs(pole) ** 2], force))


def description(start: datetime = NOON, **more: Any) -> str:
    """Return what lies beside a record."""
    axes = {"acc_top_x": [1, 0, 0], "acc_top_y": [0, 1, 0]}
    channels = {
        name: {"quantity": "acceleration", "unit": "m/s^2", "height_m": 120.0, "direction": axis}
        for name, axis in axes.items()
    }
    return json.dumps({"sample_rate_hz": 20.0, "start_utc": start.isoformat(), "channels": channels, **more})


def hour(k: int) -> datetime:
    """Return the start of a record, ``k`` hours after noon."""
    return NOON + timedelta(hours=k)


def known(twin: Any, sums: Any, newest: Any, in_all: tuple[int, float]) -> tuple[dict[str, Any], None]:
    """Stand in for the posterior."""
    k = 1e9 * in_all[0]
    parameters = {"k": {"median": k, "interval_90": [0.9 * k, 1.1 * k], "unit": "N/m"}}
    budget = [
        {"label": "mode_1", "measured": None, "sources": {"soil": {"value": 0.01, "low": 0.0, "high": 0.02}}}
    ]
    moved = {
        "mode": 1,
        "label": "mode_1",
        "frequency_hz": 0.5,
        "damping_ratio": 0.01,
        "frequency_sensitivity": {"k": 0.02},
        "damping_sensitivity": {"k": -0.01},
    }
    answers = [{"question": "Whose damping is it?", "answer": "the rotor's"}]
    found = {
        "status": "ok",
        "parameters": parameters,
        "records": in_all[0],
        "budget": budget,
        "answers": answers,
    }
    assumed = [EXAMPLES["AssumptionOut"]]
    drawn = {
        "explored": EXAMPLES["ExploredOut"],
        "structure": EXAMPLES["StructureOut"],
        "assumptions": assumed,
    }
    return {**found, "sensitivity": [moved], **drawn}, None


@pytest.fixture(scope="session", autouse=True)
def each_model_is_built_once() -> Iterator[None]:
    """Twins of the same text have the same model, and hundreds of tests have one of a few."""
    built: dict[bytes, TwinModel] = {}

    def remembered(config: TwinConfig) -> TwinModel:
        key = pickle.dumps(replace(config, path=Path()))
        if key not in built:
            built[key] = twin_model(config)
        return built[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engine, "twin_model", remembered)
        yield


@pytest.fixture
def service(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Service]:
    yield from make_service(tmp_path / "store", None, monkeypatch)


@cache
def empty_database() -> bytes:
    """Return a database of the newest schema, which takes longer to come to than most tests."""
    with TemporaryDirectory() as folder:
        open_database(sqlite_url(Path(folder))).dispose()
        return (Path(folder) / "jackettwin.sqlite").read_bytes()


def make_service(
    store: Path,
    database: str | None,
    monkeypatch: pytest.MonkeyPatch,
    assets: tuple[str, ...] = ("wtg",),
    **changes: Any,
) -> Iterator[Service]:
    """Run a service without threads: tests turn its dispatcher by hand."""
    settings = ServiceSettings(store=store, database=database, **changes)
    for folder in (settings.store, settings.spool, settings.models):
        folder.mkdir(parents=True, exist_ok=True)
    if database is None and not (store / "jackettwin.sqlite").exists():
        (store / "jackettwin.sqlite").write_bytes(empty_database())
    monkeypatch.setattr(engine, "observed", quick)
    monkeypatch.setattr(verdict, "known", known)
    monkeypatch.setattr(verdict, "watched", lambda twin, days, *_: ({"days": len(days)}, (), {}))
    monkeypatch.setattr(verdict, "through_time", lambda *_: (None, None))
    made = Service(settings, open_database(settings.database_url), Here(), "test")  # type: ignore[arg-type]
    for name in assets:
        add_text_version(made, name, TWIN, {}, "test")
    yield made
    made.database.dispose()


@pytest.fixture
def client(service: Service) -> Iterator[TestClient]:
    with TestClient(create_app(service), base_url="http://127.0.0.1:8470", client=HERE) as client:
        yield client


@pytest.fixture(scope="session")
def password_hash() -> str:
    return auth.hashed(PASSWORD)


@pytest.fixture
def users(service: Service, password_hash: str) -> Service:
    with writing(service.database) as connection:
        for role in people.ROLES:
            people.add_user(connection, people.User(role, role, password_hash, NOON))
    return service


@pytest.fixture
def stranger(users: Service) -> Iterator[TestClient]:
    with TestClient(
        create_app(users), base_url="http://127.0.0.1:8470", client=HERE, follow_redirects=False
    ) as client:
        yield client


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    made = Receiver()
    yield made
    made.server.shutdown()
    made.server.server_close()


@pytest.fixture
def clock(service: Service) -> list[datetime]:
    """The time of the service, which a test sets."""
    time = [NOON]
    service.now = lambda: time[0]
    return time


def upload(
    client: TestClient, k: int = 0, *, start: datetime | None = None, asset: str = "wtg", **more: Any
) -> Any:
    """Send a record; ``k`` chooses its samples and its hour."""
    return client.post(
        f"/api/v1/assets/{asset}/records",
        files={"file": (f"r{k}.parquet", record_file(k))},
        data={"description": description(start or hour(k), **more)},
    )


def turn(service: Service, times: int = 3) -> None:
    """Start a dispatcher, as after a death of the server, and let it do what is due."""
    with writing(service.database) as connection:
        work.remove_server(connection, service.server_id)
    dispatcher = Dispatcher(service)
    for _ in range(times):
        dispatcher._turn()
