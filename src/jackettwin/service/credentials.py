"""What a server is known by and knows others by: secrets of files, certificates."""

from __future__ import annotations

import ssl
from pathlib import Path

from pydantic import SecretStr

from jackettwin.errors import InputError, require
from jackettwin.files import read_text


def secret_of(file: Path | None, given: SecretStr | None, *, what: str) -> str:
    """Return the first line of a secret's file, else what the environment gave, else nothing.

    Raises
    ------
    InputError
        If the file cannot be read; ``what`` names it.
    """
    if file is not None:
        return read_text(file, what=what).partition("\n")[0].rstrip("\r")
    return "" if given is None else given.get_secret_value()


def secret_in(folder: Path, file: Path | None, field: str) -> str | None:
    """Return the first line of a file of a secret; None without one.

    A path that is not absolute is one in ``folder``.

    Raises
    ------
    InputError
        If it cannot be read, or is empty; ``field`` names it.
    """
    if file is None:
        return None
    try:
        found = secret_of(folder / file, None, what="file of a secret").strip()
    except InputError as error:
        raise error.at(field=field) from None
    require(
        found,
        "the file of a secret is empty",
        field=field,
        value=str(file),
        remedy="put it into its first line",
    )
    return found


def tls_context(
    ca: Path | None, certificate: Path | None = None, key: Path | None = None, *, option: str = ""
) -> ssl.SSLContext:
    """Return how the other side of a connection is known, and we to it.

    Parameters
    ----------
    ca : certificates by which it is known; None for those that the system trusts
    certificate, key : by which it knows us
    option : what the names of the fields begin with where they are options

    Raises
    ------
    InputError
        If a file is no certificate, or its key does not fit.
    """
    file, field = ca, "ca"
    try:
        context = ssl.create_default_context(cafile=ca)
        if certificate is not None:
            file, field = certificate, "certificate"
            context.load_cert_chain(certificate, key)
    except OSError as error:  # an SSLError is one
        reason = error.strerror or str(error)
        problem = f"not a certificate in PEM, or its key does not fit ({reason})"
        raise InputError(problem, field=f"{option}{field}", value=str(file)) from None
    return context
