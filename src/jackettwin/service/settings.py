"""How a server runs: what ``jackettwin serve`` is told, and the limits that an environment may set."""

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
    """Where a server listens, works and keeps things.

    What is not given is read from the environment: ``JACKETTWIN_SERVE_PARSE_LIMIT_S`` and the like. A shorter
    prefix would meet what Kubernetes sets for a service of our name (``JACKETTWIN_PORT``).
    """

    model_config = SettingsConfigDict(
        env_prefix="JACKETTWIN_SERVE_", env_ignore_empty=True, frozen=True, use_attribute_docstrings=True
    )

    store: Path
    """Folder of waveforms, spool and, without ``database``, of the database."""
    host: str = "127.0.0.1"
    """Address to listen at."""
    port: int = Field(default=8470, ge=1, le=65535)
    database: str | None = None
    """URL of PostgreSQL; None for SQLite in the store."""
    scheduler: str | None = None
    """``tls://`` address of a Dask scheduler whose workers see the store at this path; None for own ones."""
    scheduler_ca: Path | None = None
    """Certificates by which that scheduler is known."""
    scheduler_certificate: Path | None = None
    """By which it knows us, with ``scheduler_key``."""
    scheduler_key: Path | None = None
    workers: int = Field(default=2, ge=1)
    """Number of own workers, one thread each."""
    mqtt: str | None = None
    """``mqtt[s]://[user@]host[:port]`` of a broker to listen to; its ports are 1883 and 8883."""
    mqtt_password: SecretStr | None = None
    """Of the broker's user; from the environment alone, since every user of a machine reads its commands."""
    mqtt_password_file: Path | None = None
    """File whose first line is that password."""
    mqtt_ca: Path | None = None
    """Certificates by which the broker is known; None for those the system trusts."""
    mqtt_certificate: Path | None = None
    """By which the broker knows us, with ``mqtt_key``."""
    mqtt_key: Path | None = None
    alerts: Path | None = None
    """File that says who is told what, and how; without it nobody is."""
    tls_certificate: Path | None = None
    """For HTTPS without a proxy, with ``tls_key``."""
    tls_key: Path | None = None
    behind_proxy: bool = False
    """Whether a proxy in front ends TLS and passes on who asked."""
    trusted_proxies: tuple[Annotated[str, AfterValidator(_network)], ...] = LOOPBACK
    """Addresses and networks of the proxies whose word on who asks is taken; nobody else's is."""
    trusted_header: str | None = None
    """Header in which the proxy names the user it has authenticated, as OIDC proxies do."""
    oidc_issuer: str | None = None
    """Address of the OpenID provider at which people may log in, as it names itself."""
    oidc_client: str | None = None
    """Name by which it knows this server."""
    oidc_secret: SecretStr | None = None
    """By which it knows that it is us, from the environment alone; None if it asks for PKCE only."""
    oidc_secret_file: Path | None = None
    """File whose first line is that secret."""
    oidc_claim: str = "sub"
    """What the provider says of somebody that is the user's name here; nobody may change it there himself."""
    public_url: str | None = None
    """Address at which browsers find this server, such as ``https://twin.example.org``."""
    password_days: float | None = Field(default=None, gt=0.0)
    """Days after which a password must be replaced by another one; None for never."""
    raw_days: float | None = None
    """Days for which the samples of observed records are kept, 0 for ever; None leaves the store's policy."""
    observation_days: float | None = Field(default=None, ge=0.0)
    """The same for what each record said; its day stays, and is not summed anew after that."""
    job_days: float | None = Field(default=None, ge=0.0)
    """The same for work that has ended."""
    audit_days: float | None = Field(default=None, ge=0.0)
    """The same for the audit log."""
    slow_query_s: float = Field(default=1.0, gt=0.0)
    """Time from which on a query of the database is counted, and told to the log."""
    upload_limit_bytes: int = 512 * 2**20
    """Largest file that is taken."""
    samples_limit: int = 200_000_000
    """Most samples, over all channels, that a file may expand to."""
    parse_limit_s: float = 120.0
    """Time after which reading a file, or evaluating a twin, is given up."""
    freedoms_limit: int = 10_000
    """Most freedoms of a twin's structure: at 6,200 every worker takes three CPU seconds to load it."""
    observe_limit_s: float = 600.0
    """Time after which observing a record is given up."""
    worker_memory_bytes: int = 3 * 2**30
    """Memory of one worker: no file may expand beyond it; a worker that observes beyond it is ended."""

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

    def trusts(self, host: str) -> bool:
        """Whether a proxy is at the other end of a connection, and its word is taken."""
        try:
            peer = ipaddress.ip_address(host)
        except ValueError:
            return False
        return self.behind_proxy and any(peer in ipaddress.ip_network(net) for net in self.trusted_proxies)

    @property
    def spool(self) -> Path:
        """Folder of files on their way in."""
        return self.store / "spool"

    @property
    def inbox(self) -> Path:
        """Folder with a folder of every asset, into which its files may be dropped."""
        return self.store / "inbox"

    @property
    def alerts_folder(self) -> Path:
        """Folder in which what the alerts file names is looked for."""
        return self.store if self.alerts is None else self.alerts.parent

    @property
    def models(self) -> Path:
        """Folder in which the twins' files are laid out for workers."""
        return self.store / "models"


def read_settings(**given: Any) -> ServiceSettings:
    """Return the settings that are given, completed by the environment.

    Raises
    ------
    InputError
        If one is not what it must be.
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
    """Return an address, if what is sent there can be read by nobody else.

    Raises
    ------
    InputError
        If it is neither of https nor of this machine.
    """
    parts = urlsplit(url)
    safe = parts.scheme == "https" or (parts.scheme == "http" and is_loopback(parts.hostname or ""))
    require(
        safe and bool(parts.hostname) and not parts.query and not parts.fragment and "@" not in parts.netloc,
        "what is sent there could be read on its way",
        field=field,
        value=url,
        allowed="https://HOST…, or http:// of this machine",
    )
    return url


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
        If the host is not loopback, or a proxy passes others on, and there are no users; or if there is no
        TLS of our own or of a proxy.
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
        remedy="give --tls-certificate and --tls-key, or --behind-proxy if a proxy ends TLS",
    )
