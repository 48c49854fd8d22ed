"""One database of each kind: SQLite in a file, PostgreSQL of Debian's packages if it is installed."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import Engine

from jackettwin.store import open_database


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Engine]:
    if request.param == "sqlite":
        url = f"sqlite:///{tmp_path / 'twin.sqlite'}"
    else:
        url = fresh(request.getfixturevalue("postgresql_url"))
    engine = open_database(url)
    yield engine
    engine.dispose()


def fresh(url: str) -> str:
    """Return the URL of a new database on the same server."""
    import secrets

    from sqlalchemy import create_engine, make_url, text

    name = f"t{secrets.token_hex(4)}"
    engine = create_engine(url, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.execute(text(f"create database {name}"))
    engine.dispose()
    return make_url(url).set(database=name).render_as_string(hide_password=False)
