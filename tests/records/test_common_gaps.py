"""Gaps that all channels have in common: what a logger lost, held, or joined by a line."""

import numpy as np
import pytest
from scipy import signal

from jackettwin.records import Channel, Record, assess, repair

RATE_HZ = 20.0
HEIGHTS = (80.0, 50.0, 30.0)
SHAPES = np.array([[1.0, 0.46, 0.19], [-0.5, 1.0, 0.62]])
"""First and second mode of a tower at these heights."""


def tower(rng: np.random.Generator) -> np.ndarray:
    """Return accelerations in x and y at three heights: two modes an axis of their own forces, and noise."""
    rows = []
    for frequencies in ((0.30, 2.76), (0.31, 2.84)):
        motion = np.zeros((3, 12_000))
        for f, shape in zip(frequencies, SHAPES, strict=True):
            radius = np.exp(-0.01 * 2.0 * np.pi * f / RATE_HZ)
            poles = [1.0, -2.0 * radius * np.cos(2.0 * np.pi * f / RATE_HZ), radius**2]
            q = signal.lfilter([1.0, -2.0, 1.0], poles, rng.standard_normal(13_000))[1000:]
            motion += np.outer(shape, q / q.std())
        rows.append(motion + 0.2 * rng.standard_normal(motion.shape))
    return np.stack(rows, axis=1).reshape(6, -1)


@pytest.mark.parametrize(
    ("kind", "seed", "gap"),
    [
        ("missing", 1, slice(9000, 11_000)),
        ("missing", 8, slice(3000, 4000)),
        ("zero", 2, slice(5000, 7500)),
        ("joined", 0, slice(5000, 5600)),
    ],
)
def test_a_common_gap_is_neither_a_clock_nor_a_sign(kind: str, seed: int, gap: slice) -> None:
    """The corners at its ends are the same in all channels, a gap apart; nothing else is in common.

    Bridged by lines, they showed independent axes up to 50 s apart, which was corrected, and correct signs
    were reversed.
    """
    channels = tuple(
        Channel(f"{axis}{height:.0f}", height_m=height, direction=direction)
        for height in HEIGHTS
        for axis, direction in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)))
    )
    y = tower(np.random.default_rng(seed))
    lost = y.copy()
    line = np.linspace(y[:, gap.start], y[:, gap.stop - 1], gap.stop - gap.start, axis=1)
    lost[:, gap] = {"missing": np.nan, "zero": 0.0, "joined": line}[kind]
    record = Record(lost, RATE_HZ, channels)
    quality = assess(record)
    assert {f.code for f in quality.findings} == {"gaps" if kind == "missing" else "stuck"}
    mended = repair(record, quality).data
    assert np.all(np.isnan(mended[:, gap]))
    # elsewhere as it was: neither shifted nor reversed
    assert np.array_equal(np.delete(mended, np.r_[gap], axis=1), np.delete(y, np.r_[gap], axis=1))


def test_a_sensor_that_is_mostly_missing_keeps_no_other_from_being_judged() -> None:
    y = tower(np.random.default_rng(3))[::2]
    y[1, 2000:9500] = np.nan
    y[2] *= -1.0
    channels = tuple(Channel(f"x{h:.0f}", height_m=h, direction=(1.0, 0.0, 0.0)) for h in HEIGHTS)
    told = {(f.code, f.subject) for f in assess(Record(y, RATE_HZ, channels)).findings}
    # of two that are left it is not known which one is wrong
    assert {code for code, _ in told} == {"gaps", "sign_unclear"}
