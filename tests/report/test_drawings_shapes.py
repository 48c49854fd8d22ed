"""Measured shapes are drawn where the sensors of their own record sat."""

from __future__ import annotations

from dataclasses import replace

from jackettwin.report.figures.drawings_shapes import shape_drawings
from jackettwin.study import TwinResult

DOT = "<circle"


def dots(result: TwinResult) -> list[int]:
    return [str(drawing).count(DOT) for drawing in shape_drawings(result, result.updates[0])]


def test_every_sensor_that_sees_the_plane_has_an_arrow(complete: TwinResult) -> None:
    """Two heights, of which each bending mode is seen at both; the third target was not measured."""
    assert dots(complete) == [2, 2, 0]


def test_a_record_with_fewer_channels_has_fewer_arrows(complete: TwinResult) -> None:
    """The first record lost a channel, so that the other's shapes, which are drawn, are longer."""
    (seen,) = complete.observations
    found = seen.identification
    short = replace(
        found,
        channels=found.channels[1:],
        modes=tuple(replace(m, mode_shape=m.mode_shape[1:]) for m in found.modes),
    )
    first = replace(seen, record_id="first", identification=short, sensors=seen.sensors[1:])
    assert dots(replace(complete, observations=(first, seen))) == [2, 2, 0]
    measured = tuple(
        replace(
            m,
            estimate=next(
                (mode for mode in short.modes if m.estimate and mode.frequency_hz == m.estimate.frequency_hz),
                None,
            ),
        )
        for m in complete.measured
    )
    fewer = dots(replace(complete, observations=(first, seen), measured=measured))
    assert sum(fewer) == 3
