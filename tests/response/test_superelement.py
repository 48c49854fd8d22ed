"""Superelements: SubDyn's reduced model, the full model's damping, closed forms, round trips."""

import json
from math import pi
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.decks.subdyn import DeckDamping
from jackettwin.errors import InputError
from jackettwin.response.superelement.accuracy import damping_ratio, default_band_hz, reduced_modes
from jackettwin.response.superelement.craig_bampton import (
    INTERFACE,
    RUNGE_KUTTA,
    fixed_interface_frequencies,
    slowed,
    superelement,
    with_deck_damping,
)
from jackettwin.response.superelement.extptfm_writer import LAYOUTS
from jackettwin.response.superelement.files import read_superelement, write_superelement
from jackettwin.response.system import build_system
from jackettwin.soil import on_translations, own_support
from jackettwin.soil.files import read_support
from jackettwin.soil.laws.viscoelastic import Springpot, kelvin_voigt, maxwell_3, zener
from jackettwin.soil.support import Support, clamped
from jackettwin.structure import Rayleigh, Section, Structure, assemble, check
from jackettwin.structure.cut import at_interface
from jackettwin.structure.model import STEEL, Member, Reaction

DATA = Path(__file__).parents[1] / "data" / "subdyn"
DECKS = Path(__file__).parents[2] / "qualify" / "decks"
CASES = json.loads((DATA / "subdyn_results.json").read_text())["cases"]
FEET = kelvin_voigt(2.5e9, 7.6e8)
STEEL_DAMPING = {
    "none": Rayleigh(),
    "0.55 %": Rayleigh.minimum(0.0055, 0.183),
    "1 %": Rayleigh.minimum(0.01, 0.183),
}


def jacket15(law, rayleigh=None):
    """Return (foundation, full, rest, band)."""
    whole = read_structure("jacket15")
    base, top = at_interface(whole)
    support = on_translations(whole, law)
    systems = [build_system(assemble(part), support, rayleigh=rayleigh) for part in (base, whole)]
    return systems[0], systems[1], assemble(top), default_band_hz(systems[1])


@pytest.mark.parametrize(
    ("case", "theory", "fixed"),
    [
        ("j50_eb_ssi_jkt", "euler-bernoulli", False),
        ("j50_eb_fixed_jkt", "euler-bernoulli", True),
        ("j50_tim_ssi_jkt", "timoshenko", False),
    ],
)
def test_subdyn_s_reduced_frequencies(case: str, theory: str, fixed: bool) -> None:
    """OpenFAST v5.0.0's Guyan and fixed-interface frequencies; printed with seven digits, hence 1e-6."""
    structure = read_structure(DATA / "IEA-15-240-RWT-Jacket_SubDyn.dat")
    support = clamped(structure) if fixed else own_support(structure)
    system = build_system(assemble(structure, beam_theory=theory, subdivide=2), support)
    element = superelement(system, number=8)
    np.testing.assert_allclose(element.guyan_frequency_hz, CASES[case]["GY_frequencies"], rtol=1e-6)
    held = fixed_interface_frequencies(system, 8)
    np.testing.assert_allclose(held, CASES[case]["CB_frequencies"], rtol=1e-6)
    # elastic supports: the classical form, and nothing but it
    np.testing.assert_allclose(np.sqrt(np.diag(element.K)[INTERFACE:]) / (2 * pi), held, rtol=1e-9)
    np.testing.assert_allclose(element.M[INTERFACE:, INTERFACE:], np.eye(8), atol=1e-9)
    assert element.n_damped == 0


@pytest.mark.parametrize("steel", STEEL_DAMPING)
def test_second_bending_s_damping_with_strong_dashpots(steel: str) -> None:
    """6 + 24 coordinates: within 1 % of the full model where plain Craig–Bampton is 77–166 % off."""
    base, full, rest, band = jacket15(FEET, STEEL_DAMPING[steel])
    element = superelement(base, number=24, band_hz=band)
    plain = superelement(base, number=24, band_hz=band, damped=False)
    assert element.n == plain.n == 30
    for modes, wrong in ((reduced_modes(element, full, rest, band_hz=band), False),
                         (reduced_modes(plain, full, rest, band_hz=band), True)):  # fmt: skip
        error = modes.damping_error / damping_ratio(modes.full)
        if wrong:
            assert 0.76 < error[3] < 1.66
        else:
            assert np.abs(error).max() < 1e-3
            assert np.abs(modes.frequency_error).max() < 1e-5


@pytest.mark.parametrize(
    "law",
    [
        zener(2.62e9, 8.65e8, 9.99e9),
        zener(4.4e9, 3.76e9, 6.14e12),
        maxwell_3(2.5e9, 0.1, 0.18),
        Springpot.from_loss_factor(2.5e9, 0.1, 1.14),
        kelvin_voigt(1.1e8, 1e11),
    ],
    ids=["zener", "stiff zener", "maxwell-3", "springpot", "locked dampers"],
)
def test_internal_variables_are_carried(law) -> None:
    """Every law, without any damping of the steel: within 1 % of ζ, or 1e-5, a hundredth of steel's own."""
    base, full, rest, band = jacket15(law)
    modes = reduced_modes(superelement(base, number=24, band_hz=band), full, rest, band_hz=band)
    zeta = damping_ratio(modes.full)
    assert zeta.size >= 5
    assert (np.abs(modes.damping_error) < 0.01 * zeta + 1e-5).all()
    assert np.abs(modes.frequency_error).max() < 1e-4


@pytest.mark.parametrize("law", [FEET, zener(2.62e9, 8.65e8, 9.99e9), maxwell_3(2.5e9, 0.1, 0.18)])
def test_the_element_is_symmetric_and_only_dissipates(law) -> None:
    element = superelement(jacket15(law)[0], number=24)
    for matrix in (element.M, element.C, element.K):
        np.testing.assert_array_equal(matrix, matrix.T)
        scale = np.sqrt(np.abs(np.diag(matrix)).max())
        assert np.linalg.eigvalsh(matrix).min() > -1e-12 * scale**2


def test_rigid_body_mass_and_weight() -> None:
    """The interface carries a share of the foundation's weight, and no horizontal one."""
    base = at_interface(read_structure("jacket15"))[0]
    held = build_system(assemble(base), on_translations(base, FEET))
    element = superelement(held, number=24)
    mass = check(assemble(base)).mass_kg
    assert 0.0 < -element.weight_n[2] < mass * 9.80665
    horizontal = element.weight_n[[0, 1, 5]]
    assert np.abs(horizontal).max() < 1e-6 * mass


def test_a_cantilever_s_tip_is_its_textbook_stiffness() -> None:
    """Guyan's 3EI/L³ … about the tip: 12EI/L³, −6EI/L², 4EI/L, EA/L, GJ/L."""
    L, tube = 20.0, Section(2.0, 0.05)
    column = Structure(
        "column",
        {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.0, L)},
        (Member("m", "a", "b", tube, tube, STEEL),),
        reactions=(Reaction("a"),),
        interface_nodes=("b",),
        subdivide=4,
    )
    element = superelement(build_system(assemble(column), clamped(column)), number=3)
    A, I = np.pi / 4 * (2.0**2 - 1.9**2), np.pi / 64 * (2.0**4 - 1.9**4)  # noqa: E741
    E, G = STEEL.youngs_modulus_pa, STEEL.shear_modulus_pa
    K = np.diag([12 * E * I / L**3] * 2 + [E * A / L] + [4 * E * I / L] * 2 + [2 * G * I / L])
    K[0, 4] = K[4, 0] = -6 * E * I / L**2
    K[1, 3] = K[3, 1] = 6 * E * I / L**2
    np.testing.assert_allclose(element.interface_stiffness, K, atol=1e-7 * K.max())
    # clamped-clamped: β₁L = 4.730041
    held = fixed_interface_frequencies(build_system(assemble(column), clamped(column)), 1)[0]
    assert held == pytest.approx(4.730041**2 / (2 * pi) * np.sqrt(E * I / (7850 * A * L**4)), rel=2e-3)


def test_a_deck_damps_mass_by_alpha_stiffness_by_beta_and_internal_coordinates_by_ratio() -> None:
    """SubDyn's Guyan damping: C = α M + β K of the interface, 2 ζ ω inside."""
    element = superelement(jacket15(FEET)[0], number=4)
    damping = DeckDamping((0.01,), 0.02, 0.003, np.zeros((6, 6)))
    C = with_deck_damping(element, damping).C - element.C
    b = slice(INTERFACE)
    np.testing.assert_allclose(C[b, b], 0.02 * element.M[b, b] + 0.003 * element.K[b, b], rtol=1e-12)
    omega = np.sqrt(np.diag(element.K)[INTERFACE:])
    np.testing.assert_allclose(np.diag(C)[INTERFACE:], 2.0 * 0.01 * omega, rtol=1e-12)


def test_another_reference_point_is_a_rigid_transfer() -> None:
    base = jacket15(FEET)[0]
    here, there = (superelement(base, number=6, reference_m=(0.0, 0.0, z)) for z in (100.0, 94.0))
    np.testing.assert_allclose(there.guyan_frequency_hz, here.guyan_frequency_hz, rtol=1e-8)
    # moment about a point 6 m lower: force times arm
    arm = here.interface_stiffness[0, 4] - there.interface_stiffness[0, 4]
    assert abs(arm) == pytest.approx(6.0 * here.interface_stiffness[0, 0], rel=1e-8)


def test_slowed_poles_allow_the_step_and_keep_the_damping() -> None:
    base, full, rest, band = jacket15(FEET, STEEL_DAMPING["0.55 %"])
    element = superelement(base, number=24, band_hz=band)
    slow = slowed(element, step_s=0.005, band_hz=band)
    assert element.fastest_pole_rad_s > 1e4
    assert slow.fastest_pole_rad_s * 0.005 < RUNGE_KUTTA
    np.testing.assert_array_equal(slow.interface_stiffness, element.interface_stiffness)
    modes = reduced_modes(slow, full, rest, band_hz=band)
    assert np.abs(modes.damping_error / damping_ratio(modes.full)).max() < 0.01


@pytest.mark.parametrize("suffix", [".npz", ".dat"])
def test_round_trip(tmp_path: Path, suffix: str) -> None:
    element = superelement(jacket15(FEET, STEEL_DAMPING["1 %"])[0], number=8)
    files = write_superelement(element, tmp_path / f"jacket{suffix}")
    again = read_superelement(files[0])
    for name in ("M", "C", "K", "weight_n"):
        # sixteen digits on paper
        np.testing.assert_allclose(getattr(again, name), getattr(element, name), rtol=1e-14, atol=0.0)
    if suffix == ".npz":
        np.testing.assert_array_equal(again.basis, element.basis)
        assert again.reference_m == element.reference_m


@pytest.mark.parametrize(
    "support",
    [
        "kelvin-voigt:k=2.5e9,c=7.6e8",
        "zener:k0=2.62e9,c=8.65e8,k1=9.99e9",
        "springpot:k=1e9,alpha=0.06,f0=0.2",
        "clamped",
        "jacket15",
    ],
)
@pytest.mark.parametrize("name", ["three_legs.yaml", "oc3_tripod.dat", "oc4_jacket.dat"])
def test_every_structure_on_every_support_is_read_back(name: str, support: str, tmp_path: Path) -> None:
    """Mass, damping and stiffness, to the digits on paper, in every form that is written."""
    base = at_interface(read_structure(DECKS / name))[0]
    system = build_system(assemble(base), read_support(support, base), rayleigh=Rayleigh.minimum(0.01, 0.3))
    element = superelement(system, number=10)
    for form in (".npz", *LAYOUTS):
        path = tmp_path / f"a{form if form == '.npz' else '.dat'}"
        files = write_superelement(element, path, **({} if form == ".npz" else {"layout": form}))
        again = read_superelement(files[0])
        for one in ("M", "C", "K", "weight_n"):
            np.testing.assert_allclose(getattr(again, one), getattr(element, one), rtol=1e-14, atol=0.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nothing\n", "not a superelement of ExtPtfm"),
        ("!c\n!Flex 5 Format\n!Dimension: 3\n!Mass Matrix\n", "fewer coordinates"),
        ("!c\n!Flex 5 Format\n!Dimension: 6\n!Mass Matrix\n!Dimension: 6\n 1 2 3\n", "matrix"),
        ("!\n!Flex 5 Format\n!Dimension: 6\n!Mass Matrix\n!\n a\n!Stiffness Matrix\n!Damping Matrix", "num"),
    ],
)  # fmt: skip
def test_bad_files_are_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "bad.dat").write_text(text)
    with pytest.raises(InputError, match=message):
        read_superelement(tmp_path / "bad.dat")
    with pytest.raises(InputError, match="unknown format"):
        read_superelement(tmp_path / "bad.txt")


def test_a_held_interface_is_refused() -> None:
    base = at_interface(read_structure("jacket15"))[0]
    system = build_system(assemble(base), Support(fixed=(("tp_top", (0, 1, 2)), ("foot_1", (0, 1, 2)))))
    with pytest.raises(InputError, match="the support acts on the interface"):
        superelement(system, number=4)
