"""Joints of a SubDyn deck: places, hinges, groups of rigid links."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from jackettwin.decks.openfast import Deck, DeckRow
from jackettwin.errors import require
from jackettwin.structure import RigidLink, TwoNodeElement, Vector, spring_matrix, two_node_element
from jackettwin.structure.model import reached_by

if TYPE_CHECKING:
    from collections.abc import Collection

_RIGIDLY, _UNIVERSAL, _PIN, _BALL = "1", "2", "3", "4"

Ends = dict[str, tuple[str, str]]


def joint_rows(deck: Deck) -> tuple[DeckRow, ...]:
    """Return the rows of the table of joints."""
    return deck.table(
        "NJoints",
        required=True,
        columns=("jointid", "jointxss", "jointyss", "jointzss"),
        optional=("jointtype", "jointdirx", "jointdiry", "jointdirz", "jointstiff"),
    )


def member_rows(deck: Deck) -> tuple[DeckRow, ...]:
    """Return the rows of the table of members.

    The number behind a member's type is a cosine matrix up to OpenFAST 4.0, then a beam's spin; only the
    header tells which.
    """
    turned = "cosmid" if deck.header("NMembers")[6:7] == ("cosmid",) else "mspin/cosmid"
    return deck.table(
        "NMembers",
        required=True,
        columns=("memberid", "mjointid1", "mjointid2", "mpropsetid1", "mpropsetid2"),
        optional=("mtype", turned, "mdivsize"),
    )


def read_joints(deck: Deck) -> dict[str, Vector]:
    """Return {joint: its place}."""
    nodes: dict[str, Vector] = {}
    for row in joint_rows(deck):
        name = row["jointid"]
        require(name not in nodes, "joint is given twice", field="JointID", value=name)
        x, y, z = row.numbers("jointxss", "jointyss", "jointzss")
        nodes[name] = (x, y, z)
    return nodes


def member_ends(deck: Deck, nodes: dict[str, Vector]) -> Ends:
    """Return {member: its two joints}."""
    ends = {}
    for row in member_rows(deck):
        ends[row["memberid"]] = pair = (row["mjointid1"], row["mjointid2"])
        for joint in pair:
            require(
                joint in nodes,
                "no such joint",
                field=f"MemberID {row['memberid']}",
                value=joint,
                remedy="name a JointID of the table of joints, or add it there",
            )
    return ends


def with_hinges(
    deck: Deck, nodes: dict[str, Vector], ends: Ends, beams: Collection[str]
) -> tuple[dict[str, Vector], Ends, list[RigidLink], list[TwoNodeElement]]:
    """Return nodes, ends, links and springs with the joints that turn.

    The first beam at such a joint keeps it; each other gets a node of its own there, which follows the joint
    but for the rotations that are free. The joint's stiffness acts between the rotations of every two beams.
    """
    nodes, ends = dict(nodes), dict(ends)
    links, springs = [], []
    for row in joint_rows(deck):
        joint, kind = row["jointid"], row.get("jointtype", _RIGIDLY)
        if kind == _RIGIDLY:
            continue
        axes = _free_axes(row, kind)
        others = [name for name in beams if joint in ends[name]][1:]
        at = [joint, *(f"{joint}@{name}" for name in others)]
        for name, node in zip(others, at[1:], strict=True):
            nodes[node] = nodes[joint]
            links.append(RigidLink(joint, node, axes))
            start, end = ends[name]
            ends[name] = (node if start == joint else start, node if end == joint else end)
        springs += _joint_springs(row, axes, at)
    return nodes, ends, links, springs


def _free_axes(row: DeckRow, kind: str) -> tuple[Vector, ...]:
    place = f"JointID {row['jointid']}"
    if kind == _BALL:
        return ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    require(
        kind == _PIN,
        "unsupported joint (universal)" if kind == _UNIVERSAL else "unknown joint",
        field=f"{place}.JointType",
        value=kind,
        allowed="1 (cantilever), 3 (revolute), 4 (spherical)",
    )
    axis = np.array(row.numbers("jointdirx", "jointdiry", "jointdirz"))
    length = float(np.linalg.norm(axis))
    require(
        length > 0.0,
        "a revolute joint needs an axis",
        field=f"{place}.JointDir",
        value=axis.tolist(),
        remedy="give JointDirX, JointDirY, JointDirZ",
    )
    return (cast("Vector", tuple(float(value) / length for value in axis)),)


def _joint_springs(row: DeckRow, axes: tuple[Vector, ...], nodes: list[str]) -> list[TwoNodeElement]:
    stiffness = row.number("jointstiff", 0.0)
    if stiffness == 0.0:
        return []
    k = np.zeros((6, 6))
    k[3:, 3:] = stiffness * np.sum([np.outer(axis, axis) for axis in axes], axis=0)
    K = spring_matrix(k, np.eye(3))
    return [
        two_node_element(f"{a}-{b}", "joint spring", (a, b), K)
        for i, a in enumerate(nodes)
        for b in nodes[i + 1 :]
    ]


def link_groups(deck: Deck, pairs: list[tuple[str, str]]) -> list[RigidLink]:
    """Return links from one leader a rigid group to everybody else in it; a reaction joint leads."""
    joined = dict.fromkeys(joint for pair in pairs for joint in pair)
    leaders_first = [row["rjointid"] for row in deck.table("NReact", columns=("rjointid",))]
    seen: set[str] = set()
    links = []
    for leader in [*(name for name in leaders_first if name in joined), *joined]:
        if leader not in seen:
            group = reached_by(pairs, [leader])
            seen |= group
            links += [RigidLink(leader, follower) for follower in sorted(group - {leader})]
    return links
