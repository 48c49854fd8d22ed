"""Blind prediction of ζ4 for soil whose loss factor is the same at every frequency."""

import numpy as np
import pytest

from jackettwin.soil import DEFAULT_LAWS, family
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating import Residuals, Target, single, support_model
from jackettwin.updating.search.solutions import search

STEEL = Rayleigh.minimum(0.0055, 0.1832)


def predicted(assembly: Assembly, law: str, k: float, loss_factor: float) -> float:
    """Return the relative error of ζ4 after fitting f1, f2, f4 and ζ1 of springpot supports."""
    truth = support_model(assembly, family=family("springpot"), rayleigh=STEEL, highest_mode=5)
    poles = truth.predict(np.array([k, 2.0 / np.pi * np.arctan(loss_factor)]), (1, 2, 4)).poles
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    targets = (Target(1, f[0], damping_ratio=zeta[0]), Target(2, f[1]), Target(4, f[2]))
    model = support_model(assembly, family=family(law), rayleigh=STEEL, highest_mode=5)
    best = search(single(model, Residuals(targets, relative=True)), starts=4).solutions[0]
    return float(best.damping_ratio[2] / zeta[2] - 1.0)


@pytest.mark.parametrize(("k", "loss_factor"), [(1e9, 0.05), (3e9, 0.1), (3e9, 0.3)])
def test_the_default_law_predicts_what_it_does_not_contain(
    jacket15: Assembly, k: float, loss_factor: float
) -> None:
    # three branches keep the loss factor within 1 % up to 3 Hz
    assert abs(predicted(jacket15, DEFAULT_LAWS[0], k, loss_factor)) < 0.1


def test_kelvin_voigt_does_not(jacket15: Assembly) -> None:
    """Its loss factor grows with the frequency: ζ4 comes out at about twice the truth."""
    assert predicted(jacket15, "kelvin-voigt", 3e9, 0.1) > 0.5
