"""Root locus between its limits: thesis figure 8.4."""

import numpy as np
import pytest

from gallery.locus import damping_ratio, frequency_hz, root_locus
from jackettwin.response.condensation.condensed import condense
from jackettwin.response.system import build_system
from jackettwin.soil.laws.viscoelastic import Prony, kelvin_voigt
from jackettwin.soil.support import on_translations


@pytest.mark.parametrize(("k", "free_hz"), [(2.5e9, 0.1814), (1.1e8, 0.1507)])
def test_a_kelvin_voigt_locus_ends_on_pinned_feet(jacket15, k: float, free_hz: float) -> None:
    """Both ends undamped, one hump between; no Rayleigh damping, as in figure 8.4."""
    system = build_system(jacket15, on_translations(jacket15.structure, Prony(k0=k)))
    condensed = condense(system, below_hz=0.95)
    poles = root_locus(condensed, lambda c: kelvin_voigt(k, c), np.geomspace(1e2, 1e14, 49), n_modes=5)
    f, zeta = frequency_hz(poles), damping_ratio(poles)
    assert f[0, 0] == pytest.approx(free_hz, rel=6e-3)
    np.testing.assert_allclose(f[-1], [0.1832, 0.1859, 0.5720, 0.7489, 0.7941], rtol=2e-3)
    assert (zeta[[0, -1]] < 1e-4).all()
    for curve in zeta.T:
        peak = int(np.argmax(curve))
        assert (np.diff(curve[: peak + 1]) > 0).all() and (np.diff(curve[peak:]) < 0).all()


def test_elastic_supports_stay_on_the_imaginary_axis(jacket15) -> None:
    system = build_system(jacket15, on_translations(jacket15.structure, Prony(k0=1e9)))
    condensed = condense(system, below_hz=0.95)
    poles = root_locus(condensed, lambda k: Prony(k0=k), [1e8, 1e9, 1e10], n_modes=2)
    assert np.abs(poles.real).max() < 1e-9 * np.abs(poles).max()
    assert (np.diff(np.abs(poles), axis=0) > 0).all()
