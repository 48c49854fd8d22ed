from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Channel, Record
from jackettwin.records.processing.yaw import to_global_axes, to_rotor_axes


def turned(record: Record, yaw: np.ndarray) -> Record:
    """Measure a record given in rotor axes with global sensors under a turning nacelle."""
    n = len(record.channels) // 2
    fa, ss = record.data[:n], record.data[n:]
    data = np.vstack([np.cos(yaw) * fa - np.sin(yaw) * ss, np.sin(yaw) * fa + np.cos(yaw) * ss, yaw[None, :]])
    return replace(record, data=data, channels=(*record.channels, Channel("yaw", "yaw", "rad")))


def dominant_shape(record: Record, low_hz: float, high_hz: float) -> np.ndarray:
    """Return the strongest principal direction of a band: the mode there."""
    rows = record.data[[i for i, c in enumerate(record.channels) if c.quantity == "acceleration"]]
    frequency = np.fft.rfftfreq(rows.shape[1], 1.0 / record.sample_rate_hz)
    band = np.fft.rfft(rows, axis=1)[:, (frequency > low_hz) & (frequency < high_hz)]
    return np.linalg.eigh(np.real(band @ band.conj().T))[1][:, -1]


def mac(a: np.ndarray, b: np.ndarray) -> float:
    return float((a @ b) ** 2 / ((a @ a) * (b @ b)))


def test_fixed_yaw_is_the_closed_form() -> None:
    x, y = np.array([1.0, 0.0]), np.array([0.0, 2.0])
    channels = (Channel("acc_x", direction=(1.0, 0.0, 0.0)), Channel("acc_y", direction=(0.0, 1.0, 0.0)))
    record = Record(np.array([x, y]), 10.0, channels, conditions={"yaw_deg": 30})
    out = to_rotor_axes(record)
    c, s = np.sqrt(3) / 2, 0.5
    np.testing.assert_allclose(out.data, [c * x + s * y, c * y - s * x], rtol=1e-15)
    assert out.channel_names == ("acc_fore_aft", "acc_side_side")
    assert out.metadata["axes"] == "rotor"


def test_sensors_on_the_nacelle_turn_with_it_and_are_not_turned_again() -> None:
    along, across = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    channels = (
        Channel("nac_x", direction=along, height_m=110.0, frame="nacelle"),
        Channel("nac_y", direction=across, height_m=110.0, frame="nacelle"),
        Channel("mid_x", direction=along, height_m=60.0),
        Channel("mid_y", direction=across, height_m=60.0),
    )
    data = np.array([[1.0], [0.0], [0.0], [1.0]])  # at yaw 90°, fore-aft is global y
    record = Record(data, 10.0, channels, conditions={"yaw_deg": 90.0})
    out = to_rotor_axes(record, rename=False)
    np.testing.assert_allclose(out.data[:, 0], [1.0, 0.0, 1.0, 0.0], atol=1e-15)
    back = to_global_axes(out)
    assert back.channels[0] == channels[0]
    np.testing.assert_allclose(back.data[:2], data[:2])


def test_turning_there_and_back_is_the_identity(tower: SimpleNamespace) -> None:
    record = turned(tower.record(1), np.linspace(0.0, 8.0, 12_000))
    back = to_global_axes(to_rotor_axes(record))
    np.testing.assert_allclose(back.data, record.data, atol=1e-12)  # rounding of two rotations
    assert back.channel_names == record.channel_names
    assert [c.direction for c in back.channels] == [c.direction for c in record.channels]


def test_power_is_invariant_sample_by_sample(tower: SimpleNamespace) -> None:
    record = tower.record(2)
    out = to_rotor_axes(record, yaw_rad=1.234)
    np.testing.assert_allclose((out.data**2).sum(axis=0), (record.data**2).sum(axis=0), rtol=1e-12)


def test_mode_shapes_of_two_yaws_agree_in_rotor_axes_only(tower: SimpleNamespace) -> None:
    """Side-side made six times stronger, so that it is the band's mode in both records."""
    shapes_global, shapes_rotor = [], []
    for seed, yaw in ((3, np.full(12_000, 0.1)), (4, np.linspace(1.2, 1.5, 12_000))):
        still = tower.record(seed)
        strong = replace(still, data=still.data * np.repeat([1.0, 6.0], 4)[:, None])
        measured = turned(strong, yaw)
        shapes_global.append(dominant_shape(measured, 0.15, 0.2))
        shapes_rotor.append(dominant_shape(to_rotor_axes(measured), 0.15, 0.2))
    assert mac(*shapes_rotor) >= 0.95
    assert mac(*shapes_global) < 0.5


def test_sensors_need_not_lie_along_the_axes(tower: SimpleNamespace) -> None:
    angle = np.radians(25.0)
    u, v = (np.cos(angle), np.sin(angle), 0.0), (-np.sin(angle), np.cos(angle), 0.0)
    x, y = np.random.default_rng(0).normal(size=(2, 50))
    data = np.array([u[0] * x + u[1] * y, v[0] * x + v[1] * y])
    channels = (Channel("acc_1", height_m=3.0, direction=u), Channel("acc_2", height_m=3.0, direction=v))
    out = to_rotor_axes(Record(data, 10.0, channels), yaw_rad=0.0)
    np.testing.assert_allclose(out.data, [x, y], rtol=1e-12, atol=1e-12)
    assert out.channel_names == ("acc_1_fore_aft", "acc_2_side_side")


def test_other_channels_stay_and_lonely_ones_are_named(tower: SimpleNamespace) -> None:
    record = tower.record(5).select(["acc_144_x", "acc_144_y", "acc_77_x"])
    vertical = Channel("acc_144_z", height_m=144.0, direction=(0.0, 0.0, 1.0))
    wind = Channel("wind_x", "wind speed", "m/s", direction=(1.0, 0.0, 0.0))
    more = replace(
        record, data=np.vstack([record.data, record.data[:2]]), channels=(*record.channels, vertical, wind)
    )
    out = to_rotor_axes(more, yaw_rad=0.5)
    assert out.channel_names == ("acc_144_fore_aft", "acc_144_side_side", "acc_144_z", "wind_x")
    assert out.metadata["without_partner"] == ["acc_77_x"]
    assert np.array_equal(out.data[2:], record.data[:2])


def test_gaps_of_a_signal_reach_both_axes_and_gaps_of_the_yaw_are_bridged(tower: SimpleNamespace) -> None:
    record = turned(tower.record(6), np.full(12_000, 0.3))
    data = record.data.copy()
    data[0, 100:200] = np.nan
    data[8, 300:400] = np.nan
    out = to_rotor_axes(replace(record, data=data))
    assert np.isnan(out.data[[0, 4], 100:200]).all()
    assert np.isnan(out.data[:8]).sum() == 200


def test_unknown_or_unreadable_yaw_is_refused(tower: SimpleNamespace) -> None:
    record = tower.record(7, duration_s=10.0)
    with pytest.raises(InputError, match=r"tower_7: conditions.yaw_deg: yaw is not known.*yaw_deg"):
        to_rotor_axes(record)
    with pytest.raises(InputError, match=r"conditions.yaw_deg: is not a number \(got 'west'\)"):
        to_rotor_axes(replace(record, conditions={"yaw_deg": "west"}))
    with pytest.raises(InputError, match="is in rotor axes already"):
        to_rotor_axes(to_rotor_axes(record, yaw_rad=0.0), yaw_rad=0.0)
    with pytest.raises(InputError, match="is in global axes already"):
        to_global_axes(record, yaw_rad=0.0)
