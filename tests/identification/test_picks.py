"""Picks: what was selected once is selected again, and what is picked by hand is taken."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.errors import InputError
from jackettwin.identification import Identification, IdentificationSettings, identify
from jackettwin.identification.picks import Pick, parse_picks, plain_picks, refuse_strangers
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record

PLAIN = IdentificationSettings(refine=False)


@pytest.fixture(scope="module")
def record() -> Record:
    system = ModalSystem(
        np.array([0.29, 0.30, 1.2]), np.array([0.03, 0.01, 0.015]),
        np.array([[1.0, 0.4, 0.1, 0.0], [0.0, 0.1, 1.0, 0.4], [-0.3, 0.8, 0.2, 0.9]]), np.eye(3),
    )  # fmt: skip
    return simulate(system, np.random.default_rng(5), sample_rate_hz=10.0)


@pytest.fixture(scope="module")
def found(record: Record) -> Identification:
    return identify(record)


def replayed(found: Identification) -> tuple[Pick, ...]:
    """The picks by way of plain data, as a file would hold them."""
    return parse_picks({"picks": plain_picks(found.picks)})


def numbers(found: Identification) -> np.ndarray:
    return np.array([[m.frequency_hz, m.damping_ratio, m.damping_ratio_std] for m in found.modes])


def test_the_automatic_selection_replays(record: Record, found: Identification) -> None:
    again = identify(record, picks=replayed(found))
    # the same fit from the same start
    assert_allclose(numbers(again), numbers(found), rtol=1e-9)
    assert again.picks == found.picks
    for mode, before in zip(again.modes, found.modes, strict=True):
        assert_allclose(mode.mode_shape, before.mode_shape, rtol=1e-9)


def test_a_pick_of_another_order_is_that_pole(record: Record) -> None:
    lenient = PLAIN.model_copy(update={"max_damping_cov": 100.0})
    table = identify(record, lenient).stabilisation
    k = np.flatnonzero((table.order == 40) & (table.cluster == 2))[0]
    pick = Pick(float(f"{table.frequency_hz[k]:.4g}"), order=40)
    (mode,) = identify(record, lenient, picks=[pick]).modes
    assert mode.frequency_hz == table.frequency_hz[k]
    assert mode.damping_ratio == table.damping_ratio[k]


@pytest.mark.parametrize("order", [7, 35, 41])
def test_any_order_can_be_picked(record: Record, order: int) -> None:
    """Order 35 of the thesis's Table 6.1 among them, though high orders are computed four apart."""
    lenient = PLAIN.model_copy(update={"max_damping_cov": 100.0})
    dense = lenient.model_copy(update={"order_step": 1})
    assert order not in set(identify(record, lenient).stabilisation.order.tolist())
    (mode,) = identify(record, lenient, picks=[Pick(1.2, order=order)]).modes
    # the same pole as the method gives that is told to compute every order
    table = identify(record, dense, picks=[Pick(1.2, order=order)]).stabilisation
    at = table.frequency_hz[table.order == order]
    assert mode.frequency_hz == pytest.approx(at[np.argmin(np.abs(at - 1.2))], rel=1e-9)


def test_what_was_rejected_can_be_picked(record: Record) -> None:
    lenient = PLAIN.model_copy(update={"max_damping_cov": 100.0})
    rejected = next(r for r in identify(record, lenient).rejected if "orders" in r.reason)
    (mode,) = identify(record, lenient, picks=[Pick(rejected.frequency_hz)]).modes
    assert mode.frequency_hz == rejected.frequency_hz


def test_picks_of_another_record_change_nothing(record: Record, found: Identification) -> None:
    other = identify(record, picks=[Pick(1.2, record="another")])
    assert_allclose(numbers(other), numbers(found), rtol=0.0)


@pytest.mark.parametrize(
    ("picks", "message"),
    [
        ([Pick(0.5)], "no pole near the pick"),
        ([Pick(1.2, order=1)], r"in order 1 .*the nearest order with one is 2: 1\.19"),
        ([Pick(1.2, order=301)], r"in order 301 .*orders 2 to \d+; the nearest order with one is \d+: 1\."),
        ([Pick(1.2), Pick(1.2001)], "two picks mean one pole"),
    ],
)
def test_picks_that_cannot_be_followed(record: Record, picks: list[Pick], message: str) -> None:
    with pytest.raises(InputError, match=message):
        identify(record, PLAIN, picks=picks)


@pytest.mark.parametrize(
    ("data", "field"),
    [
        ({}, "picks"),
        ({"picks": "all"}, "picks"),
        ([0.3], r"picks\[0\]"),
        ([{"order": 4}], r"picks\[0\].frequency_hz"),
        ([{"frequency_hz": True}], r"picks\[0\].frequency_hz"),
        ([{"frequency_hz": -1.0}], r"picks\[0\].frequency_hz"),
        ([{"frequency_hz": 0.3, "order": "last"}], r"picks\[0\].order"),
        ([{"frequency_hz": 0.3, "record": 4}], r"picks\[0\].record"),
        ([{"frequency_hz": 0.3, "doubtful": 1}], r"picks\[0\].doubtful"),
        ([{"frequency_hz": 0.3, "ordre": 4}], r"picks\[0\].ordre"),
    ],
)
def test_bad_picks_are_named(data: object, field: str) -> None:
    with pytest.raises(InputError, match=field):
        parse_picks(data)


def test_efdd_has_no_poles(record: Record) -> None:
    with pytest.raises(InputError, match="has no poles to pick from"):
        identify(record, IdentificationSettings(method="efdd"), picks=[Pick(0.3)])


def test_picks_of_which_none_concerns_the_records_are_a_mistake() -> None:
    picks = (Pick(0.2, record="day_1"), Pick(0.3, record="day_2"))
    refuse_strangers(picks, ["day_2", "day_3"])
    refuse_strangers((*picks, Pick(0.4)), ["day_9"])
    refuse_strangers((), ["day_9"])
    with pytest.raises(InputError, match="no pick concerns .*day_1, day_2.*allowed: day_9"):
        refuse_strangers(picks, ["day_9"])


def test_picks_that_leave_modes_out_say_so(tower, rng):
    record = simulate(tower, rng, sample_rate_hz=5.0)
    all_modes = identify(record)
    some = identify(record, picks=all_modes.picks[:1])
    (said,) = [text for text in some.warnings if "the picks leave out modes" in text]
    assert f"{all_modes.modes[-1].unrefined.frequency_hz:.4g}" in said
    assert not any("leave out" in t for t in identify(record, picks=all_modes.picks).warnings)
