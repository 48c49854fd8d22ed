"""Names of real loggers say place and direction; what they do not say is not guessed."""

from __future__ import annotations

import pytest

from jackettwin.records.readers.channel_names import read_name, read_names, told

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("name", "direction", "height_m", "level"),
    [
        ("acc_top_x", X, None, "tower top"),
        ("acc_x_77m", X, 77.0, ""),
        ("ACC_088m_E", X, 88.0, ""),
        ("ACC_088m_N", Y, 88.0, ""),
        ("TT_FA", X, None, "tower top"),
        ("TP_SS", Y, None, "transition piece"),
        ("Acc TwrTop FA", X, None, "tower top"),
        ("TowerMid_SS", Y, None, "tower middle"),
        ("Stop_x", X, None, ""),
        ("a89m_E", X, 89.0, ""),
        ("WTG_TW_ACC_LAT097_FA", X, 97.0, ""),
        ("SG_LAT-003_DEG000", None, -3.0, ""),
        ("acc_lat_5.5m", None, 5.5, ""),
        ("acc_lat_2", None, None, ""),  # the second lateral sensor as likely as two metres above LAT
        ("acc_lat_12", None, None, ""),
        ("tower_bottom_side_side", Y, None, "tower bottom"),
        ("acc-12.5m-y", Y, 12.5, ""),
        ("az", Z, None, ""),
        ("Beschl_87m_O", X, 87.0, ""),
        ("Turm Süd 21m", (0.0, -1.0, 0.0), 21.0, ""),
        ("TW_ACC_LAT41_090deg_X", X, 41.0, ""),
        ("TW_ACC_LAT41_090deg_Y", Y, 41.0, ""),
        ("TP_ACC_LAT19_315deg_X", (-0.707107, 0.707107, 0.0), 19.0, "transition piece"),
        ("TP_ACC_LAT19_315deg_Y", (-0.707107, -0.707107, 0.0), 19.0, "transition piece"),
        ("TP_ACC_LAT19_315deg_Z", Z, 19.0, "transition piece"),
        ("B_Turm_E_65m", X, 65.0, ""),
        ("B_Turm_N_65m", Y, 65.0, ""),
        ("B_Turm_S-12.5m", (0.0, -1.0, 0.0), 12.5, ""),
        ("acc W 088m", (-1.0, 0.0, 0.0), 88.0, ""),
        ("Sensor 3 West", (-1.0, 0.0, 0.0), None, ""),
        ("Beschl_144m_Längs", X, 144.0, ""),
        ("Beschl_144m_Quer", Y, 144.0, ""),
        ("acc longitudinal TP", X, None, "transition piece"),
        ("Transverse 3", Y, None, ""),
        ("Querschnitt 3", None, None, ""),
    ],
)
def test_what_names_say(
    name: str, direction: tuple[float, float, float] | None, height_m: float | None, level: str
) -> None:
    found = read_name(name)
    assert (found.direction, found.height_m, found.level) == (direction, height_m, level)


@pytest.mark.parametrize(
    "name",
    [
        "ch1",
        "acc_1",
        "speed_10min",
        "acc_leg_a",
        "YawBrTAxp",
        "wave",
        "acc_end",
        "x_ss",
        "acc_-x",
        "a_10m_s2",
        "S_12",
        "N_65mm",
        "w_10m/s2",
        "Turm_65m_W_3",
    ],
)
def test_names_that_say_no_direction(name: str) -> None:
    assert read_name(name).direction is None


@pytest.mark.parametrize("name", ["x_100mm", "acc_g77_y", "speed_10min", "a_10m/s2", "acc_12m_to_15m"])
def test_names_that_say_no_height(name: str) -> None:
    assert read_name(name).height_m is None


def test_what_was_taken_is_told_once_a_thing() -> None:
    names = ("ACC_088m_E", "ACC_088m_N", "LAT021_E", "acc_top_x")
    (remark,) = told({name: read_name(name) for name in names})
    assert "88 m (ACC_088m_E, ACC_088m_N)" in remark
    assert "21 m above lowest astronomical tide, taken as mean sea level (LAT021_E)" in remark
    assert "east is +x (ACC_088m_E, LAT021_E)" in remark
    assert "north is +y (ACC_088m_N)" in remark
    assert "acc_top_x" not in remark


def test_what_goes_without_saying_is_not_told() -> None:
    assert told({"acc_top_x": read_name("acc_top_x")}) == ()


@pytest.mark.parametrize(
    "pattern", ["WEA3_{}_Beschl_30m", "A_{}30", "WTG07_TWR_{}_L0", "L30_{}1", "B_Turm_{}_oben"]
)
@pytest.mark.parametrize("letters", ["EN", "ON", "xy", "XY"])
def test_names_that_differ_by_a_direction_explain_each_other(pattern: str, letters: str) -> None:
    east, north = (pattern.format(letter) for letter in letters)
    found = read_names([north, east, pattern.format(7)])
    assert (found[east].direction, found[north].direction) == (X, Y)
    assert read_names([pattern.format(7)])[pattern.format(7)].direction is None
    if read_name(east).direction is None:
        assert read_names([east, pattern.format(7)])[east].direction is None  # alone it may be anything


def test_letters_without_one_across_say_nothing() -> None:
    for names in (["leg_a_1", "leg_b_1"], ["Sensor_E4", "Sensor_F4"], ["N_3", "N_4"], ["x_e_1", "y_n_2"]):
        assert [reading.direction for reading in read_names(names).values()] == [
            read_name(name).direction for name in names
        ]
