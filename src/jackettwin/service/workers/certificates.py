"""Mutual authentication of the server, its scheduler and its workers by a private certificate."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

from distributed import Security

from jackettwin.errors import InputError, require
from jackettwin.service.settings import ServiceSettings

_VALID = datetime(2000, 1, 1, tzinfo=UTC), datetime(2100, 1, 1, tzinfo=UTC)
"""Validity of the certificate, which only lives as long as its process: servers run for years, and clocks may
be set back."""


def own_security() -> Security:
    """Return the security of a local cluster: a new certificate and key, only in memory.

    Dask's own expires after a year, and is not valid if the clock is set back.
    """
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes
    from cryptography.hazmat.primitives.asymmetric import ec
    from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat

    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "jackettwin")])
    unsigned = x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number(), *_VALID)
    certificate = unsigned.sign(key, hashes.SHA256()).public_bytes(Encoding.PEM).decode()
    secret = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()).decode()
    return _security(certificate, certificate, secret)


def given_security(settings: ServiceSettings) -> Security:
    """Return the security of this server as a client of an external scheduler.

    Raises
    ------
    InputError
        If the address does not use TLS, or a certificate is missing, since anyone who can connect to a Dask
        scheduler can run programs on its workers.
    """
    require(
        str(settings.scheduler).startswith("tls://"),
        "anyone who can connect to a scheduler without TLS can run programs on its workers",
        field="scheduler",
        value=settings.scheduler,
        allowed="tls://HOST:PORT",
        remedy="start it with --protocol tls and certificates; see docs/reference/service.md",
    )
    paths = {name: getattr(settings, f"scheduler_{name}") for name in ("ca", "certificate", "key")}
    for name, path in paths.items():
        require(
            path is not None,
            "the connection to a scheduler needs certificates of both sides",
            field=f"scheduler-{name}",
            remedy="give --scheduler-ca, --scheduler-certificate and --scheduler-key",
        )
        if not Path(path).is_file():
            raise InputError("no such file", file=path, field=f"scheduler-{name}")
    return _security(*(str(path) for path in paths.values()))


def _security(ca: str, certificate: str, key: str) -> Security:
    roles = ("client", "scheduler", "worker")
    own = {
        f"tls_{role}_{part}": value for role in roles for part, value in (("cert", certificate), ("key", key))
    }
    return Security(require_encryption=True, tls_ca_file=ca, **own)
