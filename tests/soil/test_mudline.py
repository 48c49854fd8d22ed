"""One matrix at the mudline: the closed form of feet on one rigid body, and what both halves of it are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.response import build_system, damped_modes, undamped_modes
from jackettwin.soil import (
    MUDLINE,
    Spring,
    Support,
    families,
    law_stiffness,
    moved_to_mudline,
    mudline_exponents,
    mudline_parameters,
    read_foundation,
    read_support,
    read_supported,
    sway_and_rocking,
    tied_at_mudline,
)
from jackettwin.soil.laws.viscoelastic import Prony
from jackettwin.structure import STEEL, Material, Member, PointMass, Reaction, Section, Structure, assemble

SQUARE = [(6.0, 6.0), (-6.0, 6.0), (-6.0, -6.0), (6.0, -6.0)]
K_H, K_V = 6e8, 4e9


def frame(corners: list[tuple[float, float]], height: float = 60.0) -> Structure:
    """Return legs from feet on a circle to one top node with a mass: no jacket of ours."""
    tube = Section(2.0, 0.05)
    feet = {f"f{i}": (x, y, -30.0) for i, (x, y) in enumerate(corners)}
    return Structure(
        "own",
        nodes={**feet, "top": (0.0, 0.0, height - 30.0)},
        members=tuple(Member(f"m{n}", n, "top", tube, tube, STEEL) for n in feet),
        masses=(PointMass("top", 5e5),),
        reactions=tuple(Reaction(n) for n in feet),
        subdivide=4,
    )


@pytest.mark.parametrize("n", [3, 4, 7])
def test_feet_on_a_circle_have_the_closed_form(n: int) -> None:
    """k_u = n k_h, k_θ = k_v Σ x² = n R² k_v/2, torsion n R² k_h, for any n ≥ 3 equal feet on a circle R."""
    R, turn = 9.0, 0.3
    angles = turn + 2.0 * np.pi * np.arange(n) / n
    structure = tied_at_mudline(frame([(R * np.cos(a), R * np.sin(a)) for a in angles]))
    foot = np.diag([K_H, K_H, K_V, 0.0, 0.0, 0.0])
    followers = [link.follower for link in structure.rigid_links]
    moved = moved_to_mudline(structure, Support(tuple(Spring(f, foot) for f in followers)))
    total = np.sum([spring.matrix for spring in moved.springs], axis=0)
    rocking = 0.5 * n * R**2 * K_V
    closed = np.diag([n * K_H, n * K_H, n * K_V, rocking, rocking, n * R**2 * K_H])
    np.testing.assert_allclose(total, closed, atol=1e-12 * rocking)
    assert {spring.node for spring in moved.springs} == {MUDLINE}


def test_the_tied_structure_moves_as_on_its_feet() -> None:
    """Springs at the feet and their sum at the mudline are one model, to rounding; so is its mass."""
    tied = tied_at_mudline(frame(SQUARE))
    foot = np.diag([K_H, K_H, K_V, 1e9, 1e9, 1e8])
    foot[0, 4] = foot[4, 0] = -2e8  # a pile's coupling of sway and rotation
    foot[1, 3] = foot[3, 1] = 2e8
    body = 1e4 * np.diag([1.0, 1.0, 1.0, 2.0, 2.0, 3.0])
    feet = [link.follower for link in tied.rigid_links]
    at_feet = Support(tuple(Spring(f, foot) for f in feet), masses=tuple((f, body) for f in feet))
    moved = moved_to_mudline(tied, at_feet)
    # the same feet joined by very stiff spokes without mass: an independent model of the tie
    loose, tube = frame(SQUARE), Section(2.0, 0.05)
    rigid = Material(youngs_modulus_pa=1e6 * STEEL.youngs_modulus_pa, density_kg_m3=0.0)
    spokes = tuple(Member(f"s{n}", "hub", n, tube, tube, rigid) for n in feet)
    joined = replace(
        loose, nodes={**loose.nodes, "hub": (0.0, 0.0, -30.0)}, members=(*loose.members, *spokes)
    )
    exact = undamped_modes(build_system(assemble(joined), at_feet), 5).frequency_hz
    ours = undamped_modes(build_system(assemble(tied), moved), 5).frequency_hz
    np.testing.assert_allclose(ours, exact, rtol=1e-4)  # the spokes are a million times as stiff as the legs


def test_both_halves_add_up_and_store_energy(rng: np.random.Generator) -> None:
    A = rng.normal(size=(6, 6))
    K = A @ A.T + 0j
    sway, rocking = sway_and_rocking(K)
    np.testing.assert_allclose(sway + rocking, K, atol=1e-12 * np.abs(K).max())
    for part, rank in ((sway, 3), (rocking, 3)):
        values = np.linalg.eigvalsh(part.real)
        assert (values > -1e-10).all() and (values > 1e-10).sum() == rank
    # moments over rotations where the translations are free: the flexibility's inverse
    np.testing.assert_allclose(rocking[3:, 3:], np.linalg.inv(np.linalg.inv(K)[3:, 3:]), rtol=1e-9)


@pytest.mark.parametrize("name", sorted(families()))
def test_rocking_is_sway_times_the_ratio_at_every_frequency(name: str) -> None:
    law = families()[name]
    parameters = mudline_parameters(law)
    theta = np.array([np.sqrt(p.low * p.high) for p in parameters])
    assert [p.name for p in parameters][:2] == [law.names[0] + "_u", law.names[0] + "_theta"]
    both = np.exp(mudline_exponents(law) @ np.log(theta)).reshape(2, -1)
    rows, _ = law.rows(both, 0.2)
    s = 1j * np.array([0.3, 2.0, 40.0])
    sway, rocking = law_stiffness(rows[:, None], s)
    np.testing.assert_allclose(rocking / sway, theta[1] / theta[0], rtol=1e-12)


def test_a_pile_under_every_leg_is_summed_about_the_mudline() -> None:
    tied = tied_at_mudline(read_structure("jacket15"))
    heads = read_support("jacket15_records", tied)
    assert len({spring.node for spring in heads.springs}) == 4
    moved = moved_to_mudline(tied, heads)
    one = read_foundation("jacket15_records").heads(read_structure("jacket15"))
    static = sum(s.law.static_stiffness * s.matrix for s in moved.springs)
    each = sum(s.law.static_stiffness * s.matrix for s in one.springs)
    np.testing.assert_allclose(static[:3, :3], each[:3, :3], rtol=1e-12, atol=1e-3)  # Σ of the legs
    assert static[3, 3] > 10.0 * each[3, 3]  # the legs' arms


def test_a_short_form_ties_the_feet_and_damps_them() -> None:
    tied, support = read_supported("mudline:k_u=1e9,k_theta=5e11,c=2e8", frame(SQUARE))
    assert tied.reaction_nodes == (MUDLINE,) and tied.nodes[MUDLINE] == (0.0, 0.0, -30.0)
    assert support.fixed == ((MUDLINE, (2, 5)),)
    sway, rocking = support.springs
    assert sway.law == Prony(k0=1e9, c=2e8) and rocking.law.k0 == pytest.approx(5e11)
    assert rocking.law.c == pytest.approx(2e8 * 500.0)
    found = damped_modes(build_system(assemble(tied), support), below_hz=3.0)
    assert (found.damping_ratio > 0.0).all()
    # without a dashpot nothing is lost
    _, elastic = read_supported("mudline:k_u=1e9,k_theta=5e11,c=0", frame(SQUARE))
    free = damped_modes(build_system(assemble(tied), elastic), below_hz=3.0)
    np.testing.assert_allclose(free.damping_ratio, 0.0, atol=1e-9)
    assert found.frequency_hz[0] > free.frequency_hz[0]


def test_on_stiff_ground_it_is_the_structure_with_clamped_feet() -> None:
    structure = frame(SQUARE)
    tied, support = read_supported("mudline:k_u=1e16,k_theta=1e18,c=0", structure)
    exact = undamped_modes(build_system(assemble(structure), read_support("clamped", structure)), 4)
    ours = undamped_modes(build_system(assemble(tied), support), 4)
    # 1e16 N/m is five orders above the legs'
    np.testing.assert_allclose(ours.frequency_hz, exact.frequency_hz, rtol=1e-5)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("mudline:k_u=1e9,c=1", "argument is missing"),
        ("mudline:k_u=-1e9,k_theta=1,c=1", "k_u"),
        ("mudline:k_u=nan,k_theta=1,c=1", "not a finite number"),
        ("mudline:rubber:k_u=1,k_theta=1", "law"),
        ("mudline:zener:k_u=1e9,k_theta=1e11,c=1,k1=1", "unknown argument"),
        ("mudlin:k_u=1,k_theta=1,c=1", "mudline"),
    ],
)
def test_wrong_input_is_named(text: str, match: str) -> None:
    with pytest.raises(InputError, match=match):
        read_supported(text, frame(SQUARE))


def test_what_cannot_be_tied_is_refused() -> None:
    with pytest.raises(InputError, match="not tied to one node"):
        read_support("mudline:k_u=1e9,k_theta=1e11,c=1", frame(SQUARE))
    free = frame(SQUARE)
    taken = Structure(
        "taken",
        nodes={**free.nodes, MUDLINE: (0.0, 0.0, -30.0)},
        members=(*free.members, Member("x", MUDLINE, "top", *[Section(2.0, 0.05)] * 2, STEEL)),
        reactions=free.reactions,
    )
    with pytest.raises(InputError, match="name that is taken"):
        tied_at_mudline(taken)
    with pytest.raises(InputError, match="no feet to tie"):
        tied_at_mudline(Structure("bare", free.nodes, free.members))
