"""SubDyn decks as people mangle them: read by position, or refused with a message of ours."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from jackettwin.decks import read_structure
from jackettwin.errors import JackettwinError

DECK = Path(__file__).parents[1] / "data" / "subdyn" / "IEA-15-240-RWT-Jacket_SubDyn.dat"
LINES = DECK.read_text().splitlines()
COUNTS = [at for at, line in enumerate(LINES) if line.split()[1:2] and line.split()[1].startswith("N")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("decks")
    for beside in DECK.parent.glob("*.txt"):
        (folder / beside.name).write_bytes(beside.read_bytes())
    return folder


def header_of(keyword: str) -> int:
    return next(at for at in COUNTS if LINES[at].split()[1] == keyword) + 1


@pytest.mark.parametrize(
    "header", ["", "a b c", "nonsense", "MPropSetID2 MemberID MJointID2 MJointID1 x y z"]
)
@pytest.mark.parametrize("keyword", ["NMembers", "NJoints", "NReact", "NInterf"])
def test_headers_do_not_matter(folder: Path, keyword: str, header: str) -> None:
    lines = list(LINES)
    lines[header_of(keyword)] = header
    path = folder / "headers.dat"
    path.write_text("\n".join(lines))
    mangled, right = read_structure(path), read_structure(DECK)
    assert mangled.members == right.members and mangled.nodes == right.nodes
    assert mangled.reactions == right.reactions and mangled.interface_nodes == right.interface_nodes


def test_a_remark_behind_a_row_is_no_number(folder: Path) -> None:
    lines = list(LINES)
    lines[header_of("NJoints") + 2] += "  - foot of a leg"
    path = folder / "remark.dat"
    path.write_text("\n".join(lines))
    assert read_structure(path).nodes == read_structure(DECK).nodes


def mangled(data: st.DataObject) -> bytes:
    """Return the deck with a few lines changed, dropped, doubled or cut, in some encoding."""
    lines = list(LINES)
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.sampled_from([*COUNTS, *(c + k for c in COUNTS for k in (1, 2, 3))]))
        at = min(at, len(lines) - 1)
        words = lines[at].split() or [""]
        where = data.draw(st.integers(0, len(words) - 1))
        word = st.sampled_from(
            ["", "x", "-1", "1e99", "nan", "1e9999999", "0.5", "ä", '"', "!", "1d3", "99999999"]
        )
        match data.draw(st.sampled_from(["word", "drop", "double", "cut", "empty"])):
            case "word":
                words[where] = data.draw(word)
                lines[at] = " ".join(words)
            case "drop":
                del lines[at]
            case "double":
                lines.insert(at, lines[at])
            case "cut":
                lines[at] = " ".join(words[:where])
            case _:
                lines[at] = ""
    encoding = data.draw(st.sampled_from(["utf-8", "utf-8-sig", "latin-1", "utf-16"]))
    return "\n".join(lines).encode(encoding)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_nothing_but_our_own_errors_leaves_the_reader(folder: Path, data: st.DataObject) -> None:
    path = folder / "mangled.dat"
    path.write_bytes(mangled(data))
    try:
        structure = read_structure(path)
    except JackettwinError:
        return
    assert np.isfinite(list(structure.nodes.values())).all()
