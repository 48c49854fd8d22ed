"""Setups with moved sensors: one shape at all places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.errors import InputError
from jackettwin.identification import (
    FusedIdentification,
    Identification,
    IdentificationSettings,
    fuse,
    identify,
    mac,
)
from jackettwin.identification.many_records.setups import ShapeSum
from jackettwin.identification.mode_shapes import normalised
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel

HEIGHTS = np.array([90.0, 80.0, 65.0, 50.0, 35.0, 20.0])
"""Of a mast clamped at 0; the first two places are measured in both setups."""
SETUPS = ((0, 1, 2, 3), (1, 0, 4, 5))


def shear_mode(k: int) -> np.ndarray:
    """Shape of a clamped shear beam of 100 m: sin((2k − 1)πz/2L)."""
    return np.asarray(np.sin((2 * k - 1) * np.pi * HEIGHTS / 200.0))


SHAPES = np.array([shear_mode(k) for k in (1, 2, 3)])
F = np.array([0.4, 1.2, 2.0])


def setup(rows: tuple[int, ...], seed: int, strength: float) -> Identification:
    system = ModalSystem(F, np.full(3, 0.012), SHAPES, strength * np.diag(F**-2.0), noise_ratio=0.05)
    record = simulate(system, np.random.default_rng(seed), duration_s=900.0, sample_rate_hz=8.0)
    channels = tuple(Channel(f"z{HEIGHTS[i]:.0f}", height_m=float(HEIGHTS[i])) for i in rows)
    record = replace(record, data=record.data[list(rows)], channels=channels, name=f"setup {seed}")
    return identify(record, IdentificationSettings(lowest_frequency_hz=0.25, refine=False))


@pytest.fixture(scope="module")
def merged() -> tuple[FusedIdentification, list[Identification]]:
    """Four sensors at six places, the second time under nine times the force."""
    found = [setup(rows, seed, 9.0**seed) for seed, rows in enumerate(SETUPS)]
    return fuse(found), found


def test_two_setups_give_the_whole_shape(
    merged: tuple[FusedIdentification, list[Identification]],
) -> None:
    fused, found = merged
    assert [c.height_m for c in fused.channels] == [90.0, 80.0, 65.0, 50.0, 35.0, 20.0]
    assert len(fused.modes) == 3
    for mode, f, shape in zip(fused.modes, F, SHAPES, strict=True):
        assert mac(mode.mode_shape, shape) > 0.995
        # four standard deviations
        assert abs(mode.frequency_hz - f) < 4.0 * mode.frequency_std_hz
        assert abs(mode.damping_ratio - 0.012) < 4.0 * mode.damping_ratio_std
        single = [m.frequency_std_hz for one in found for m in one.modes if abs(m.frequency_hz - f) < 0.05]
        assert mode.frequency_std_hz < max(single)
    assert fused.warnings == ("records have different channels: shapes are connected by z90, z80",)


def test_fifteen_setups_of_velocities_beside_two_accelerometers() -> None:
    """As a scanning vibrometer measures a frame: three moved velocities a setup, two fixed accelerations."""
    rng = np.random.default_rng(15)
    f, shapes = np.array([0.6, 1.4, 2.3]), rng.standard_normal((3, 47))
    system = ModalSystem(f, np.full(3, 0.01), shapes, np.diag(f**-2.0), noise_ratio=0.02)
    found = []
    for k in range(15):
        record = simulate(system, rng, duration_s=300.0, sample_rate_hz=8.0)
        rows = [0, 1, *range(2 + 3 * k, 5 + 3 * k)]
        data = record.data[rows]
        omega = 2j * np.pi * np.fft.rfftfreq(data.shape[1], 1.0 / 8.0)
        omega[0] = np.inf
        data[2:] = np.fft.irfft(np.fft.rfft(data[2:], axis=1) / omega, data.shape[1], axis=1)
        places = [("m/s²", "acceleration")] * 2 + [("m/s", "velocity")] * 3
        channels = tuple(
            Channel(f"p{i}", unit=unit, quantity=quantity, node=f"{i}")
            for i, (unit, quantity) in zip(rows, places, strict=True)
        )
        record = replace(record, data=data, channels=channels, name=f"setup {k}")
        found.append(identify(record, IdentificationSettings(lowest_frequency_hz=0.3, refine=False)))
    fused = fuse(found)
    assert [round(mode.frequency_hz, 1) for mode in fused.modes] == [0.6, 1.4, 2.3]
    at = [int(channel.name[1:]) for channel in fused.channels]
    assert sorted(at) == list(range(47))
    for mode, shape in zip(fused.modes, shapes, strict=True):
        # fifteen parts, each of which carries the error of its two fixed sensors
        assert mac(mode.mode_shape, shape[at]) > 0.98


def test_exact_parts_give_the_exact_shape(rng: np.random.Generator) -> None:
    whole = rng.standard_normal(7) + 1j * rng.standard_normal(7)
    rows = [np.array(r) for r in ((0, 1, 2, 3), (1, 0, 4), (0, 5, 1))]
    factors = rng.standard_normal(3) + 1j * rng.standard_normal(3)
    total = ShapeSum.none(7)
    for factor, at in zip(factors, rows, strict=True):
        total = total.with_shape(factor * whole[at], at)
    shape = total.mean()
    assert np.isnan(shape[6])
    assert_allclose(shape[:6], normalised(whole[:6]), rtol=1e-9)


def test_complete_records_give_the_principal_direction(rng: np.random.Generator) -> None:
    shapes = rng.standard_normal(5) + 0.1 * rng.standard_normal((9, 5)) + 0j
    unit = shapes / np.linalg.norm(shapes, axis=1, keepdims=True)
    principal = np.linalg.eigh(unit.T @ unit.conj())[1][:, -1]
    total = ShapeSum.none(0)
    for one in shapes:
        total = total.with_shape(one, np.arange(5))
    assert mac(total.mean(), principal) == pytest.approx(1.0, abs=1e-12)


def test_a_name_that_moved_is_refused(merged: tuple[FusedIdentification, list[Identification]]) -> None:
    _, (first, second) = merged
    moved = tuple(replace(c, height_m=10.0) if c.name == "z80" else c for c in second.channels)
    with pytest.raises(InputError, match=r"setup 1: channels.z80: one name is used for different sensors"):
        fuse([first, replace(second, channels=moved)])


def test_shared_sensors_at_rest_are_said(
    merged: tuple[FusedIdentification, list[Identification]],
) -> None:
    _, found = merged
    still = []
    for one in found:
        quiet = np.array([0.1 if c.name in ("z90", "z80") else 1.0 for c in one.channels])
        modes = tuple(replace(m, mode_shape=m.mode_shape * quiet) for m in one.modes)
        still.append(replace(one, modes=modes))
    assert "hardly move" in fuse(still).warnings[-1]


def test_setups_that_share_nothing_are_refused(
    merged: tuple[FusedIdentification, list[Identification]],
) -> None:
    _, (first, second) = merged
    other = tuple(replace(c, name=f"other_{c.name}") for c in second.channels)
    with pytest.raises(InputError, match="records share no channel"):
        fuse([first, replace(second, channels=other)])
