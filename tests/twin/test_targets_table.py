"""A consultant's table becomes the targets of a twin: by name, with ± or columns, in percent or not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.study.fit_data import target_modes
from jackettwin.study.narrative import cautions
from jackettwin.twin import read_twin
from jackettwin.twin.targets_table import read_targets_table


def table(path: Path, *lines: str) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_columns_of_standard_deviations_in_percent(tmp_path: Path) -> None:
    path = table(
        tmp_path / "m.csv",
        "No.;Mode;Frequency [Hz];Std [Hz];Damping [%];Std damping [%];Remark",
        "1;1st FA;0,1819;0,0008;1,27;0,4;good",
        "2;1st SS;0,1835;0,0009;;;rotor",
    )
    first, second = read_targets_table(path)
    assert first == {
        "mode": "1st FA",
        "frequency_hz": 0.1819,
        "frequency_std_hz": 0.0008,
        "damping_ratio": pytest.approx(0.0127),
        "damping_ratio_std": pytest.approx(0.004),
    }
    assert second == {"mode": "1st SS", "frequency_hz": 0.1835, "frequency_std_hz": 0.0009}


def test_a_column_of_bare_deviations_is_of_the_quantity_before_it(tmp_path: Path) -> None:
    """±15 % of a damping ratio's column was taken for 0.15 Hz of the frequency."""
    path = table(tmp_path / "m.csv", "Mode;Freq. [Hz];+/-;Damping [%];+/-", "1st FA;0,2467;0,001;0,81;0,15")
    (only,) = read_targets_table(path)
    assert only["frequency_std_hz"] == 0.001
    assert only["damping_ratio_std"] == pytest.approx(0.0015)
    share = table(tmp_path / "s.csv", "Mode,Freq. [Hz],std [%]", "FA1,0.25,0.4")
    with pytest.raises(InputError, match="is in per cent of the frequency.*Hz"):
        read_targets_table(share)


@pytest.mark.parametrize(("unit", "value", "std"), [("mHz", "181,9", "0,8"), ("rad/s", "1,14291", "0,00503")])
def test_a_frequency_is_in_the_unit_that_its_column_says(
    tmp_path: Path, unit: str, value: str, std: str
) -> None:
    """The unit was passed over, and 1.47 rad/s taken for the mode near 1.47 Hz."""
    path = table(tmp_path / "m.csv", f"Mode;Frequency [{unit}];±", f"1st FA;{value};{std}")
    (only,) = read_targets_table(path)
    assert only["frequency_hz"] == pytest.approx(0.1819, rel=1e-4)
    assert only["frequency_std_hz"] == pytest.approx(0.0008, rel=1e-2)


def test_plus_minus_behind_the_value(tmp_path: Path) -> None:
    path = table(
        tmp_path / "m.csv",
        "mode,f (Hz),damping",
        "SS1,0.25 ± 0.001,1.2 ± 0.3 %",
        "fore_aft_2,1.01 +/- 0.01,0.02",
        "5,1.3,–",
    )
    one, two, three = read_targets_table(path)
    assert one["frequency_std_hz"] == 0.001
    assert (one["damping_ratio"], one["damping_ratio_std"]) == (pytest.approx(0.012), pytest.approx(0.003))
    assert (two["frequency_std_hz"], two["damping_ratio"]) == (0.01, 0.02)
    assert three == {"mode": 5, "frequency_hz": 1.3}


def test_intervals_of_95_percent_are_two_standard_deviations_wide(tmp_path: Path) -> None:
    path = table(tmp_path / "m.csv", "mode,frequency_hz,±95% [Hz]", "FA1,0.25,0.00196")
    assert read_targets_table(path)[0]["frequency_std_hz"] == pytest.approx(1e-3, rel=1e-4)


def test_a_decrement_is_no_ratio_and_a_row_without_numbers_no_mode(tmp_path: Path) -> None:
    """ζ = δ/2π of small damping; as spreadsheets write it, in UTF-16."""
    path = tmp_path / "m.csv"
    text = "Mode\tf [Hz]\tDamping [log. dec.]\n1st FA\t0.25\t0.0628 ± 0.00628\n2nd FA\t-\tn.a.\n"
    path.write_bytes(text.encode("utf-16"))
    (only,) = read_targets_table(path)
    assert only["damping_ratio"] == pytest.approx(0.01, rel=1e-3)
    assert only["damping_ratio_std"] == pytest.approx(0.001, rel=1e-3)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["mode,f [Hz],damping", "FA1,0.25,1.2"], "seems to be a percentage"),
        (["mode,f [Hz]", "FA1,about 0.25"], "row 2.f \\[Hz\\]: is not a number"),
        (["what,f [Hz]", "FA1,0.25"], "no column for the name of the mode"),
        (["mode,value", "FA1,0.25"], "no column for the frequency"),
        (["mode,f [Hz]"], "contains no modes"),
        (["Mode,Frequency [Hz]", "1st FA,0,1819"], "row 2: has more cells than"),
    ],
)
def test_what_is_not_understood_is_named(tmp_path: Path, lines: list[str], message: str) -> None:
    path = table(tmp_path / "m.csv", *lines)
    with pytest.raises(InputError, match=message) as refused:
        read_targets_table(path)
    assert refused.value.file == path


def test_a_twin_takes_the_table_and_names_among_its_targets(tmp_path: Path) -> None:
    """The reference jacket's modes 1 and 2 are its first side-side and fore-aft ones, in some order."""
    table(tmp_path / "m.csv", "mode,f [Hz],std [Hz]", "1st FA,0.18,0.001", "1st SS,0.181,0.001")
    (tmp_path / "twin.yaml").write_text("structure: jacket15\ntargets: m.csv\n")
    config = read_twin(tmp_path / "twin.yaml")
    assert sorted(target.mode for target in config.targets) == [1, 2]
    (tmp_path / "twin.yaml").write_text("structure: jacket15\ntargets: [{mode: FA9, frequency_hz: 0.2}]\n")
    with pytest.raises(InputError, match="no mode of the structure has this name") as refused:
        read_twin(tmp_path / "twin.yaml")
    assert refused.value.field == "targets.0.mode"


def test_a_logger_is_told_once_for_all_records(tmp_path: Path) -> None:
    head = "structure: jacket15\nrecords: [a.csv]\nlogger: "
    (tmp_path / "twin.yaml").write_text(head + "{unit: mg, clock: +02:00, sample_rate_hz: 25}\n")
    defaults = read_twin(tmp_path / "twin.yaml").defaults
    assert (defaults.unit, defaults.timezone, defaults.sample_rate_hz) == ("mg", "+02:00", 25.0)
    (tmp_path / "twin.yaml").write_text(head + "{clock: here}\n")
    with pytest.raises(InputError, match="is not a time zone") as refused:
        read_twin(tmp_path / "twin.yaml")
    assert refused.value.field == "logger.clock"


def test_frequencies_alone_are_given_their_modes_and_the_assignment_is_said(tmp_path: Path) -> None:
    """Pinned, the jacket has .1832 .1859 .5720 .7489 .7941 Hz (thesis, chapter 5)."""
    table(tmp_path / "m.csv", "frequency [Hz],mode", "0.7362,", "0.1838,", "0.1819,side_side_1")
    (tmp_path / "t.yaml").write_text("structure: jacket15\ntargets: m.csv\n")
    config = read_twin(tmp_path / "t.yaml")
    assert [(t.mode, t.frequency_hz) for t in config.targets] == [(4, 0.7362), (2, 0.1838), (1, 0.1819)]
    assert config.assigned == (4, 2)
    measured = target_modes(config, tuple(f"mode_{k}" for k in range(1, 13)), pinned_hz=np.full(12, 0.75))
    (said,) = [line for line in cautions(config, None, measured, ()) if "without a mode's name" in line]
    assert "0.7362 Hz is mode_4 (mode 4)" in said and "0.1838 Hz is mode_2" in said and "0.1819" not in said


def test_a_frequency_that_is_no_mode_is_refused_with_the_nearest(tmp_path: Path) -> None:
    (tmp_path / "t.yaml").write_text(
        "structure: jacket15\ngravity: false\ntargets: [{frequency_hz: 0.182}, {frequency_hz: 0.09}]\n"
    )
    message = r"t\.yaml: targets\.frequency_hz: is near no mode .*0\.09.*nearest is mode 1"
    with pytest.raises(InputError, match=message):
        read_twin(tmp_path / "t.yaml")


def test_german_columns_are_read_and_others_said(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A damping column that was passed over in silence made a foundation without a word on its damping."""
    columns = "Mode;Frequenz [Hz];Abweichung [Hz];Dämpfung [%];Prüfer"
    with caplog.at_level("WARNING"):
        (target,) = read_targets_table(
            table(tmp_path / "m.csv", columns, "1st FA;0,2531;0,0008;1,02 ± 0,3;A")
        )
    assert target["damping_ratio"] == pytest.approx(0.0102)
    assert target["damping_ratio_std"] == pytest.approx(0.003)
    assert target["frequency_std_hz"] == pytest.approx(0.0008)
    assert caplog.messages == ["table of modes: columns that are not used: Prüfer"]
