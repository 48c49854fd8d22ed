"""ExtPtfm's files by version: what ReadPrimaryFile and ReadReducedFile of OpenFAST find where they look."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.response.superelement.craig_bampton import Superelement
from jackettwin.response.superelement.extptfm_writer import LAYOUTS, Layout, static_internal
from jackettwin.response.superelement.files import write_superelement

N = 8
BEFORE = [
    *("Echo", "DT", "IntMethod", "", "FileFormat", "Red_FileName", "RedCst_FileName"),
    *("NActiveDOFList", "ActiveDOFList", "NInitPosList", "InitPosList", "NInitVelList", "InitVelList", ""),
    *("SumPrint", "OutFile", "TabDelim", "OutFmt", "TStart", "OutList"),
]
"""ReadPrimaryFile of v3.0.0 to v4.2.1."""
SINCE = [
    *("Echo", "DT", "IntMethod", "", "RBMod", "Red_FileName"),
    *("NActiveDOFList", "ActiveDOFList", "NInitPosList", "InitPosList", "NInitVelList", "InitVelList", ""),
    *("Connections", "Conn_FileName", ""),
    *("UserForcing", "Force_FileName", "ConnForcing", "FConn_FileName", ""),
    *("SumPrint", "OutFile", "TabDelim", "OutFmt", "TStart", "OutList"),
]
"""ReadPrimaryFile of v5.0.0."""


@pytest.fixture
def element() -> Superelement:
    rng = np.random.default_rng(N)
    M, C, K = (a @ a.T + np.eye(N) for a in rng.normal(size=(3, N, N)))
    return Superelement(M, C, 1e9 * K, (0.0, 0.0, 15.0), rng.normal(size=N), np.empty((0, N)))


@pytest.mark.parametrize(
    ("layout", "wanted"), [*((old, BEFORE) for old in LAYOUTS[1:]), ("openfast5", SINCE)]
)
def test_items_stand_in_their_place(
    tmp_path: Path, element: Superelement, layout: Layout, wanted: list[str]
) -> None:
    _, module = write_superelement(element, tmp_path / "jacket.dat", layout=layout)
    lines = module.read_text().splitlines()[3:]
    for line, keyword in zip(lines, wanted, strict=False):
        assert f" {keyword} " in line if keyword else line.startswith("---")
    at = wanted.index("InitPosList")
    start = [float(v) for v in lines[at].split("InitPosList")[0].rstrip(" -,").split(",")]
    np.testing.assert_allclose(start, static_internal(element), rtol=1e-8)
    assert '"jacket.dat"' in lines[wanted.index("Red_FileName")]


def test_openfast_5_reads_rows_at_once_below_a_header(tmp_path: Path, element: Superelement) -> None:
    """``index(Line, '!MASS') == 1`` in upper case, then n rows; the weight is one row, by 3 MN or by none."""
    path, _ = write_superelement(element, tmp_path / "jacket.dat")
    lines = [line.upper() for line in path.read_text().splitlines()]
    assert int(lines[1][11:]) == N  # read from column 12
    for keyword, matrix in (
        ("!MASS", element.M),
        ("!STIFFNESS", element.K),
        ("!DAMPING", element.C),
        ("!WEIGHT CONSTANT", element.weight_n[None]),
        ("!WEIGHT STIFFNESS", np.zeros((N, N))),
    ):
        at = next(k for k, line in enumerate(lines) if line.startswith(keyword))
        rows = lines[at + 1 : at + 1 + len(matrix)]
        np.testing.assert_allclose([[float(v) for v in row.split()] for row in rows], matrix, rtol=1e-14)
    assert not any(line.startswith("!LOADING") for line in lines)


@pytest.mark.parametrize("layout", LAYOUTS[1:])
def test_flex_ascii_has_a_row_of_dimensions_between(
    tmp_path: Path, element: Superelement, layout: Layout
) -> None:
    """Keywords start a line, matrices two lines below, nint(T/dt) + 1 loads."""
    path, _ = write_superelement(element, tmp_path / "jacket.dat", layout=layout)
    lines = [line.upper() for line in path.read_text().splitlines()]
    assert "FLEX 5 FORMAT" in lines[1]
    header = {line.split(":")[0]: float(line.split(":")[1]) for line in lines[2:5]}
    assert header["!DIMENSION"] == N
    n_loads = round(header["!TOTAL SIMULATION TIME IN FILE"] / header["!TIME INCREMENT IN SIMULATION"]) + 1
    for keyword, matrix in (
        ("!MASS MATRIX", element.M),
        ("!STIFFNESS MATRIX", element.K),
        ("!DAMPING MATRIX", element.C),
    ):
        at = next(k for k, line in enumerate(lines) if line.startswith(keyword))
        read = np.array([[float(v) for v in line.split()] for line in lines[at + 2 : at + 2 + N]])
        np.testing.assert_allclose(read, matrix, rtol=1e-14)
    at = next(k for k, line in enumerate(lines) if line.startswith("!LOADING"))
    loads = [line for line in lines[at + 2 :] if line]
    assert len(loads) == n_loads
    assert all(len(line.split()) >= N + 1 for line in loads)
    assert max(map(len, lines)) < 4096  # the reader's line buffer
