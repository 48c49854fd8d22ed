"""Superelement files: ``.npz`` with all data, and OpenFAST's ExtPtfm.

ExtPtfm needs two files: the module's input file, and the matrices' file that it names. OpenFAST does not add
the self-weight of the element; it is contained in the matrices' file.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from jackettwin.errors import InputError, require
from jackettwin.files import atomic_path
from jackettwin.response.superelement.craig_bampton import Superelement
from jackettwin.response.superelement.extptfm_reader import is_extptfm, read_extptfm
from jackettwin.response.superelement.extptfm_writer import DEFAULT, Layout, matrices_text, module_input

FORMATS = (".npz", ".dat")


def write_superelement(element: Superelement, path: Path, *, layout: Layout = DEFAULT) -> tuple[Path, ...]:
    """Write ``.npz``, or ``.dat`` for OpenFAST with ``NAME_ExtPtfm.dat`` beside it; return the files.

    Parameters
    ----------
    layout : {"openfast5", "openfast4", "openfast3"}
        OpenFAST version for which ``.dat`` is written.

    Raises
    ------
    InputError
        If the ending is neither.
    """
    require_format(path)
    if path.suffix.lower() == ".npz":
        with atomic_path(path) as temporary, temporary.open("wb") as stream:
            np.savez_compressed(
                stream,
                M=element.M,
                C=element.C,
                K=element.K,
                T=element.basis,
                reference_m=np.array(element.reference_m),
                weight_n=element.weight_n,
                n_damped=element.n_damped,
            )
        return (path,)
    module = path.with_name(f"{path.stem}_ExtPtfm.dat")
    for target, text in (
        (path, matrices_text(element, layout=layout)),
        (module, module_input(element, path.name, layout=layout)),
    ):
        with atomic_path(target) as temporary:
            temporary.write_text(text, encoding="ascii")
    return (path, module)


def require_format(path: Path) -> None:
    """Raise an error for endings other than ``.npz`` and ``.dat``.

    Raises
    ------
    InputError
        If the ending is another one.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(
            "unknown format of a superelement",
            field="--out",
            value=path.name,
            allowed=", ".join(FORMATS),
            remedy="give the file one of these endings",
        )


def is_superelement(path: Path) -> bool:
    """Return whether a file is a superelement: ``.npz``, or a file of ExtPtfm."""
    if path.suffix.lower() != ".dat":
        return path.suffix.lower() == ".npz"
    return path.is_file() and is_extptfm(path)


def read_superelement(path: Path) -> Superelement:
    """Read a superelement, or the one named by ExtPtfm's input file (without shapes and reference point).

    Raises
    ------
    InputError
        If the file is missing or incomplete.
    """
    require_format(path)
    if path.suffix.lower() == ".dat":
        return read_extptfm(path)
    require(path.is_file(), "no such superelement file", file=path)
    try:
        with np.load(path, allow_pickle=False) as data:
            x, y, z = (float(v) for v in data["reference_m"])
            return Superelement(
                data["M"], data["C"], data["K"], (x, y, z), data["weight_n"], data["T"], int(data["n_damped"])
            )
    except (ValueError, KeyError, OSError) as error:
        raise InputError(
            f"not a superelement: {error}", file=path, remedy="write it with jackettwin"
        ) from None
