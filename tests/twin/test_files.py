"""Twin files: every mistake is refused with file, field, value and remedy."""

from pathlib import Path

import pytest

from jackettwin.errors import InputError
from jackettwin.identification.picks import Pick
from jackettwin.twin import read_twin, shipped_twins

GOOD = """\
structure: jacket15
damping: {rayleigh: {ratio: 0.01, frequency_hz: 0.1832}}
support: {tie: all}
targets:
  - {mode: 1, frequency_hz: 0.1819, damping_ratio: 0.0127}
  - {mode: 4, frequency_hz: 0.7362}
"""


@pytest.mark.parametrize("name", shipped_twins())
def test_shipped_twins_read(name: str) -> None:
    config = read_twin(name)
    assert all(path.exists() for path in config.records)


def test_scientific_notation_without_sign_is_a_number(tmp_path: Path) -> None:
    (tmp_path / "t.yaml").write_text(GOOD + "update: {bounds: {k: [1e8, 5e10]}}\n")
    assert read_twin(tmp_path / "t.yaml").update.bounds["k"] == (1e8, 5e10)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("structure:", "strcture:", r"strcture: unknown key .*did you mean 'structure'"),
        ("rayleigh:", "raleigh:", r"damping\.raleigh: unknown key .*did you mean 'rayleigh'"),
        ("frequency_hz: 0.1819", "frequency_hz: .nan", r"targets\.0\.frequency_hz.*finite"),
        ("frequency_hz: 0.1819", "frequency_hz: -1", r"targets\.0\.frequency_hz.*greater than 0.*-1"),
        ("mode: 4", "mode: 0", r"targets\.1\.mode.*1 to 50"),
        ("ratio: 0.01,", "ratio: 1.5,", r"damping\.rayleigh\.ratio.*< 1"),
        ("jacket15", "jacket51", r"no such structure.*did you mean 'jacket15'"),
        ("tie: all", "tie: some", r"support\.tie.*horizontal-vertical"),
        ("tie: all", "tie: per-leg, shared: [eta]", r"support\.shared.*no such parameter of a law"),
        ("tie: all", "scatter: {k: 0.3}", r"support\.scatter.*share all parameters already"),
        (
            "tie: all",
            "tie: per-leg, shared: [k], scatter: {k: 0.3}",
            r"support\.scatter.*both shared and scattered",
        ),
        ("tie: all", "law: zenner", r"no such law.*did you mean 'zener'"),
        ("support: {tie: all}\n", "support: {tie: all}\nsupport: {tie: all}\n", r"'support' is given twice"),
        ("targets:", "records: [a.parquet]\ntargets:", r"give records or targets"),
        ("{mode: 4", "[mode: 4", r"line 6"),
        (
            "damping_ratio: 0.0127",
            "damping_ratio_std: 0.002",
            r"targets\.0\.damping_ratio_std: a standard deviation is given without its value.*0\.002",
        ),
        (
            "targets:",
            "update: {mac_std: 0.02}\ntargets:",
            r"update\.mac_std: mac_std is given but no target has a shape.*0\.02.*mode_shape",
        ),
        (
            "targets:",
            "update: {weights: {damping: {1: 2.0, 7: 4.0}}}\ntargets:",
            r"update\.weights\.damping: weights of modes that are not fitted .got 7.; allowed: 1, 4;",
        ),
        (
            "targets:",
            "update: {modes: [1, 99]}\ntargets:",
            r"update\.modes: measured modes are paired with the model's first 12.*\[99\].*as targets",
        ),
    ],
)
def test_mistakes_are_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = tmp_path / "t.yaml"
    path.write_text(GOOD.replace(old, new, 1))
    with pytest.raises(InputError, match=message) as caught:
        read_twin(path)
    assert str(path) in str(caught.value)


SHAPED = (
    GOOD.replace("0.0127}", "0.0127, mode_shape: {x: 1.0, y: [0.1, 0.01]}}")
    + """\
sensors:
  - {channel: x, height_m: 50.0, direction: [1, 0, 0]}
  - {channel: y, height_m: 50.0, direction: [0, 1, 0]}
update: {mac_std: 0.02}
"""
)


def test_a_target_may_have_a_shape(tmp_path: Path) -> None:
    path = tmp_path / "t.yaml"
    path.write_text(SHAPED)
    assert read_twin(path).shapes == {1: {"x": 1.0, "y": 0.1 + 0.01j}}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "mac_std: 0.02",
            "starts: 3",
            r"update\.mac_std: fitting shapes needs the standard deviation of 1 − MAC",
        ),
        ("{x: 1.0, y", "{x: 1.0, z", r"targets\.0\.mode_shape: no sensor .*\['z'\].*allowed: x, y"),
        ("{x: 1.0, y: [0.1, 0.01]}", "{x: 1.0}", r"targets\.mode_shape: a shape needs at least two sensors"),
        (
            "frequency_hz: 0.1819,",
            "",
            r"targets\.mode_shape: the target has a shape but no frequency.*frequency_hz",
        ),
    ],
)
def test_shapes_that_cannot_count_are_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = tmp_path / "t.yaml"
    path.write_text(SHAPED.replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        read_twin(path)


def test_targets_are_all_fitted_unless_the_file_says_which(tmp_path: Path) -> None:
    path = tmp_path / "t.yaml"
    path.write_text(GOOD.replace("mode: 4", "mode: 7"))
    assert read_twin(path).update.modes == (1, 2, 3, 4, 5, 7)
    assert read_twin(path).update.damping_of == "all"
    path.write_text(GOOD + "update: {modes: [1], damping_of: none}\n")
    assert read_twin(path).update.modes == (1,)
    assert read_twin(path).update.damping_of == "none"


def test_a_rotor_frees_both_dashpots_unless_one_is_named(tmp_path: Path) -> None:
    path = tmp_path / "t.yaml"
    path.write_text(GOOD + "update: {rotor: iea15, wind_speed_m_s: 10.0}\n")
    assert read_twin(path).update.dashpots == ("c_fore_aft", "c_side_side")
    path.write_text(GOOD + "update: {rotor: iea15, wind_speed_m_s: 10.0, dashpots: [c_side_side]}\n")
    assert read_twin(path).update.dashpots == ("c_side_side",)
    path.write_text(GOOD)
    assert not read_twin(path).update.dashpots


@pytest.mark.parametrize("content", ["", "- a\n- b\n", "just text", "{", "a: [1, 2", "\x00"])
def test_files_that_are_no_twin(tmp_path: Path, content: str) -> None:
    (tmp_path / "t.yaml").write_text(content)
    with pytest.raises(InputError):
        read_twin(tmp_path / "t.yaml")


WITH_RECORDS = "structure: jacket15\nrecords: [a.parquet]\nidentification: "


def test_picks_are_a_list_or_a_file(tmp_path: Path) -> None:
    listed = '[{"frequency_hz": 0.18, "order": 20}]'
    (tmp_path / "picks.json").write_text('{"picks": ' + listed + "}")
    read = []
    for i, given in enumerate((listed, "picks.json")):
        path = tmp_path / f"t{i}.yaml"
        path.write_text(WITH_RECORDS + f"{{picks: {given}, max_order: 30}}")
        read.append(read_twin(path))
    assert read[0].picks == read[1].picks == (Pick(0.18, 20),)
    assert read[0].identification.max_order == 30


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("{picks: [{frequency_hz: -1}]}", r"t\.yaml: identification\.picks\[0\]\.frequency_hz.*-1"),
        ("{picks: gone.json}", r"gone\.json: no such file of picks"),
        ("{picks: 3}", r"t\.yaml: identification\.picks: holds no picks.*3"),
        ("{max_ordr: 3}", r"t\.yaml: identification\.max_ordr: unknown key.*max_order"),
    ],
)
def test_mistakes_in_identification_are_named(tmp_path: Path, given: str, message: str) -> None:
    (tmp_path / "t.yaml").write_text(WITH_RECORDS + given)
    with pytest.raises(InputError, match=message):
        read_twin(tmp_path / "t.yaml")


def test_missing_file() -> None:
    with pytest.raises(InputError, match=r"gone\.yaml: no such twin file"):
        read_twin("gone.yaml")


def test_records_that_follow_need_not_be_named(tmp_path: Path) -> None:
    """`run --simulate` brings its own records; both kinds of data at once stay a mistake."""
    bare = tmp_path / "t.yaml"
    bare.write_text(GOOD[: GOOD.index("targets")])
    with pytest.raises(InputError, match="give records or targets"):
        read_twin(bare)
    config = read_twin(bare, records_follow=True)
    assert (config.records, config.targets) == ((), ())
    bare.write_text(GOOD + "records: [a.parquet]\n")
    with pytest.raises(InputError, match="give records or targets"):
        read_twin(bare, records_follow=True)
