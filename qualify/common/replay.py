"""Servers and workers that replay records which were identified before: a farm on few cores.

All of a server is the product's own, its queue, transactions, days and answers. Only its workers wait
as long as an identification takes, and then return what one found.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import uvicorn

from jackettwin.service import ServiceSettings
from jackettwin.service.context import Service
from jackettwin.service.web.app import create_app
from jackettwin.service.work.dispatch import Dispatcher
from jackettwin.service.workers.tasks import Outcome, Task
from jackettwin.store import open_database

STUDY_S = 12.0
"""What a study of a turbine's supports takes."""


class Found(Future):  # type: ignore[type-arg]
    """A future as the dispatcher asks it."""

    @property
    def status(self) -> str:
        """Return whether it is done, in Dask's words."""
        return "finished" if self.done() else "pending"


class Replaying:
    """Workers that wait and return one of some outcomes, with the task's own record and time."""

    restarts, reachable = 0, True

    def __init__(self, workers: int, seconds: float, outcomes: Sequence[Outcome]) -> None:
        self.workers, self._seconds, self._outcomes = workers, seconds, outcomes
        self._arrivals, self._studies = ThreadPoolExecutor(workers), ThreadPoolExecutor(1)

    def submit(self, task: Callable[..., Any], *args: Any, priority: int = 0, study: bool = False) -> Found:
        """Begin to wait."""
        found, pool = Found(), self._studies if study else self._arrivals
        pool.submit(lambda: found.set_result(self._studied(*args) if study else self._observed(*args)))
        return found

    def _studied(self, question: Any) -> Outcome:
        time.sleep(STUDY_S)
        return Outcome(json.dumps({"known": {"status": "replayed", "parameters": {}}}), of=question.of)

    def _observed(self, task: Task) -> Outcome:
        time.sleep(self._seconds)
        number, start = Path(task.waveform).name.split("@")
        like = self._outcomes[int(number, 16) % len(self._outcomes)]
        document = json.loads(like.document or "{}")
        document |= {"record_id": number, "name": number, "start_utc": start}
        return replace(like, document=json.dumps(document))

    def has_begun(self, future: Any, ago_s: float = 0.0) -> bool:
        """Return that a task was begun, and none too long ago."""
        return ago_s == 0.0

    def forsaken(self, future: Any) -> bool:
        """Return that no worker was lost."""
        return False

    def mend(self) -> None:
        """Nothing to mend."""


def main() -> None:
    """Serve until killed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("store", type=Path)
    parser.add_argument("--database", required=True)
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--workers", type=int, required=True)
    parser.add_argument("--seconds", type=float, required=True)
    given = parser.parse_args()
    outcomes = [Outcome(**one) for one in json.loads((given.store / "outcomes.json").read_text())]
    settings = ServiceSettings(store=given.store, database=given.database, port=given.port)
    for place in (settings.spool, settings.models):
        place.mkdir(exist_ok=True)
    cluster: Any = Replaying(given.workers, given.seconds, outcomes)
    service = Service(settings, open_database(settings.database_url), cluster, f"replay-{given.port}")
    dispatcher = Dispatcher(service)
    service.wake, service.turning = dispatcher.wake.set, lambda: dispatcher.turning
    dispatcher.start()
    uvicorn.run(create_app(service), port=given.port, log_level="warning", access_log=False)


if __name__ == "__main__":
    main()
