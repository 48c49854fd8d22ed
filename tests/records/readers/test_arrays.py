"""MATLAB and HDF5 files as others write them; our own are covered by the registry's round trip."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy import io

from jackettwin.errors import InputError, MissingExtra
from jackettwin.records import assess, read_record
from jackettwin.records.readers import hdf5
from jackettwin.records.readers.channels import FileDefaults

ENTRY = '{"quantity": "acceleration", "unit": "g"}'
BESIDE = f'{{"channels": {{"a": {ENTRY}, "b": {ENTRY}}}}}'


def save_mat(path: Path, **content: Any) -> None:
    io.savemat(path, content)


def save_npz(path: Path, **content: Any) -> None:
    np.savez(path, **content)


def save_h5(path: Path, **content: Any) -> None:
    with h5py.File(path, "w") as file:
        for key, value in content.items():
            texts = np.asarray(value).dtype.kind == "U"
            file.create_dataset(key, data=np.asarray(value, dtype=object) if texts else value)


WRITERS = {"mat": save_mat, "npz": save_npz, "h5": save_h5}
Y = np.random.default_rng(1).normal(size=(2, 50))


@pytest.mark.parametrize("extension", WRITERS)
@pytest.mark.parametrize("matrix", [Y, Y.T])
def test_a_matrix_with_names_either_way_round(extension: str, matrix: np.ndarray, tmp_path: Path) -> None:
    WRITERS[extension](tmp_path / f"r.{extension}", data=matrix, fs=20.0, channel_names=np.array(["a", "b"]))
    (tmp_path / "r.json").write_text(BESIDE)
    record = read_record(tmp_path / f"r.{extension}")
    np.testing.assert_allclose(record.data, Y * 9.80665, rtol=1e-15)
    assert record.sample_rate_hz == 20.0


@pytest.mark.parametrize("extension", WRITERS)
def test_vectors_are_channels_and_a_time_is_not(extension: str, tmp_path: Path) -> None:
    WRITERS[extension](
        tmp_path / f"r.{extension}", time=np.arange(50) / 20.0, b=Y[1], a=Y[0], note=np.array("x")
    )
    (tmp_path / "r.json").write_text(BESIDE)
    record = read_record(tmp_path / f"r.{extension}")
    np.testing.assert_allclose(record.data, Y * 9.80665, rtol=1e-15)
    assert record.sample_rate_hz == 20.0


@pytest.mark.parametrize("extension", WRITERS)
@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"data": Y}, "sample rate is missing"),
        ({"data": Y, "fs": 0.0}, "is not a rate"),
        ({"data": Y, "more": Y, "fs": 5.0}, "several matrices.*data, more"),
        ({"data": Y, "fs": 5.0, "channel_names": np.array(["a", "a"])}, "names and channels disagree"),
        ({"fs": 5.0}, "holds no channels"),
    ],
)
def test_ambiguous_content_is_refused(
    extension: str, content: dict[str, Any], message: str, tmp_path: Path
) -> None:
    WRITERS[extension](tmp_path / f"r.{extension}", **content)
    with pytest.raises(InputError, match=message):
        read_record(tmp_path / f"r.{extension}")


def test_fields_of_a_matlab_struct(tmp_path: Path) -> None:
    io.savemat(tmp_path / "r.mat", {"rec": {"a": Y[0], "b": Y[1], "Fs": 20.0, "info": {"site": "x"}}})
    (tmp_path / "r.json").write_text(BESIDE.replace('"a"', '"rec.a"').replace('"b"', '"rec.b"'))
    assert read_record(tmp_path / "r.mat").channel_names == ("rec.a", "rec.b")


def test_matlab_7_3_is_read_as_the_hdf5_it_is(tmp_path: Path) -> None:
    """User block, column-major matrix, a cell array of char arrays: as MATLAB's save -v7.3 lays it out."""
    with h5py.File(tmp_path / "r.mat", "w", userblock_size=512) as file:
        file["data"] = Y  # MATLAB's 50 × 2
        file["Fs"] = np.array([[20.0]])
        references = file.create_dataset("channel_names", (1, 2), dtype=h5py.ref_dtype)
        for i, name in enumerate("ab"):
            text = file.create_dataset(f"#refs#/{name}", data=np.array([[ord(name)]], dtype="u2"))
            text.attrs["MATLAB_class"] = np.bytes_("char")
            references[0, i] = text.ref
        note = file.create_dataset("note", data=np.array([[104], [105]], dtype="u2"))
        note.attrs["MATLAB_class"] = np.bytes_("char")
    (tmp_path / "r.json").write_text(BESIDE)
    np.testing.assert_allclose(read_record(tmp_path / "r.mat").data, Y * 9.80665, rtol=1e-15)


def test_hdf5_attributes_give_rate_and_unit(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        group = file.create_group("turbine/acc")
        group.attrs["sample_rate_hz"] = 20.0
        for name, row in zip("ab", Y, strict=True):
            group.create_dataset(f"acc_{name}", data=row).attrs["unit"] = "mg"
    record = read_record(tmp_path / "r.h5")
    assert record.channel_names == ("turbine/acc/acc_a", "turbine/acc/acc_b")
    np.testing.assert_allclose(record.data, Y * 9.80665e-3, rtol=1e-15)


@pytest.mark.parametrize(("key", "value"), [("fs", 20.0), ("wf_increment", 0.05)])
def test_a_dataset_may_hold_its_rate(key: str, value: float, tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        item = file.create_dataset("2024/acc_x", data=Y[0])
        item.attrs[key] = value
        item.attrs["unit_string"] = "g"
    record = read_record(tmp_path / "r.h5")
    assert record.sample_rate_hz == pytest.approx(20.0)
    np.testing.assert_allclose(record.data[0], Y[0] * 9.80665, rtol=1e-15)


def test_a_missing_package_names_its_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_h5(tmp_path / "r.h5", data=Y)

    def absent(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr(hdf5, "import_module", absent)
    with pytest.raises(MissingExtra, match=r"r.h5.*pip install 'jackettwin\[hdf5\]'"):
        read_record(tmp_path / "r.h5")


def test_pickled_objects_are_never_loaded(tmp_path: Path) -> None:
    np.savez(tmp_path / "r.npz", data=np.array([{"a": 1}], dtype=object))
    with pytest.raises(InputError, match="allow_pickle"):
        read_record(tmp_path / "r.npz")


@pytest.mark.parametrize(("save", "extension"), [(save_mat, ".mat"), (save_h5, ".h5"), (save_npz, ".npz")])
@pytest.mark.parametrize("units", [["g"], ["g", "m/s^2"]])
def test_units_beside_a_matrix_hold_for_its_rows(
    save: Any, extension: str, units: list[str], tmp_path: Path
) -> None:
    data = np.arange(40.0).reshape(2, 20)
    kind: Any = {".mat": object, ".h5": "S", ".npz": str}[extension]
    texts = {"channel_names": ["top_x", "top_y"], "units": units}
    beside = {key: np.array(value, dtype=kind) for key, value in texts.items()}
    save(tmp_path / f"r{extension}", data=data, fs=10.0, **beside)
    record = read_record(tmp_path / f"r{extension}")
    factors = np.array([[9.80665], [9.80665 if len(units) == 1 else 1.0]])
    np.testing.assert_allclose(record.data, factors * data, rtol=1e-15)


def test_an_attribute_of_the_matrix_is_the_unit_of_its_rows(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file["acc"] = np.arange(40.0).reshape(2, 20)
        file["acc"].attrs["units"], file["acc"].attrs["fs"] = "mg", 10.0
    assert read_record(tmp_path / "r.h5").data[0, 1] == pytest.approx(9.80665e-3)


def test_units_that_do_not_fit_the_matrix_are_refused(tmp_path: Path) -> None:
    save_npz(tmp_path / "r.npz", data=np.zeros((3, 20)), fs=10.0, units=np.array(["g", "g"]))
    with pytest.raises(InputError, match=r"units and channels disagree.*one unit, or 3.*one unit a channel"):
        read_record(tmp_path / "r.npz")


def test_vectors_that_all_differ_in_length_are_refused_by_name(tmp_path: Path) -> None:
    save_mat(tmp_path / "r.mat", acc_x=np.zeros(60), acc_y=np.zeros(59), fs=10.0)
    with pytest.raises(InputError, match=r"vectors differ in length.*acc_x \(60\), acc_y \(59\)"):
        read_record(tmp_path / "r.mat", FileDefaults(unit="g"))


def test_vectors_of_another_length_are_left_out_with_a_remark(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).normal(size=(3, 60))
    save_mat(tmp_path / "r.mat", acc_x=noise[0], acc_y=noise[1], wind=noise[2, :6], fs=10.0)
    record = read_record(tmp_path / "r.mat", FileDefaults(unit="g"))
    assert record.channel_names == ("acc_x", "acc_y")
    assert record.metadata["remarks"] == ["vectors of another length than 60 are left out: wind (6)"]
    assert [f.text for f in assess(record).findings if f.code == "file"] == record.metadata["remarks"]


def test_times_of_another_length_are_refused(tmp_path: Path) -> None:
    save_npz(tmp_path / "r.npz", acc_x=np.zeros(60), acc_y=np.zeros(60), time=np.arange(59.0))
    with pytest.raises(InputError, match=r"times and channels differ in length.*59.*60"):
        read_record(tmp_path / "r.npz", FileDefaults(unit="g"))
