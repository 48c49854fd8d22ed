"""Whoever speaks to Dask runs programs as the server's user: nobody else does, on this machine or another."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import psutil
import pytest
from distributed import Security
from tests.service.servers import free_port, wait_for_port

from jackettwin.errors import InputError
from jackettwin.service import ServiceSettings
from jackettwin.service.workers.certificates import own_security
from jackettwin.service.workers.cluster import WorkerCluster

INTRUDER = """
import os, sys
from distributed import Client, Security
from distributed.comm import tcp
address, marker = sys.argv[1:]
own = Security.temporary()
if os.geteuid() == 0:
    os.setgroups([])
    os.setresgid(65534, 65534, 65534)
    os.setresuid(65534, 65534, 65534)
for security in (None, own):
    scheme = "tcp" if security is None else "tls"
    try:
        client = Client(f"{scheme}://{address}", security=security, timeout="3s")
        client.submit(os.mkdir, marker).result(timeout=10)
        print("let in")
    except Exception as error:
        print("refused" if isinstance(error, OSError) else repr(error))
"""
"""As nobody, where we are root: the intruder is another user of the machine."""


@pytest.fixture(scope="module")
def compute(tmp_path_factory: pytest.TempPathFactory) -> Iterator[WorkerCluster]:
    made = WorkerCluster(ServiceSettings(store=tmp_path_factory.mktemp("store"), workers=1))
    assert made.submit(os.getpid).result(timeout=120)
    yield made
    made.close()


def ports() -> set[tuple[str, int]]:
    """Return where this process and its children listen."""
    me = psutil.Process()
    found = set()
    for process in (me, *me.children(recursive=True)):
        with suppress(psutil.Error):
            found |= {
                tuple(c.laddr) for c in process.net_connections("tcp") if c.status == psutil.CONN_LISTEN
            }
    return found


def intrude(address: str, marker: Path) -> list[str]:
    asked = [sys.executable, "-c", INTRUDER, address, str(marker)]
    ran = subprocess.run(asked, capture_output=True, text=True, cwd="/", check=False, timeout=120)
    return ran.stdout.splitlines() or [ran.stderr]


def test_nobody_else_has_a_worker_run_anything(compute: WorkerCluster, tmp_path: Path) -> None:
    """Neither by plain TCP nor with a certificate of his own."""
    address = compute.client.scheduler_info()["address"].partition("//")[2]
    assert intrude(address, tmp_path / "marker") == ["refused", "refused"]
    assert not (tmp_path / "marker").exists()


def test_what_listens_is_of_this_machine_and_answers_strangers_nothing(compute: WorkerCluster) -> None:
    found = ports()
    assert len(found) >= 3  # scheduler, nanny, worker
    assert {host for host, _ in found} == {"127.0.0.1"}
    for place in found:
        with socket.create_connection(place, timeout=5.0) as stranger, suppress(OSError):
            stranger.sendall(b"GET /json/identity.json HTTP/1.0\r\n\r\n")
            answer = stranger.recv(4096)
            assert answer[:1] in (b"", b"\x15") or b" 404 " in answer, (place, answer)  # an alert of TLS


def test_the_certificate_outlives_every_server_and_clock(compute: WorkerCluster) -> None:
    from cryptography import x509

    found = x509.load_pem_x509_certificate(str(own_security().tls_ca_file).encode())
    assert (found.not_valid_before_utc.year, found.not_valid_after_utc.year) == (2000, 2100)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:8786", "127.0.0.1:8786"])
def test_a_scheduler_elsewhere_is_asked_by_tls_alone(tmp_path: Path, address: str) -> None:
    with pytest.raises(InputError) as error:
        WorkerCluster(ServiceSettings(store=tmp_path, scheduler=address))
    assert (error.value.field, error.value.allowed) == ("scheduler", "tls://HOST:PORT")
    with pytest.raises(InputError, match="certificates"):
        WorkerCluster(ServiceSettings(store=tmp_path, scheduler="tls://127.0.0.1:8786"))


def written(security: Security, folder: Path) -> dict[str, Path]:
    names = {"ca": "tls_ca_file", "certificate": "tls_client_cert", "key": "tls_client_key"}
    for name, field in names.items():
        (folder / f"{name}.pem").write_text(str(getattr(security, field)))
    return {name: folder / f"{name}.pem" for name in names}


def test_a_scheduler_elsewhere_does_our_work_and_no_strangers(tmp_path: Path) -> None:
    files, port = written(own_security(), tmp_path), free_port()
    tls = ["--tls-ca-file", files["ca"], "--tls-cert", files["certificate"], "--tls-key", files["key"]]
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    host = [
        "--host",
        "127.0.0.1",
        "--port",
        str(port),
        "--no-dashboard",
        "--dashboard-address",
        "127.0.0.1:0",
    ]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": tmp_path}
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", f"tls://127.0.0.1:{port}", *tls]
    started = [subprocess.Popen([*dask, "--protocol", "tls", *host, *tls], **quiet)]  # type: ignore[call-overload]
    try:
        wait_for_port(port, 60.0)
        started.append(subprocess.Popen([*worker, "--nthreads", "1", "--no-dashboard"], **quiet))  # type: ignore[call-overload]
        given = {f"scheduler_{name}": path for name, path in files.items()}
        settings = ServiceSettings(store=tmp_path, scheduler=f"tls://127.0.0.1:{port}", **given)
        ours = WorkerCluster(settings)
        try:
            assert ours.submit(os.getpid).result(timeout=120) != os.getpid()
        finally:
            ours.close()
        assert intrude(f"127.0.0.1:{port}", tmp_path / "marker") == ["refused", "refused"]
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait(timeout=20)
        time.sleep(0.1)
