"""ExtPtfm's files as ExtPtfm_MCKF_IO.f90 of OpenFAST reads them."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.response.superelement.craig_bampton import Superelement
from jackettwin.response.superelement.extptfm_reader import is_extptfm
from jackettwin.response.superelement.extptfm_writer import LAYOUTS
from jackettwin.response.superelement.files import is_superelement, read_superelement, write_superelement


def element(n: int) -> Superelement:
    rng = np.random.default_rng(n)
    M, C, K = (a @ a.T + np.eye(n) for a in rng.normal(size=(3, n, n)))
    return Superelement(M, C, 1e9 * K, (0.0, 0.0, 15.0), rng.normal(size=n), np.empty((0, n)))


def guyan_text(e: Superelement, loads: bool = True) -> str:
    """ReadGuyanASCII: a header, three matrices under a comment each, three comments, the table."""

    def rows(matrix: np.ndarray) -> list[str]:
        return [" ".join(f"{v:.15e}" for v in row) for row in matrix]

    lines = ["a support structure", "#Mass", *rows(e.M), "#Damping", *rows(e.C), "#Stiffness", *rows(e.K)]
    lines += ["#Loading", "time Fx Fy Fz Mx My Mz", "s N N N Nm Nm Nm"]
    if loads:
        lines += rows(np.array([[0.0, *e.weight_n], [9.0, *e.weight_n]]))
    return "\n".join(lines) + "\n"


def same(found: Superelement, e: Superelement, at: list[int]) -> None:
    for name in ("M", "C", "K"):
        # sixteen digits on paper
        np.testing.assert_allclose(getattr(found, name), getattr(e, name)[np.ix_(at, at)], rtol=1e-14)


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize(
    ("active", "kept"),
    [(("-1", "1,"), range(10)), (("2", "4, 1"), [*range(6), 9, 6]), (("0", "1,"), range(6))],
)
def test_the_input_file_leads_to_the_matrices(
    tmp_path: Path, layout: str, active: tuple[str, str], kept: list[int]
) -> None:
    """NActiveDOFList < 0 keeps all coordinates, 0 the interface alone."""
    e = element(10)
    module = write_superelement(e, tmp_path / "tower.dat", layout=layout)[1]
    text = module.read_text().replace("-1             NActive", f"{active[0]}  NActive")
    module.write_text(text.replace("1,             ActiveDOFList", f"{active[1]}  ActiveDOFList"))
    assert is_superelement(module)
    found = read_superelement(module)
    same(found, e, list(kept))
    np.testing.assert_allclose(found.weight_n, e.weight_n[list(kept)], rtol=1e-14)


@pytest.mark.parametrize("loads", [True, False])
def test_guyan_s_format(tmp_path: Path, loads: bool) -> None:
    e = element(6)
    path = tmp_path / "guyan.dat"
    path.write_text(guyan_text(e, loads))
    module = write_superelement(e, tmp_path / "other.dat", layout="openfast4")[1]
    text = module.read_text().replace('"other.dat"', '"guyan.dat"')
    module.write_text(text.replace("1              FileFormat", "0  FileFormat"))
    for one in (path, module):
        assert is_superelement(one)
        found = read_superelement(one)
        same(found, e, list(range(6)))
        np.testing.assert_allclose(found.weight_n, e.weight_n if loads else np.zeros(6), rtol=1e-14)


def test_a_subdyn_deck_is_no_superelement(tmp_path: Path) -> None:
    path = tmp_path / "deck.dat"
    path.write_text("---- SubDyn input file ----\nmass-tuned jacket, 6 legs\n---- SIMULATION CONTROL ----\n")
    assert not is_extptfm(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("1              FileFormat", "2  FileFormat", "FileFormat: unknown format .got '2'.*FlexASCII"),
        ("FileFormat", "Format", "FileFormat: keyword is missing"),
        ('"tower.dat"', '"gone.dat"', "gone.dat: no such superelement file"),
        ("-1             NActive", "1  NActive", None),
        ("-1             NActive", "9  NActive", "ActiveDOFList: .*allowed: 9 numbers from 1 to 2"),
        ("-1             NActive", "many  NActive", "ActiveDOFList: not whole numbers"),
    ],
)
def test_wrong_input_files_are_refused(tmp_path: Path, old: str, new: str, message: str | None) -> None:
    module = write_superelement(element(8), tmp_path / "tower.dat", layout="openfast4")[1]
    text = module.read_text()
    assert old in text
    module.write_text(text.replace(old, new))
    if message is None:
        assert read_superelement(module).n == 7
        return
    with pytest.raises(InputError, match=message):
        read_superelement(module)


def test_a_short_guyan_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "guyan.dat"
    path.write_text("\n".join(guyan_text(element(6)).splitlines()[:20]))
    with pytest.raises(InputError, match="stiffness: matrix has the wrong shape"):
        read_superelement(path)


def test_weight_stiffness_is_stiffness(tmp_path: Path) -> None:
    """OpenFAST 5 takes the block's forces off the weight: what another program left there is added."""
    e = element(7)
    path = write_superelement(e, tmp_path / "se.dat")[0]
    head, tail = path.read_text().split("!Weight stiffness (N,m)\n")
    extra = np.diag(np.arange(7.0))
    path.write_text(head + "!Weight stiffness\n" + "\n".join(" ".join(map(str, row)) for row in extra))
    np.testing.assert_allclose(read_superelement(path).K, e.K + extra, rtol=1e-14)
    assert tail.split() == ["0.000000000000000e+00"] * 49
