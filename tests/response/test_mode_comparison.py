"""Modes beside another program's: MAC, pairs of one frequency, nodes by name and place, tables."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from jackettwin.cli.main import main
from jackettwin.decks import NodalModes, read_modes, read_structure, write_modes
from jackettwin.errors import InputError
from jackettwin.response import (
    UndampedModes,
    build_system,
    compare_modes,
    expanded,
    nodal_modes,
    undamped_modes,
)
from jackettwin.soil import pinned
from jackettwin.structure import Assembly, assemble

JACKET = assemble(read_structure("jacket15"))
OWN = undamped_modes(build_system(JACKET, pinned(JACKET.structure)), 6)
THEIRS = nodal_modes(JACKET, OWN)


def symmetric() -> tuple[Assembly, UndampedModes]:
    """Return the jacket with its nacelle on the axis: bending modes in pairs."""
    whole = JACKET.structure
    masses = tuple(
        replace(m, cg_offset_m=(0.0, 0.0, 2.0), inertia_kg_m2=(1e8, 1e8, 2e8, 0, 0, 0)) for m in whole.masses
    )
    assembly = assemble(whole.with_masses(masses))
    return assembly, undamped_modes(build_system(assembly, pinned(assembly.structure)), 6)


def test_a_structure_is_like_itself(tmp_path: Path) -> None:
    """Through a file and back every mode is its own: MAC 1 on the diagonal and below it elsewhere."""
    table = read_modes(write_modes([("", THEIRS)], tmp_path / "modes.csv"))[""]
    found = compare_modes(JACKET, OWN, table)
    assert [(p.own, p.other) for p in found.pairs] == [(k, k) for k in range(6)]
    np.testing.assert_allclose([p.mac for p in found.pairs], 1.0, rtol=1e-6)
    np.testing.assert_allclose([p.rotations_mac for p in found.pairs], 1.0, rtol=1e-6)
    assert (found.mac - np.diag(np.diag(found.mac))).max() < 0.5
    np.testing.assert_allclose(table.frequency_hz, OWN.frequency_hz, rtol=1e-8)


def test_order_sign_and_scale_do_not_matter() -> None:
    order = [3, 0, 5, 1, 4, 2]
    mixed = replace(
        THEIRS,
        frequency_hz=THEIRS.frequency_hz[order],
        shapes=-7.0 * THEIRS.shapes[order],
    )
    found = compare_modes(JACKET, OWN, mixed)
    assert {p.own: order[p.other] for p in found.pairs} == {k: k for k in range(6)}
    assert min(p.mac for p in found.pairs) > 1.0 - 1e-9


def test_nodes_are_found_by_place() -> None:
    """Other names, 5 cm off: the same node. Half a metre off it is none."""
    places = THEIRS.places + np.array([0.03, 0.04, 0.0])
    places[7] += 0.5
    other = replace(THEIRS, nodes=tuple(f"n{k}" for k in range(len(THEIRS.nodes))), places=places)
    found = compare_modes(JACKET, OWN, other)
    assert found.unknown == ("n7",)
    assert found.other.nodes[:3] == THEIRS.nodes[:3]
    assert min(p.mac for p in found.pairs) > 1.0 - 1e-9
    with pytest.raises(InputError, match="3 nodes or more, by name or by x_m"):
        compare_modes(JACKET, OWN, replace(other, places=None))


@pytest.mark.parametrize("angle", [0.3, np.pi / 4.0, 1.9])
def test_pairs_are_turned_to_each_other(angle: float) -> None:
    """A pair that the other program has turned by any angle is the same pair, whichever way it is mixed."""
    assembly, own = symmetric()
    assert own.frequency_hz[1] == pytest.approx(own.frequency_hz[0], rel=1e-6)
    other = nodal_modes(assembly, own)
    c, s = np.cos(angle), np.sin(angle)
    first, second = (
        other.shapes[0] / np.linalg.norm(other.shapes[0]),
        other.shapes[1] / np.linalg.norm(other.shapes[1]),
    )
    shapes = other.shapes.copy()
    shapes[0], shapes[1] = c * first + s * second, c * second - s * first
    found = compare_modes(assembly, own, replace(other, shapes=shapes))
    assert min(p.mac for p in found.pairs) > 1.0 - 1e-6
    # the turned modes are modes still: of unit mass, orthogonal, of the pair's frequency
    turned = found.own.shapes
    np.testing.assert_allclose(turned.T @ (assembly.mass @ turned), np.eye(6), atol=1e-9)


def test_modes_that_are_no_pair_are_not_turned() -> None:
    """Fore-aft and side-side 1.5 % apart: a mixture of them is like neither."""
    shapes = THEIRS.shapes.copy()
    shapes[:2] = (shapes[0] + shapes[1]) / 2**0.5, (shapes[0] - shapes[1]) / 2**0.5
    found = compare_modes(JACKET, OWN, replace(THEIRS, shapes=shapes))
    assert max(p.mac for p in found.pairs if p.own < 2) < 0.6


def test_what_is_between_known_nodes_rests_on_them() -> None:
    """Known with six components at every node, a shape is met between them but for (f/f_e)².

    f_e is a member's between held ends, some fifteen times the modes' own; between ends free to turn, where
    translations alone are known, some four times.
    """
    fine = assemble(JACKET.structure, subdivide=3)
    modes = undamped_modes(build_system(fine, pinned(fine.structure)), 3)
    other = nodal_modes(fine, modes)
    for known, worst in ((other, 5e-3), (replace(other, has_rotations=False), 0.1)):
        u = expanded(fine, known)
        for k in range(3):
            scale = modes.shapes[:, k] @ u[:, k] / (u[:, k] @ u[:, k])
            wrong = np.linalg.norm(modes.shapes[:, k] - scale * u[:, k]) / np.linalg.norm(modes.shapes[:, k])
            assert wrong < worst


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("mode,freq", "mod,freq", "mode: column is missing"),
        ("rx,ry", "rx,phi", "phi: unknown column"),
        ("\n1,", "\n1x,", "mode 1"),
        (",foot_2,", ",foot_1,", "line 3.node: mode 1 has this node twice"),
        ("1,0.1831", "1,nan1", "line 2.frequency_hz: not a finite number"),
        ("1,0.1831", "1,-0.1831", "line 2.frequency_hz: must be positive"),
    ],
)
def test_mistakes_in_a_table_are_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = write_modes([("", THEIRS)], tmp_path / "modes.csv")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        read_modes(path)


def test_still_and_empty_tables_are_refused(tmp_path: Path) -> None:
    still = NodalModes(np.array([1.0]), ("foot_1", "foot_2"), np.zeros((1, 2, 6)))
    with pytest.raises(InputError, match="without motion"):
        read_modes(write_modes([("", still)], tmp_path / "still.csv"))
    (tmp_path / "empty.csv").write_text("mode,frequency_hz,node,ux,uy,uz\n")
    with pytest.raises(InputError, match="empty"):
        read_modes(tmp_path / "empty.csv")


def test_commands_compare_and_draw(tmp_path: Path) -> None:
    """`modes` writes what it reads, `view` shows it, `stages` takes it by stage."""

    def run(*words: str) -> str:
        answer = CliRunner().invoke(main, [*words])
        assert answer.exit_code == 0, answer.output
        return answer.stdout

    table, page = str(tmp_path / "theirs.csv"), str(tmp_path / "page.html")
    run("modes", "jacket15", "--support", "pinned", "--number", "5", "--shapes", table)
    said = run(
        "modes", "jacket15", "--support", "pinned", "--number", "5", "--against", table, "--figure", page
    )
    assert "1.0000" in said
    assert Path(page).read_text().count("MAC 1.000") == 5
    view = ["view", "jacket15", "--support", "pinned", "--modes", "3", "--against", table]
    pairs = json.loads(run(*view, "--out", page, "--json"))["shapes"]["pairs"]
    for pair in pairs:  # of the same elements as those of `modes`, however finely they are drawn
        assert abs(pair["relative_error"]) < 1e-4
    assert "another program" in Path(page).read_text()
    rows = Path(table).read_text().splitlines()
    (tmp_path / "staged.csv").write_text(
        "\n".join([f"stage,{rows[0]}", *(f"tower,{row}" for row in rows[1:])]) + "\n"
    )
    said = run("stages", "jacket15", "--against", str(tmp_path / "staged.csv"), "--figure", page)
    assert re.search(r"shapes at \d+ nodes", said)
    said = run("stages", "jacket15", "--against", "jacket15", "--figure", page)
    assert Path(page).read_text().count("MAC 1.000") == 15
    refused = CliRunner().invoke(main, ["modes", "jacket15", "--support", "pinned", "--figure", page])
    assert refused.exit_code == 2
    assert "--against" in refused.output
