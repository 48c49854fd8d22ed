"""Piles in soil: closed-form heads, scour, non-linear equilibrium, and jacket15 on its piles."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError, NumericalError
from jackettwin.response.modes.modal import damped_modes
from jackettwin.response.system import build_system
from jackettwin.soil.foundation import read_foundation
from jackettwin.soil.ground.profile import Clay, Layer, Sand, Scour, SoilProfile
from jackettwin.soil.laws.viscoelastic import Springpot
from jackettwin.soil.piles.capacity import push
from jackettwin.soil.piles.impedance import head_impedance, lumped_head, on_pile_heads
from jackettwin.soil.piles.piles import Pile, dashpots, linear_springs, stations
from jackettwin.soil.piles.reaction_curves import linearised, pile_curves
from jackettwin.structure import assemble
from jackettwin.structure.masses import body_from_static_moments
from jackettwin.structure.sections import tube_properties

PILE = Pile(60.0, 2.0, 0.05)
EI = 2.1e11 * float(tube_properties(np.array(2.0), np.array(0.05)).I)
BENDING = np.ix_([0, 4], [0, 4])


def test_head_in_constant_subgrade() -> None:
    """Hetényi's semi-infinite beam: K_hh = 4EIλ³, K_hr = 2EIλ², K_rr = 2EIλ; tests/data/soil."""
    cases = json.loads((Path(__file__).parents[1] / "data/soil/soil_values.json").read_text("utf-8"))["cases"]
    case = next(c for c in cases if c["id"] == "PILEHEAD_CONST_K")
    k = case["inputs"]["k_Pa"]
    springs = linear_springs(PILE, lateral=lambda z: k + 0.0 * z, axial=lambda z: 1e8 + 0.0 * z)
    K = head_impedance(PILE, springs, 0.0)[0].real
    exact = case["closed_form_semi_infinite"]
    # 0.1 % is the bar; Simpson's rule at half a diameter leaves 5e-5
    np.testing.assert_allclose(
        [K[0, 0], abs(K[0, 4]), K[4, 4]], [exact["K_hh"], exact["K_hr"], exact["K_rr"]], rtol=1e-4
    )
    np.testing.assert_allclose(K[BENDING], K[np.ix_([1, 3], [1, 3])] * [[1, -1], [-1, 1]], rtol=1e-9)


def test_axial_head_in_constant_friction() -> None:
    """K = EA μ tanh(μL), μ² = k_v/EA, for a free tip."""
    EA = 2.1e11 * float(tube_properties(np.array(2.0), np.array(0.05)).A)
    mu = np.sqrt(1.6e8 / EA)
    springs = linear_springs(PILE, lateral=lambda z: 1e7 * z, axial=lambda z: 1.6e8 + 0.0 * z)
    K = head_impedance(PILE, springs, 0.0)[0].real
    assert K[2, 2] == pytest.approx(EA * mu * np.tanh(mu * 60.0), rel=2e-4)  # half a diameter an element


@pytest.mark.parametrize("n_h", [5e6, 1e7, 4e7])
def test_head_in_linear_subgrade(n_h: float) -> None:
    """Free-head flexibilities 2.4292 T³/EI, 1.6194 T²/EI, 1.7468 T/EI, T = (EI/n_h)^⅕ (L > 5T)."""
    springs = linear_springs(PILE, lateral=lambda z: n_h * z, axial=lambda z: 1e8 + 0.0 * z)
    F = np.linalg.inv(head_impedance(PILE, springs, 0.0)[0].real[BENDING])
    T = (EI / n_h) ** 0.2
    exact = np.array([2.4292 * T**3, 1.6194 * T**2, 1.7468 * T]) / EI
    np.testing.assert_allclose([F[0, 0], abs(F[0, 1]), F[1, 1]], exact, rtol=1e-3)


def test_simpson_springs_converge_with_the_fourth_power() -> None:
    flexibility = []
    for spacing in (2.0, 1.0, 0.5, 0.1):
        pile = replace(PILE, element_m=spacing)
        springs = linear_springs(pile, lateral=lambda z: 1e7 * z, axial=lambda z: 1e8 + 0.0 * z)
        flexibility.append(np.linalg.inv(head_impedance(pile, springs, 0.0)[0].real[BENDING])[0, 0])
    error = np.abs(np.array(flexibility[:3]) / flexibility[3] - 1.0)
    assert (error[:-1] / error[1:] > 12.0).all()  # 16 in the limit


def test_stations_share_out_every_layer() -> None:
    at = stations(PILE, (7.3, 21.0, 80.0))
    assert at.weight.sum() == pytest.approx(60.0)
    np.testing.assert_allclose(np.bincount(at.layer, at.weight), [7.3, 13.7, 39.0])
    np.testing.assert_array_equal(at.node_depth[at.node], at.depth)


@pytest.mark.parametrize("law", [dashpots(0.02, 1.15), Springpot.from_loss_factor(1.0, 0.1, 1.15)])
def test_the_lumped_head_follows_the_exact_one(law) -> None:
    """So do the springs and the mass that a foot is given, which radiate, too."""
    springs = linear_springs(PILE, lateral=lambda z: 1e7 * z, axial=lambda z: 1e8 + 0.0 * z)
    lost = linear_springs(PILE, lateral=lambda z: 2e5 + 0.0 * z, axial=lambda z: 1e5 + 0.0 * z)
    support = on_pile_heads(read_structure("jacket15"), lumped_head(PILE, springs, law=law, dashpots=lost))
    foot, mass = support.masses[0]
    s = 2j * np.pi * np.array([0.1, 0.3, 1.0])[:, None, None]
    lumped = s**2 * mass + sum(
        one.law.stiffness(s) * one.matrix for one in support.springs if one.node == foot
    )
    exact = head_impedance(PILE, springs, s.ravel(), law=law, dashpots=lost)
    error = np.abs(lumped - exact).max(axis=(1, 2)) / np.abs(exact).max(axis=(1, 2))
    assert (error < [1e-3, 1e-3, 5e-3]).all()  # second order in D − 1 and in ω²
    dissipated = np.linalg.eigvalsh(exact.imag)
    assert (dissipated > -1e-6 * np.abs(exact).max()).all()


def test_loss_of_the_head_is_that_of_the_soil_times_its_share_of_the_energy() -> None:
    """Rayleigh's principle: Im K*(iω) → η·(soil part of K) for a small loss factor η."""
    springs = linear_springs(PILE, lateral=lambda z: 1e7 * z, axial=lambda z: 1e8 + 0.0 * z)
    law = dashpots(0.02, 1.0)
    K = head_impedance(PILE, springs, 0.01j, law=law)[0]
    soil = lumped_head(PILE, springs).soil
    np.testing.assert_allclose(K.imag[BENDING], 0.01 * 0.04 * soil[BENDING], rtol=1e-5)


def test_scour_softens_the_head_and_local_scour_less_than_general() -> None:
    def stiffness(scour: Scour) -> float:
        curves = pile_curves(PILE, SoilProfile((Layer(60.0, 10e3, Sand(35.0)),), scour))
        return float(head_impedance(PILE, linearised(curves), 0.0)[0, 0, 0].real)

    intact, local, general = (stiffness(s) for s in (Scour(), Scour(local_m=3.0), Scour(general_m=3.0)))
    assert general < 0.7 * intact
    # the initial stiffness k z of sand knows depth only, not overburden
    assert local == pytest.approx(general, rel=1e-6)
    capacity = [
        pile_curves(PILE, SoilProfile((Layer(60.0, 10e3, Sand(35.0)),), s)).py[12].force(1.0)
        for s in (Scour(local_m=3.0), Scour(general_m=3.0))
    ]
    # what lies about a local hole still weighs on the ground below it
    assert capacity[0] > capacity[1]


def test_scour_is_a_shorter_pile_with_a_stick_up() -> None:
    """General scour in uniform sand: the ground below does not know how much was above it."""
    S = 2.0
    sand = Layer(60.0, 10e3, Sand(35.0))
    scoured = pile_curves(PILE, SoilProfile((sand,), Scour(general_m=S)))
    fresh = pile_curves(replace(PILE, length_m=58.0), SoilProfile((sand,)))
    y = 0.02
    below = scoured.at.depth >= S
    below[np.flatnonzero(below)[0]] = False  # the upper side of the cut
    np.testing.assert_allclose(
        [float(c.force(y)) for c, b in zip(scoured.py, below, strict=True) if b],
        [float(c.force(y)) for c in fresh.py],
        rtol=1e-9,
        atol=1e-6,
    )
    with pytest.raises(InputError, match="tip"):
        pile_curves(PILE, SoilProfile((sand,), Scour(general_m=60.0)))


def test_layers_meet_at_a_node_with_both_soils() -> None:
    profile = SoilProfile((Layer(10.0, 8e3, clay=Clay((20e3, 60e3))), Layer(50.0, 10e3, Sand(35.0))))
    curves = pile_curves(PILE, profile)
    pair = np.flatnonzero(curves.at.depth == 10.0)
    assert [type(curves.py[i]).__name__ for i in pair] == ["TabulatedCurve", "Tanh"]
    assert profile.effective_stress(np.array([10.0, 20.0])).tolist() == [80e3, 180e3]


def test_a_pushed_pile_is_in_equilibrium_and_its_secant_springs_agree() -> None:
    profile = SoilProfile((Layer(60.0, 8e3, clay=Clay((20e3, 150e3))),))
    curves = pile_curves(PILE, profile)
    load = np.array([1.2e6, 0.5e6, -4e6, 0.0, 0.0, 0.0])
    pushed = push(PILE, curves, load)
    head = head_impedance(PILE, pushed.secant(curves), 0.0)[0].real @ pushed.displacement[0]
    np.testing.assert_allclose(head, load, atol=1e-5 * np.abs(load).max())
    small = push(PILE, curves, load * 1e-4).displacement[0]
    np.testing.assert_allclose(
        head_impedance(PILE, linearised(curves), 0.0)[0].real @ small, load * 1e-4, atol=1e-2 * load[0] * 1e-4
    )
    assert np.abs(pushed.displacement[0, 0]) > 1.3e4 * np.abs(small[0])  # softer under load
    with pytest.raises(NumericalError, match="capacity"):
        push(PILE, curves, np.array([0.0, 0.0, -4e8, 0.0, 0.0, 0.0]))


def test_the_pile_asset_of_the_openfast_records() -> None:
    """Records README: soil's share of ζ without wind 0.016 % and 0.33/0.40 %, frequencies of the JSON.

    OpenFAST's tower has two shapes a direction and its nacelle no roll inertia: the README grants 0.5 % on
    f1–f2 and 1–3.5 % on the second pair.
    """
    meta = json.loads(
        (Path(__file__).parents[1] / "records/data/pile_U12_s301.json").read_text(encoding="utf-8")
    )
    given = meta["rna_about_tower_top"]
    rna = body_from_static_moments(
        node="tower_top",
        mass_kg=given["mass_kg"],
        static_moment_kg_m=(given["static_moment_x_kg_m"], 0.0, given["static_moment_z_kg_m"]),
        inertia_about_node_kg_m2=(
            given["ixx_kg_m2"],
            given["iyy_kg_m2"],
            given["izz_kg_m2"],
            0.0,
            0.0,
            0.0,
        ),
    )
    foundation = read_foundation("jacket15_records")
    structure = read_structure("jacket15").with_masses((rna,))
    piled, support = foundation.piled(structure)
    modes = damped_modes(build_system(assemble(piled, gravity=True), support), below_hz=0.8)
    truth = {mode["label"]: mode["frequency_hz"] for mode in meta["true_modes"]}
    wanted = [truth[k] for k in ("side_side_1", "fore_aft_1", "torsion_1", "side_side_2", "fore_aft_2")]
    np.testing.assert_allclose(modes.frequency_hz[:2], wanted[:2], rtol=0.0055)
    np.testing.assert_allclose(modes.frequency_hz[2:5], wanted[2:], rtol=0.01)
    np.testing.assert_allclose(modes.damping_ratio[:2], 0.00016, rtol=0.1)  # printed to two digits
    np.testing.assert_allclose(modes.damping_ratio[3:5], [0.0033, 0.0040], rtol=0.15)
    # lumped at the heads it is the same system
    lumped, support = foundation.lumped(structure)
    again = damped_modes(build_system(assemble(lumped, gravity=True), support), below_hz=0.8)
    np.testing.assert_allclose(again.frequency_hz[:5], modes.frequency_hz[:5], rtol=3e-4)
    np.testing.assert_allclose(again.damping_ratio[:5], modes.damping_ratio[:5], rtol=0.02)
