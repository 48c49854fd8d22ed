"""How a server runs: everything that ``jackettwin serve`` may be told."""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass
from pathlib import Path

from jackettwin.errors import InputError
from jackettwin.store import sqlite_url


@dataclass(frozen=True)
class ServiceSettings:
    """Where a server listens, works and keeps things.

    Attributes
    ----------
    store : Path
        Folder of waveforms, spool and, without ``database``, of the database.
    host, port
        Where it listens.
    database : str or None
        URL of PostgreSQL; None for SQLite in the store.
    scheduler : str or None
        Address of a Dask scheduler whose workers see the store at the same path; None for workers of its own.
    workers : int
        Of its own, one thread each.
    mqtt : str or None
        ``mqtt[s]://[user:password@]host[:port]`` of a broker to listen to.
    tls_certificate, tls_key : Path or None
        For HTTPS without a proxy.
    behind_proxy : bool
        Whether a proxy in front ends TLS and passes on who asked.
    trusted_header : str or None
        Header in which the proxy names the user it has authenticated, as OIDC proxies do.
    raw_days : float or None
        Days for which the samples of observed records are kept, 0 for ever; None leaves the store's policy.
    upload_limit_bytes : int
        Largest file that is taken.
    samples_limit : int
        Most samples, over all channels, that a file may expand to.
    parse_limit_s, observe_limit_s : float
        After which reading or observing a record is given up.
    worker_memory_bytes : int
        Of one worker: no file may expand beyond it; who observes beyond it is ended, a try of the record.
    """

    store: Path
    host: str = "127.0.0.1"
    port: int = 8470
    database: str | None = None
    scheduler: str | None = None
    workers: int = 2
    mqtt: str | None = None
    tls_certificate: Path | None = None
    tls_key: Path | None = None
    behind_proxy: bool = False
    trusted_header: str | None = None
    raw_days: float | None = None
    upload_limit_bytes: int = 512 * 2**20
    samples_limit: int = 200_000_000
    parse_limit_s: float = 120.0
    observe_limit_s: float = 600.0
    worker_memory_bytes: int = 3 * 2**30

    @property
    def database_url(self) -> str:
        """URL of the database, stated or of the store's own."""
        return self.database or sqlite_url(self.store)

    @property
    def loopback(self) -> bool:
        """Whether nobody but this machine can reach the server."""
        return is_loopback(self.host)

    @property
    def secure(self) -> bool:
        """Whether what browsers send is encrypted on its way."""
        return self.tls_certificate is not None or self.behind_proxy

    @property
    def spool(self) -> Path:
        """Folder of files on their way in."""
        return self.store / "spool"

    @property
    def inbox(self) -> Path:
        """Folder with a folder of every asset, into which its files may be dropped."""
        return self.store / "inbox"

    @property
    def models(self) -> Path:
        """Folder in which the twins' files are laid out for workers."""
        return self.store / "models"


def is_loopback(host: str) -> bool:
    """Tell whether a host name or address is this machine's own."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def refuse_exposed(settings: ServiceSettings, users: bool) -> None:
    """Refuse to listen where others can reach, unless users are defined and TLS protects their passwords.

    Raises
    ------
    InputError
        If the host is not loopback and there are no users, or no TLS of our own or of a proxy.
    """
    if settings.loopback:
        return
    if not users:
        raise InputError(
            "others can reach this address, and no user is defined",
            field="host",
            value=settings.host,
            allowed="127.0.0.1, or users",
            remedy="define one: jackettwin user add NAME --role admin --store STORE",
        )
    if not settings.secure:
        raise InputError(
            "others can reach this address, and passwords would travel unencrypted",
            field="host",
            value=settings.host,
            allowed="127.0.0.1, or TLS",
            remedy="give --tls-certificate and --tls-key, or --behind-proxy if a proxy ends TLS",
        )
