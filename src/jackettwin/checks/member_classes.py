"""Braces and crossed braces of a frame, and the effective lengths of table 13.5-1 of ISO 19902."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

from jackettwin.checks.columns import StraightRun
from jackettwin.checks.joint_check import JointPlan

BRACE, CROSSED, OTHER = "brace", "crossed brace", "other"
K_OF_CLASS = {BRACE: 0.7, CROSSED: 0.8}
"""Table 13.5-1: primary diagonals, K-braces and horizontals 0.7; 0.8 on the longer segment of crossed braces.
Legs between the joints that hold them keep 1, cantilevers 2."""
_IN_LINE = -0.98
"""Cosine of the angle between ends that go on through a crossing."""


def member_classes(plans: tuple[JointPlan, ...]) -> dict[str, str]:
    """Return the class of every member that stands on a chord, by name; others have none.

    A brace ends on a wider run and carries no brace itself, but for the one it crosses: at a crossing two
    tubes go on through one node, and each of them is a brace at its other end.
    """
    braces, chords = defaultdict(set), defaultdict(set)
    for plan in plans:
        for end in plan.braces:
            braces[end.member.name].add(plan.node)
        for end in plan.chord:
            chords[end.member.name].add(plan.node)
    crossings = {plan.node for plan in plans if _is_crossing(plan, braces)}
    found = {}
    for name in {*braces, *chords}:
        stands, carries = braces[name] - crossings, chords[name] - crossings
        if stands and not carries:
            crossed = (braces[name] | chords[name]) & crossings
            found[name] = CROSSED if crossed else BRACE
    return found


def _is_crossing(plan: JointPlan, braces: Mapping[str, set[str]]) -> bool:
    """Return whether two braces meet on two others in line, that are braces at their far ends."""
    if len(plan.chord) != 2 or len(plan.braces) != 2:
        return False
    through = float(plan.braces[0].away @ plan.braces[1].away) < _IN_LINE
    return through and all(braces[end.member.name] - {plan.node} for end in (*plan.chord, *plan.braces))


def column_lengths(plans: tuple[JointPlan, ...], runs: Mapping[str, StraightRun]) -> dict[str, float]:
    """Return the length [m] of every column; of crossed braces the longer of the two segments in line."""
    length = {name: run.length_m for name, run in runs.items()}
    classes = member_classes(plans)
    for plan in plans:
        for pair in (plan.chord, plan.braces):
            names = [end.member.name for end in pair]
            if len(names) == 2 and all(classes.get(name) == CROSSED for name in names):
                length |= dict.fromkeys(names, max(runs[name].length_m for name in names))
    return length
