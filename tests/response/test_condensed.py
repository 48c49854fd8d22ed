"""The condensed structure: exact statics, exact poles, shapes and numbering."""

import numpy as np
import pytest
import scipy.sparse.linalg as spla
from tests.support.law_rows import law_rows

from jackettwin.errors import InputError
from jackettwin.response.condensation.condensed import Condensed, condense
from jackettwin.response.condensation.pole_count import all_modes
from jackettwin.response.modes.modal import damped_modes, undamped_modes
from jackettwin.response.system import System, build_system
from jackettwin.soil.laws.viscoelastic import Law, Springpot, kelvin_voigt, maxwell_3, zener
from jackettwin.soil.support import Spring, Support, on_translations, pinned
from jackettwin.structure import Rayleigh

RAYLEIGH = Rayleigh.minimum(0.01, 0.1832)
LAWS: dict[str, Law] = {
    "kelvin-voigt": kelvin_voigt(2.5e9, 7.6e8),  # thesis table 8.1
    "strong dashpot": kelvin_voigt(1.1e8, 1e9),
    "nearly locked": kelvin_voigt(1.1e8, 1e12),  # thesis table 8.3
    "zener": zener(2.62e9, 8.65e8, 9.99e9),
    "maxwell-3": maxwell_3(2.5e9, 0.2, 0.183),
    "springpot": Springpot(3e9, 0.06, 1.15),
}


def modes_of(system: System, condensed: Condensed):
    rows = law_rows([group.law for group in condensed.pencil.groups])
    steel = condensed.pencil.rayleigh
    return all_modes(condensed, rows, np.array([steel.alpha, steel.beta]))


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_poles_are_those_of_the_full_model(jacket15, law: Law) -> None:
    system = build_system(jacket15, on_translations(jacket15.structure, law), rayleigh=RAYLEIGH)
    found = modes_of(system, condense(system, below_hz=0.95))
    exact = damped_modes(system, below_hz=found.radius / (2.0 * np.pi))
    assert found.certified
    # nothing is truncated: what is left is rounding, in the full model more than here
    np.testing.assert_allclose(found.poles, exact.eigenvalues, rtol=1e-9)


def test_shapes_are_those_of_the_full_model(jacket15) -> None:
    system = build_system(jacket15, on_translations(jacket15.structure, LAWS["zener"]), rayleigh=RAYLEIGH)
    condensed = condense(system, below_hz=0.95)
    found = modes_of(system, condensed)
    exact = damped_modes(system, below_hz=found.radius / (2.0 * np.pi))
    for pole, x, reference in zip(found.poles, found.shapes, exact.shapes.T, strict=True):
        u = condensed.expand(pole, x)
        u *= np.vdot(u, reference) / np.vdot(u, u)
        # the truncated modes enter the shape with their first moment only: (f/2.4 Hz)⁴ of their share
        np.testing.assert_allclose(u, reference, atol=1e-4 * np.abs(reference).max())


def test_f_is_the_schur_complement_of_the_full_one(jacket15) -> None:
    """Static condensation is the case s = 0; a general s holds every term of the series."""
    from jackettwin.response.condensation.kernels import fill

    system = build_system(jacket15, on_translations(jacket15.structure, LAWS["maxwell-3"]), rayleigh=RAYLEIGH)
    condensed = condense(system, below_hz=0.95)
    rows = law_rows([group.law for group in condensed.pencil.groups])
    b = np.searchsorted(system.free, condensed.boundary)
    load = np.zeros((system.pencil.n, b.size))
    load[b, np.arange(b.size)] = 1.0
    scale = condensed.basis[condensed.boundary, np.arange(b.size)]
    n, n_pairs = condensed.n, condensed.terms.shape[1]
    for s in (0.0, -1.0 + 4.0j, -5.0 + 0.1j):
        F, dF = np.empty((2, n, n), dtype=np.complex128)
        packed = np.empty((2, n_pairs), dtype=np.complex128)
        fill(condensed.arrays(), rows, RAYLEIGH.alpha, RAYLEIGH.beta, complex(s), F, dF, *packed)
        flexibility = np.linalg.inv(F)[: b.size, : b.size] * np.outer(scale, scale)
        full = spla.splu(system.pencil.F(s).astype(complex).tocsc()).solve(load.astype(complex))[b]
        np.testing.assert_allclose(flexibility, full, rtol=1e-8, atol=1e-9 * np.abs(full).max())


def test_a_nacelle_dashpot_does_not_change_the_numbering(jacket15) -> None:
    """Its DOF is a boundary DOF, but the pinned modes that count the modes leave it free."""
    structure = jacket15.structure
    reference = undamped_modes(build_system(jacket15, pinned(structure)), 5)
    nacelle = Spring("tower_top", np.diag([0.0, 1.0, 0, 0, 0, 0]), kelvin_voigt(0.0, 1.24e5))
    system = build_system(
        jacket15, on_translations(structure, LAWS["zener"]), rayleigh=RAYLEIGH, dashpots=(nacelle,)
    )
    condensed = condense(system, below_hz=0.95)
    # Craig–Bampton: what counts the modes need not be exact
    np.testing.assert_allclose(condensed.pinned.frequency_hz[:5], reference.frequency_hz, rtol=1e-2)
    found = modes_of(system, condensed)
    exact = damped_modes(system, below_hz=found.radius / (2.0 * np.pi))
    assert found.certified
    np.testing.assert_allclose(found.poles, exact.eigenvalues, rtol=1e-9)
    zeta = -found.poles.real / np.abs(found.poles)
    # evidence: this dashpot alone gives 5.9 % side-side; fore-aft keeps its steel and soil
    assert 0.055 < zeta[0] < 0.07 and zeta[1] < 0.015


def test_six_by_six_supports(monopile) -> None:
    support = Support(springs=(Spring("n0", np.diag([1.0, 1, 1, 400, 400, 400]), LAWS["zener"]),))
    system = build_system(monopile, support)
    found = modes_of(system, condense(system, below_hz=1.0))
    exact = damped_modes(system, below_hz=found.radius / (2.0 * np.pi))
    assert found.certified
    np.testing.assert_allclose(found.poles, exact.eigenvalues, rtol=1e-9)


def test_pinned_supports_leave_no_boundary(jacket15) -> None:
    with pytest.raises(InputError, match="no support has a law"):
        condense(build_system(jacket15, pinned(jacket15.structure)), below_hz=1.0)


def test_overdamped_steel_is_refused(jacket15) -> None:
    support = on_translations(jacket15.structure, LAWS["zener"])
    system = build_system(jacket15, support, rayleigh=Rayleigh(beta=0.1))
    with pytest.raises(InputError, match="too strong for the band"):
        condense(system, below_hz=0.95)
