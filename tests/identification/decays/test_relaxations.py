"""Relaxations after a release: found with an honest interval, and not with less than the limit says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from click.testing import CliRunner
from scipy import signal, stats

from jackettwin import read_record, read_structure
from jackettwin.cli.main import main
from jackettwin.identification import IdentificationSettings, identify, release_relaxations
from jackettwin.identification.decays.relaxations import POWER, amplitude_test, onset
from jackettwin.records import Channel, Record
from jackettwin.response import build_system, damped_modes
from jackettwin.soil import read_support
from jackettwin.structure import Rayleigh, assemble

RATE_HZ, F, ZETA = 5.0, np.array([0.2, 0.7]), np.array([0.008, 0.012])
RATES = np.array([0.05, 0.3, 1.0])
ZENER = "zener:k0=2.0e9,c=3.0e9,k1=2.0e9"


def decays(rng: np.random.Generator, slow: np.ndarray, rate: float, *, colour: float = 0.0) -> np.ndarray:
    """Return two modes, a slow part (n_channels,) at a rate, and noise, white or of first order."""
    t = np.arange(1500) / RATE_HZ
    poles = 2.0 * np.pi * F * (-ZETA + 1j * np.sqrt(1.0 - ZETA**2))
    modes = (np.array([[1.0, 0.5], [0.6, -0.4]]) @ np.exp(np.outer(poles, t))).real
    noise = rng.normal(size=(2, len(t)))
    noise = signal.lfilter([1.0], [1.0, -colour], noise)
    return modes + np.outer(slow, np.exp(-rate * t)) + 0.01 * noise


@pytest.mark.parametrize("colour", [0.0, 0.6])
def test_a_false_alarm_is_as_rare_as_it_says(colour: float) -> None:
    """One rate, one channel: 5 % both ways. Several: Bonferroni's 5 % at most, and not never."""
    rng, n = np.random.default_rng(3), 400
    one = many = 0
    for _ in range(n):
        y = decays(rng, np.zeros(2), 1.0, colour=colour)
        one += amplitude_test(y[:1], RATE_HZ, F, ZETA, RATES[1:2]).passed
        many += amplitude_test(y, RATE_HZ, F, ZETA, RATES).passed
    low, high = stats.binom.interval(0.999, n, 0.05)
    assert low <= one <= high
    assert 0 < many <= high


@pytest.mark.parametrize("k", range(3))
@pytest.mark.parametrize("colour", [0.0, 0.6])
def test_at_the_limit_95_percent_are_found(k: int, colour: float) -> None:
    """An amplitude at the stated limit passes its test in 95 % of records, no fewer and no more."""
    rng, n, found = np.random.default_rng(17 + k), 300, 0
    limit = np.mean([
        amplitude_test(decays(rng, np.zeros(2), 1.0, colour=colour), RATE_HZ, F, ZETA, RATES).limit[k, 0]
        for _ in range(40)
    ])  # fmt: skip
    for _ in range(n):
        y = decays(rng, np.array([limit, 0.0]), RATES[k], colour=colour)
        test = amplitude_test(y, RATE_HZ, F, ZETA, RATES)
        found += abs(test.amplitude[k, 0]) > test.critical[k, 0] * test.std[k, 0]
    low, high = stats.binom.interval(0.999, n, POWER)
    assert low <= found <= high


def test_a_mode_too_damped_to_be_fitted_is_no_relaxation() -> None:
    """At 1 Hz with 30 % it dies out like a relaxation of 8 1/s, faster than any rate that is tested."""
    t = np.arange(3000) / 20.0
    pole = 2.0 * np.pi * (-0.3 + 1j * np.sqrt(1.0 - 0.3**2))
    y = np.stack([
        np.cos(2.0 * np.pi * f * t) * np.exp(-2.0 * np.pi * f * 0.015 * t) + a * np.exp(pole * t).real
        for f, a in ((0.28, 0.5), (0.3, 0.3))
    ])  # fmt: skip
    y = np.concatenate([np.zeros((2, 400)), y], axis=1)
    y += 0.003 * np.random.default_rng(2).standard_normal(y.shape)
    channels = tuple(Channel(name, "acceleration", "m/s²") for name in ("x", "y"))
    found = release_relaxations(Record(y, 20.0, channels))
    assert found is not None
    rates = [limit.rate_rad_s for limit in found.limits]
    assert found.pole is None or rates[0] <= found.pole.rate_rad_s <= rates[-1]


def test_half_the_limit_is_mostly_missed() -> None:
    """The limit is no upper bound that anything would pass: at half of it the power is t's, below a half."""
    rng, n, found = np.random.default_rng(5), 200, 0
    limit = amplitude_test(decays(rng, np.zeros(2), 1.0), RATE_HZ, F, ZETA, RATES).limit[1, 0]
    for _ in range(n):
        y = decays(rng, np.array([0.5 * limit, 0.0]), RATES[1])
        test = amplitude_test(y, RATE_HZ, F, ZETA, RATES)
        found += abs(test.amplitude[1, 0]) > test.critical[1, 0] * test.std[1, 0]
    assert found < 0.5 * n


def released(rng: np.random.Generator, slow: float, *, wait_s: float = 12.0) -> Record:
    y = decays(rng, np.array([slow, -0.5 * slow]), 0.3)
    still = 0.01 * rng.normal(size=(2, round(wait_s * RATE_HZ)))
    return Record(
        np.hstack([still, y]),
        RATE_HZ,
        tuple(Channel(n, "displacement", "m") for n in ("a", "b")),
        name="let go",
    )


def test_the_interval_of_the_rate_holds_the_truth_in_90_percent() -> None:
    rng, n, inside, widths = np.random.default_rng(11), 30, 0, []
    for _ in range(n):
        found = release_relaxations(released(rng, 0.2))
        assert found is not None and found.pole is not None
        low, high = found.pole.rate_interval_90
        inside += low < 0.3 < high
        widths.append(high / low)
    assert np.median(widths) < 1.5
    assert inside >= stats.binom.ppf(0.0005, n, 0.9)


def test_an_error_of_the_modes_is_no_relaxation() -> None:
    """A companion 0.3 % beside a mode is to first order its derivative: it adds nothing to the amplitudes."""
    rng = np.random.default_rng(12)
    t = np.arange(1500) / RATE_HZ
    pole = 2.0 * np.pi * 1.003 * F[0] * (-ZETA[0] + 1j * np.sqrt(1.0 - ZETA[0] ** 2))
    y = decays(rng, np.array([0.2, -0.1]), RATES[1])
    alone = amplitude_test(y, RATE_HZ, F, ZETA, RATES).amplitude[1]
    beside = amplitude_test(y + np.exp(pole * t).real, RATE_HZ, F, ZETA, RATES).amplitude[1]
    np.testing.assert_allclose(beside, alone, rtol=0.02)


def test_where_it_is_let_go() -> None:
    rng = np.random.default_rng(2)
    record = released(rng, 0.2, wait_s=30.0)
    assert onset(record.data, RATE_HZ, 0.2) == pytest.approx(30.0, abs=1.0)
    found = release_relaxations(record)
    assert found is not None and found.pole is not None
    # the amplitude is stated at the release: 0.2 and −0.1, within what half a second of onset makes
    np.testing.assert_allclose(found.amplitude, [0.2, -0.1], rtol=0.25)
    assert onset(released(rng, 0.2, wait_s=0.0).data, RATE_HZ, 0.2) == 0.0


@pytest.mark.parametrize("data", ["noise", "constant", "short", "gap"])
def test_what_is_no_release_is_none(data: str) -> None:
    rng = np.random.default_rng(4)
    y = {
        "noise": rng.normal(size=(1, 3000)),
        "constant": np.r_[np.ones(2999), 1.0 + 1e-9][None],
        "short": rng.normal(size=(1, 100)),
        "gap": np.where(np.arange(3000) < 2990, np.nan, rng.normal(size=3000))[None],
    }[data]
    channels = (Channel("a", "acceleration"), Channel("b", "acceleration"))
    record = Record(np.vstack([y, rng.normal(size=y.shape)]), 20.0, channels)
    assert release_relaxations(record) is None


@pytest.fixture(scope="module")
def pulled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Pull the reference jacket on Zener feet aside and let it go; noise of 0.01 to 0.1 mm."""
    folder = tmp_path_factory.mktemp("pull")
    sensors = [
        {"channel": "top_x", "node": "tower_top", "direction": [1, 0, 0], "noise": 1e-4},
        {"channel": "foot_1_z", "node": "foot_1", "direction": [0, 0, 1], "noise": 1e-5},
        {"channel": "foot_2_z", "node": "foot_2", "direction": [0, 0, 1], "noise": 1e-5},
    ]
    scenario = {
        "structure": "jacket15", "support": ZENER,
        "damping": {"rayleigh": {"ratio": 0.0055, "frequency_hz": 0.183}},
        "start": {"node": "tower_top", "direction": [1, 0, 0], "force_n": 2.0e6, "release_s": 20},
        "time": {"duration_s": 400, "step_s": 0.04},
        "sensors": [{**one, "quantity": "displacement"} for one in sensors],
    }  # fmt: skip
    (folder / "pull.yaml").write_text(yaml.safe_dump(scenario))
    reply = CliRunner().invoke(
        main, ["simulate", str(folder / "pull.yaml"), "--out", str(folder / "pull.parquet"), "--json"]
    )
    assert reply.exit_code == 0, reply.output
    return folder / "pull.parquet"


def test_a_pull_of_a_jacket_shows_the_real_poles_of_its_feet(pulled: Path) -> None:
    """Twelve real poles lie between 0.33 and 0.36 rad/s: one relaxation of a rate among them."""
    reply = CliRunner().invoke(main, ["identify", str(pulled), "--real-poles", "--json"])
    assert reply.exit_code == 0, reply.output
    document = json.loads(reply.stdout)
    assembly = assemble(read_structure("jacket15"), gravity=True)
    support = read_support(ZENER, assembly.structure)
    system = build_system(assembly, support, rayleigh=Rayleigh.minimum(0.0055, 0.183))
    true = np.abs(damped_modes(system, below_hz=1.0).real_poles)
    (pole,) = document["real_poles"]
    # the slowest carry the overturning, which the pull loads: within their spread and the interval's
    low, high = pole["rate_interval_90"]
    assert low < true.max() and high > 0.99 * true.min()
    limits = document["real_pole_limits"]
    assert limits["kind"] == "release" and limits["power"] == 0.95
    assert limits["release_s"] == pytest.approx(20.0, abs=2.0)
    near = min(limits["limits"], key=lambda one: abs(np.log(one["rate_rad_s"] / pole["rate_rad_s"])))
    assert abs(limits["amplitude"]["foot_1_z"]) > 10.0 * near["amplitude"]["foot_1_z"]


def test_python_finds_the_same_and_text_says_it(pulled: Path) -> None:
    settings = IdentificationSettings(real_poles=True)
    record = read_record(pulled)
    (pole,) = identify(record, settings).real_poles
    found = release_relaxations(record)
    assert found is not None and found.pole is not None
    assert found.pole.rate_rad_s == pole.rate_rad_s
    reply = CliRunner().invoke(main, ["identify", str(pulled), "--real-poles"])
    assert reply.exit_code == 0 and "release at" in reply.stdout and "95 % power" in reply.stdout
