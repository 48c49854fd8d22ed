"""Real poles of a twin: from its file or its records, through the update and into what is written."""

import json
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from observations import observation

from jackettwin.errors import InputError
from jackettwin.files.json import null_for_nan
from jackettwin.identification import RealPole
from jackettwin.report.tables.updating import relaxation_table
from jackettwin.response.sensors import Sensor
from jackettwin.study import TwinResult, run_document, run_twin, update_document
from jackettwin.study.relaxations import measured_relaxations
from jackettwin.twin import TwinConfig, TwinState, advance_all, read_twin
from jackettwin.twin.config import GivenRelaxation

GOOD = """\
structure: jacket15
damping: {rayleigh: {ratio: 0.0055, frequency_hz: 0.1832}}
sensors:
  - {channel: z1, node: foot_1, direction: [0, 0, 1]}
  - {channel: z2, node: foot_2, direction: [0, 0, 1]}
targets:
  - {mode: 1, frequency_hz: 0.1807, frequency_std_hz: 0.0007, damping_ratio: 0.0129, damping_ratio_std: 0.002}
  - {rate_rad_s: 3.76, rate_std_rad_s: 0.4}
  - {mode: 4, frequency_hz: 0.735, frequency_std_hz: 0.003}
  - {rate_rad_s: 3.5, rate_std_rad_s: 0.3, mode_shape: {z1: [1.0, 0.1], z2: -0.5}}
update:
  laws: [springpot, kelvin-voigt]
  bounds: {k: [1.0e+9, 1.0e+10], c: [1.0e+8, 5.0e+9]}
  particles: 20
  starts: 2
  model_error: [{rate: 0.05}]
"""


@pytest.fixture
def config(tmp_path: Path) -> TwinConfig:
    (tmp_path / "t.yaml").write_text(GOOD)
    return read_twin(tmp_path / "t.yaml")


def test_the_file_says_rates_and_shapes(config: TwinConfig) -> None:
    assert [target.mode for target in config.targets] == [1, 4]
    first, second = config.relaxations
    assert first == GivenRelaxation(3.76, 0.4)
    assert second.shape == {"z1": 1.0 + 0.1j, "z2": -0.5 + 0j}
    assert config.update.rate_error == pytest.approx(0.05)
    slowest, fastest = measured_relaxations(config, None)
    assert (slowest.name, slowest.rate_rad_s, fastest.name) == ("a1", 3.5, "a2")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rate_rad_s: 3.76", "rate_rad_s: -5.0", r"targets\.1\.rate_rad_s.*greater than 0"),
        ("rate_std_rad_s: 0.4", "rate_std_rad_s: 0", r"targets\.1\.rate_std_rad_s.*greater than 0"),
        ("rate_rad_s: 3.76, ", "", r"targets\.1.*a mode or a relaxation"),
        ("{rate_rad_s: 3.76", "{mode: 2, rate_rad_s: 3.76", r"targets\.1.*a mode or a relaxation"),
        ("{rate_rad_s: 3.76", "{frequency_hz: 0.2, rate_rad_s: 3.76", r"targets\.1.*a mode or a relaxation"),
        ("z2: -0.5", "z3: -0.5", r"targets\.3\.mode_shape.*no sensor.*z3.*z1, z2"),
        ("rate_rad_s: 3.76", "rate_rads: 5.0", r"targets\.1\.rate_rads: unknown key.*did you mean"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    (tmp_path / "t.yaml").write_text(GOOD.replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        read_twin(tmp_path / "t.yaml")


def test_relaxations_alone_are_refused(tmp_path: Path) -> None:
    lines = [line for line in GOOD.splitlines() if "mode:" not in line]
    (tmp_path / "t.yaml").write_text("\n".join(lines))
    with pytest.raises(InputError, match="relaxations alone"):
        read_twin(tmp_path / "t.yaml")


def test_rates_in_another_unit_are_refused(config: TwinConfig) -> None:
    fast = replace(config, relaxations=(GivenRelaxation(3500.0, 1.0),))
    with pytest.raises(InputError, match=r"rate_rad_s.*far above"):
        run_twin(fast)


def test_laws_without_real_poles(config: TwinConfig) -> None:
    with pytest.raises(InputError, match=r"update\.laws.*no structure on this law has real poles"):
        run_twin(config, laws=("springpot",))


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> TwinResult:
    path = tmp_path_factory.mktemp("twin") / "t.yaml"
    path.write_text(GOOD)
    return run_twin(read_twin(path))


def test_the_update_meets_what_it_can(result: TwinResult) -> None:
    """Supports of k/c = 3.29 1/s relax at 3.3 to 3.8."""
    (update,) = result.updates
    assert update.law == "kelvin-voigt" and "springpot: omitted" in result.warnings[0]
    assert update.problem.data_names == ["f1", "ζ1", "f4", "a1", "a2"]
    assert update.best.rates.shape == (2,)
    assert any("a1 (relaxation at 3.5 rad/s)" in one.value for one in result.assumptions)
    assert any("Model error of relaxations: 5 %" in one.value for one in result.assumptions)


def test_documents_and_tables_say_both_rates(result: TwinResult) -> None:
    document = json.loads(json.dumps(null_for_nan(run_document(result, report=None)), allow_nan=False))
    given = document["real_poles"][0]
    assert given["rate_rad_s"] == 3.5 and given["time_constant_s"] == pytest.approx(1 / 3.5)
    assert given["mode_shape"] == {"z1": [1.0, 0.1], "z2": [-0.5, 0.0]} and given["records"] == 0
    row = update_document(result, 0)["real_poles"][0]
    assert row["measured_rate_rad_s"] == 3.5 and row["posterior"]["interval_90"][0] < row["rate_rad_s"] * 1.2
    assert len(relaxation_table(result).rows) == 2


Shown = tuple[tuple[float, float, tuple[float, float]], ...]
"""What one record shows: rates, deviations of ln a, shapes at two channels."""
SENSORS = (Sensor("x", (1.0, 0.0, 0.0), "foot_1"), Sensor("y", (0.0, 1.0, 0.0), "foot_1"))


def in_records(*records: Shown) -> TwinState:
    observations = []
    for i, poles in enumerate(records):
        real_poles = tuple(
            RealPole(a, a * s, (a / 2, 2 * a), np.array(shape, complex), 1.0) for a, s, shape in poles
        )
        start = datetime(2025, 1, 1, i, tzinfo=UTC)
        observations.append(observation({}, start, name=f"r{i}", sensors=SENSORS, real_poles=real_poles))
    return advance_all(TwinState("model"), observations)[0]


def test_records_share_relaxations(config: TwinConfig) -> None:
    """One in two of three records, another shape at its rate in one, a third in two."""
    x, y = (1.0, 0.1), (-0.1, 1.0)
    state = in_records(((3.0, 0.1, x), (3.1, 0.2, y)), ((3.3, 0.2, x), (6.0, 0.1, y)), ((6.6, 0.1, y),))
    found = measured_relaxations(config, state)
    assert [(one.name, one.records) for one in found] == [("a1", 2), ("a2", 2)]
    # precision weights 4 : 1; χ² = (ln 1.1)²/(0.1² + 0.2²) < 1 does not widen the deviation
    assert np.log(found[0].rate_rad_s) == pytest.approx(np.log(3.0) + 0.2 * np.log(1.1))
    assert found[0].rate_std_rad_s == pytest.approx(found[0].rate_rad_s / np.sqrt(125.0))
    # equal deviations of 10 %, apart by ln 1.1: χ² = (ln 1.1)²/0.02 < 1
    assert found[1].rate_rad_s == pytest.approx(6.0 * np.sqrt(1.1))
    assert found[1].channels == ("x", "y")


def test_scatter_between_records_widens_the_deviation(config: TwinConfig) -> None:
    records = tuple(((a, 0.01, (1.0, 0.0)),) for a in (2.0, 2.2, 2.4))
    (found,) = measured_relaxations(config, in_records(*records))
    scatter = np.log([2.0, 2.2, 2.4]).std(ddof=1)
    assert found.rate_std_rad_s == pytest.approx(found.rate_rad_s * scatter / np.sqrt(3.0))
