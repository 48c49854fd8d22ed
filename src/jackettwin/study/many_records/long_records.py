"""Division of long records into ten-minute records, each in its own file."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path

from jackettwin.errors import InputError
from jackettwin.records import FileDefaults, read_record_pieces, write_record

PIECE_S = 600.0
"""Length of a piece [s], over which conditions are about steady; turbine loggers use the same length."""
LONG = 6
"""Number of pieces (one hour) above which a record is divided."""
WORTH_A_LOOK_BYTES = 500_000
"""Size below which no file can hold more than an hour of vibrations."""


def without_long(
    files: Sequence[Path],
    folder: Path,
    defaults: FileDefaults,
    step: Callable[[str], None] = lambda _: None,
) -> tuple[Path, ...]:
    """Return the files, each long one replaced by its pieces, which are written into ``folder``.

    A file that cannot be read stays in the list, after any pieces before its fault, and is refused later.
    """
    return tuple(chain.from_iterable(_cut(file, folder, defaults, step) for file in files))


def _cut(file: Path, folder: Path, defaults: FileDefaults, step: Callable[[str], None]) -> Iterator[Path]:
    if not file.is_file() or file.stat().st_size < WORTH_A_LOOK_BYTES:
        yield file
        return
    try:
        pieces = read_record_pieces(file, PIECE_S, defaults)
        first = list(islice(pieces, LONG + 1))
        if len(first) <= LONG:
            yield file
            return
        step(f"divide {file.name} into pieces of {PIECE_S:g} s")
        for piece in chain(first, pieces):
            path = folder / f"{piece.name}.parquet"
            write_record(piece, path)
            yield path
    except InputError:
        yield file
