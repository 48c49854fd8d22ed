"""Writer of superelements for OpenFAST's ExtPtfm: the module's input file and the matrices' file, by version.

``openfast5`` is the layout of 5.0 (``ExtPtfm_MCKF_IO.f90`` of v5.0.0): no format switch, the self-weight in a
separate matrix block, and no row between a header and its matrix. ``openfast3`` and ``openfast4`` are
FlexASCII, whose reader did not change from 2.4 to 4.2: the self-weight is a table of loads over time. Both
readers rely on line numbers, so that each stops with an error on the other layout.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.response.superelement.craig_bampton import INTERFACE, Superelement

Layout = Literal["openfast5", "openfast4", "openfast3"]
LAYOUTS: tuple[Layout, ...] = get_args(Layout)
DEFAULT: Layout = "openfast5"
NEWEST_LISTED = 9
"""Number of internal coordinates that are output channels."""
_FOREVER_S = 1.0e5
"""The constant loads of FlexASCII are given at 0 and at this time."""
_FORCES = ("IntrfFx", "IntrfFy", "IntrfFz", "IntrfMx", "IntrfMy", "IntrfMz")

Row = tuple[str, ...]


def matrices_text(element: Superelement, *, layout: Layout = DEFAULT) -> str:
    """Return the text of the matrices' file."""
    return _version_5(element) if layout == "openfast5" else _flex_ascii(element)


def _title(element: Superelement) -> str:
    x, y, z = element.reference_m
    inner = element.n - INTERFACE
    return f"{INTERFACE} + {inner} coordinates about the reference point ({x:.6g}, {y:.6g}, {z:.6g}) m"


def _version_5(element: Superelement) -> str:
    n = element.n
    lines = [f"!{_title(element)}", f"!Dimension: {n}"]
    for name, matrix in (
        ("Mass Matrix (kg,m)", element.M),
        ("Stiffness Matrix (N,m)", element.K),
        ("Damping Matrix (N,m,s)", element.C),
        ("Weight constant (N,m)", element.weight_n[None]),
        # the geometric stiffness due to weight (P-Δ) is in the stiffness matrix already
        ("Weight stiffness (N,m)", np.zeros((n, n))),
    ):
        lines += ["", f"!{name}", *map(_row, matrix)]
    return "\n".join(lines) + "\n"


def _flex_ascii(element: Superelement) -> str:
    n = element.n
    lines = [
        f"!{_title(element)}",
        "!Flex 5 Format",
        f"!Dimension: {n}",
        f"!Time increment in simulation: {_FOREVER_S:.5f}",
        f"!Total simulation time in file: {_FOREVER_S:.5f}",
    ]
    for name, matrix in (
        ("Mass Matrix (Units (kg,m))", element.M),
        ("Stiffness Matrix (Units (N,m))", element.K),
        ("Damping Matrix (Units (N,m,kg))", element.C),
    ):
        lines += ["", f"!{name}", f"!Dimension: {n}", *map(_row, matrix)]
    lines += ["", "!Loading and Wave Elevation (Units (N,m))",
              f"!Dimension: 1 time column - {n} force columns - 1 wave elevation column"]  # fmt: skip
    lines += [_row(np.array([t, *element.weight_n, 0.0])) for t in (0.0, _FOREVER_S)]
    return "\n".join(lines) + "\n"


def _row(values: FloatArray) -> str:
    return " ".join(f"{value:23.15e}" for value in values)


def static_internal(element: Superelement) -> FloatArray:
    """Return the static internal coordinates under the self-weight, with the interface fixed."""
    i = slice(INTERFACE, None)
    return np.asarray(np.linalg.solve(element.K[i, i], element.weight_n[i]))


def module_input(element: Superelement, name: str, *, layout: Layout = DEFAULT) -> str:
    """Return the text of the module's input file; the coordinates start from static equilibrium under weight.

    Parameters
    ----------
    name : name of the matrices' file in the same folder
    """
    rows = _rows_5(element, name) if layout == "openfast5" else _rows_flex(element, name)
    inner = min(element.n - INTERFACE, NEWEST_LISTED)
    prefix = "CBD" if layout == "openfast5" else "CBQ_"
    channels = [*_FORCES, *(f"{prefix}{k:03d}" for k in range(1, inner + 1))]
    return "\n".join(
        [
            _ruled(f"EXTPTFM INPUT FILE for OpenFAST {layout[-1]}"),
            f"Reference point at z = {element.reference_m[2]:.6g} m in the structure's frame",
            _ruled("SIMULATION CONTROL"),
            *(_ruled(row[0]) if len(row) == 1 else f"{row[0]:<14} {row[1]:<15} - {row[2]}" for row in rows),
            *(f'"{channel}"' for channel in channels),
            'END of input file (the word "END" must appear in the first 3 columns of this last OutList line)',
            _ruled(""),
            "",
        ]
    )


def _rows_5(element: Superelement, name: str) -> list[Row]:
    return [
        *_CONTROL,
        ("REDUCTION INPUTS",),
        ("0", "RBMod", "Rigid-body motion {0:fixed bottom; 1,2:floating} (switch)"),
        (f'"{name}"', "Red_FileName", "Path of the file containing Guyan/Craig-Bampton inputs (-)"),
        *_coordinates(element),
        ("CONNECTIONS",),
        ("False", "Connections", "Flag for connections (flag)"),
        ('"NA"', "Conn_FileName", "Path containing connections inputs (-)"),
        ("USER FORCING",),
        ("False", "UserForcing", "Flag for user prescribed modal forcing (flag)"),
        ('"NA"', "Force_FileName", "Path containing user modal forcing inputs (-)"),
        ("False", "ConnForcing", "Flag for user prescribed connection forcing (flag)"),
        ('"NA"', "FConn_FileName", "Path containing user connection forcing inputs (-)"),
        *_OUTPUT,
    ]


def _rows_flex(element: Superelement, name: str) -> list[Row]:
    return [
        *_CONTROL,
        ("REDUCTION INPUTS",),
        ("1", "FileFormat", "File Format {0:Guyan; 1:FlexASCII} (switch)"),
        (f'"{name}"', "Red_FileName", "Path of the file containing Guyan/Craig-Bampton inputs (-)"),
        ('"NA"', "RedCst_FileName", "Path of the file containing constant inputs (-) (unused)"),
        *_coordinates(element),
        *_OUTPUT,
    ]


def _coordinates(element: Superelement) -> tuple[Row, ...]:
    rest = static_internal(element)
    start = ", ".join(f"{q:.9e}" for q in rest) if rest.size else "0,"
    return (
        ("-1", "NActiveDOFList", "Number of active CB modes in ActiveDOFList, -1 for all (integer)"),
        ("1,", "ActiveDOFList", "List of CB modes that are active [unused if NActiveDOFList<=0]"),
        (f"{rest.size}", "NInitPosList", "Number of initial positions listed in InitPosList (integer)"),
        (start, "InitPosList", "List of initial positions of the CB modes"),
        ("0", "NInitVelList", "Number of initial velocities listed in InitVelList (integer)"),
        ("0,", "InitVelList", "List of initial velocities of the CB modes"),
    )


_CONTROL: tuple[Row, ...] = (
    ("False", "Echo", "Echo input data to <RootName>.ech (flag)"),
    ('"default"', "DT", 'Communication interval (s) (or "default")'),
    ("1", "IntMethod", "Integration Method {1:RK4; 2:AB4, 3:ABM4} (switch)"),
)
_OUTPUT: tuple[Row, ...] = (
    ("OUTPUT",),
    ("True", "SumPrint", "Print summary data to <RootName>.sum (flag)"),
    ("1", "OutFile", "Switch for the output (unused)"),
    ("True", "TabDelim", "Use tab delimiters in text tabular output file? (flag) (unused)"),
    ('"ES10.3E2"', "OutFmt", "Format used for text tabular output (unused)"),
    ("0", "TStart", "Time to begin tabular output (s) (unused)"),
    ("", "OutList", "The next lines contain a list of output parameters (-)"),
)


def _ruled(title: str) -> str:
    return f"{'-' * 22} {title} ".ljust(80, "-")
