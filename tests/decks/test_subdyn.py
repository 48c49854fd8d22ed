"""Structures from SubDyn decks against SubDyn's own results (OpenFAST v5.0.0)."""

import json
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response.modes.modal import undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil import Support, own_support
from jackettwin.structure import assemble

DATA = Path(__file__).parents[1] / "data" / "subdyn"
DECK = DATA / "IEA-15-240-RWT-Jacket_SubDyn.dat"
CASES = json.loads((DATA / "subdyn_results.json").read_text())["cases"]


@pytest.mark.parametrize(
    ("case", "theory", "fixed"),
    [
        ("j50_eb_ssi_jkt", "euler-bernoulli", False),
        ("j50_eb_fixed_jkt", "euler-bernoulli", True),
        ("j50_tim_ssi_jkt", "timoshenko", False),
    ],
)
def test_first_eight_frequencies(case: str, theory: str, fixed: bool) -> None:
    structure = read_structure(DECK)
    support = own_support(structure)
    if fixed:
        support = Support(fixed=tuple((node, (0, 1, 2, 3, 4, 5)) for node in structure.reaction_nodes))
    system = build_system(assemble(structure, beam_theory=theory, subdivide=2), support)
    # SubDyn itself used one or two elements a member; 0.01 % holds for all three runs
    np.testing.assert_allclose(
        undamped_modes(system, 8).frequency_hz, CASES[case]["Full_frequencies"][:8], rtol=1e-4
    )


def test_mass_and_centre_of_gravity() -> None:
    assembly = assemble(read_structure(DECK))
    lift = np.tile([0, 0, 1.0, 0, 0, 0], assembly.n_dof // 6)
    weight = assembly.mass @ lift
    mass = lift @ weight
    assert mass == pytest.approx(CASES["j50_eb_ssi_jkt"]["Mass"], rel=1e-6)
    about_x = np.zeros((assembly.n_dof // 6, 6))
    about_x[:, 1], about_x[:, 2], about_x[:, 3] = (
        -assembly.mesh.coordinates[:, 2], assembly.mesh.coordinates[:, 1], 1.0,
    )  # fmt: skip
    sway = np.tile([0, 1.0, 0, 0, 0, 0], assembly.n_dof // 6)
    z = -(about_x.ravel() @ assembly.mass @ sway) / mass
    assert z == pytest.approx(float(CASES["j50_eb_ssi_jkt"]["CM"].split(",")[2]), rel=1e-4)


def test_the_newer_format_reads_the_same(tmp_path: Path) -> None:
    """OpenFAST 5: NPropSetsCyl, member type 1c, a TPID column, an extra spring table, lines moved."""
    text = DECK.read_text()
    new = text.replace("NPropSets   -", "NPropSetsCyl -").replace("GuyanLoadCorrection", "Removed")
    start = new.index("MemberID")
    end = new.index("------------------ MEMBER X-SECTION")
    new = (
        new[:start]
        + new[start:end].replace("\t\t1\n", "\t\t1c -1\n").replace("MType\tCOSMID", "MType MSpin/COSMID")
        + new[end:]
    )
    (tmp_path / "new.dat").write_text("an extra line\n" + new)
    (tmp_path / "Jacket_Kzz.txt").write_text((DATA / "Jacket_Kzz.txt").read_text())
    old, again = read_structure(DECK), read_structure(tmp_path / "new.dat")
    assert (old.nodes, old.members, old.masses, old.reactions) == (
        again.nodes,
        again.members,
        again.masses,
        again.reactions,
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("1\t\t1\t\t4\t\t1\t\t1\t\t1", "1\t\t1\t\t4\t\t1\t\t1\t\t7", "unsupported member type .unknown"),
        ("1\t\t1\t\t4\t\t1\t\t1\t\t1", "1\t\t1\t\t99\t\t1\t\t1\t\t1", "no such joint .got '99'"),
        (
            "1.7             0.080",
            "1.7             -0.080",
            "PropSetID 1.thickness_m.*at most the radius.*-0.08",
        ),
        ("1.7             0.080", "1.7             abc", "not a number .got 'abc'"),
        ("'Jacket_Kzz.txt'", "'gone.txt'", "no such SSI file"),
    ],
)
def test_bad_decks_are_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    (tmp_path / "bad.dat").write_text(DECK.read_text().replace(old, new, 1))
    (tmp_path / "Jacket_Kzz.txt").write_text((DATA / "Jacket_Kzz.txt").read_text())
    with pytest.raises(InputError, match=message):
        read_structure(tmp_path / "bad.dat")


def test_headings_of_another_spelling_do_not_matter(tmp_path: Path) -> None:
    """SubDyn reads these tables by position."""
    text = DECK.read_text()
    for name in ("XsecD", "XsecT", "JointXss"):
        assert name in text
        text = text.replace(name, name.replace("X", "X_"))
    path = tmp_path / DECK.name
    path.write_text(text)
    ssi = DECK.with_name("Jacket_Kzz.txt")
    (tmp_path / ssi.name).write_bytes(ssi.read_bytes())
    assert read_structure(path) == read_structure(DECK)
