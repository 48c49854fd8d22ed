"""Find a file by path or by the name under which it comes with the package."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from jackettwin.errors import InputError, did_you_mean


def shipped(kind: str) -> tuple[str, ...]:
    """Return the names in a folder of ``jackettwin.data`` (``structures``, ``twins``)."""
    return tuple(sorted(path.stem for path in _folder(kind).glob("*.yaml")))


def find_file(source: str | Path, kind: str, *, folder: Path | None = None, also: str = "") -> Path:
    """Return the path of a shipped name, or of a file relative to ``folder``.

    Parameters
    ----------
    kind : str
        A folder of ``jackettwin.data``, in the plural.
    also : str
        Other kinds of files that will do, for the message.

    Raises
    ------
    InputError
        If the source has no suffix and is neither a shipped name nor a file.
    """
    names = shipped(kind)
    if str(source) in names:
        return _folder(kind) / f"{source}.yaml"
    path = Path(source) if folder is None else folder / source
    if path.suffix == "" and not _exists(path):
        what = kind.removesuffix("s")
        raise InputError(
            f"no such {what}",
            field=what,
            value=str(source),
            allowed=f"{', '.join(names)}, or a .yaml file{also}",
            remedy=did_you_mean(str(source), names) or "take one of these, or give the path of a file",
        )
    return path


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):  # no name that a file can have
        return False


def _folder(kind: str) -> Path:
    return Path(str(resources.files("jackettwin") / "data" / kind))
