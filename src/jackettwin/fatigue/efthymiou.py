r"""Stress concentration at tubular joints by Efthymiou's equations.

Hot-spot stress over nominal stress of the brace, at the crown and the saddle of chord and brace, as in
appendix B of DNV-RP-C203 (tables B-1 to B-4; Efthymiou 1988, OTH'88). With chord D, T, L, brace d, t, angle θ
and gap g: β = d/D, γ = D/2T, τ = t/T, α = 2L/D, ζ = g/D. Joints beyond the tested ranges get the larger of
the factors at their own and at the limiting shape, as the recommended practice asks.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, exp, pi, radians, sin, sqrt
from pathlib import Path
from typing import Literal, NamedTuple, get_args

from pydantic import Field

from jackettwin.errors import InputError, located, require, require_between
from jackettwin.files import Schema, read_mapping, validate

JointClass = Literal["y", "x", "k", "kt"]
CLASSES: tuple[JointClass, ...] = get_args(JointClass)
RANGES = {
    "β": (0.2, 1.0),
    "τ": (0.2, 1.0),
    "γ": (8.0, 32.0),
    "α": (4.0, 40.0),
    "θ": (radians(20.0), 0.5 * pi),
}
"""Ranges of validity; and −0.6 β/sin θ ≤ ζ ≤ 1."""
_NAMES = ("β", "γ", "τ", "α", "θ")
"""Of the ratios of :class:`_Shape`, in their order."""
_SHORT = 12.0
"""Chords with a smaller α are short: their ends stiffen the saddle."""
_LARGER = "the larger of the factors there and at the limit is taken"
OF_KT = 3
"""Braces of a KT joint."""
_FIXED = 0.5
"""Chord-end fixity C of a chord whose ends are clamped."""


@dataclass(frozen=True)
class OutOfRange:
    """A ratio outside its range, as a sentence.

    ``safe`` if the factors are then larger than the joint's own: those at crossings do not depend on the
    chord's length, others rise with it, so that a longer chord than any tested is on the safe side.
    """

    text: str
    safe: bool


@dataclass(frozen=True)
class BraceTube:
    """A brace: outer diameter and wall [m], angle to the chord [rad]; above 90° it is mirrored."""

    diameter_m: float
    thickness_m: float
    angle_rad: float

    def __post_init__(self) -> None:
        _require_tube(self.diameter_m, self.thickness_m, "")
        require(
            0.0 < self.angle_rad < pi,
            "a brace stands on its chord at an angle",
            field="angle_deg",
            value=round(self.angle_rad * 180.0 / pi, 6),
            allowed="between 0 and 180",
        )


@dataclass(frozen=True)
class TubularJoint:
    """Braces in one plane on a chord [m].

    Attributes
    ----------
    fixity : float
        C of the chord's ends, 0.5 (fixed) to 1 (pinned).
    gap_m : float or None
        Between the two braces of a K joint along the chord, negative where they overlap.
    gaps_m : (2,) or None
        Of a KT joint, before and behind the second of its three braces.
    """

    chord_diameter_m: float
    chord_thickness_m: float
    chord_length_m: float
    braces: tuple[BraceTube, ...]
    fixity: float = 0.7
    gap_m: float | None = None
    gaps_m: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        _require_tube(self.chord_diameter_m, self.chord_thickness_m, "chord_")
        require_between("chord_length_m", self.chord_length_m, 1e-3, 1e4)
        require_between("fixity", self.fixity, 0.5, 1.0)


class ConcentrationFactors(NamedTuple):
    """Stress concentration factors of one brace, each on the brace's nominal stress."""

    axial_chord_saddle: float
    axial_chord_crown: float
    axial_brace_saddle: float
    axial_brace_crown: float
    in_plane_chord: float
    in_plane_brace: float
    out_of_plane_chord: float
    out_of_plane_brace: float


class _Shape(NamedTuple):
    """Ratios of one brace's joint."""

    beta: float
    gamma: float
    tau: float
    alpha: float
    theta: float


def concentration(
    joint: TubularJoint, kind: JointClass
) -> tuple[tuple[ConcentrationFactors, ...], tuple[OutOfRange, ...]]:
    """Return the factors of every brace, and each ratio outside its range.

    Raises
    ------
    InputError
        If a K joint has not two braces and a gap, a KT joint not three and two, or the class is unknown.
    """
    if kind not in CLASSES:
        raise InputError("no such class of joint", field="class", value=kind, allowed=", ".join(CLASSES))
    if kind == "k":
        require(
            len(joint.braces) == 2 and joint.gap_m is not None,
            "a K joint has two braces and a gap",
            field="gap_m" if joint.gap_m is None else "braces",
            value=len(joint.braces),
            allowed="2 braces, and gap_m (negative: overlap)",
        )
    if kind == "kt":
        require(
            len(joint.braces) == OF_KT and joint.gaps_m is not None,
            "a KT joint has three braces and two gaps",
            field="gaps_m" if joint.gaps_m is None else "braces",
            value=len(joint.braces),
            allowed="3 braces along the chord, and gaps_m between them (negative: overlap)",
        )
    shapes = tuple(_shape(joint, brace) for brace in joint.braces)
    gaps = {"k": (joint.gap_m,), "kt": joint.gaps_m or ()}.get(kind, ())
    zetas = tuple((gap or 0.0) / joint.chord_diameter_m for gap in gaps)
    limited = tuple(_limited(shape) for shape in shapes)
    # of the narrower brace: the gap's range is its own
    deepest = max(-0.6 * s.beta / sin(s.theta) for s in limited)
    near = tuple(min(max(zeta, deepest), 1.0) for zeta in zetas)
    outside = _out_of_range(shapes, zetas, deepest)
    own = _factors(shapes, kind, joint.fixity, zetas)
    if not outside:
        return own, ()
    at_limit = _factors(limited, kind, joint.fixity, near)
    larger = tuple(
        ConcentrationFactors(*(max(a, b) for a, b in zip(x, y, strict=True)))
        for x, y in zip(own, at_limit, strict=True)
    )
    return larger, outside


def _shape(joint: TubularJoint, brace: BraceTube) -> _Shape:
    D, T = joint.chord_diameter_m, joint.chord_thickness_m
    sharp = brace.angle_rad if brace.angle_rad <= 0.5 * pi else pi - brace.angle_rad
    return _Shape(
        brace.diameter_m / D, 0.5 * D / T, brace.thickness_m / T, 2.0 * joint.chord_length_m / D, sharp
    )


def _limited(shape: _Shape) -> _Shape:
    values = zip(shape, _NAMES, strict=True)
    return _Shape(*(min(max(value, RANGES[name][0]), RANGES[name][1]) for value, name in values))


def _out_of_range(
    shapes: tuple[_Shape, ...], zetas: tuple[float, ...], deepest: float
) -> tuple[OutOfRange, ...]:
    found = []
    for i, shape in enumerate(shapes, start=1):
        for value, name in zip(shape, _NAMES, strict=True):
            low, high = RANGES[name]
            if not low * (1.0 - 1e-9) <= value <= high * (1.0 + 1e-9):
                scale, unit = (180.0 / pi, "°") if name == "θ" else (1.0, "")
                said = (
                    f"brace {i}: {name} = {scale * value:.3g}{unit} is not {scale * low:g} to "
                    f"{scale * high:g}{unit}: {_LARGER}"
                )
                found.append(OutOfRange(said, safe=name == "α" and value > high))
    for zeta in zetas:
        if not deepest - 1e-9 <= zeta <= 1.0 + 1e-9:
            found.append(OutOfRange(f"ζ = {zeta:.3g} is not {deepest:.2g} to 1: {_LARGER}", safe=False))
    return tuple(found)


def _factors(
    shapes: tuple[_Shape, ...], kind: JointClass, fixity: float, zetas: tuple[float, ...]
) -> tuple[ConcentrationFactors, ...]:
    if kind in ("k", "kt"):
        return tuple(_k(shapes, i, zetas) for i in range(len(shapes)))
    return tuple(_y(s, fixity) if kind == "y" else _x(s, fixity) for s in shapes)


def _y(s: _Shape, C: float) -> ConcentrationFactors:
    """Return table B-1, general fixity of the chord's ends."""
    beta, gamma, tau, alpha, theta = s
    C1, C2, C3 = 2.0 * (C - 0.5), 0.5 * C, 0.2 * C
    saddle = gamma * tau**1.1 * (1.11 - 3.0 * (beta - 0.52) ** 2) * sin(theta) ** 1.6
    saddle += C1 * (0.8 * alpha - 6.0) * tau * beta**2 * sqrt(max(1.0 - beta**2, 0.0)) * sin(2.0 * theta) ** 2
    crown = gamma**0.2 * tau * (2.65 + 5.0 * (beta - 0.65) ** 2)
    crown += tau * beta * (C2 * alpha - 3.0) * sin(theta)
    brace_saddle = 1.3 + gamma * tau**0.52 * alpha**0.1 * (0.187 - 1.25 * beta**1.1 * (beta - 0.96)) * sin(
        theta
    ) ** (2.7 - 0.01 * alpha)
    brace_crown = 3.0 + gamma**1.2 * (0.12 * exp(-4.0 * beta) + 0.011 * beta**2 - 0.045)
    brace_crown += beta * tau * (C3 * alpha - 1.2)
    F = _axial_short(s, C)
    out = _out_of_plane(s) * _F3(s)
    return ConcentrationFactors(
        F * saddle, crown, F * brace_saddle, brace_crown, *_in_plane(s), out, _brace_side(s) * out
    )


def _x(s: _Shape, C: float) -> ConcentrationFactors:
    """Return table B-2, balanced."""
    beta, gamma, tau, _, theta = s
    saddle = 3.87 * gamma * tau * beta * (1.10 - beta**1.8) * sin(theta) ** 1.7
    crown = gamma**0.2 * tau * (2.65 + 5.0 * (beta - 0.65) ** 2) - 3.0 * tau * beta * sin(theta)
    brace_saddle = 1.0 + 1.9 * gamma * tau**0.5 * beta**0.9 * (1.09 - beta**1.7) * sin(theta) ** 2.5
    brace_crown = 3.0 + gamma**1.2 * (0.12 * exp(-4.0 * beta) + 0.011 * beta**2 - 0.045)
    F = _axial_short(s, C)
    out = gamma * tau * beta * (1.56 - 1.34 * beta**4) * sin(theta) ** 1.6 * _F3(s)
    return ConcentrationFactors(
        F * saddle, crown, F * brace_saddle, brace_crown, *_in_plane(s), out, _brace_side(s) * out
    )


def _k(shapes: tuple[_Shape, ...], i: int, zetas: tuple[float, ...]) -> ConcentrationFactors:
    """Return table B-3 or B-4 of one of two or three braces: balanced axial force, unbalanced moments aside.

    Outer braces of a KT joint balance each other across the middle one, which balances with the farther.
    """
    own, middle = shapes[i], len(zetas) == 2 and i == 1
    to = {j: _between(shapes, zetas, i, j) for j in range(len(shapes)) if j != i}
    chord, brace = _balanced(own, shapes, max(to.values()))
    widest, out = max(s.beta for s in shapes), _out_of_plane(own)
    for j, zeta in to.items():
        x = 1.0 + zeta * sin(own.theta) / own.beta
        power = (shapes[j].beta / own.beta) ** 2 if middle else 1.0
        out *= (1.0 - 0.08 * sqrt(shapes[j].beta * own.gamma) * exp(-0.8 * x)) ** power
    for j, zeta in to.items():
        x = 1.0 + zeta * sin(own.theta) / own.beta
        carried = (1.0 - 0.08 * sqrt(own.beta * own.gamma) * exp(-0.8 * x)) * 2.05 * sqrt(widest)
        out += _out_of_plane(shapes[j]) * carried * exp(-1.3 * x)
    out *= _F4(own)
    return ConcentrationFactors(chord, chord, brace, brace, *_in_plane(own), out, _brace_side(own) * out)


def _between(shapes: tuple[_Shape, ...], zetas: tuple[float, ...], i: int, j: int) -> float:
    """Return ζ between two braces; across the middle one it is both gaps and β of that one."""
    if abs(i - j) > 1:
        return sum(zetas) + shapes[1].beta
    return zetas[min(i, j)]


def _balanced(s: _Shape, shapes: tuple[_Shape, ...], zeta: float) -> tuple[float, float]:
    """Return the factors of chord and brace under axial forces that balance, equations (20) and (21)."""
    beta, gamma, tau, _, theta = s
    sines, widths = ([f(one) for one in shapes] for f in (lambda o: sin(o.theta), lambda o: o.beta))
    chord = tau**0.9 * gamma**0.5 * (0.67 - beta**2 + 1.16 * beta) * sin(theta)
    chord *= (max(sines) / min(sines)) ** 0.30 * (max(widths) / min(widths)) ** 0.30
    chord *= 1.64 + 0.29 * beta**-0.38 * atan(8.0 * zeta)
    brace = 1.0 + chord * (1.97 - 1.57 * beta**0.25) * tau**-0.14 * sin(theta) ** 0.7
    angles = max(one.theta for one in shapes) + min(one.theta for one in shapes)
    if zeta < 0.0 and sin(angles) > 0.0:
        # the through brace's factor for all: which of them lies above is not said
        lap = beta**1.5 * gamma**0.5 * tau**-1.22 * sin(angles) ** 1.8
        brace += lap * (0.131 - 0.084 * atan(14.0 * zeta + 4.2 * beta))
    return chord, brace


def _in_plane(s: _Shape) -> tuple[float, float]:
    """Return the factors of chord and brace under in-plane bending, equations (8) and (9)."""
    beta, gamma, tau, _, theta = s
    chord = 1.45 * beta * tau**0.85 * gamma ** (1.0 - 0.68 * beta) * sin(theta) ** 0.7
    brace = 1.0 + 0.65 * beta * tau**0.4 * gamma ** (1.09 - 0.77 * beta) * sin(theta) ** (0.06 * gamma - 1.16)
    return chord, brace


def _out_of_plane(s: _Shape) -> float:
    """Return equation (10): a Y joint's chord saddle under out-of-plane bending."""
    beta, gamma, tau, _, theta = s
    return float(gamma * tau * beta * (1.7 - 1.05 * beta**3) * sin(theta) ** 1.6)


def _brace_side(s: _Shape) -> float:
    """Return equation (11) over (10): brace over chord under out-of-plane bending."""
    return float(s.tau**-0.54 * s.gamma**-0.05 * (0.99 - 0.47 * s.beta + 0.08 * s.beta**4))


def _axial_short(s: _Shape, C: float) -> float:
    """Return F1 (fixed ends) or F2 of table B-1 where the chord is short, else 1."""
    if s.alpha >= _SHORT:
        return 1.0
    beta, gamma, alpha = s.beta, s.gamma, s.alpha
    if C <= _FIXED:
        depth = (0.83 * beta - 0.56 * beta**2 - 0.02) * gamma**0.23
        return float(1.0 - depth * exp(-0.21 * gamma**-1.16 * alpha**2.5))
    depth = (1.43 * beta - 0.97 * beta**2 - 0.03) * gamma**0.04
    return float(1.0 - depth * exp(-0.71 * gamma**-1.38 * alpha**2.5))


def _F3(s: _Shape) -> float:
    if s.alpha >= _SHORT:
        return 1.0
    return float(1.0 - 0.55 * s.beta**1.8 * s.gamma**0.16 * exp(-0.49 * s.gamma**-0.89 * s.alpha**1.8))


def _F4(s: _Shape) -> float:
    if s.alpha >= _SHORT:
        return 1.0
    return float(1.0 - 1.07 * s.beta**1.88 * exp(-0.16 * s.gamma**-1.06 * s.alpha**2.4))


def _require_tube(diameter: float, thickness: float, name: str) -> None:
    require_between(f"{name}diameter_m", diameter, 1e-3, 100.0)
    require(
        0.0 < thickness < 0.5 * diameter,
        "a wall is thinner than the radius",
        field=f"{name}thickness_m",
        value=thickness,
        allowed=f"0 to {0.5 * diameter:g}",
    )


class _BraceSchema(Schema):
    diameter_m: float
    thickness_m: float
    angle_deg: float


class _JointSchema(Schema):
    class_: JointClass = Field(alias="class")
    chord_diameter_m: float
    chord_thickness_m: float
    chord_length_m: float
    fixity: float = 0.7
    braces: list[_BraceSchema] = Field(min_length=1)
    gap_m: float | None = None
    gaps_m: tuple[float, float] | None = None


def read_joint(path: Path) -> tuple[JointClass, TubularJoint]:
    """Return the class and the shape of a joint from a YAML or JSON file.

    Raises
    ------
    InputError
        Names the file, the field and what is allowed.
    """
    said = validate(_JointSchema, read_mapping(path), file=path)
    with located(file=path):
        braces = []
        for i, one in enumerate(said.braces):
            with located(field=f"braces.{i}"):
                require_between("diameter_m", one.diameter_m, 0.0, said.chord_diameter_m)
                braces.append(BraceTube(one.diameter_m, one.thickness_m, radians(one.angle_deg)))
        D, T, L = said.chord_diameter_m, said.chord_thickness_m, said.chord_length_m
        return said.class_, TubularJoint(D, T, L, tuple(braces), said.fixity, said.gap_m, said.gaps_m)


def factors_document(f: ConcentrationFactors, kind: JointClass) -> dict[str, dict[str, float]]:
    """Return the factors of a brace by load and place; of a K or KT joint, saddles and crowns have one."""
    if kind in ("k", "kt"):
        axial = {"chord": f.axial_chord_crown, "brace": f.axial_brace_crown}
        out = {"chord": f.out_of_plane_chord, "brace": f.out_of_plane_brace}
    else:
        axial = {
            "chord_saddle": f.axial_chord_saddle,
            "chord_crown": f.axial_chord_crown,
            "brace_saddle": f.axial_brace_saddle,
            "brace_crown": f.axial_brace_crown,
        }
        out = {"chord_saddle": f.out_of_plane_chord, "brace_saddle": f.out_of_plane_brace}
    return {
        "axial": axial,
        "in_plane": {"chord_crown": f.in_plane_chord, "brace_crown": f.in_plane_brace},
        "out_of_plane": out,
    }
