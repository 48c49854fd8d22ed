"""Relaxations: found where there is one, not where there is none."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import signal

from jackettwin.errors import InputError
from jackettwin.files.codec import decode, encode
from jackettwin.identification import Identification, IdentificationSettings, identify, mac
from jackettwin.identification.subspace.real_poles import real_poles
from jackettwin.identification.subspace.ssi_cov import OrderPoles
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record

SETTINGS = IdentificationSettings(refine=False, real_poles=True, lowest_frequency_hz=0.25)
RATE_RAD_S, SHAPE = 6.0, np.array([1.0, 0.8, 0.6])


def displacements(relaxing: bool) -> Record:
    """Two modes and a first-order process (exact discretisation) at its own shape."""
    system = ModalSystem(
        np.array([0.5, 1.3]), np.array([0.02, 0.015]), np.array([[1.0, 0.4, 0.1], [-0.3, 1.0, 0.5]]),
        np.diag([4.0, 0.2]),
    )  # fmt: skip
    rng = np.random.default_rng(1)
    y = simulate(system, rng, duration_s=1200.0).data
    y /= y.std()
    if relaxing:
        mu = np.exp(-RATE_RAD_S / 20.0)
        force = np.sqrt(1.0 - mu**2) * rng.standard_normal(y.shape[1])
        y += np.outer(SHAPE, signal.lfilter([1.0], [1.0, -mu], force))
    return Record(y, 20.0, tuple(Channel(f"d{i}", "displacement", "m") for i in range(3)))


@pytest.fixture(scope="module")
def found() -> Identification:
    return identify(displacements(relaxing=True), SETTINGS)


def test_a_relaxation_is_found_with_its_interval(found: Identification) -> None:
    (pole,) = found.real_poles
    low, high = np.log(pole.rate_interval_90)
    # one record in ten lies outside of 90 %, this one among them; in a hundred one outside of 1.57 times that
    assert abs(np.log(RATE_RAD_S) - 0.5 * (low + high)) < 1.57 * 0.5 * (high - low)
    assert pole.time_constant_s == pytest.approx(1.0 / pole.rate_rad_s)
    assert mac(pole.mode_shape, SHAPE) > 0.99
    # never better than a first-order process observed alone
    assert pole.rate_std_rad_s / pole.rate_rad_s > np.sqrt(2.0 / (RATE_RAD_S * 1200.0))
    assert [round(mode.frequency_hz, 1) for mode in found.modes] == [0.5, 1.3]


def test_modes_alone_have_none() -> None:
    assert identify(displacements(relaxing=False), SETTINGS).real_poles == ()


def test_no_mode_depends_on_whether_relaxations_are_sought() -> None:
    """Same poles, same modes with the same status; only the relaxations are more."""
    record = displacements(relaxing=True)
    plain, asked = (
        identify(record, SETTINGS.model_copy(update={"real_poles": wanted})) for wanted in (False, True)
    )
    assert plain.real_poles == () and len(asked.real_poles) == 1
    assert plain.settings == asked.settings
    for one, other in zip(plain.modes, asked.modes, strict=True):
        assert (one.frequency_hz, one.damping_ratio, one.status) == (
            other.frequency_hz, other.damping_ratio, other.status,
        )  # fmt: skip
    assert_allclose(plain.stabilisation.frequency_hz, asked.stabilisation.frequency_hz, rtol=0.0)


def test_only_when_asked() -> None:
    assert not IdentificationSettings().real_poles
    with pytest.raises(InputError, match="real poles need the uncertainty of ssi-cov"):
        identify(displacements(relaxing=False), SETTINGS.with_method("plscf"))


def test_the_variance_is_that_of_the_logarithm() -> None:
    """μ = exp(−aΔt): δ ln a = −δμ/(μ a Δt), here with one block that moves μ by 0.1 %."""
    mu, rate = np.exp(-0.3), 10.0
    poles = [
        OrderPoles(n, np.array([mu + 0j]), np.ones((1, 2), dtype=complex), np.array([[0.001 * mu + 0j]]))
        for n in range(2, 22, 2)
    ]
    (pole,) = real_poles(
        poles, IdentificationSettings(), sample_rate_hz=rate, band_hz=(0.1, 4.0), scale=np.ones(2)
    )
    assert pole.rate_rad_s == pytest.approx(3.0)
    assert pole.rate_std_rad_s == pytest.approx(0.001 * rate)
    assert pole.order_share == 1.0


def test_files_keep_them(found: Identification) -> None:
    (back,) = decode(Identification, encode(found)).real_poles
    (pole,) = found.real_poles
    assert back.rate_interval_90 == pole.rate_interval_90
    assert_allclose(back.mode_shape, pole.mode_shape)
