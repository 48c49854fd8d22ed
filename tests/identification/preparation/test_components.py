"""Dozens of channels are identified from a few components, and have their shapes all the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, identify, mac
from jackettwin.identification.preparation.components import COMPONENTS, MAX_CHANNELS, components
from jackettwin.identification.preparation.prepared_record import prepare
from jackettwin.identification.synthetic import ModalSystem, simulate

N = 40
SHAPES = np.array([np.sin((k + 1) * np.pi * np.linspace(0.05, 0.95, N)) for k in range(3)])
SYSTEM = ModalSystem(
    np.array([0.5, 1.1, 1.9]), np.array([0.01, 0.012, 0.015]), SHAPES, np.eye(3), noise_ratio=0.1
)
SETTINGS = IdentificationSettings(
    lowest_frequency_hz=0.3, highest_frequency_hz=2.4, refine=False, max_order=24
)


@pytest.fixture(scope="module")
def record():
    return simulate(SYSTEM, np.random.default_rng(2), duration_s=300.0, sample_rate_hz=8.0)


def test_shapes_hold_every_channel(record):
    found = identify(record, SETTINGS)
    assert [c.name for c in found.channels] == [f"a{j}" for j in range(N)]
    assert len(found.modes) == 3
    for mode, f, zeta, shape in zip(
        found.modes, SYSTEM.frequency_hz, SYSTEM.damping_ratio, SHAPES, strict=True
    ):
        # four standard deviations
        assert abs(mode.frequency_hz - f) < 4.0 * mode.frequency_std_hz
        assert abs(mode.damping_ratio - zeta) < 4.0 * mode.damping_ratio_std
        assert mac(mode.mode_shape, shape) > 0.995
        assert mode.mode_shape_std.shape == (N,)
    assert found.stabilisation.mode_shape.shape[1] == found.spectrum.density.shape[0] == N
    assert f"{COMPONENTS} components of {N} channels" in found.findings[0].text


def test_what_components_leave_out_is_noise(record):
    """Three modes and a tenth of noise, 1 % of the power: components must hold all but most of that."""
    whole = prepare(record, SETTINGS)
    fewer, basis = components(whole, SETTINGS)
    rebuilt = (basis @ fewer.y) / whole.scale[:, None]
    assert np.mean((rebuilt - whole.y) ** 2) < 0.01
    assert fewer.y.shape == (COMPONENTS, whole.y.shape[1])


def test_few_channels_mixed_kinds_and_chosen_references_stay(record):
    few = record.select(record.channel_names[:MAX_CHANNELS])
    assert components(prepare(few, SETTINGS), SETTINGS)[1] is None
    kinds = (replace(record.channels[0], quantity="strain"), *record.channels[1:])
    mixed = replace(record, channels=kinds)
    assert components(prepare(mixed, SETTINGS), SETTINGS)[1] is None
    chosen = SETTINGS.model_copy(update={"reference_channels": ("a0", "a9")})
    assert components(prepare(record, chosen), chosen)[1] is None
