"""The unit file is run: another user, nothing but the store to be written, homes closed; with real work.

Where there is no systemd its settings are made by hand, in a mount namespace of our own.
"""

from __future__ import annotations

import configparser
import os
import shutil
import signal
import socket
import subprocess
import sys
import sysconfig
import time
from contextlib import suppress
from datetime import timedelta
from pathlib import Path
from typing import Any

import httpx
import pytest
from tests.service.conftest import PASSWORD, description, hour, record_file
from tests.service.servers import free_port, opened
from tests.service.test_survival import new_store

from jackettwin.service.web import auth
from jackettwin.store import people, sqlite_url, work, writing

ROOT = Path(__file__).parents[2]
NOBODY = 65534
INSIDE = """
set -e
cd /
mount -t tmpfs tmpfs /srv && mkdir /srv/twin && mount --bind "$STORE" /srv/twin
mount -t tmpfs tmpfs /opt && mkdir -p /opt/jackettwin/bin /opt/python /opt/source /opt/packages
mount --bind "$PYTHON" /opt/python
mount --bind "$SOURCE" /opt/source
mount --bind "$PACKAGES" /opt/packages
printf '#!/bin/sh\\nexec /opt/python/bin/%s -m jackettwin "$@"\\n' "$NAME" > /opt/jackettwin/bin/jackettwin
chmod 755 /opt/jackettwin/bin/jackettwin
findmnt -rno TARGET | grep -v -e '^/proc' -e '^/sys' -e '^/dev' -e '^/srv/twin$' | while read -r place; do
  mount -o remount,bind,ro "$place" 2> /dev/null || true
done
for place in /home /root; do mount -t tmpfs -o mode=000,ro tmpfs "$place"; done
for place in /tmp /var/tmp; do mount -t tmpfs tmpfs "$place"; done
umask "$MASK"
exec setpriv --reuid="$WHO" --regid="$WHO" --clear-groups --no-new-privs env -i \\
  PATH=/usr/bin:/bin HOME=/nonexistent LD_LIBRARY_PATH=/opt/python/lib OMP_NUM_THREADS=1 \\
  JACKETTWIN_SERVE_PARSE_LIMIT_S=900 \\
  PYTHONPATH=/opt/source:/opt/packages NOTIFY_SOCKET="$NOTIFY" "$@"
"""
"""ProtectSystem=strict, ProtectHome=true, ReadWritePaths=/srv/twin, PrivateTmp=true, NoNewPrivileges=true."""


def unit() -> configparser.SectionProxy:
    """Return what the unit file says of the service."""
    parsed = configparser.ConfigParser(interpolation=None, strict=True)
    parsed.optionxform = str  # type: ignore[assignment, method-assign]
    parsed.read(ROOT / "deploy" / "jackettwin.service")
    return parsed["Service"]


def inside(store: Path, notify: str, *command: str) -> list[str]:
    """Return a command that runs another one as the unit file says."""
    given = {
        "STORE": store,
        "PYTHON": sys.base_prefix,
        "SOURCE": ROOT / "src",
        "PACKAGES": sysconfig.get_path("purelib"),
        "NAME": Path(os.path.realpath(sys.executable)).name,
        "WHO": NOBODY,
        "MASK": unit()["UMask"],
        "NOTIFY": notify,
    }
    place = [f"{name}={value}" for name, value in given.items()]
    return [
        "env",
        *place,
        "unshare",
        "--mount",
        "--propagation",
        "private",
        "sh",
        "-c",
        INSIDE,
        "sh",
        *command,
    ]


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """A store of the service's user, with a turbine and an engineer."""
    for settings in (
        "ProtectSystem=strict",
        "ProtectHome=true",
        "ReadWritePaths=/srv/twin",
        "PrivateTmp=true",
    ):
        name, value = settings.split("=")
        assert unit()[name] == value  # what is made by hand here
    if os.geteuid() != 0 or not all(map(shutil.which, ("unshare", "setpriv", "findmnt"))):
        pytest.skip("only root makes mount namespaces, with util-linux")
    made = new_store(tmp_path, "wtg")
    for path in (made, *made.rglob("*")):
        os.chown(path, NOBODY, NOBODY)
    tried = inside(made, "", "/opt/jackettwin/bin/jackettwin", "--version")
    if subprocess.run(tried, capture_output=True, check=False).returncode:
        pytest.skip("no mount namespace can be made here, or Python does not run elsewhere")
    return made


def test_homes_are_closed_and_only_the_store_is_written(store: Path) -> None:
    script = (
        "for d in /srv/twin /opt/jackettwin /usr /etc /home /root; do touch $d/x 2>/dev/null && echo $d; done"
    )
    done = subprocess.run(
        inside(store, "", "sh", "-c", f"{script}; id -u"), capture_output=True, text=True, check=False
    )
    assert done.stdout.split() == ["/srv/twin", str(NOBODY)]


def test_the_unit_file_serves_observes_and_studies(store: Path) -> None:
    """What is compiled for a study is kept in the store: there is no other place to write."""
    name, port, settings = f"@jackettwin-{os.getpid()}", free_port(), unit()
    with opened(sqlite_url(store)) as database, writing(database) as connection:
        admin = people.User("admin", "admin", auth.hashed(PASSWORD), hour(0))
        people.add_user(connection, admin)
        secret, _ = auth.new_grant(connection, "admin", "token", "test", hour(0), timedelta(days=3650))
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as system:
        system.bind("\0" + name[1:])
        system.settimeout(1.0)
        command = [*settings["ExecStart"].split(), "--port", str(port), "--workers", "1"]
        with (store.parent / "log").open("wb") as log:
            process = subprocess.Popen(inside(store, name, *command), stdout=log, stderr=log)
        try:
            _heard(system, b"READY=1", process, float(settings["TimeoutStartSec"]))
            client = httpx.Client(
                base_url=f"http://127.0.0.1:{port}/api/v1",
                headers={"Authorization": f"Bearer {secret}", "X-Forwarded-Proto": "https"},
                timeout=900.0,
            )
            with client:
                sent = client.post(
                    "/assets/wtg/records",
                    files={"file": ("r.parquet", record_file(1, samples=2400))},
                    data={"description": description(hour(6))},
                )
                assert sent.status_code == 202, sent.text
                _wait_for_work(client, store / "cache")
                health = client.get("/health").json()
                assert (health["status"], health["problems"]) == ("ok", [])
            _heard(system, b"WATCHDOG=1", process, float(settings["WatchdogSec"]))
            process.send_signal(getattr(signal, settings["KillSignal"]))  # unshare and the shell became it
            assert process.wait(float(settings["TimeoutStopSec"])) == int(settings["SuccessExitStatus"]), (
                store.parent / "log"
            ).read_text()
        finally:
            with suppress(ProcessLookupError):
                process.kill()
    assert "Matplotlib created a temporary" not in (store.parent / "log").read_text()
    owners = {path.stat().st_uid for path in store.rglob("*")}
    assert owners == {NOBODY}
    assert not any(path.stat().st_mode & 0o077 for path in (store, *store.glob("*.sqlite*")))


def _wait_for_work(client: httpx.Client, cache: Path) -> None:
    """Wait until a record is observed and its study has kept what it compiled, without a failed try.

    That study ends within two CPU minutes, most of them compilation; this test does not wait for it.
    """
    end = time.monotonic() + 600.0
    found: dict[str, Any] = {}
    while time.monotonic() < end:
        found = {job["kind"]: job for job in client.get("/jobs").json()["items"]}
        studied = found.get(work.KNOW, {"state": "queued", "tries": 0})
        first_try = {"queued": 0, "leased": 1, "done": 1}  # a try is counted when it begins
        assert studied["tries"] == first_try.get(studied["state"]), studied
        compiled = any(cache.rglob("*.nbc"))
        if found["observe"]["state"] == "done" and studied["state"] != "queued" and compiled:
            return
        time.sleep(0.5)
    raise TimeoutError(found)


def _heard(system: socket.socket, what: bytes, process: subprocess.Popen[bytes], seconds: float) -> None:
    """Wait until the server tells its manager something."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        assert process.poll() is None, "it ended by itself"
        with suppress(TimeoutError):
            if system.recv(100) == what:
                return
    raise TimeoutError(what)
