"""One table of formats: file extension → reader and writer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from jackettwin.errors import InputError, JackettwinError, did_you_mean
from jackettwin.files import atomic_path
from jackettwin.plugins import plugins_of_type
from jackettwin.records.readers import arrays, delimited, hdf5, matlab, openfast, parquet, tdms, uff
from jackettwin.records.readers.channels import FileDefaults
from jackettwin.records.readers.description import Description, description_text, read_description
from jackettwin.records.readers.table import ReadTable, to_record
from jackettwin.records.record import Record

SHARED_DESCRIPTION = "records.json"
"""Describes every record of its folder that has no JSON of its own."""


@dataclass(frozen=True)
class Format:
    """A file format: how it is called, read and, if we write it, written.

    ``json_beside`` says that the description does not fit inside the file; ``pieces`` reads it in tables of
    some ten thousand rows.
    """

    name: str
    extensions: tuple[str, ...]
    read: Callable[[Path], ReadTable]
    write: Callable[[Record, Path], None] | None = None
    json_beside: bool = True
    pieces: Callable[[Path], Iterator[ReadTable]] | None = None


FORMATS = (
    Format("Parquet", (".parquet", ".pq"), parquet.read, parquet.write, pieces=parquet.pieces),
    Format(
        "delimited text",
        (".csv", ".txt", ".tsv", ".asc"),
        delimited.read,
        delimited.write,
        pieces=delimited.pieces,
    ),
    Format("NumPy archive", (".npz",), arrays.read, arrays.write, json_beside=False),
    Format("NumPy array", (".npy",), arrays.read_single),
    Format("HDF5", (".h5", ".hdf5"), hdf5.read, hdf5.write, json_beside=False, pieces=hdf5.pieces),
    Format("MATLAB", (".mat",), matlab.read, matlab.write, json_beside=False),
    Format("universal file", (".uff", ".unv"), uff.read, uff.write),
    Format("TDMS", (".tdms",), tdms.read),
    Format("OpenFAST text output", (".out",), openfast.read_text),
    Format("OpenFAST binary output", (".outb",), openfast.read_binary),
)


PLUGINS = "jackettwin.readers"
"""Group of entry points, each a :class:`Format`: readers that other packages bring."""


@cache
def formats() -> tuple[Format, ...]:
    """Return every format: ours, then those that installed packages bring."""
    return (*FORMATS, *plugins_of_type(PLUGINS, Format).values())


def read_record(path: Path | str, defaults: FileDefaults | None = None) -> Record:
    """Read a record in any known format, with the JSON that describes it if there is one.

    That is ``NAME.json`` beside it, else ``records.json`` in its folder, for all records there. The JSON
    chooses and describes channels and wins over what the file says of them; a contradiction in the sample
    rate is an error. Numbers are brought to SI units; what is not a
    finite number, or is beyond 1e15, becomes a missing sample (NaN).

    Parameters
    ----------
    defaults : FileDefaults, optional
        Rate and unit, for a file that does not say them.

    Raises
    ------
    InputError
        Names the file, the field, the value, what is allowed and what to do.
    """
    path = Path(path)
    described = described_by(path)
    with reading(path):
        return to_record(_format_of(path).read(path), described, path, defaults)


def read_table(path: Path) -> ReadTable:
    """Return the columns of a file in its own units, without the JSON that may lie beside it.

    Raises
    ------
    InputError
        If the file cannot be opened, is of no known format or is damaged.
    """
    described_by(path)
    with reading(path):
        return _format_of(path).read(path)


def tables_of(path: Path) -> Iterator[ReadTable]:
    """Yield a file in tables of some ten thousand rows, where the format allows it; else in one."""
    form = _format_of(path)
    if form.pieces is None:
        yield form.read(path)
    else:
        yield from form.pieces(path)


def described_by(path: Path) -> Description | None:
    """Return what the JSON beside a record says, None without one.

    Raises
    ------
    InputError
        If the record cannot be opened or is of no known format, or the JSON is wrong.
    """
    _format_of(path)
    _refuse_unreadable(path)
    beside = description_file(path)
    return read_description(beside) if beside is not None else None


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Name the file in every error raised inside; what a parser raises is an error of the file."""
    try:
        yield
    except InputError as error:
        raise error.at(file=path) from error.__cause__
    except (JackettwinError, MemoryError, GeneratorExit):
        raise
    except Exception as error:  # what parsers raise on damaged bytes is not theirs to promise
        said = str(error).replace(str(path), path.name)  # where it lies may be nobody's business
        raise InputError(
            f"is not readable as {_format_of(path).name} ({type(error).__name__}: {said[:120]})",
            file=path,
            remedy="the file is damaged or not of this format",
        ) from error


def description_file(path: Path) -> Path | None:
    """Return the JSON that describes a record: its own, else that of its folder, else None."""
    for beside in (path.with_suffix(".json"), path.with_name(SHARED_DESCRIPTION)):
        if beside.is_file():
            return beside
    return None


def record_files(sources: Sequence[str | Path]) -> tuple[Path, ...]:
    """Return the files meant by paths of records and of folders of records, folders in the order of names.

    Raises
    ------
    InputError
        If a path does not exist or a folder holds no record.
    """
    known = {extension for form in formats() for extension in form.extensions}
    files: list[Path] = []
    for source in map(Path, sources):
        if not source.is_dir():
            files.append(source)
            continue
        shown = (p for p in source.iterdir() if p.is_file() and not p.name.startswith("."))
        inside = sorted(p for p in shown if p.suffix.lower() in known)
        if not inside:
            raise InputError(
                "folder holds no record",
                file=source,
                allowed=", ".join(sorted(known)),
                remedy="give the folder that holds the files, or the files",
            )
        files += inside
    if len(files) > 1:
        for file in files:
            if not file.exists():
                raise InputError("no such file", file=file, remedy="check the path")
    return tuple(files)


def write_record(record: Record, path: Path | str) -> None:
    """Write a record, whole or not at all, with ``NAME.json`` beside it where the format needs it.

    Raises
    ------
    InputError
        If the extension is not one we write.
    """
    path = Path(path)
    form = _format_of(path)
    if form.write is None:
        raise InputError(
            f"{form.name} is read, not written",
            file=path,
            allowed=", ".join(e for f in formats() if f.write for e in f.extensions),
            remedy="use .parquet",
        )
    with atomic_path(path) as temporary:
        form.write(record, temporary)
        if form.json_beside:
            with atomic_path(path.with_suffix(".json")) as beside:
                beside.write_text(description_text(record), encoding="utf-8")


def _format_of(path: Path) -> Format:
    extension = path.suffix.lower()
    for form in FORMATS:  # first, because looking for plugins takes a tenth of a second
        if extension in form.extensions:
            return form
    known = [e for form in formats() for e in form.extensions]
    if extension not in known:
        remedy = "give the data file, not its description" if extension == ".json" else "convert the file"
        raise InputError(
            "unknown record format",
            file=path,
            field="extension",
            value=extension,
            allowed=", ".join(known),
            remedy=did_you_mean(extension, known) or remedy,
        )
    return next(form for form in formats() if extension in form.extensions)


def _refuse_unreadable(path: Path) -> None:
    problem = None
    try:
        if not path.exists():
            problem = "no such file"
        elif not path.is_file():
            problem = "is not a file"
        elif path.stat().st_size == 0:
            problem = "is empty"
    except (OSError, ValueError) as error:
        problem = f"cannot be opened ({error})"
    if problem == "is empty":
        raise InputError(problem, file=path, remedy="export the record again, or leave the file out")
    if problem:
        beside = path.parent.glob(f"*{path.suffix}") if path.parent.is_dir() else ()
        near = [p.name for p in beside if p.name != path.name]
        raise InputError(problem, file=path, remedy=did_you_mean(path.name, near) or "check the path")
