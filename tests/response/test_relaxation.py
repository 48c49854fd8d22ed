"""The real pole nearest a rate: closed form, every real pole of the full model, and shapes that choose."""

import numpy as np
import pytest
from tests.support.law_rows import law_rows

from jackettwin.response.condensation.condensed import Condensed, condense
from jackettwin.response.condensation.numbered_modes import Points
from jackettwin.response.condensation.relaxation import nearest_relaxation
from jackettwin.response.modes.modal import damped_modes
from jackettwin.response.system import build_system
from jackettwin.soil.laws.viscoelastic import Law, Springpot, kelvin_voigt, maxwell_3, zener
from jackettwin.soil.support import on_translations
from jackettwin.structure import Assembly, Rayleigh

RAYLEIGH = Rayleigh.minimum(0.01, 0.1832)


@pytest.fixture(scope="module")
def condensed(jacket15: Assembly) -> Condensed:
    support = on_translations(jacket15.structure, kelvin_voigt(1e9, 1e8))
    return condense(build_system(jacket15, support, rayleigh=RAYLEIGH), below_hz=0.95)


def fixed(*laws: Law) -> Points:
    return Points.fixed(np.array([law_rows([law]) for law in laws]), RAYLEIGH)


def test_a_slow_relaxation_is_the_laws_own(condensed: Condensed) -> None:
    """Under a rigid structure too slow to feel its mass, k0 + k1 τs/(1 + τs) = 0 at s = −k0/((k0 + k1)τ)."""
    found = nearest_relaxation(condensed, fixed(zener(1e6, 3e8, 3e6)), 0.0025)
    # 4 (k0 + …) per direction against 3578 t · a² = 22 N/m and 1 % Rayleigh damping of a stiff jacket
    assert found.rate[0] == pytest.approx(1e6 / (4e6 * 100.0), rel=1e-3)


@pytest.mark.parametrize("name", ["kelvin-voigt", "zener", "maxwell-3"])
def test_every_real_pole_of_the_full_model_is_found(
    jacket15: Assembly, condensed: Condensed, name: str
) -> None:
    """Asked for any real pole of the full model, nearly locked and overdamped supports included."""
    rng, asked = np.random.default_rng(len(name)), 0
    for _ in range(4):
        k, k1 = 10.0 ** rng.uniform(8, 11, 2)
        tau = 10.0 ** rng.uniform(-0.7, 2.0)
        law = {
            "kelvin-voigt": kelvin_voigt(k, k * tau),
            "zener": zener(k, k1 * tau, k1),
            "maxwell-3": maxwell_3(k, float(rng.uniform(0.01, 0.5)), 0.1832),
        }[name]
        system = build_system(jacket15, on_translations(jacket15.structure, law), rayleigh=RAYLEIGH)
        exact = -damped_modes(system, below_hz=0.9).real_poles
        for rate in exact:
            found = nearest_relaxation(condensed, fixed(law), float(rate))
            # the full model is rounded to about 1e-9
            assert found.rate[0] == pytest.approx(rate, rel=1e-8), law
            asked += 1
    assert asked > 20


def test_many_sets_are_as_each(condensed: Condensed) -> None:
    laws = [zener(k0, 9e8, 8e9) for k0 in (1e9, 2e9, 4e9)]
    together = nearest_relaxation(condensed, fixed(*laws), 2.4).rate
    each = [nearest_relaxation(condensed, fixed(law), 2.4).rate[0] for law in laws]
    np.testing.assert_allclose(together, each, rtol=1e-10)


def test_a_shape_chooses_among_neighbours(condensed: Condensed) -> None:
    """The fan of these supports ends at 3.767; asked at its other end, that pole's shape still finds it."""
    points = fixed(kelvin_voigt(2.5e9, 7.6e8))
    last = nearest_relaxation(condensed, points, 3.77)
    sensors = np.eye(condensed.n)
    found = nearest_relaxation(
        condensed, points, 3.29, at_sensors=sensors, shape=last.shapes[0].astype(complex)
    )
    assert found.rate[0] == pytest.approx(last.rate[0], rel=1e-9)
    assert nearest_relaxation(condensed, points, 3.29).rate[0] < 3.3


def test_beyond_the_band_the_rate_tends_to_the_laws_own(condensed: Condensed) -> None:
    """The mass holds the feet: only the branch's spring and dashpot move."""
    found = nearest_relaxation(condensed, fixed(zener(1e9, 1e4, 1e9)), 3.0)
    assert found.rate[0] == pytest.approx(1e5, rel=0.5)


def test_a_springpot_has_none(condensed: Condensed) -> None:
    found = nearest_relaxation(condensed, fixed(Springpot(2e9, 0.1, 1.15)), 3.0)
    assert np.isnan(found.rate).all()
