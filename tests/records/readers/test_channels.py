"""Places, gains and single arrays, through the reader as a user meets them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.constants import GRAVITY_M_S2
from jackettwin.errors import InputError
from jackettwin.records import read_record
from jackettwin.records.readers.channels import FileDefaults

RATE = FileDefaults(sample_rate_hz=10.0)


def table(path: Path, header: str, *rows: str) -> Path:
    path.write_text("\n".join([header, *rows, *rows, *rows]) + "\n", encoding="utf-8")
    return path


def test_heights_and_directions_of_a_german_logger(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", "ACC_088m_E [g];ACC_088m_N [g]", "0,1;0,2", "0,3;0,4")
    record = read_record(path, RATE)
    assert [(c.height_m, c.direction) for c in record.channels] == [
        (88.0, (1.0, 0.0, 0.0)),
        (88.0, (0.0, 1.0, 0.0)),
    ]
    assert "88 m (ACC_088m_E, ACC_088m_N)" in record.metadata["remarks"][-1]


def test_the_description_overrules_the_name(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", "ACC_088m_E [g]", "0.1", "0.2")
    said = {"ACC_088m_E": {"height_m": None, "direction": [0, 0, 2]}}
    path.with_suffix(".json").write_text(json.dumps({"channels": said}))
    record = read_record(path, RATE)
    assert (record.channels[0].height_m, record.channels[0].direction) == (None, (0.0, 0.0, 1.0))
    assert "remarks" not in record.metadata
    path.with_suffix(".json").write_text(json.dumps({"channels": {"ACC_088m_E": {"node": "top"}}}))
    assert read_record(path, RATE).channels[0].height_m is None


def test_a_name_that_ends_in_another_unit_than_its_bracket_is_said(tmp_path: Path) -> None:
    """Numbers in g under [m/s²] are 9.8 times too small; the JSON beside the file settles it."""
    path = table(tmp_path / "a.csv", "acc_x_g [m/s²],acc_y_m_s2 [m/s²],disp_x_mm [mm]", "0.1,1,2", "0.2,2,1")
    record = read_record(path, RATE)
    assert record.data[0, 0] == 0.1
    (said,) = [text for text in record.metadata["remarks"] if "name ends in" in text]
    assert said.startswith("acc_x_g: its name ends in g") and "a factor of 9.807" in said
    path.with_suffix(".json").write_text(json.dumps({"channels": {"acc_x_g": {"unit": "g"}}}))
    record = read_record(path, RATE)
    assert record.data[0, 0] == pytest.approx(0.1 * GRAVITY_M_S2)
    assert not any("name ends in" in text for text in record.metadata.get("remarks", ()))


def test_counts_need_a_gain(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", "acc_x [counts]", "100", "200")
    with pytest.raises(InputError, match="stored unscaled") as refused:
        read_record(path, RATE)
    assert refused.value.field == "channels.acc_x.gain"
    by_option = read_record(path, FileDefaults(10.0, unit="mg", gain=0.5))
    assert_allclose(by_option.data[0, :2], [50e-3 * GRAVITY_M_S2, 100e-3 * GRAVITY_M_S2])
    path.with_suffix(".json").write_text('{"channels": {"acc_x": {"unit": "g", "gain": 1e-3}}}')
    assert_allclose(read_record(path, RATE).data[0, :2], [0.1 * GRAVITY_M_S2, 0.2 * GRAVITY_M_S2])


def test_a_gain_without_a_unit_leads_to_si(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", "acc_x [V],WindSpeed [V]", "1,4", "2,5")
    record = read_record(path, FileDefaults(10.0, gain=3.0))
    assert_allclose(record.data[0, :2], [3.0, 6.0])
    assert record.channels[0].unit == "m/s^2"
    assert_allclose(record.data[1, :2], [4.0, 5.0])  # a wind speed is no vibration: the gain is not for it


@pytest.mark.parametrize(
    ("unit", "quantity", "factor"),
    [("µε", "strain", 1e-6), ("um/m", "strain", 1e-6), ("mdeg", "inclination", np.pi / 180e3)],
)
def test_units_of_strain_and_inclination(tmp_path: Path, unit: str, quantity: str, factor: float) -> None:
    name = {"strain": "SG_LAT017_DEG302", "inclination": "tilt_tp_x"}[quantity]
    path = table(tmp_path / "a.csv", f"{name} [{unit}]", "1.5", "2.5")
    record = read_record(path, RATE)
    assert record.channels[0].quantity == quantity
    assert_allclose(record.data[0, :2], [1.5 * factor, 2.5 * factor], rtol=1e-12)


def test_an_archive_of_one_column_with_its_name_and_unit(tmp_path: Path) -> None:
    y = np.array([[0.1], [0.2], [0.3]])
    np.savez(tmp_path / "a.npz", data=y, channel_names=["acc_top_x"], units=["g"], sample_rate_hz=5.0)
    record = read_record(tmp_path / "a.npz")
    assert record.channel_names == ("acc_top_x",)
    assert_allclose(record.data, GRAVITY_M_S2 * y.T)


def test_one_unit_beside_vectors_is_that_of_the_vibrations(tmp_path: Path) -> None:
    y = np.array([0.1, 0.2, 0.3])
    np.savez(tmp_path / "a.npz", acc_x=y, WindSpeed=10.0 + y, unit="mg", fs=5.0)
    record = read_record(tmp_path / "a.npz")
    assert_allclose(record.select(["acc_x"]).data[0], 1e-3 * GRAVITY_M_S2 * y)
    assert_allclose(record.select(["WindSpeed"]).data[0], 10.0 + y)


def test_single_arrays(tmp_path: Path) -> None:
    y = np.arange(12.0).reshape(6, 2)
    np.save(tmp_path / "a.npy", y)
    record = read_record(tmp_path / "a.npy", FileDefaults(5.0, "g"))
    assert record.channel_names == ("channel_1", "channel_2")
    assert_allclose(record.data, GRAVITY_M_S2 * y.T)
    fields = np.array([(0.1, 1.0), (0.2, 2.0)], dtype=[("acc_x", float), ("acc_y", float)])
    np.save(tmp_path / "b.npy", fields)
    assert read_record(tmp_path / "b.npy", FileDefaults(5.0, "g")).channel_names == ("acc_x", "acc_y")
    np.save(tmp_path / "c.npy", np.array([{}], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match="not readable as NumPy array"):
        read_record(tmp_path / "c.npy")
