"""Superelements as files: ``.npz`` with everything, and OpenFAST's ExtPtfm (FlexASCII).

ExtPtfm (OpenFAST 2.3 to 4) wants two files: the module's input file, and the superelement it names. Loads
come as a table over time: here the self-weight, constant, which OpenFAST does not add by itself.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.files import atomic_path
from jackettwin.response.extptfm import MATRICES, is_extptfm, read_extptfm
from jackettwin.response.superelement import INTERFACE, Superelement

FloatArray = npt.NDArray[np.float64]

FORMATS = (".npz", ".dat")
_FOREVER_S = 1.0e5
"""The constant loads are given at 0 and at this time."""
Layout = Literal["classic", "connections"]
"""Of the module's input file: OpenFAST 2.4's, or with the lines that the hydroelastic super-element (pull
request 3210 of February 2026) put among them."""
_CONNECTIONS: tuple[tuple[tuple[str, ...], ...], ...] = (
    (("False", "RBMode", "Flag for the presence of rigid-body modes (flag)"),),
    (
        ("CONNECTIONS",),
        ("False", "Connections", "Flag for connections (flag)"),
        ('"unused"', "Conn_FileName", "Path containing connections inputs (-)"),
    ),
)


def write_superelement(element: Superelement, path: Path, *, layout: Layout = "classic") -> tuple[Path, ...]:
    """Write ``.npz``, or ``.dat`` for OpenFAST with ``NAME_ExtPtfm.dat`` beside it; return the files.

    Parameters
    ----------
    layout : {"classic", "connections"}
        Lines of the module's input file, which are read by their place, not by their keywords.

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
        (path, flex_ascii(element)),
        (module, module_input(element, path.name, layout=layout)),
    ):
        with atomic_path(target) as temporary:
            temporary.write_text(text, encoding="ascii")
    return (path, module)


def require_format(path: Path) -> None:
    """Refuse endings other than ``.npz`` and ``.dat``.

    Raises
    ------
    InputError
        Names the ending.
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
    """Return whether a file holds a superelement: ``.npz``, or one of ExtPtfm's."""
    if path.suffix.lower() != ".dat":
        return path.suffix.lower() == ".npz"
    return path.is_file() and is_extptfm(path)


def read_superelement(path: Path) -> Superelement:
    """Read a superelement, also by ExtPtfm's input file. ExtPtfm knows no shapes and no reference point.

    Raises
    ------
    InputError
        If the file is missing or incomplete.
    """
    require_format(path)
    if path.suffix.lower() == ".dat":
        return read_extptfm(path)
    if not path.is_file():
        raise InputError("no such superelement file", file=path)
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


def flex_ascii(element: Superelement) -> str:
    """Return the text of a superelement in ExtPtfm's FlexASCII format."""
    n = element.n
    x, y, z = element.reference_m
    lines = [
        f"!{INTERFACE} + {n - INTERFACE} coordinates about the reference point ({x:.6g}, {y:.6g}, {z:.6g}) m",
        "!Flex 5 Format",
        f"!Dimension: {n}",
        f"!Time increment in simulation: {_FOREVER_S:.5f}",
        f"!Total simulation time in file: {_FOREVER_S:.5f}",
    ]
    for name, matrix in (("mass", element.M), ("stiffness", element.K), ("damping", element.C)):
        lines += ["", f"!{MATRICES[name]}", f"!Dimension: {n}", *map(_row, matrix)]
    lines += ["", "!Loading and Wave Elevation (Units (N,m))",
              f"!Dimension: 1 time column - {n} force columns - 1 wave elevation column"]  # fmt: skip
    lines += [_row(np.array([t, *element.weight_n, 0.0])) for t in (0.0, _FOREVER_S)]
    return "\n".join(lines) + "\n"


def _row(values: FloatArray) -> str:
    return " ".join(f"{value:23.15e}" for value in values)


def static_internal(element: Superelement) -> FloatArray:
    """Return the internal coordinates at rest under the self-weight, interface held."""
    i = slice(INTERFACE, None)
    return np.asarray(np.linalg.solve(element.K[i, i], element.weight_n[i]))


def module_input(element: Superelement, name: str, *, layout: Layout = "classic") -> str:
    """Return the text of ExtPtfm's module input file; it starts from static equilibrium."""
    rigid, connections = _CONNECTIONS if layout == "connections" else ((), ())
    rest = static_internal(element)
    start = ", ".join(f"{q:.9e}" for q in rest) if rest.size else "0,"
    inner = element.n - INTERFACE
    channels = ["IntrfFx", "IntrfFy", "IntrfFz", "IntrfMx", "IntrfMy", "IntrfMz"]
    channels += [f"CBQ_{k:03d}" for k in range(1, min(inner, 9) + 1)]
    rows: list[tuple[str, ...]] = [
        ("False", "Echo", "Echo input data to <RootName>.ech (flag)"),
        ('"default"', "DT", 'Communication interval (s) (or "default")'),
        ("1", "IntMethod", "Integration Method {1:RK4; 2:AB4, 3:ABM4} (switch)"),
        ("REDUCTION INPUTS",),
        *rigid,
        ("1", "FileFormat", "File Format {0:Guyan; 1:FlexASCII} (switch)"),
        (f'"{name}"', "Red_FileName", "Path of the file containing Guyan/Craig-Bampton inputs (-)"),
        ('"NA"', "RedCst_FileName", "Path of the file containing constant inputs (-) (unused)"),
        ("-1", "NActiveDOFList", "Number of active CB modes in ActiveDOFList, -1 for all (integer)"),
        ("1,", "ActiveDOFList", "List of CB modes that are active [unused if NActiveDOFList<=0]"),
        (f"{rest.size}", "NInitPosList", "Number of initial positions listed in InitPosList (integer)"),
        (start, "InitPosList", "List of initial positions of the CB modes"),
        ("0", "NInitVelList", "Number of initial velocities listed in InitVelList (integer)"),
        ("0,", "InitVelList", "List of initial velocities of the CB modes"),
        *connections,
        ("OUTPUT",),
        ("True", "SumPrint", "Print summary data to <RootName>.sum (flag)"),
        ("1", "OutFile", "Switch for the output (unused)"),
        ("True", "TabDelim", "Use tab delimiters in text tabular output file? (flag) (unused)"),
        ('"ES10.3E2"', "OutFmt", "Format used for text tabular output (unused)"),
        ("0", "TStart", "Time to begin tabular output (s) (unused)"),
        ("", "OutList", "The next lines contain a list of output parameters (-)"),
    ]
    return "\n".join(
        [
            _ruled("EXTPTFM INPUT FILE"),
            f"Reference point at z = {element.reference_m[2]:.6g} m in the structure's frame",
            _ruled("SIMULATION CONTROL"),
            *(_ruled(row[0]) if len(row) == 1 else f"{row[0]:<14} {row[1]:<15} - {row[2]}" for row in rows),
            *(f'"{channel}"' for channel in channels),
            'END of input file (the word "END" must appear in the first 3 columns of this last OutList line)',
            _ruled(""),
            "",
        ]
    )


def _ruled(title: str) -> str:
    return f"{'-' * 22} {title} ".ljust(80, "-")
