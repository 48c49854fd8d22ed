"""Orders of a rotor whose speed is hidden, and what moves alike without being one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import fuse, identify
from jackettwin.identification.many_records.rotor_orders import objections
from jackettwin.identification.many_records.sightings import Sightings
from jackettwin.identification.maximum_likelihood.line_likelihood import LOG_ZETA, NOISE_WEIGHTS
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record

RECORDS = 12


def track(log_f: np.ndarray, rng: np.random.Generator, std: float = 0.002) -> Sightings:
    """Return estimates of ln f, NaN in records without."""
    at = np.flatnonzero(np.isfinite(log_f))
    n = at.size
    covariance = np.tile(np.diag([std**2, 0.09]), (n, 1, 1))
    f = np.exp(log_f[at] + std * rng.standard_normal(n))
    return Sightings(
        at, np.zeros(n, dtype=np.int64), f, np.full(n, 0.01), np.full(n, 600.0), covariance,
        np.zeros(n, dtype=np.int64), np.full((n, len(NOISE_WEIGHTS), len(LOG_ZETA)), np.nan),
    )  # fmt: skip


def still(f: float, share: float, rng: np.random.Generator) -> Sightings:
    """Return a mode found in a share of the records."""
    return track(np.where(rng.random(RECORDS) < share, np.log(f), np.nan), rng)


def by_speed(log_speed: np.ndarray, order: int, rng: np.random.Generator) -> list[Sightings]:
    """Return an order as tracking keeps it: what is further apart than 3 % is another track."""
    log_f = np.log(order) + log_speed
    place = np.round(log_f / 0.03)
    return [track(np.where(place == one, log_f, np.nan), rng) for one in np.unique(place)]


def test_orders_of_a_hidden_speed_are_no_modes(rng: np.random.Generator) -> None:
    log_speed = np.log(rng.uniform(0.1, 0.18, RECORDS))
    modes = [still(0.31, 1.0, rng), still(0.315, 0.9, rng), still(1.3, 0.4, rng)]
    orders = [one for order in (3, 6) for one in by_speed(log_speed, order, rng)]
    found = objections([*modes, *orders])
    assert sorted(found) == list(range(len(modes), len(modes) + len(orders)))
    assert {one.status for one in found.values()} == {ModeStatus.TONE}
    (ratio,) = {one.reason.params["ratio"] for one in found.values()}
    assert ratio == 2.0


def test_a_rated_speed_makes_no_mode(rng: np.random.Generator) -> None:
    """Seven of twelve records at one speed: its orders seem settled, but where others are they are not."""
    log_speed = np.log(np.where(np.arange(RECORDS) < 7, 0.16, rng.uniform(0.1, 0.13, RECORDS)))
    orders = [one for order in (3, 6) for one in by_speed(log_speed, order, rng)]
    found = objections([still(0.31, 1.0, rng), still(1.3, 0.9, rng), *orders])
    assert sorted(found) == list(range(2, 2 + len(orders)))


@pytest.mark.parametrize("share", [0.4, 1.0])
def test_modes_at_twice_a_frequency_stay_modes(rng: np.random.Generator, share: float) -> None:
    """Found in all records or in a few, they do not move."""
    others = [still(0.31, 1.0, rng), still(0.47, share, rng), still(0.94, share, rng), still(1.4, share, rng)]
    assert not objections(others)


def test_modes_that_move_together_with_the_weather_stay_modes(rng: np.random.Generator) -> None:
    """A bridge that freezes: all rise by 8 %, the first like the others, and two are at a ratio of two."""
    warmth = np.linspace(0.0, 0.08, RECORDS)
    assert not objections([track(np.log(f) + warmth, rng) for f in (0.47, 0.94, 1.41)])


def test_a_lone_order_is_doubted_and_a_step_is_not(rng: np.random.Generator) -> None:
    lone = np.log(0.5) + np.where(rng.random(RECORDS) < 0.5, 0.0, 0.03)
    damaged = np.log(0.9) - 0.05 * (np.arange(RECORDS) >= 6)
    found = objections([still(0.31, 1.0, rng), track(lone, rng), track(damaged, rng)])
    assert list(found) == [1] and found[1].status is ModeStatus.DOUBTFUL
    assert found[1].reason.params["stays_hz"] == pytest.approx(0.31, rel=0.01)


@pytest.fixture
def turning() -> Callable[[int, float], Record]:
    """Return a maker of records of a tower whose rotor turns at a speed that no channel tells.

    The orders are random within 1 % of their frequency, as turbulence that the blades cut is.
    """
    shapes = np.kron(np.array([[1.0, 0.55, 0.2], [-0.5, 1.0, 0.8]]), np.eye(2))
    f, zeta = np.array([0.31, 0.318, 1.35, 1.42]), np.array([0.015, 0.012, 0.01, 0.011])
    system = ModalSystem(f, zeta, shapes, np.diag([1.0, 1.0, 0.3, 0.3]))

    def peak(rng: np.random.Generator, n: int, middle: float) -> np.ndarray:
        lines = np.fft.rfftfreq(n, 0.1)
        drawn = rng.standard_normal(lines.size) + 1j * rng.standard_normal(lines.size)
        x = np.fft.irfft(drawn * np.exp(-0.5 * ((lines - middle) / (0.012 * middle)) ** 2), n)
        return np.asarray(x / x.std())

    def made(seed: int, speed_hz: float) -> Record:
        rng = np.random.default_rng([31, seed])
        record = simulate(system, rng, duration_s=600.0, sample_rate_hz=10.0)
        n, rms = record.data.shape[1], record.data.std()
        third, sixth = shapes[0] + 0.3 * shapes[1], 0.3 * shapes[0] + 0.9 * shapes[1]
        x = 0.6 * np.outer(third, peak(rng, n, 3.0 * speed_hz))
        x += 0.4 * np.outer(sixth, peak(rng, n, 6.0 * speed_hz))
        return replace(record, data=record.data + rms * x)

    return made


def test_records_of_a_turning_rotor_keep_their_modes_alone(turning: Callable[[int, float], Record]) -> None:
    speeds = (0.16, 0.18, 0.145, 0.16, 0.17, 0.18)
    found = [identify(turning(k, speed)) for k, speed in enumerate(speeds)]
    one_by_one = [m.frequency_hz for one in found for m in one.modes if m.status is ModeStatus.OK]
    assert sum(0.4 < f < 1.2 for f in one_by_one) <= 2  # of twelve orders, before records are compared
    fused = fuse(found).modes
    modes = [m.frequency_hz for m in fused if m.status.is_a_mode]
    np.testing.assert_allclose(modes, [0.31, 0.318, 1.35, 1.42], rtol=0.01)
    orders = [m for m in fused if not m.status.is_a_mode]
    assert orders and all("orders of a rotor" in (m.status_reason or "") for m in orders)
