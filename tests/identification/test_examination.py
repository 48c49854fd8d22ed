"""Records under a turned nacelle: the same modes, in the same axes."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.identification import Examination, IdentificationSettings, examine_file, mac, moving_channels
from jackettwin.identification.record_steps import set_aside, unclear, unplaced
from jackettwin.records import Channel, Record, read_record, write_record

RECORDS = files("jackettwin") / "data" / "records"


def turned(name: str, yaw: np.ndarray) -> Record:
    """Return a shipped record (nacelle along x) as global sensors see it under a turned nacelle."""
    record = read_record(str(RECORDS / f"{name}.parquet"))
    record = record.of_quantity("acceleration")
    data = record.data.copy()
    fa, ss = record.data[0::2], record.data[1::2]
    data[0::2], data[1::2] = np.cos(yaw) * fa - np.sin(yaw) * ss, np.sin(yaw) * fa + np.cos(yaw) * ss
    return replace(record, data=data, conditions={})


def seen(record: Record, path: Path, places: tuple[Channel, ...] = ()) -> Examination:
    write_record(record, path)
    return examine_file(path, IdentificationSettings(), places=places)


@pytest.fixture(scope="module")
def straight() -> Examination:
    return examine_file(Path(str(RECORDS / "pile_U12_s301.parquet")), IdentificationSettings())


def test_modes_of_another_record_at_another_yaw_are_the_same(straight: Examination, tmp_path: Path) -> None:
    """Another ten minutes, turned by 60 degrees: MAC ≥ 0.95 with each mode of the first two pairs."""
    other = replace(turned("pile_U12_s308", np.array(np.pi / 3)), conditions={"yaw_deg": 60.0})
    found = seen(other, tmp_path / "r.parquet").identification
    # between the pairs both records show a mode at 0.64 Hz, whose shape ten minutes tell to a MAC of 0.94
    pairs = [m for m in straight.identification.modes if not 0.6 < m.frequency_hz < 0.7][:4]
    for mode in pairs:
        # two records differ by √2 · √(ζ/2πfT) = 1.0 % at least in f of the wide first peak: three of them
        near = [m for m in found.modes if abs(m.frequency_hz / mode.frequency_hz - 1.0) < 0.03]
        twin = max(near, key=lambda m: float(mac(mode.mode_shape, m.mode_shape)))
        assert mac(mode.mode_shape, twin.mode_shape) >= 0.95
    # the first pair is 0.6 half bandwidths apart, and what ten minutes say of its shapes is kept
    assert straight.identification.modes[1].mode_shape_unaligned is not None
    assert any(note.code == "pair_rotated" for note in straight.identification.notes)
    assert mac(straight.identification.modes[1].mode_shape_unaligned, found.modes[1].mode_shape) < 0.95


def test_yaw_as_a_channel(straight: Examination, tmp_path: Path) -> None:
    """The same ten minutes while the nacelle turns by 80 degrees: the very same modes."""
    yaw = np.radians(np.linspace(-20.0, 60.0, 60_001))
    record = turned("pile_U12_s301", yaw)
    channels = (*record.channels, Channel("yaw", "yaw", "rad"))
    record = replace(record, data=np.vstack([record.data, yaw]), channels=channels)
    found = seen(record, tmp_path / "r.parquet")
    f = [m.frequency_hz for m in straight.identification.modes]
    # the line taken from a channel before turning differs by a hair from that taken after
    assert [m.frequency_hz for m in found.identification.modes] == pytest.approx(f, rel=2e-3)
    assert found.record.metadata["axes"] == "rotor"
    assert found.record.channel_names == straight.record.channel_names


def test_sensors_off_the_axes_are_turned_onto_them(straight: Examination, tmp_path: Path) -> None:
    """Sensors at 45 degrees to x, as a twin's ``sensors`` say; the record itself says nothing."""
    record = turned("pile_U12_s301", np.array(np.radians(-45.0)))
    channels = tuple(Channel(f"s{i}") for i in range(8))
    record = replace(record, channels=channels, conditions={"yaw_deg": 1e-6})
    half = np.sqrt(0.5)
    sensors = tuple(
        Channel(
            f"s{i}",
            direction=(half, half, 0.0) if i % 2 == 0 else (-half, half, 0.0),
            height_m=10.0 * (i // 2),
        )
        for i in range(8)
    )
    found = seen(record, tmp_path / "r.parquet", sensors)
    assert [c.direction for c in found.record.channels] == 4 * [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
    a, b = found.identification.modes[1], straight.identification.modes[1]
    assert mac(a.mode_shape, b.mode_shape) > 0.999


def test_what_cannot_be_turned_is_said(tmp_path: Path) -> None:
    record = replace(turned("pile_U12_s301", np.array(0.0)), conditions={"yaw_deg": 20.0})
    lonely = seen(record.select([*record.channel_names[:7]]), tmp_path / "a.parquet")
    assert "no second horizontal channel" in lonely.identification.warnings[0]
    assert "acc_tp_x" in lonely.identification.warnings[0]
    none = seen(record.select(record.channel_names[::2]), tmp_path / "b.parquet")
    assert "not rotated to the rotor's axes" in none.identification.warnings[0]
    assert len(none.identification.channels) == 4


def test_turning_and_fixed_sensors_without_a_yaw_are_said(tmp_path: Path) -> None:
    record = turned("pile_U12_s301", np.array(0.0))
    top = tuple(replace(c, frame="nacelle") if c.name.startswith("acc_top") else c for c in record.channels)
    found = seen(replace(record, channels=top, conditions={}), tmp_path / "a.parquet")
    assert any("the yaw is not known" in line for line in found.identification.warnings)
    assert {c.frame for c in found.record.channels} == {"nacelle", "global"}


def test_sensors_without_a_place_are_named() -> None:
    record = turned("pile_U12_s301", np.array(0.0))
    assert unplaced(record) == ()
    nowhere = replace(record, channels=tuple(replace(c, height_m=None) for c in record.channels))
    (note,) = unplaced(nowhere)
    assert str(note).startswith(
        "acc_top_x, acc_top_y, acc_g77_x, acc_g77_y, acc_g41_x …: the position is not known"
    )


def test_channels_of_which_nobody_knows_what_they_measure_are_named() -> None:
    record = turned("pile_U12_s301", np.array(0.0))
    assert unclear(record) == ()
    strange = (replace(record.channels[0], quantity="other", unit="mm"), *record.channels[1:])
    (note,) = unclear(replace(record, channels=strange))
    assert str(note).startswith("acc_top_x (mm): left out: neither name and unit nor the JSON show")


def test_a_dead_channel_is_left_out_and_said(tmp_path: Path) -> None:
    record = turned("pile_U12_s301", np.array(0.0))
    data = record.data[:4].copy()
    data[1] = 0.25
    found = seen(replace(record, data=data, channels=record.channels[:4]), tmp_path / "a.parquet")
    dead = record.channel_names[1]
    assert found.record.channel_names == (record.channel_names[0], *record.channel_names[2:4])
    assert [f.subject for f in found.quality.findings if f.code == "dead"] == [dead]
    nothing = replace(record, data=np.ones((1, 6000)), channels=record.channels[:1])
    with pytest.raises(InputError, match="no channel carries a signal"):
        seen(nothing, tmp_path / "b.parquet")


def test_a_record_that_lacks_a_sensor_is_identified_without_it(tmp_path: Path) -> None:
    """What is nearly the name of a channel without a sensor is a slip, and refused."""
    record = turned("pile_U12_s301", np.array(0.0))
    sensors = tuple(Channel(c.name, direction=c.direction, height_m=c.height_m) for c in record.channels)
    fewer = seen(record.select(record.channel_names[2:]), tmp_path / "a.parquet", sensors)
    assert fewer.record.channel_names == record.channel_names[2:]
    (absent,) = [f for f in fewer.identification.findings if f.code == "sensors_absent"]
    assert set(str(absent.subject).split(", ")) == {*record.channel_names[:2]}
    slip = (replace(sensors[0], name=f"{sensors[0].name}_"), *sensors[1:])
    with pytest.raises(InputError, match="no such channel.*did you mean"):
        seen(record, tmp_path / "b.parquet", slip)


def test_strains_are_identified_where_nothing_measures_motion() -> None:
    record = turned("pile_U12_s301", np.array(0.0))
    strain = tuple(replace(c, quantity="strain", unit="-") for c in record.channels[:2])
    mixed = replace(record, channels=(*strain, *record.channels[2:]))
    assert moving_channels(mixed).channel_names == record.channel_names[2:]
    (note,) = set_aside(mixed, moving_channels(mixed))
    assert note.subject == ", ".join(record.channel_names[:2])
    assert moving_channels(mixed.select(record.channel_names[:2])).channels == strain
