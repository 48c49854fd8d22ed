"""A small form of ``qualify/watching.py``: seasons made by other code, quiet and changed."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from jackettwin.watching import Change, History, Watch, diagnose, general_causes, start, step

BASELINE = 365.0


@pytest.fixture(scope="module")
def made() -> ModuleType:
    """The seasons of the campaign; they import nothing of the package."""
    path = Path(__file__).parents[2] / "qualify" / "common" / "seasons.py"
    spec = importlib.util.spec_from_file_location("qualify_seasons", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def history(s) -> History:  # type: ignore[no-untyped-def]
    beside = np.stack(list(s.conditions.values()), axis=1)
    labels = tuple(f"bending_{k}" for k in range(1, 5))
    return History(
        s.days, labels, s.frequency, s.frequency_std, s.damping, s.damping_std, beside, tuple(s.conditions),
        np.zeros(s.days.size, dtype=np.intp), ("all",), s.angle, s.angle_std,
    )  # fmt: skip


def first_alarm(h: History, until: float, arl_years: float = 10.0) -> tuple[Watch, Change | None]:
    watch = start(h.between(0.0, BASELINE), arl_years=arl_years)
    for day in h.between(BASELINE, until).by_day():
        watch, look = step(watch, day)
        if look.change is not None:
            return watch, look.change
    return watch, None


@pytest.mark.parametrize("memory", ["two days", "flicker"])
def test_quiet_seasons_raise_no_alarm(made: ModuleType, memory: str) -> None:
    """Half a year each at one alarm in ten years: by chance one of twenty would."""
    quiet = history(made.seasons(5001, BASELINE + 180.0, made.Kind(memory=memory)))
    assert first_alarm(quiet, np.inf)[1] is None


def test_mass_is_found_within_weeks_and_named(made: ModuleType) -> None:
    seasons = made.seasons(7001, BASELINE + 120.0)
    begun = BASELINE + 40.0
    heavier = history(seasons.changed(made.step(seasons.days, begun, np.full(4, -0.0025))))
    watch, change = first_alarm(heavier, begun + 60.0)
    assert change is not None and begun <= change.day < begun + 45.0
    causes = general_causes(watch.quantities, watch.labels, made.FREQUENCY_HZ)
    found = diagnose(change, causes, [kind for kind, _ in watch.quantities])
    assert found.verdicts[0].cause == "all modes alike"
    assert np.all(np.abs(change.size[:4] + 0.0025) < 4.0 * change.size_std[:4])


def test_a_failing_sensor_is_no_scour(made: ModuleType) -> None:
    seasons = made.seasons(7002, BASELINE + 60.0)
    begun, rng = BASELINE + 30.0, np.random.default_rng(2)
    hit = ((seasons.days >= begun) & (seasons.days < begun + 10.0))[:, None] & np.array(
        [1, 0, 1, 0], dtype=bool
    )
    louder = np.sqrt(8.0) * rng.standard_normal(hit.shape)  # threefold scatter in all
    ln_f = np.where(hit, 0.001 + louder * seasons.noise_std, 0.0)
    ln_zeta = np.where(hit, louder * seasons.damping_std / seasons.damping, 0.0)
    watch, change = first_alarm(history(seasons.changed(ln_f, ln_zeta)), begun + 14.0)
    assert change is not None and change.day >= begun
    causes = general_causes(watch.quantities, watch.labels, made.FREQUENCY_HZ)
    found = diagnose(change, causes, [kind for kind, _ in watch.quantities])
    assert found.verdicts[0].cause.startswith("sensor")
