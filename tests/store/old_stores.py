"""Stores as released versions left them: a turbine with two records, an alarm, users, a token."""

import gzip
import sqlite3
from contextlib import closing
from pathlib import Path

_STORES = Path(__file__).with_name("stores")


def schemas() -> list[str]:
    """Return the schemas of which a store is kept."""
    return sorted(path.name.split(".")[0].removeprefix("schema_") for path in _STORES.glob("*.sqlite.gz"))


def lay_out(schema: str, store: Path) -> Path:
    """Write the database of a store into a folder, as it was; return the store."""
    store.mkdir(mode=0o700)
    packed = (_STORES / f"schema_{schema}.sqlite.gz").read_bytes()
    (store / "jackettwin.sqlite").write_bytes(gzip.decompress(packed))
    return store


def documents(schema: str) -> list[str]:
    """Return the observations of a store as text, as that version wrote them."""
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.deserialize(gzip.decompress((_STORES / f"schema_{schema}.sqlite.gz").read_bytes()))
        found = connection.execute("select document from observations order by record_id").fetchall()
        return [document for (document,) in found]
