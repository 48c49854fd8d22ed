"""Stores as released versions left them: a turbine with two records, an alarm, users, a token."""

import gzip
import json
import sqlite3
import tempfile
from contextlib import closing
from functools import cache
from pathlib import Path

from jackettwin.service.workers.engine import load_twin
from jackettwin.store import assets

_STORES = Path(__file__).with_name("stores")


def schemas() -> list[str]:
    """Return the schemas of which a store is kept."""
    return sorted(path.name.split(".")[0].removeprefix("schema_") for path in _STORES.glob("*.sqlite.gz"))


@cache
def _content(schema: str) -> bytes:
    """Return the database of a store, with today's identity of its model.

    The identity was of the last bits of the model's matrices, which differ from processor to processor. No
    released version had it so, and such stores are observed anew.
    """
    content = gzip.decompress((_STORES / f"schema_{schema}.sqlite.gz").read_bytes())
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.deserialize(content)
        (bundle,) = connection.execute("select bundle from versions").fetchone()
        (document,) = connection.execute("select document from observations").fetchone()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "twin"
        assets.lay_out(bundle, place)
        today = load_twin(place).model.model_hash
    return content.replace(json.loads(document)["model_hash"].encode(), today.encode())


def lay_out(schema: str, store: Path) -> Path:
    """Write the database of a store into a folder, as it was; return the store."""
    store.mkdir(mode=0o700)
    (store / "jackettwin.sqlite").write_bytes(_content(schema))
    return store


def documents(schema: str) -> list[str]:
    """Return the observations of a store as text, as that version wrote them."""
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.deserialize(_content(schema))
        found = connection.execute("select document from observations order by record_id").fetchall()
        return [bytes(document).decode() if schema > "0100" else document for (document,) in found]
