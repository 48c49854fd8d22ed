"""Long records as the ten-minute records they are made of, each a file of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path

from jackettwin.errors import InputError
from jackettwin.records import Unsaid, read_record_pieces, write_record

PIECE_S = 600.0
"""Length of a piece [s]: what conditions are steady over, and the records of every turbine's logger."""
LONG = 6
"""More pieces than this (an hour) make a record long."""
WORTH_A_LOOK_BYTES = 500_000
"""No smaller file holds more than an hour of vibrations."""


def without_long(
    files: Sequence[Path],
    folder: Path,
    unsaid: Unsaid,
    step: Callable[[str], None] = lambda _: None,
) -> tuple[Path, ...]:
    """Return the files, with the pieces of each long one in its place, written into ``folder``.

    A file that cannot be read is left in its place for others to refuse, behind the pieces before its fault.
    """
    return tuple(chain.from_iterable(_cut(file, folder, unsaid, step) for file in files))


def _cut(file: Path, folder: Path, unsaid: Unsaid, step: Callable[[str], None]) -> Iterator[Path]:
    if not file.is_file() or file.stat().st_size < WORTH_A_LOOK_BYTES:
        yield file
        return
    try:
        pieces = read_record_pieces(file, PIECE_S, unsaid)
        first = list(islice(pieces, LONG + 1))
        if len(first) <= LONG:
            yield file
            return
        step(f"cut {file.name} into pieces of {PIECE_S:g} s")
        for piece in chain(first, pieces):
            path = folder / f"{piece.name}.parquet"
            write_record(piece, path)
            yield path
    except InputError:
        yield file
