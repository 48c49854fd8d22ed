"""Events become visible in the order of their numbers, on both databases."""

import threading
from datetime import UTC, datetime

from sqlalchemy import Engine

from jackettwin.store.journal import events_after, tell

NOW = datetime(2026, 1, 1, tzinfo=UTC)


def test_a_reader_who_goes_on_from_the_last_number_misses_no_event(database: Engine) -> None:
    """A second event waits for the transaction of the first: else its number could be seen before."""
    told = threading.Event()

    def second() -> None:
        with database.begin() as connection:
            tell(connection, "record", "B", {}, NOW)
        told.set()

    other = threading.Thread(target=second)
    with database.begin() as connection:
        tell(connection, "record", "A", {}, NOW)
        other.start()
        assert not told.wait(0.5)
        with database.connect() as reader:
            assert events_after(reader, 0) == []
    other.join(timeout=10.0)
    with database.connect() as reader:
        assert [event.asset for event in events_after(reader, 0)] == ["A", "B"]
