"""What keeps a server from starting is said as the user's input, before anything is started."""

from __future__ import annotations

import signal
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from jackettwin.errors import InputError
from jackettwin.service import ServiceSettings, serve
from jackettwin.service.context import Service
from jackettwin.service.intake.mqtt import MqttIntake
from jackettwin.service.workers.cluster import WorkerCluster


@pytest.fixture(autouse=True)
def handler() -> Iterator[None]:
    before = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, before)


@pytest.fixture
def settings(tmp_path: Path) -> ServiceSettings:
    return ServiceSettings(store=tmp_path / "store")


def test_a_port_that_is_taken_is_said(settings: ServiceSettings) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        with pytest.raises(InputError, match="taken") as error:
            serve(settings.model_copy(update={"port": other.getsockname()[1]}))
    assert error.value.field == "port"
    assert not settings.store.exists()


def test_an_address_of_another_machine_is_said(settings: ServiceSettings) -> None:
    with pytest.raises(InputError, match="listen") as error:
        serve(settings.model_copy(update={"host": "192.0.2.1"}))  # kept for documentation, RFC 5737
    assert error.value.field == "host"


def test_a_certificate_that_is_none_is_said(settings: ServiceSettings, tmp_path: Path) -> None:
    (tmp_path / "cert.pem").write_text("no certificate")
    with pytest.raises(InputError, match="certificate"):
        serve(settings.model_copy(update={"tls_certificate": tmp_path / "cert.pem"}))


def test_a_scheduler_that_is_none_is_said(settings: ServiceSettings) -> None:
    with pytest.raises(InputError) as error:
        WorkerCluster(settings.model_copy(update={"scheduler": "nonsense"}))
    assert (error.value.field, error.value.value) == ("scheduler", "nonsense")


def test_a_broker_of_another_kind_is_said(service: Service) -> None:
    with pytest.raises(InputError, match="broker"):
        MqttIntake(service, "http://127.0.0.1")
