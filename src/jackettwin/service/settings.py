"""Settings of a server: options of ``jackettwin serve``, and limits from the environment."""

from __future__ import annotations

import ipaddress
from pathlib import Path
from typing import Annotated, Any
from urllib.parse import urlsplit

from pydantic import AfterValidator, Field, SecretStr, ValidationError
from pydantic_settings import BaseSettings, SettingsConfigDict

from jackettwin.errors import InputError, require
from jackettwin.store import sqlite_url

LOOPBACK = ("127.0.0.1", "::1")


def _network(text: str) -> str:
    return str(ipaddress.ip_network(text))


class ServiceSettings(BaseSettings):
    """Settings of a server.

    Missing ones are read from the environment, as ``JACKETTWIN_SERVE_PARSE_LIMIT_S``. A shorter prefix would
    clash with variables that Kubernetes sets for a service of this name (``JACKETTWIN_PORT``).
    """

    model_config = SettingsConfigDict(
        env_prefix="JACKETTWIN_SERVE_", env_ignore_empty=True, frozen=True, use_attribute_docstrings=True
    )

    store: Path
    """Folder of waveforms, spool and, without ``database``, the database."""
    host: str = "127.0.0.1"
    """Address to listen at."""
    port: int = Field(default=8470, ge=1, le=65535)
    database: str | None = None
    """URL of PostgreSQL; None for SQLite in the store."""
    scheduler: str | None = None
    """``tls://`` address of a Dask scheduler whose workers have the store at this path; None for local
    workers."""
    scheduler_ca: Path | None = None
    """CA certificates that verify the scheduler."""
    scheduler_certificate: Path | None = None
    """Certificate of this server for the scheduler, with ``scheduler_key``."""
    scheduler_key: Path | None = None
    workers: int = Field(default=2, ge=1)
    """Number of local workers, of one thread each."""
    mqtt: str | None = None
    """``mqtt[s]://[user@]host[:port]`` of a broker to subscribe to; default ports are 1883 and 8883."""
    mqtt_password: SecretStr | None = None
    """Password of the broker's user; only from the environment, since command lines are visible to all
    users."""
    mqtt_password_file: Path | None = None
    """File whose first line is the password."""
    mqtt_ca: Path | None = None
    """CA certificates that verify the broker; None for those of the system."""
    mqtt_certificate: Path | None = None
    """Certificate of this server for the broker, with ``mqtt_key``."""
    mqtt_key: Path | None = None
    opcua: Path | None = None
    """File that says which nodes of an OPC UA server are channels."""
    alerts: Path | None = None
    """Alerts file; without it no alerts are sent."""
    tls_certificate: Path | None = None
    """Certificate for HTTPS without a proxy, with ``tls_key``."""
    tls_key: Path | None = None
    behind_proxy: bool = False
    """Whether a reverse proxy terminates TLS and forwards the client's address."""
    trusted_proxies: tuple[Annotated[str, AfterValidator(_network)], ...] = LOOPBACK
    """Addresses and networks of proxies whose forwarded headers are trusted."""
    trusted_header: str | None = None
    """Header with the user that the proxy has authenticated, as OIDC proxies send."""
    oidc_issuer: str | None = None
    """URL of the OpenID provider (issuer) for logging in."""
    oidc_client: str | None = None
    """Client identifier of this server at the provider."""
    oidc_secret: SecretStr | None = None
    """Client secret, only from the environment; None if the provider requires PKCE only."""
    oidc_secret_file: Path | None = None
    """File whose first line is the client secret."""
    oidc_claim: str = "sub"
    """Claim of the provider used as the user name here; users must not be able to change it."""
    public_url: str | None = None
    """Address at which browsers find this server, such as ``https://twin.example.org``."""
    password_days: float | None = Field(default=None, gt=0.0)
    """Days after which a password must be replaced by another one; None for never."""
    raw_days: float | None = None
    """Days for which samples of observed records are stored, 0 without limit; None keeps the store's
    policy."""
    observation_days: float | None = Field(default=None, ge=0.0)
    """The same for observations of records; the sums of their days remain, and can no longer be repeated."""
    job_days: float | None = Field(default=None, ge=0.0)
    """The same for finished jobs."""
    audit_days: float | None = Field(default=None, ge=0.0)
    """The same for the audit log."""
    slow_query_s: float = Field(default=1.0, gt=0.0)
    """Duration from which a query of the database is counted and logged."""
    upload_limit_bytes: int = 512 * 2**20
    """Largest size of an uploaded file."""
    samples_limit: int = 200_000_000
    """Largest number of samples of a file, over all channels."""
    parse_limit_s: float = 120.0
    """Time limit for reading a file or evaluating a twin."""
    freedoms_limit: int = 10_000
    """Largest number of degrees of freedom of a twin; with 6,200 each worker needs 3 s of CPU time to load
    it."""
    observe_limit_s: float = 600.0
    """Time limit for observing a record."""
    study_limit_s: float = 3600.0
    """The same for estimating what all records of a turbine say: two minutes of CPU time, which on a loaded
    machine take many times as long."""
    worker_memory_bytes: int = 3 * 2**30
    """Memory limit of one worker, for reading a file and for observing; a worker above it is ended."""

    @property
    def database_url(self) -> str:
        """URL of the given database or of the store's own."""
        return self.database or sqlite_url(self.store)

    @property
    def loopback(self) -> bool:
        """Whether only this machine can reach the server."""
        return is_loopback(self.host)

    @property
    def secure(self) -> bool:
        """Whether requests of browsers are encrypted."""
        return self.tls_certificate is not None or self.behind_proxy

    def trusts(self, host: str) -> bool:
        """Whether the other end of a connection is a trusted proxy."""
        try:
            peer = ipaddress.ip_address(host)
        except ValueError:
            return False
        return self.behind_proxy and any(peer in ipaddress.ip_network(net) for net in self.trusted_proxies)

    @property
    def spool(self) -> Path:
        """Folder of files being imported."""
        return self.store / "spool"

    @property
    def inbox(self) -> Path:
        """Folder with a subfolder for the files of each asset."""
        return self.store / "inbox"

    @property
    def alerts_folder(self) -> Path:
        """Folder in which what the alerts file names is looked for."""
        return self.store if self.alerts is None else self.alerts.parent

    @property
    def models(self) -> Path:
        """Folder with the extracted files of twins for workers."""
        return self.store / "models"


def read_settings(**given: Any) -> ServiceSettings:
    """Return the given settings, completed from the environment.

    Raises
    ------
    InputError
        If one is not valid.
    """
    try:
        return ServiceSettings(**given)
    except ValidationError as error:
        first = error.errors()[0]
        name = ".".join(map(str, first["loc"]))
        raise InputError(
            first["msg"], field=name, value=first["input"], remedy=f"see JACKETTWIN_SERVE_{name.upper()}"
        ) from None


def checked_url(url: str, field: str) -> str:
    """Return an address after checking that requests to it are protected.

    Raises
    ------
    InputError
        If it is neither https nor of this machine.
    """
    parts = urlsplit(url)
    safe = parts.scheme == "https" or (parts.scheme == "http" and is_loopback(parts.hostname or ""))
    require(
        safe and bool(parts.hostname) and not parts.query and not parts.fragment and "@" not in parts.netloc,
        "requests to this address would not be encrypted",
        field=field,
        value=url,
        allowed="https://HOST…, or http:// of this machine",
    )
    return url


def is_loopback(host: str) -> bool:
    """Return whether a host name or address is a loopback one."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def refuse_exposed(settings: ServiceSettings, users: bool) -> None:
    """Raise an error if others could reach the server without users or TLS.

    Raises
    ------
    InputError
        If the host is not loopback, or there is a proxy, and no user is defined or there is no TLS by the
        server or the proxy.
    """
    require(
        (settings.loopback and not settings.behind_proxy) or users,
        "others can reach this address, and no user is defined",
        field="host",
        value=settings.host,
        allowed="127.0.0.1 without a proxy, or users",
        remedy="define one: jackettwin user add NAME --role admin --store STORE",
    )
    require(
        settings.loopback or settings.secure,
        "others can reach this address, and passwords would travel unencrypted",
        field="host",
        value=settings.host,
        allowed="127.0.0.1, or TLS",
        remedy="give --tls-certificate and --tls-key, or --behind-proxy if a proxy terminates TLS",
    )
