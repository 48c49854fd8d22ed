"""Credentials of a server: secrets in files, and certificates."""

from __future__ import annotations

import ssl
from pathlib import Path

from pydantic import SecretStr

from jackettwin.errors import InputError, require
from jackettwin.files import read_text


def secret_of(file: Path | None, given: SecretStr | None, *, what: str) -> str:
    """Return the first line of a secret's file, otherwise the secret from the environment, otherwise "".

    Raises
    ------
    InputError
        If the file cannot be read; ``what`` names it.
    """
    if file is not None:
        return read_text(file, what=what).partition("\n")[0].rstrip("\r")
    return "" if given is None else given.get_secret_value()


def secret_in(folder: Path, file: Path | None, field: str) -> str | None:
    """Return the first line of a file with a secret; None without a file.

    A relative path starts at ``folder``.

    Raises
    ------
    InputError
        If it cannot be read, or is empty; ``field`` names it.
    """
    if file is None:
        return None
    try:
        found = secret_of(folder / file, None, what="file with a secret").strip()
    except InputError as error:
        raise error.at(field=field) from None
    require(
        found,
        "the file with the secret is empty",
        field=field,
        value=str(file),
        remedy="write the secret in its first line",
    )
    return found


def tls_context(
    ca: Path | None, certificate: Path | None = None, key: Path | None = None, *, option: str = ""
) -> ssl.SSLContext:
    """Return the TLS context of a connection.

    Parameters
    ----------
    ca : CA certificates that verify the other side; None for those of the system
    certificate, key : of this server, for the other side
    option : prefix of the names of fields that are options

    Raises
    ------
    InputError
        If a file is not a certificate, or its key does not match.
    """
    file, field = ca, "ca"
    try:
        context = ssl.create_default_context(cafile=ca)
        if certificate is not None:
            file, field = certificate, "certificate"
            context.load_cert_chain(certificate, key)
    except OSError as error:  # includes SSLError
        reason = error.strerror or str(error)
        problem = f"not a certificate in PEM, or its key does not match ({reason})"
        raise InputError(problem, field=f"{option}{field}", value=str(file)) from None
    return context
