"""Setups joined before the identification: eight channels in three setups with two references."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import resample_poly

from jackettwin.errors import InputError
from jackettwin.identification import Identification, IdentificationSettings, identify_setups, mac
from jackettwin.identification.subspace.covariances import covariances
from jackettwin.identification.subspace.joined_setups import joined_hankel
from jackettwin.identification.subspace.ssi_cov import (
    balanced_subspace,
    frequency_and_damping,
    hankel,
    order_poles,
)
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record

F, ZETA = np.array([0.4, 1.2, 2.0]), 0.012
HEIGHTS_M = np.linspace(90.0, 20.0, 8)
SHAPES = np.array([np.sin((2 * k - 1) * np.pi * HEIGHTS_M / 200.0) for k in (1, 2, 3)])
SETUPS = ((0, 3, 1, 2), (0, 3, 4, 5), (3, 0, 6, 7))
FORCES = np.array([[1.0, 1.0, 1.0], [48.0, 192.0, 48.0], [100.0, 30.0, 100.0]])
"""Of each mode in each setup: up to a factor of 14 in amplitude, and of 2.5 between the modes."""


def setup(number: int, rows: tuple[int, ...], force: np.ndarray = FORCES, seed: int = 20) -> Record:
    system = ModalSystem(F, np.full(3, ZETA), SHAPES, np.diag(force[number] / F**2), noise_ratio=0.05)
    record = simulate(system, np.random.default_rng(seed + number), duration_s=900.0, sample_rate_hz=8.0)
    channels = tuple(Channel(f"z{i}", height_m=float(HEIGHTS_M[i])) for i in rows)
    return replace(record, data=record.data[list(rows)], channels=channels, name=f"setup {number}")


def exact(n_lags: int, strength: np.ndarray) -> np.ndarray:
    """Covariances (lags, 8, 8) without noise, of a force that acts on each mode with this strength."""
    omega = 2.0 * np.pi * F / 8.0
    decay = np.exp(omega * (-ZETA + 1j * np.sqrt(1.0 - ZETA**2)))
    lags = decay ** np.arange(n_lags + 1)[:, None] * np.exp(0.3j * np.arange(3)) * strength
    return np.asarray(np.einsum("kc,lk,kr->lcr", SHAPES, lags, SHAPES).real)


@pytest.fixture(scope="module")
def found() -> Identification:
    return identify_setups([setup(j, rows) for j, rows in enumerate(SETUPS)])


def test_exact_covariances_give_the_whole_system() -> None:
    """Without noise the joined matrix is of the rank of the system: poles and shapes to rounding."""
    lags = [exact(40, np.array(s)) for s in ([1.0, 1.0, 1.0], [40.0, 3.0, 9.0], [0.2, 0.5, 0.1])]
    pieces = [full[:, list(rows)][:, :, [0, 3]] for full, rows in zip(lags, SETUPS, strict=True)]
    h = joined_hankel(pieces, [np.array(rows) for rows in SETUPS], 20, 20)
    for k in range(3):
        assert_allclose(h[:, 40 * k : 40 * k + 40], hankel(lags[k][:, :, [0, 3]], 20), atol=1e-9 * h.max())
    (poles,) = order_poles(balanced_subspace(h, 8, 6, factors=False), [6])
    f, zeta = frequency_and_damping(poles.eigenvalues, 8.0)
    order = np.argsort(f)
    assert_allclose(f[order], F, rtol=1e-7)
    assert_allclose(zeta[order], ZETA, rtol=1e-5)
    assert np.all(np.diag(mac(poles.shapes[order], SHAPES)) > 1.0 - 1e-9)


def test_three_setups_give_frequency_damping_and_the_whole_shape(found: Identification) -> None:
    names = [channel.name for channel in found.channels]
    assert names == ["z0", "z3", "z1", "z2", "z4", "z5", "z6", "z7"]
    rows = [int(name[1:]) for name in names]
    ok = [mode for mode in found.modes if mode.status == "unchecked"]
    # poles of noise are stable as well, without a peak
    for mode, f, shape in zip(ok, F, SHAPES, strict=True):
        # four standard deviations of the long-data limits of one setup of the three
        cycles = 2.0 * np.pi * f * found.duration_s
        assert abs(mode.frequency_hz / f - 1.0) < 4.0 * np.sqrt(3.0 * ZETA / cycles)
        assert abs(mode.damping_ratio / ZETA - 1.0) < 4.0 * np.sqrt(3.0 / (ZETA * cycles))
        assert mac(mode.mode_shape, shape[rows]) > 0.99
        assert mode.frequency_std_hz is None


def test_a_broad_pole_beside_a_mode_is_doubtful() -> None:
    """In this realisation 1.2 and 2.0 Hz each have a second stable pole, of four times the damping."""
    found = identify_setups([setup(j, rows, seed=150) for j, rows in enumerate(SETUPS)])
    assert_allclose([m.frequency_hz for m in found.modes if m.status == "unchecked"], F, rtol=0.01)
    assert sum("shape_twice" in [reason.code for reason in m.reasons] for m in found.modes) == 2


def test_a_setup_of_another_structure_leaves_no_mode_without_doubt() -> None:
    records = [setup(j, rows) for j, rows in enumerate(SETUPS)]
    stiffer = replace(records[2], sample_rate_hz=10.4)
    other = replace(stiffer, data=resample_poly(stiffer.data, 10, 13, axis=1), sample_rate_hz=8.0)
    found = identify_setups([*records[:2], other])
    assert found.modes
    for mode in found.modes:
        assert mode.status == "doubtful"
        assert {reason.code for reason in mode.reasons} & {"no_peak", "no_peak_in_setup"}


def test_one_setup_of_all_channels_is_plain_ssi() -> None:
    record = setup(0, tuple(range(8)))
    lags = covariances(record.data, 40)[:, :, [0, 3]]
    assert_allclose(joined_hankel([lags], [np.arange(8)], 20, 20), hankel(lags, 20), rtol=0.0, atol=0.0)


def test_level_of_a_setup_changes_nothing(found: Identification) -> None:
    records = [setup(j, rows) for j, rows in enumerate(SETUPS)]
    louder = [records[0], replace(records[1], data=7.0 * records[1].data), records[2]]
    again = identify_setups(louder)
    assert_allclose([m.frequency_hz for m in again.modes], [m.frequency_hz for m in found.modes], rtol=1e-6)
    for one, other in zip(again.modes, found.modes, strict=True):
        assert_allclose(one.mode_shape, other.mode_shape, atol=1e-5)


def test_setups_without_common_references_are_refused() -> None:
    chain = [setup(j, rows) for j, rows in enumerate(((0, 1, 2), (2, 3, 4), (4, 5, 6)))]
    with pytest.raises(InputError, match="share no reference channel"):
        identify_setups(chain)
    records = [setup(j, rows) for j, rows in enumerate(SETUPS)]
    with pytest.raises(InputError, match="z1"):
        identify_setups(records, IdentificationSettings(reference_channels=("z0", "z1")))
    with pytest.raises(InputError, match="unit weights"):
        identify_setups(records, IdentificationSettings(method="plscf"))


def test_one_name_at_two_places_is_refused() -> None:
    records = [setup(j, rows) for j, rows in enumerate(SETUPS)]
    moved = tuple(replace(c, name={"z4": "z1"}.get(c.name, c.name)) for c in records[1].channels)
    with pytest.raises(InputError, match="different sensors"):
        identify_setups([records[0], replace(records[1], channels=moved)])


def test_chosen_references_and_setups_of_different_bands(found: Identification) -> None:
    """One reference may do; a quiet lowest mode in one setup must not make another band of it."""
    quiet = FORCES * np.array([[1.0, 1.0, 1.0], [1e-3, 1.0, 1.0], [1.0, 1.0, 1.0]])
    records = [setup(j, rows, quiet) for j, rows in enumerate(SETUPS)]
    one = identify_setups(records, IdentificationSettings(reference_channels=("z0",)))
    assert one.settings.lowest_frequency_hz < F[0]
    for f in F[1:]:
        assert min(abs(m.frequency_hz / f - 1.0) for m in one.modes) < 0.01
