"""A law's curves against closed forms, and short forms read without a structure."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil import families, law_curves, read_law


def test_the_zener_solid_in_closed_form() -> None:
    """Storage from k0 to k0 + k1, the loss factor highest at √(k0/(k0 + k1))/τ; thesis (4.8) and (4.9)."""
    k0, k1, c = 2.0, 3.0, 0.6
    curves = law_curves(read_law(f"zener:k0={k0},c={c},k1={k1}"), 1e-3, 1e3, n=4001)
    tau = c / k1
    np.testing.assert_allclose(curves.relaxation, k0 + k1 * np.exp(-curves.time_s / tau), rtol=1e-12)
    slow = tau * (k0 + k1) / k0
    expected = 1.0 / k0 - (1.0 / k0 - 1.0 / (k0 + k1)) * np.exp(-curves.time_s / slow)
    np.testing.assert_allclose(curves.creep, expected, rtol=1e-9)
    assert curves.stiffness[0].real == pytest.approx(k0, rel=1e-4)
    assert curves.stiffness[-1].real == pytest.approx(k0 + k1, rel=1e-4)
    peak = curves.frequency_hz[np.argmax(curves.loss_factor)]
    # the grid steps by 0.35 %
    assert 2 * np.pi * peak == pytest.approx(np.sqrt(k0 / (k0 + k1)) / tau, rel=4e-3)


@pytest.mark.parametrize("name", sorted(families()))
def test_every_registered_law_obeys_the_theorems_of_its_ends(name: str) -> None:
    """Storage grows with frequency, relaxation falls, creep grows; creep times relaxation is at most one."""
    law = families()[name]
    values = ",".join(f"{p.name}={np.sqrt(p.low * p.high)}" for p in law.parameters)
    f0 = ",f0=0.2" if law.needs_frequency else ""
    curves = law_curves(read_law(f"{name}:{values}{f0}"), 1e-3, 10.0)
    scale = np.abs(curves.stiffness).max()
    assert (np.diff(curves.stiffness.real) >= -1e-12 * scale).all()
    assert (curves.stiffness.imag >= 0.0).all()
    assert (np.diff(curves.relaxation) <= 1e-12 * scale).all()
    assert (np.diff(curves.creep) >= -1e-12 * curves.creep.max()).all()
    assert (curves.creep * curves.relaxation <= 1.0 + 1e-9).all()


def test_a_dashpot_alone_cannot_relax_and_nothing_cannot_creep() -> None:
    nothing = law_curves(read_law("elastic:k=0"), 0.1, 1.0)
    assert np.isnan(nothing.creep).all() and np.isnan(nothing.loss_factor).all()
    flowing = law_curves(read_law("kelvin-voigt:k=0,c=2"), 0.1, 1.0)
    np.testing.assert_allclose(flowing.creep, flowing.time_s / 2.0, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("foo:k=1", "no such law"),
        ("zener:k0=1", "missing"),
        ("springpot:k=1,alpha=0.1", "give f0="),
        ("elastic", "missing"),
    ],
)
def test_short_forms_that_say_no_law_are_refused(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_law(text)


def test_a_band_has_two_ends() -> None:
    with pytest.raises(InputError, match="0 < low < high"):
        law_curves(read_law("elastic:k=1"), 1.0, 1.0)
