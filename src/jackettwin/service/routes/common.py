"""What routes share: the service, transactions, and finding what a path names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from fastapi import Depends, Path, Request
from sqlalchemy import Connection

from jackettwin.errors import InputError
from jackettwin.service.auth import Who
from jackettwin.service.context import Service
from jackettwin.service.problems import ApiError
from jackettwin.store import assets, reading, records, writing


def get_service(request: Request) -> Service:
    """Return the server's parts."""
    service: Service = request.app.state.service
    return service


def read_connection(request: Request) -> Iterator[Connection]:
    """Give a connection that only reads."""
    with reading(get_service(request).database) as connection:
        yield connection


def write_connection(request: Request) -> Iterator[Connection]:
    """Give a connection in a transaction, kept if the route succeeds."""
    with writing(get_service(request).database) as connection:
        yield connection


def asker(request: Request) -> Who:
    """Return who sent the request; routes ask for a role before."""
    who: Who = request.state.who
    return who


Parts = Annotated[Service, Depends(get_service)]
Reads = Annotated[Connection, Depends(read_connection)]
Writes = Annotated[Connection, Depends(write_connection, scope="function")]
Asker = Annotated[Who, Depends(asker)]
AssetName = Annotated[str, Path(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$", examples=["demo"])]
RecordId = Annotated[str, Path(pattern=r"^[0-9a-f]{8,64}$", examples=["0123456789abcdef01234567"])]


def known_asset(connection: Connection, name: str) -> assets.Version:
    """Return the adopted version of an asset; answers 404 if there is none."""
    try:
        return assets.found_version(connection, name)
    except InputError as error:
        raise ApiError(404, error.problem, field="asset", value=name) from None


def known_record(connection: Connection, record_id: str) -> records.StoredRecord:
    """Return a record by its number; answers 404 if there is none."""
    found = records.records_with_id(connection, record_id)
    if not found:
        raise ApiError(404, "no such record", field="record_id", value=record_id)
    return found[0]
