"""Other methods than SSI-cov: exact on exact data, near the truth on ten minutes."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.files import validate
from jackettwin.identification import IdentificationSettings, identify
from jackettwin.identification.frequency_domain.plscf import plscf_poles
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.subspace.ssi_cov import frequency_and_damping, order_poles
from jackettwin.identification.subspace.ssi_dat import ssi_dat
from jackettwin.identification.synthetic import ModalSystem, simulate

RATE = 10.0
F = np.array([0.5, 0.56, 1.7])
ZETA = np.array([0.03, 0.05, 0.02])
SHAPES = np.array([[1.0, 0.4, 0.1, 0.2], [-0.2, 0.9, 1.0, 0.3], [0.5, -1.0, 0.6, 0.4]])


def decays(n: int, weights: np.ndarray) -> np.ndarray:
    """Return (n, 4, columns) sums of the three modes' free decays."""
    omega = 2 * np.pi * F
    lam = -ZETA * omega + 1j * omega * np.sqrt(1 - ZETA**2)
    t = np.arange(n) / RATE
    return 2 * np.real(np.einsum("tm,mo,mr->tor", np.exp(np.outer(t, lam)), SHAPES, weights))


def test_ssi_dat_is_exact_on_a_free_decay() -> None:
    y = decays(900, np.ones((3, 1)))[:, :, 0].T
    for references in (None, [0, 2]):
        subspace = ssi_dat(y, block_rows=12, max_order=8, references=references)
        (poles,) = order_poles(subspace, [6])
        f, zeta = frequency_and_damping(poles.eigenvalues, RATE)
        order = np.argsort(f)
        # the data decays to 1e-4 of its start and below: rounding grows by as much
        np.testing.assert_allclose(f[order], F, rtol=1e-6)
        np.testing.assert_allclose(zeta[order], ZETA, rtol=1e-4)
        np.testing.assert_allclose(np.diag(mac(poles.shapes[order], SHAPES)), 1.0, atol=1e-6)


def test_ssi_dat_leaves_out_instants_with_gaps() -> None:
    y = decays(900, np.ones((3, 1)))[:, :, 0].T
    y[1, 300:310] = np.nan
    (poles,) = order_poles(ssi_dat(y, block_rows=12, max_order=8), [6])
    f, _ = frequency_and_damping(poles.eigenvalues, RATE)
    np.testing.assert_allclose(np.sort(f), F, rtol=1e-6)


def test_ssi_dat_refuses_a_record_of_gaps() -> None:
    y = np.ones((2, 400))
    y[0, ::10] = np.nan
    with pytest.raises(InputError, match=r"too little for SSI-dat.*0 complete instants.*ssi-cov"):
        ssi_dat(y, block_rows=8, max_order=4)


@pytest.mark.parametrize("n_references", [1, 2, 4])
def test_plscf_is_exact_on_exact_covariances(n_references: int) -> None:
    """Covariances are sums of decays; 2000 lags hold them whole, so the window's end does not show."""
    weights = np.array([[1.0, 0.3, -0.5, 0.2], [0.4, 1.0, 0.7, -0.6], [-0.3, 0.8, 1.0, 0.5]])[
        :, :n_references
    ]
    lags = decays(2001, weights)
    degree = 6 // n_references + 1
    (poles,) = plscf_poles(lags, [max(degree, 6)], band=(0.02, 0.4))
    f, zeta = frequency_and_damping(poles.eigenvalues, RATE)
    for k in range(3):
        nearest = np.argmin(np.abs(f - F[k]) / F[k] + np.abs(zeta - ZETA[k]) / ZETA[k])
        assert f[nearest] == pytest.approx(F[k], rel=1e-5)
        assert zeta[nearest] == pytest.approx(ZETA[k], rel=1e-3)
        assert mac(poles.shapes[nearest], SHAPES[k]) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("method", ["ssi-dat", "plscf"])
def test_both_close_pairs_in_ten_minutes(method, tower, rng):
    result = identify(simulate(tower, rng), IdentificationSettings(method=method))
    f = np.array([m.frequency_hz for m in result.modes])
    similarity = mac(tower.mode_shapes, np.array([m.mode_shape for m in result.modes]))
    nearest = np.argmin(np.abs(np.log(f / tower.frequency_hz[:, None])) + 0.2 * (1 - similarity), axis=1)
    assert len(set(nearest)) == 4
    for k, mode in enumerate(nearest):
        # six standard deviations of the best possible estimate from 600 s: √(ζ/2πfT)
        limit = 6 * np.sqrt(tower.damping_ratio[k] / (2 * np.pi * tower.frequency_hz[k] * 600))
        assert f[mode] == pytest.approx(tower.frequency_hz[k], rel=limit)
        assert similarity[k, mode] > 0.8
        assert result.modes[mode].method == method


def test_a_few_reference_channels_find_the_same_modes(tower, rng):
    record = simulate(tower, rng)
    whole = identify(record)
    few = identify(record, IdentificationSettings(reference_channels=("a0", "a1", "a4")))
    for mode in whole.modes[:2]:
        apart = min(abs(m.frequency_hz / mode.frequency_hz - 1.0) for m in few.modes)
        # the two share all but the noise of the covariances
        assert apart < 2.0 * mode.frequency_std_hz / mode.frequency_hz
    assert all(m.damping_ratio_std is not None for m in few.modes)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"method": "ssi"}, "method: not one of the choices.*ssi-cov"),
        ({"reference_channels": "a0"}, "reference_channels: not a list"),
        ({"reference_channels": ["a0"], "weighting": "cva"}, "takes all channels as references"),
    ],
)
def test_bad_choices_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        validate(IdentificationSettings, values)


def test_a_reference_that_is_not_there_is_refused(tower, rng):
    with pytest.raises(InputError, match="no such channel"):
        identify(simulate(tower, rng), IdentificationSettings(reference_channels=("b0",)))


@pytest.mark.parametrize("method", ["ssi-cov", "ssi-dat", "plscf"])
def test_an_exactly_double_mode_is_two_modes_in_one_plane(method):
    """A symmetric tower has no directions of its own: groups of poles by shape are fragments of the pair.

    Wind along x drives one direction three times as much, as in the field.
    """
    bending = np.array([[1.0, 0.5, 0.15], [-0.6, 1.0, 0.8]])
    shapes = np.kron(bending, np.eye(2))
    pairs = ModalSystem(
        frequency_hz=np.array([0.25, 0.25, 1.1, 1.1]),
        damping_ratio=np.array([0.008, 0.008, 0.012, 0.012]),
        mode_shapes=shapes,
        force=np.diag([9.0, 1.0, 0.9, 0.1]),
    )
    record = simulate(pairs, np.random.default_rng(0))
    result = identify(record, IdentificationSettings(method=method))
    for k in (0, 2):
        f, zeta = pairs.frequency_hz[k], pairs.damping_ratio[k]
        limit = 6 * np.sqrt(zeta / (2 * np.pi * f * 600))
        found = [m for m in result.modes if abs(m.frequency_hz / f - 1.0) < limit]
        assert len(found) == 2
        if method == "ssi-cov":
            assert [m.status for m in found] == [ModeStatus.OK] * 2
        plane = shapes[k : k + 2] / np.linalg.norm(shapes[k : k + 2], axis=1, keepdims=True)
        for mode in found:
            own = mode.mode_shape / np.linalg.norm(mode.mode_shape)
            assert np.linalg.norm(plane @ own) ** 2 > 0.95
