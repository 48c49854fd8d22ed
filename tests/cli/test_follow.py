"""``jackettwin follow``: tables, files and messages; what is fitted is tested in tests/twin."""

import json
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from jackettwin import study
from jackettwin.cli import main
from jackettwin.study.follow_result import DayEstimate, Followed
from jackettwin.twin import TwinState
from jackettwin.updating.drift import Drift


def found(n_days: int = 3) -> Followed:
    """Return a twin whose stiffness falls by a hundredth a day."""
    days = []
    for i in range(n_days):
        k, eta = 3e9 * 0.99**i, 0.1
        days.append(
            DayEstimate(
                f"2025-01-0{1 + i}",
                datetime(2025, 1, 1 + i, 12, 30, tzinfo=UTC),
                2,
                "evidence",
                {"k": k, "loss_factor": eta},
                {"k": (k / 2, 2 * k), "loss_factor": (0.05, 0.2)},
            )
        )
    z = np.array([np.log(3e9), np.log(0.1), np.log(0.99)])
    drift = Drift(("k", "loss_factor", "growth_per_day"), z, np.diag([1e-2, 1e-2, 1e-6]), 1.0)
    return Followed(
        name="pile",
        law="maxwell-3",
        reference_hz=0.18,
        wind_m_s=12.0,
        units={"k": "N/m", "loss_factor": "-"},
        days=tuple(days),
        drift=drift if n_days >= 3 else None,
        state=TwinState("model"),
        warnings=("r0a: few cycles",),
    )


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch):  # type: ignore[no-untyped-def]
    def invoke(result: Followed, *options: str) -> Result:
        monkeypatch.setattr(study, "follow", lambda *_, **__: result)
        return CliRunner().invoke(main, ["follow", "openfast_pile", *options])

    return invoke


def test_the_table_and_the_statement(run) -> None:  # type: ignore[no-untyped-def]
    done = run(found())
    assert done.exit_code == 0, done.stderr
    assert "2025-01-02 12:30" in done.stdout
    assert (
        "Falling: stiffness changes by -1 % a day, 90 % interval -1.2 to -0.84 %, over 2 days." in done.stdout
    )
    assert "warning: r0a: few cycles" in done.stdout


def test_the_folder_holds_the_next_prior_and_a_page(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    out = tmp_path / "out"
    done = run(found(), "--out", str(out))
    assert done.exit_code == 0, done.stderr
    assert sorted(p.name for p in out.iterdir()) == ["followed.json", "report.html"]
    document = json.loads((out / "followed.json").read_text())
    assert document["drift"]["detected"] is True
    assert document["days"][0]["records"] == 2 and document["wind_speed_m_s"] == 12.0
    again = run(found(), "--prior", str(out / "followed.json"), "--json")
    assert json.loads(again.stdout) == document


def test_before_the_third_day_nothing_is_said_of_a_drift(run) -> None:  # type: ignore[no-untyped-def]
    done = run(replace(found(2), warnings=()))
    assert "Too early to estimate a drift: 3 days with data are needed." in done.stdout
    assert json.loads(run(found(2), "--json").stdout)["drift"] is None


@pytest.mark.parametrize(
    ("text", "message"), [("[", "not a JSON document"), ("{}", "required key is missing")]
)
def test_a_prior_that_is_none(run, tmp_path: Path, text: str, message: str) -> None:  # type: ignore[no-untyped-def]
    path = tmp_path / "prior.json"
    path.write_text(text)
    done = run(found(), "--prior", str(path))
    assert done.exit_code == 2
    assert message in done.stderr


def test_a_prior_that_is_not_there(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = run(found(), "--prior", str(tmp_path / "none.json"))
    assert done.exit_code == 2
    assert "none.json" in done.stderr
