"""The reduced basis: exact statics, small error with strong dashpots, numbering with a nacelle dashpot."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.response.follow import follow
from jackettwin.response.locus import followed_poles
from jackettwin.response.modal import damped_modes, undamped_modes
from jackettwin.response.reduced import craig_bampton, pinned_reference, undamped_reduced
from jackettwin.response.system import build_system
from jackettwin.soil.support import Spring, on_translations, pinned
from jackettwin.soil.viscoelastic import Prony, kelvin_voigt, maxwell_3, zener
from jackettwin.structure import Rayleigh

RAYLEIGH = Rayleigh.minimum(0.01, 0.1832)
LAWS = {
    "kelvin-voigt": kelvin_voigt(2.5e9, 7.6e8),
    "strong dashpot": kelvin_voigt(1.1e8, 1e9),
    "zener": zener(2.62e9, 8.65e8, 9.99e9),
    "maxwell-3": maxwell_3(2.5e9, 0.2, 0.183),
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_poles_of_the_first_five_modes_are_within_1e4(jacket15, law: Prony) -> None:
    """Evidence: fixed-interface modes alone miss ζ of mode 4 by a factor of 2.5 with strong dashpots."""
    structure = jacket15.structure
    reference = undamped_modes(build_system(jacket15, pinned(structure)), 7)
    system = build_system(jacket15, on_translations(structure, law), rayleigh=RAYLEIGH)
    full = damped_modes(system, below_hz=1.2)
    exact = full.eigenvalues[follow(jacket15.mass, reference.omega, reference.shapes, full.shapes)[:5]]
    reduced = craig_bampton(system, n_modes=24)
    assert reduced.pencil.n == 12 + 24
    ours = followed_poles(reduced.pencil, pinned_reference(reduced, 7))[:5]
    np.testing.assert_allclose(ours, exact, rtol=1e-4)
    np.testing.assert_allclose(-ours.real / np.abs(ours), -exact.real / np.abs(exact), rtol=2e-3)


def test_more_modes_bring_the_poles_closer(jacket15) -> None:
    """Ritz: the undamped frequencies come down on the exact ones."""
    system = build_system(jacket15, on_translations(jacket15.structure, LAWS["zener"]))
    exact = undamped_modes(system, 5).omega
    errors = [
        undamped_reduced(craig_bampton(system, n_modes=n).pencil).omega[:5] / exact - 1.0 for n in (8, 16, 32)
    ]
    assert all((error > -1e-9).all() for error in errors)
    assert (errors[1] <= errors[0] + 1e-12).all() and (errors[2] <= errors[1] + 1e-12).all()
    assert errors[2].max() < 1e-5


def test_static_stiffness_seen_by_the_supports_is_exact(jacket15) -> None:
    system = build_system(jacket15, on_translations(jacket15.structure, LAWS["zener"]))
    reduced = craig_bampton(system, n_modes=6)
    force = np.random.default_rng(1).standard_normal(12)
    b = np.searchsorted(system.free, reduced.boundary)
    load = np.zeros(system.pencil.n)
    load[b] = force
    full = np.linalg.solve(system.pencil.static_stiffness().toarray(), load)[b]
    small = np.linalg.solve(reduced.pencil.static_stiffness(), np.concatenate([force, np.zeros(6)]))[:12]
    np.testing.assert_allclose(small, full, rtol=1e-8)


def test_a_nacelle_dashpot_does_not_change_the_numbering(jacket15) -> None:
    """Its DOF is a boundary DOF, but the pinned modes that count the modes leave it free."""
    structure = jacket15.structure
    reference = undamped_modes(build_system(jacket15, pinned(structure)), 5)
    nacelle = Spring("tower_top", np.diag([0.0, 1.0, 0, 0, 0, 0]), kelvin_voigt(0.0, 1.24e5))
    system = build_system(
        jacket15, on_translations(structure, LAWS["zener"]), rayleigh=RAYLEIGH, dashpots=(nacelle,)
    )
    reduced = craig_bampton(system, n_modes=24)
    np.testing.assert_allclose(pinned_reference(reduced, 5).frequency_hz, reference.frequency_hz, rtol=1e-4)
    poles = followed_poles(reduced.pencil, pinned_reference(reduced, 5))
    zeta = -poles.real / np.abs(poles)
    # evidence: this dashpot alone gives 5.9 % side-side; fore-aft keeps its steel and soil
    assert 0.055 < zeta[0] < 0.07 and zeta[1] < 0.015


def test_coordinates_expand_to_shapes_of_the_structure(jacket15) -> None:
    system = build_system(jacket15, on_translations(jacket15.structure, LAWS["zener"]))
    reduced = craig_bampton(system, n_modes=8)
    M = reduced.basis.T @ jacket15.mass @ reduced.basis
    np.testing.assert_allclose(M, reduced.pencil.M, atol=1e-9 * np.abs(M).max())


def test_a_small_structure_keeps_all_it_has(monopile) -> None:
    support = (Spring("n0", np.diag([1.0, 1, 1, 400, 400, 400]), LAWS["zener"]),)
    system = build_system(monopile, type(pinned(monopile.structure))(springs=support))
    reduced = craig_bampton(system, n_modes=100)
    exact = damped_modes(system, below_hz=1.0).eigenvalues
    ours = damped_poles(reduced)
    np.testing.assert_allclose(ours[: exact.size], exact, rtol=1e-8)


def damped_poles(reduced) -> np.ndarray:
    from jackettwin.response.locus import oscillating_poles

    return oscillating_poles(reduced.pencil)[0]


def test_pinned_supports_leave_no_boundary(jacket15) -> None:
    with pytest.raises(InputError, match="no support to keep as boundary"):
        craig_bampton(build_system(jacket15, pinned(jacket15.structure)), n_modes=5)
