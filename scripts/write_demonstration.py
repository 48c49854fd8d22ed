"""Write the demonstration asset as it is shipped: days told, all records but the last observed, all judged.

Minutes of one core. Run it when the model, the story or the form of what is stored changes;
`tests/service/test_story.py` says when.
"""

from __future__ import annotations

import gzip
import sys
import tempfile
from datetime import UTC, datetime, time
from pathlib import Path
from typing import Any, cast

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.service.conftest import Here

from jackettwin.report import without_library
from jackettwin.service import ServiceSettings
from jackettwin.service.context import Service
from jackettwin.service.demonstration import ASSET, SHIPPED, arrive, shipped_records, tell_story
from jackettwin.service.story import UNTIL
from jackettwin.service.work.dispatch import Dispatcher
from jackettwin.store import asset_copy, open_database, reading, work


def without_what_is_large(rows: asset_copy.Rows) -> asset_copy.Rows:
    """Return rows without the state of judging, which a server makes with the next record.

    The report is plain and without the program that draws its plots, which every installation has. The
    estimate from all records is said to be another program's, so that it is due.
    """
    (knowledge,) = rows["knowledge"]
    document = {name: value for name, value in knowledge["document"].items() if name != "judged"}
    document["together"] = {**document["together"], "code_version": "shipped"}
    report = without_library(gzip.decompress(knowledge["report"]).decode()).encode()
    return {**rows, "knowledge": [{**knowledge, "document": document, "report": report}]}


def main() -> None:
    """Make the asset in a store of its own, with all work done in this process, and write it."""
    with tempfile.TemporaryDirectory() as folder:
        settings = ServiceSettings(store=Path(folder))
        for place in (settings.spool, settings.models, settings.inbox):
            place.mkdir()
        database = open_database(settings.database_url)
        now = datetime.combine(UNTIL, time(18), UTC)
        service = Service(settings, database, cast(Any, Here()), "demonstration", now=lambda: now)
        tell_story(service)
        for record in list(shipped_records())[:-1]:
            arrive(service, record)
        dispatcher, left = Dispatcher(service), 1
        while left:
            dispatcher._turn()
            with reading(database) as connection:
                sizes = work.queue_sizes(connection)
            left = sizes.get("queued", 0) + sizes.get("leased", 0)
            print(sizes, file=sys.stderr, flush=True)
        with reading(database) as connection:
            rows = asset_copy.copy_out(connection, ASSET)
        SHIPPED.write_bytes(asset_copy.write_copy(without_what_is_large(rows)))
        print(f"{SHIPPED}: {SHIPPED.stat().st_size} bytes")


if __name__ == "__main__":
    main()
