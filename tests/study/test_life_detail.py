"""What damage is made of, what a sensor more would tell, and the page that says so."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.fatigue import WeldLife, count, models_at_height, weld_lives
from jackettwin.fatigue.efthymiou import OutOfRange
from jackettwin.records import Channel, Record
from jackettwin.report.pages.life import life_quantity, worst_welds, write_life_page
from jackettwin.response import Sensor, build_system
from jackettwin.sensing import MotionEstimate, Weather, motion_from, readings_of, sensed_model
from jackettwin.soil import pinned
from jackettwin.structure import Rayleigh, assemble
from jackettwin.study.life.life_detail import bands, candidates, damage_by_band, lost_without, with_one_more
from jackettwin.twin import RestingLoads, WeldMap, weld_map

MODELS = models_at_height("T")


def test_a_band_without_which_nothing_is_left_has_all_of_the_damage() -> None:
    """D = Σ n ΔS³ of 120 cycles of 20 that ride on 12 of 4: (24³ + 9 · 20³ + …) falls to 12 · 4³."""
    t = np.arange(6000) * 0.1
    slow, fast = 2.0 * np.sin(2.0 * np.pi * 0.02 * t), 10.0 * np.sin(2.0 * np.pi * 0.2 * t)

    def damage(values: np.ndarray) -> float:
        found = count(values)
        return float((found.numbers * found.ranges**3).sum())

    lost = lost_without(slow + fast, 0.1, bands(0.18), damage)
    assert lost["first modes"] == pytest.approx(1.0 - damage(slow) / damage(slow + fast), rel=1e-9)
    assert lost["first modes"] > 0.999
    assert lost["quasi-static"] == pytest.approx(1.0 - damage(fast) / damage(slow + fast), rel=1e-9)
    assert 0.0 < lost["quasi-static"] < 0.15
    assert lost["waves"] == pytest.approx(0.0, abs=1e-9)
    assert lost["second and higher modes"] == pytest.approx(0.0, abs=1e-9)


@pytest.fixture(scope="module")
def sensed() -> tuple[MotionEstimate, WeldMap, tuple[WeldLife, ...]]:
    """Return what two accelerometers tell of jacket15, and the lives of one joint's welds."""
    structure = read_structure("jacket15")
    assembly = assemble(structure)
    system = build_system(assembly, pinned(structure), rayleigh=Rayleigh.minimum(0.01, 0.3))
    sensors = tuple(
        Sensor(f"a{k}", way, height_m=144.0) for k, way in enumerate(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    )
    t, rng = np.arange(1500) * 0.1, np.random.default_rng(1)
    y = 0.05 * np.array([np.sin(1.1 * t), np.cos(1.1 * t)]) + 1e-3 * rng.standard_normal((2, t.size))
    record = Record(y, 10.0, tuple(Channel(s.channel) for s in sensors))
    found = motion_from(sensed_model(system, Weather(10.0, 2.0, 8.0)), readings_of(record, sensors, assembly))
    chart, motion = weld_map(system, found.model, RestingLoads.of(assembly)), found.mean()
    cycles = [[[count(point) for point in side] for side in weld] for weld in chart.stress(0, motion)]
    lives = weld_lives(structure, chart.joints[0].welds, cycles, 150.0, MODELS)
    return found, chart, lives


def test_one_more_sensor_never_tells_less(
    sensed: tuple[MotionEstimate, WeldMap, tuple[WeldLife, ...]],
) -> None:
    """Of sensors beside two accelerometers at the top the best leaves a third less open, and not all do."""
    estimate, chart, lives = sensed
    unseen = with_one_more(estimate, chart, lives[:2], candidates(estimate.model.assembly.structure))
    now = unseen[""]
    assert ((now > 0.0) & (now < 1.0)).all()
    assert all((share <= now * (1.0 + 1e-6)).all() for share in unseen.values())
    best, worst = (f(float(share.max()) for name, share in unseen.items() if name) for f in (min, max))
    assert best < 0.7 * now.max()
    assert worst > 1.2 * best


def test_the_page_colours_the_structure_by_its_shortest_life(
    sensed: tuple[MotionEstimate, WeldMap, tuple[WeldLife, ...]], tmp_path: Path
) -> None:
    estimate, chart, lives = sensed
    assembly = estimate.model.assembly
    coloured = life_quantity(assembly, lives)
    assert coloured.values.min() == pytest.approx(lives[0].life.life_years)
    of_first = {lives[0].weld.chord, lives[0].weld.brace}
    shortest = assembly.mesh.member[int(coloured.values.argmin())]
    assert assembly.structure.members[shortest].name in of_first
    within, beyond = (
        [replace(one, weld=replace(one.weld, out_of_range=said)) for one in lives[:2]]
        for said in ((), (OutOfRange("β", safe=False),))
    )
    assert worst_welds([*beyond, *within]) == (*within, *beyond)
    by_band = [damage_by_band(estimate, chart, MODELS, one) for one in worst_welds(lives)]
    page = write_life_page(
        assembly, lives, tmp_path / "life.html", title="t", like="r", by_band=by_band,
        unseen={"": np.full(2, 0.3), "strain": np.full(2, 0.1)}, remarks=("a remark",),
    ).read_text()  # fmt: skip
    for text in ("first modes", "S-N scatter", "strain", "30.0", "a remark", lives[0].weld.brace):
        assert text in page
