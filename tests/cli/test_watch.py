"""``jackettwin watch``: tables as people write them, and what is wrong with them."""

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner, Result

from jackettwin.change import WorkingRotor
from jackettwin.change.modal_table import read_modal_table
from jackettwin.change.table_monitoring import watch_table
from jackettwin.cli import main
from jackettwin.decks import read_structure
from jackettwin.errors import InputError

Columns = dict[str, np.ndarray]


def invoke(path: Path, *options: str) -> Result:
    return CliRunner().invoke(main, ["watch", str(path), *options])


@pytest.fixture
def wide() -> Columns:
    """Return two modes twice a day for 160 days; both lose 1 % on day 120."""
    rng = np.random.default_rng(3)
    days = np.arange(0.0, 160.0, 0.5)
    f = np.array([0.3, 1.1]) * np.exp(0.002 * rng.standard_normal((days.size, 2)))
    f *= np.where(days >= 120.0, 0.99, 1.0)[:, None]
    time = np.datetime64("2024-03-01", "ms") + (days * 86400e3).astype("timedelta64[ms]")
    return {"time": time, "f1": f[:, 0], "f2": f[:, 1], "temperature": 10 + rng.standard_normal(days.size)}


def written(columns: Columns, path: Path) -> Path:
    table = pa.table(columns)
    if path.suffix == ".csv":
        pacsv.write_csv(table, path)
    else:
        pq.write_table(table, path)
    return path


def long(wide: Columns) -> Columns:
    n = len(wide["time"])
    return {
        "time_utc": np.repeat(wide["time"], 2),
        "label": np.tile(["fore_aft_1", "fore_aft_2"], n),
        "frequency_hz": np.column_stack([wide["f1"], wide["f2"]]).ravel(),
        "temperature": np.repeat(wide["temperature"], 2),
    }


def test_a_table_of_one_column_a_mode(wide: Columns, tmp_path: Path) -> None:
    out = tmp_path / "out"
    options = ("--columns", "f1,f2", "--baseline-days", "90", "--out", str(out), "--json")
    done = invoke(written(wide, tmp_path / "bridge.csv"), *options)
    assert done.exit_code == 0, done.stderr
    document = json.loads(done.stdout)
    (alarm,) = document["alarms"]
    assert "2024-06-29" <= alarm["time_utc"][:10] <= "2024-07-06"  # day 120 is 2024-06-29
    assert alarm["began_interval_90"][0] <= "2024-06-29" <= alarm["began_interval_90"][1]
    assert alarm["quantities"] == ["f1", "f2"]
    assert alarm["size_interval_90"][0] < -0.01 < alarm["size_interval_90"][1] < 0.0
    assert alarm["causes"][0]["cause"] == "all modes alike"
    assert set(document["quantities"]["f1"]["explained_by"]) == {"temperature", "slow, unexplained", "noise"}
    assert any("no standard deviations" in limit for limit in document["limits"])
    assert sorted(p.name for p in out.iterdir()) == ["report.html", "watched.json"]
    assert json.loads((out / "watched.json").read_text()) == document
    page = (out / "report.html").read_text()
    assert "the changes that the most likely causes predict" in page and "all modes alike" in page


def test_one_row_a_mode_says_the_same(wide: Columns, tmp_path: Path) -> None:
    options = ("--baseline-days", "90", "--json")
    one = invoke(written(wide, tmp_path / "a.csv"), "--columns", "f1,f2", *options)
    other = invoke(written(long(wide), tmp_path / "b.parquet"), *options)
    assert other.exit_code == 0, other.stderr
    a, b = (json.loads(done.stdout)["alarms"] for done in (one, other))
    assert [x["time_utc"] for x in a] == [x["time_utc"] for x in b]
    assert b[0]["quantities"] == ["fore_aft_1", "fore_aft_2"]


def test_a_german_table_says_the_same_as_an_english_one(tmp_path: Path) -> None:
    """The headings that ``targets`` understand; a spread of the wind is none of the modes'."""
    english, german = tmp_path / "a.csv", tmp_path / "b.csv"
    english.write_text(
        "time_utc,label,frequency_hz,frequency_std_hz,damping_ratio,air,wind std\n"
        "2024-01-08T12:00Z,fore_aft_1,0.2808,0.001,0.0084,3.4,0.7\n"
        "2024-01-08T12:00Z,side_side_2,1.2160,0.005,0.0543,3.4,0.7\n"
    )
    german.write_text(
        "Zeit;Mode;Frequenz [mHz];Std [mHz];Dämpfung [%];air;wind std\n"
        "08.01.2024 12:00;1st FA;280,8;1,0;0,84;3,4;0,7\n"
        "08.01.2024 12:00;2nd SS;1216,0;5,0;5,43;3,4;0,7\n",
        encoding="cp1252",
    )
    a, b = (read_modal_table(path).history for path in (english, german))
    assert a.labels == b.labels == ("fore_aft_1", "side_side_2")
    assert a.condition_names == b.condition_names == ("air", "wind std")
    for name in ("days", "frequency", "frequency_std", "damping", "conditions"):
        np.testing.assert_allclose(getattr(b, name), getattr(a, name), rtol=1e-12)
    german.write_text("Zeit;Mode;Eigenwert\nkeine Zeit;1;2\n")
    with pytest.raises(InputError, match=r"frequency_hz: no such column .*Eigenwert"):
        read_modal_table(german)


def test_a_table_as_analysts_export_it_says_the_same(wide: Columns, tmp_path: Path) -> None:
    """Titles above, numbered rows, the newest first, and another mode beside those that are watched."""
    n = len(wide["time"])
    other = np.linspace(1.0, 1.1, n) + 0.01 * np.cos(np.arange(n))
    more = {"T1": wide["temperature"], "f1_damping": 0.01 * wide["f1"], "f1_damping_std": 0.1 * wide["f2"]}
    plain = written(wide | more, tmp_path / "a.csv").read_text().splitlines()
    header = f'"",{plain[0]},torsion_1,w,w_damping,Status'
    rows = enumerate(zip(plain[1:], other, strict=True))
    body = [f"{i},{line},{x:.4f},{x:.3f},0.01,ok" for i, (line, x) in rows]
    path = tmp_path / "b.csv"
    path.write_text("\n".join(["Modes of 2024,,,,,,,,", "turbine A01", header, *body[::-1]]))
    one = read_modal_table(tmp_path / "a.csv", columns=("f1", "f2"))
    found = read_modal_table(path, columns=("f1", "f2"))
    np.testing.assert_array_equal(found.history.frequency, one.history.frequency)
    assert found.history.condition_names == one.history.condition_names == ("temperature", "T1")
    said = "not taken as conditions: a column without name, torsion_1, w, w_damping, Status"
    assert said in found.remarks and not any("per cent" in remark for remark in found.remarks)
    percent = more | {name: 100.0 * more[name] for name in ("f1_damping", "f1_damping_std")}
    read = read_modal_table(written(wide | percent, tmp_path / "p.csv"), columns=("f1", "f2"))
    np.testing.assert_allclose(read.history.damping, one.history.damping)
    np.testing.assert_allclose(read.history.damping_std, one.history.damping_std)
    assert any("taken as per cent" in remark for remark in read.remarks)
    (tmp_path / "c.xlsx").write_bytes(b"PK\x03\x04 of Excel")
    with pytest.raises(InputError, match="save the sheet as CSV"):
        read_modal_table(tmp_path / "c.xlsx")


def test_learnt_anew_after_the_change_there_is_none(wide: Columns, tmp_path: Path) -> None:
    path = written(wide, tmp_path / "a.csv")
    done = invoke(
        path, "--columns", "f1,f2", "--baseline-days", "25", "--relearn", "2024-07-01T00:00:00Z", "--json"
    )
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["alarms"] == []


def unsorted_times(c: Columns) -> None:
    c["time"][[3, 9]] = c["time"][[9, 3]]


def doubled_time(c: Columns) -> None:
    c["time"][4] = c["time"][3]


def no_times(c: Columns) -> None:
    c["mode"] = c.pop("time").astype(str)
    c["mode"][:] = "x"


def words_for_numbers(c: Columns) -> None:
    c["f1"] = np.array(["good"] * len(c["f1"]))


def three_days(c: Columns) -> None:
    for name in c:
        c[name] = c[name][:6]


def mixed_zones(c: Columns) -> None:
    stamps = np.char.add(c["time"].astype("datetime64[s]").astype(str), "Z")
    stamps[7] = stamps[7][:-1]
    c["time"] = stamps


def no_time_at_all(c: Columns) -> None:
    c["time"] = np.array(["yesterday"] * len(c["time"]))


def std_below_zero(c: Columns) -> None:
    c["f1_std"] = np.full(len(c["f1"]), 0.002)
    c["f1_std"][5] = -0.002


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (no_time_at_all, "is no time (got 'yesterday')"),
        (std_below_zero, "a standard deviation below zero (got -0.002)"),
        (unsorted_times, "times are not sorted"),
        (doubled_time, "a time stands twice"),
        (no_times, "no column of times"),
        (words_for_numbers, "is not a number"),
        (three_days, "too short to learn from"),
        (mixed_zones, "some times have a zone"),
    ],
    ids=lambda x: getattr(x, "__name__", "said"),
)
def test_what_is_wrong_is_refused(wide: Columns, tmp_path: Path, spoil, said: str) -> None:  # type: ignore[no-untyped-def]
    spoil(wide)
    out = tmp_path / "out"
    done = invoke(written(wide, tmp_path / "bad.csv"), "--columns", "f1,f2", "--out", str(out))
    assert done.exit_code == 2, (done.stdout, done.stderr, done.exception)
    assert said in done.stderr and "bad.csv" in done.stderr
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--conditions", "f1"), "cannot be a condition (got 'f1')"),
        (("--arl-years", "nan"), "nan is not a finite number"),
    ],
)
def test_what_makes_no_sense_is_refused(
    wide: Columns, tmp_path: Path, options: tuple[str, ...], said: str
) -> None:
    done = invoke(written(wide, tmp_path / "a.csv"), "--columns", "f1,f2", *options)
    assert done.exit_code == 2 and said in done.stderr


def test_too_short_a_baseline_is_refused_before_the_model_is_asked(wide: Columns, tmp_path: Path) -> None:
    """The refusal came after the causes of a structure, a quarter of a minute later."""
    three_days(wide)
    read = read_modal_table(written(wide, tmp_path / "a.csv"), columns=("f1", "f2"))
    steps: list[str] = []
    with pytest.raises(InputError, match="too short"):
        watch_table(read, structure=read_structure("jacket15"), progress=steps.append)
    assert steps == []


def test_a_twin_gives_its_rotor_at_work(
    wide: Columns, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A parked twin has none; a twin in operation has the stiffness that `update` gives it."""
    table, given = written(wide, tmp_path / "a.csv"), {}

    def seen(*_: object, rotor: WorkingRotor | None, gravity: bool, **others: object) -> None:
        given["rotor"], given["gravity"] = rotor, gravity
        raise InputError("seen enough")

    monkeypatch.setattr("jackettwin.change.table_monitoring.watch_table", seen)
    found = {}
    for state in ("parked", "operating"):
        twin = tmp_path / f"{state}.yaml"
        update = f"update: {{rotor: iea15, rotor_state: {state}, wind_speed_m_s: 12.0}}"
        seen_modes = "targets: [{mode: 1, frequency_hz: 0.18, frequency_std_hz: 0.001}]"
        twin.write_text(f"structure: jacket15\ngravity: true\n{seen_modes}\n{update}\n")
        invoke(table, "--columns", "f1,f2", "--twin", str(twin))
        found[state] = given["rotor"]
    assert found["parked"] is None and given["gravity"] is True
    assert found["operating"].sides["c_fore_aft"].stiffness[0, 0] > 1e4  # N/m
    done = invoke(table, "--columns", "f1,f2", "--twin", str(twin), "--structure", "jacket15")
    assert done.exit_code == 2 and "omit --structure" in done.stderr


def test_a_row_without_a_label_is_refused(wide: Columns, tmp_path: Path) -> None:
    rows = long(wide)
    rows["label"][4] = ""
    done = invoke(written(rows, tmp_path / "a.csv"))
    assert done.exit_code == 2 and "a row without a label (got 'line 6')" in done.stderr


def test_an_unknown_column_is_refused_with_the_nearest(wide: Columns, tmp_path: Path) -> None:
    done = invoke(written(wide, tmp_path / "a.csv"), "--columns", "f1,temprature")
    assert done.exit_code == 2 and "did you mean 'temperature'?" in done.stderr


def test_limits_are_said(wide: Columns, tmp_path: Path) -> None:
    wide["humidity"] = np.full(len(wide["time"]), 0.5)
    done = invoke(written(wide, tmp_path / "a.csv"), "--columns", "f1", "--baseline-days", "90")
    assert done.exit_code == 0, done.stderr
    assert "one mode only" in done.stdout and "left out: humidity" in done.stdout


def still(c: Columns) -> None:
    c["f1"][:] = 0.3


def endless(c: Columns) -> None:
    c["f1"][3] = np.inf


def without_temperature(c: Columns) -> None:
    c["temperature"][200:] = np.nan


def another_state(c: Columns) -> None:
    c["state"] = np.where(np.arange(len(c["time"])) < 220, "parked", "idling")


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (still, "always the same: f1"),
        (endless, "1 values of frequency_hz (f1) that are not above zero or infinite count as missing"),
        (without_temperature, "temperature is missing or always the same in 86 % of the rows watched"),
        (another_state, "not judged: idling (100 rows)"),
    ],
    ids=lambda x: getattr(x, "__name__", "said"),
)
def test_what_cannot_be_judged_is_said(wide: Columns, tmp_path: Path, spoil, said: str) -> None:  # type: ignore[no-untyped-def]
    spoil(wide)
    done = invoke(written(wide, tmp_path / "a.csv"), "--columns", "f1,f2", "--baseline-days", "90")
    assert done.exit_code == 0, (done.stdout, done.stderr)
    assert said in done.stdout


def test_an_alarm_can_be_replayed(wide: Columns, tmp_path: Path) -> None:
    path = written(wide, tmp_path / "a.csv")
    first, again = (invoke(path, "--columns", "f1,f2", "--baseline-days", "90", "--json") for _ in range(2))
    assert json.loads(first.stdout)["alarms"] and first.stdout == again.stdout
    # rows after the alarm change nothing of what was said on its day
    alarm = json.loads(first.stdout)["alarms"][0]
    kept = np.array([str(t) <= alarm["time_utc"][:10] + "T23" for t in wide["time"]])
    short = written({name: x[kept] for name, x in wide.items()}, tmp_path / "short.csv")
    cut = invoke(short, "--columns", "f1,f2", "--baseline-days", "90", "--json")
    (as_told,) = json.loads(cut.stdout)["alarms"]
    assert as_told == {**alarm["at_alarm"], "at_alarm": None}
    assert {key: alarm[key] for key in ("time_utc", "ln_evidence")}.items() <= as_told.items()
    assert alarm["looked_utc"] > as_told["looked_utc"]


def test_the_likeliest_pattern_is_what_was_seen(wide: Columns, tmp_path: Path) -> None:
    table = read_modal_table(written(wide, tmp_path / "a.csv"), columns=("f1", "f2"))
    (alarm,) = watch_table(table, baseline_days=90.0).alarms
    best = alarm.diagnosis.verdicts[0].cause
    step, seen = alarm.patterns[best], alarm.change
    np.testing.assert_array_less(np.abs(step - seen.size), 3.0 * seen.size_std)
    assert np.all(step < 0.0)  # a wrong sign would lie three standard deviations off


def test_a_pair_that_turns_is_found_and_said_in_degrees(wide: Columns, tmp_path: Path) -> None:
    """The lower mode's direction lies about 0°, read as −2° or 178°; from day 120 on it lies at 8°."""
    rng = np.random.default_rng(5)
    n = len(wide["time"])
    turned = np.where(np.arange(n) >= 240, 8.0, 0.0) + 3.0 * rng.standard_normal(n)
    quiet = {k: wide[k] for k in ("time", "temperature")}
    quiet |= {f: wide[f] / np.where(np.arange(n) >= 240, 0.99, 1.0) for f in ("f1", "f2")}
    table = quiet | {"f1_angle_deg": turned % 180.0, "f1_angle_std_deg": np.full(n, 3.0)}
    options = ("--columns", "f1,f2", "--baseline-days", "90", "--json", "--out", str(tmp_path / "out"))
    done = invoke(written(table, tmp_path / "a.csv"), *options)
    assert done.exit_code == 0, done.stderr
    document = json.loads(done.stdout)
    (alarm,) = document["alarms"]
    assert alarm["quantities"] == ["f1 direction"]
    assert alarm["unit"] == "deg"
    assert 0.0 < alarm["size_interval_90"][0] < 8.0 < alarm["size_interval_90"][1]
    assert "2024-06-29" <= alarm["time_utc"][:10] <= "2024-07-09"
    assert alarm["causes"][0]["cause"] == "direction of f1 alone"
    assert "f1 direction by +" in document["statement"] and "°" in document["statement"]
    assert json.loads(invoke(written(quiet, tmp_path / "b.csv"), *options[:5]).stdout)["alarms"] == []


def test_the_slopes_with_conditions_are_said(wide: Columns, tmp_path: Path) -> None:
    """A level that moves ln f by −0.003 per metre, another condition that does nothing."""
    rng = np.random.default_rng(8)
    level = 1.3 * np.cos(np.arange(len(wide["time"])) * 3.1)
    table = {"time": wide["time"], "sea_level_m": level, "idle": rng.standard_normal(level.size)}
    table |= {f: wide[f] * np.exp(-0.003 * level) for f in ("f1", "f2")}
    done = invoke(written(table, tmp_path / "a.csv"), "--columns", "f1,f2", "--baseline-days", "90", "--json")
    for label in ("f1", "f2"):
        found = json.loads(done.stdout)["quantities"][label]["per_unit"]
        # 180 values of 0.2 % at levels that scatter by 0.9 m: 0.00016 per metre
        assert found["sea_level_m"] == pytest.approx(-0.003, abs=6e-4)
        assert abs(found["idle"]) < 6e-4
