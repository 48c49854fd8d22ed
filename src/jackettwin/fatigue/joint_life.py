"""Hot-spot stresses of every brace of every tubular joint of a structure, from its section forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.checks import IN_PLANE, JointPlan, brace_forces, joint_shares
from jackettwin.fatigue.efthymiou import (
    OF_KT,
    BraceTube,
    ConcentrationFactors,
    JointClass,
    OutOfRange,
    TubularJoint,
    concentration,
    factors_document,
)
from jackettwin.fatigue.hot_spots import hot_spot_matrix
from jackettwin.structure import Assembly, SectionForces, Structure

_CLASSES: tuple[JointClass, ...] = ("k", "y", "x")
"""In the order in which a joint's forces are shared."""


@dataclass(frozen=True)
class HotSpot:
    """The weld of one brace on its chord.

    Attributes
    ----------
    node, chord, brace : str
    factors : {class: its factors}
    matrices : (3 classes, 2 sides, 8 points, 3 components) hot-spot over nominal stress
    thickness_m : (chord, brace)
    per_force : (3,) nominal stress per axial force [Pa/N], in-plane and out-of-plane moment [Pa/(N·m)]
    out_of_range : what lies outside the ranges of the factors
    """

    node: str
    chord: str
    brace: str
    factors: dict[str, ConcentrationFactors]
    matrices: FloatArray
    thickness_m: tuple[float, float]
    per_force: FloatArray
    out_of_range: tuple[OutOfRange, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What lies outside the ranges of the factors, in sentences."""
        return tuple(one.text for one in self.out_of_range)

    @property
    def doubts(self) -> tuple[str, ...]:
        """Those of the warnings whose factors may be too small."""
        return tuple(one.text for one in self.out_of_range if not one.safe)

    @property
    def scf(self) -> dict[str, dict[str, dict[str, float]]]:
        """The factors by class, load and place."""
        return {kind: factors_document(factors, "y") for kind, factors in self.factors.items()}


@dataclass(frozen=True)
class JointStresses:
    """Hot-spot stresses of a joint's welds.

    Attributes
    ----------
    plan : JointPlan
    welds : one for every brace
    """

    plan: JointPlan
    welds: tuple[HotSpot, ...]

    def stress(self, assembly: Assembly, forces: SectionForces) -> FloatArray:
        """Return stresses (n_braces, 2 sides, 8 points, n) [Pa] under section forces (n, n_elements, 2)."""
        return self.stress_under(self.nominal(assembly, forces))

    def nominal(self, assembly: Assembly, forces: SectionForces) -> FloatArray:
        """Return the braces' nominal stresses (n_braces, 3, n) [Pa]: axial, in-plane, out-of-plane bending.

        They are linear in the section forces, so that those of unit coordinates give rows for any motion.
        """
        own = brace_forces(assembly, self.plan, forces)
        return np.array([w.per_force[:, None] * np.array(f) for w, f in zip(self.welds, own, strict=True)])

    def stress_under(self, nominal: FloatArray, braces: Sequence[int] | None = None) -> FloatArray:
        """Return stresses (n_braces, 2 sides, 8 points, n) [Pa] under nominal ones (n_braces, 3, n).

        The axial force is shared between K, Y and X at every instant, and each share has its own factors.

        Parameters
        ----------
        braces : those whose stresses are returned; all of the joint's without it
        """
        of = range(len(self.welds)) if braces is None else braces
        parts = self.parts(nominal[:, 0], nominal[list(of)], of)
        return np.array([self.weld_stress(i, own) for i, own in zip(of, parts, strict=True)])

    def parts(self, axial: FloatArray, nominal: FloatArray, of: Sequence[int]) -> FloatArray:
        """Return K's, Y's and X's parts of the nominal stresses of some braces, (n, 9, n_cases).

        Parameters
        ----------
        axial : (n_braces, n_cases) axial stress of all braces
        nominal : (n, 3, n_cases) of those that are asked
        """
        area = np.array([weld.per_force[0] for weld in self.welds])
        shares = joint_shares(self.plan, axial / area[:, None], of).astype(nominal.dtype)
        return np.asarray((shares.swapaxes(0, 1)[:, :, None] * nominal[:, None]).reshape(len(of), 9, -1))

    def weld_stress(
        self, brace: int, parts: FloatArray, side: int | None = None, points: IntArray | None = None
    ) -> FloatArray:
        """Return stresses (2 sides, 8 points, n) [Pa] of a weld, or of points of a side (n_points, n).

        Parameters
        ----------
        parts : (9, n) of :meth:`parts`
        """
        by_part = self.welds[brace].matrices.transpose(1, 2, 0, 3).reshape(2, 8, 9)
        return np.asarray((by_part if side is None else by_part[side, points]).astype(parts.dtype) @ parts)


def joint_stresses(structure: Structure, plans: tuple[JointPlan, ...]) -> tuple[JointStresses, ...]:
    """Return the welds of planned joints, with the factors of each class.

    A chord is as long as the distance between the middles of the bays on its two sides. The K joint is that
    with the nearest brace in the same plane on the same side, a KT joint where there are two of them; a brace
    without one has a Y joint's factors.
    """
    return tuple(JointStresses(plan, _welds(structure, plan)) for plan in plans)


def _welds(structure: Structure, plan: JointPlan) -> tuple[HotSpot, ...]:
    length = 0.0
    for end in plan.chord:
        ends = (np.array(structure.nodes[node]) for node in (end.member.start, end.member.end))
        length += 0.5 * float(np.linalg.norm(np.subtract(*ends)))
    length *= 2.0 / len(plan.chord) if len(plan.chord) == 1 else 1.0
    return tuple(_weld(plan, i, length) for i in range(len(plan.braces)))


def _weld(plan: JointPlan, i: int, length: float) -> HotSpot:
    end, shape = plan.braces[i], plan.joints[i]
    braces = tuple(BraceTube(j.d, j.t, j.theta) for j in plan.joints)
    alone = TubularJoint(shape.D, shape.T, length, (braces[i],))
    beside, three = _nearest(plan, i), _three(plan, i)
    factors: dict[str, ConcentrationFactors] = {}
    outside: list[OutOfRange] = []
    for kind in _CLASSES:
        joint, by, mine = alone, kind, 0
        if kind == "k" and three is not None:
            order, gaps = three
            of = tuple(braces[j] for j in order)
            joint = TubularJoint(shape.D, shape.T, length, of, gaps_m=gaps)
            by, mine = "kt", order.index(i)
        elif kind == "k" and beside is not None:
            pair = (braces[i], braces[beside])
            joint = TubularJoint(shape.D, shape.T, length, pair, gap_m=float(shape.gap))
        elif kind == "k":
            by = "y"
        found, said = concentration(joint, by)
        factors[kind] = found[mine]
        outside += said
    D, d = shape.d, shape.d - 2.0 * shape.t
    area, modulus = 0.25 * np.pi * (D**2 - d**2), np.pi * (D**4 - d**4) / (32.0 * D)
    return HotSpot(
        plan.node,
        plan.chord[0].member.name,
        end.member.name,
        factors,
        np.array([hot_spot_matrix(factors[kind]) for kind in _CLASSES]),
        (shape.T, shape.t),
        np.array([1.0 / area, 1.0 / modulus, 1.0 / modulus]),
        tuple(dict.fromkeys(outside)),
    )


def _nearest(plan: JointPlan, i: int) -> int | None:
    """Return the brace beside one in its plane, None without one."""
    beside = np.flatnonzero((plan.across @ plan.across[i] > IN_PLANE) & (np.arange(len(plan.braces)) != i))
    if beside.size == 0 or not np.isfinite(plan.joints[i].gap):
        return None
    same = [j for j in beside if plan.joints[j].gap == plan.joints[i].gap]
    return int(same[0] if same else beside[0])


def _three(plan: JointPlan, i: int) -> tuple[tuple[int, int, int], tuple[float, float]] | None:
    """Return three braces in one plane in their order along the chord, and their gaps; None without them."""
    beside = np.flatnonzero(plan.across @ plan.across[i] > IN_PLANE)
    if beside.size != OF_KT:
        return None
    centre, half = plan.centre_m, plan.half_m
    a, b, c = (int(j) for j in beside[np.argsort(centre[beside], kind="stable")])
    first, second = (float(centre[q] - half[q] - centre[p] - half[p]) for p, q in ((a, b), (b, c)))
    return (a, b, c), (first, second)
