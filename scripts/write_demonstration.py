"""Work out what the demonstration's two years lead to, and write it where the package ships it.

To be run when the story, the judgement of days or the posterior changed: about a minute.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import jackettwin.data
from jackettwin.service import ServiceSettings
from jackettwin.service.context import OpenStore
from jackettwin.service.demonstration import ASSET, SHIPPED, shipped, tell_story
from jackettwin.service.work.consequences import question_of
from jackettwin.service.workers.tasks import know
from jackettwin.store import assets, open_database, reading


def main(path: Path) -> None:
    """Tell the story to a store of its own, and ask what it leads to."""
    path.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        settings = ServiceSettings(store=Path(folder))
        for place in (settings.spool, settings.models):
            place.mkdir(parents=True, exist_ok=True)
        place = OpenStore(settings, open_database(settings.database_url))
        print("telling the story …", file=sys.stderr)
        tell_story(place)
        with reading(place.database) as connection:
            version = assets.found_version(connection, ASSET)
            job = SimpleNamespace(asset=ASSET, version=version.version, model_hash=version.model_hash)
            question = question_of(connection, place, cast(Any, job), every_day=True)
        print("judging its days, sampling the posterior …", file=sys.stderr)
        outcome = know(question)
        assert outcome is not None
        path.write_bytes(shipped(outcome))
        place.database.dispose()


if __name__ == "__main__":
    main(Path(jackettwin.data.__file__).parent / SHIPPED)
