"""Small drawings of mode shapes: the updated model, torsion seen from above, and the measured motion."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from markupsafe import Markup

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.report.figures import style
from jackettwin.report.figures.svg import Canvas
from jackettwin.report.tables.numbers import fixed, words
from jackettwin.response import Sensor, observation_matrix, sensor_positions
from jackettwin.structure import Assembly
from jackettwin.study import MeasuredMode, TwinResult, sensors_of
from jackettwin.updating import Update

SeenShape = tuple[tuple[Sensor, ...], ComplexArray]

_WIDTH, _HEIGHT, _HEAD = 160.0, 330.0, 40.0
_SWAY = 0.11
"""Largest drawn displacement, as a share of the drawing's height."""


def shape_drawings(result: TwinResult, u: Update) -> list[Markup]:
    """Return one drawing per measured mode, none for a mode that the model lacks."""
    drawn = []
    for i, m in enumerate(result.measured):
        shape = u.modes.shapes[:, i]
        if not np.isfinite(shape).all() or not np.abs(shape).any():
            continue
        drawn.append(_drawing(result, m, shape, _seen(result, m), float(u.central_hz[i])))
    return drawn


def _seen(result: TwinResult, m: MeasuredMode) -> SeenShape | None:
    """Return the sensors of a mode's measured shape, with the shape there; None without a shape."""
    at = sensors_of(m, result.observations)
    return None if at is None or m.estimate is None else (at[0], m.estimate.mode_shape[at[1]])


def _drawing(
    result: TwinResult, m: MeasuredMode, shape: ComplexArray, seen: SeenShape | None, model_hz: float
) -> Markup:
    assembly = result.assembly
    points = assembly.mesh.coordinates - [0.0, 0.0, assembly.structure.sea_level_z_m]
    motion = np.asarray(assembly.expand @ shape).reshape(-1, 6)[:, :3]
    peak = motion.ravel()[np.argmax(np.abs(motion))]
    moved = np.real(motion / peak)
    axes = _axes(m.label, moved)
    flat, extent = points[:, axes], np.ptp(points[:, axes], axis=0)
    sway = _SWAY * float(extent.max())
    c = Canvas(_WIDTH, _HEIGHT if axes[1] == 2 else _WIDTH + _HEAD, f"Shape of {words(m.label)}")
    scale = min((_WIDTH - 30.0) / (extent[0] + 2 * sway), (c.height - _HEAD - 30.0) / (extent[1] + 2 * sway))
    middle = 0.5 * (flat.min(axis=0) + flat.max(axis=0))

    def place(at: FloatArray) -> FloatArray:
        centre = [_WIDTH / 2, _HEAD + (c.height - _HEAD) / 2]
        return np.asarray(centre + (at - middle) * [scale, -scale])

    colour = style.mode_look(m.label).colour
    c.text(_WIDTH / 2, 14, words(m.label), anchor="middle", colour=colour, bold=True)
    mac = "" if m.mac is None else f", MAC {fixed(m.mac, 2)}"
    c.text(_WIDTH / 2, 31, f"{model_hz:.3f} Hz{mac}", anchor="middle")
    mesh = assembly.mesh
    c.path(_strokes(place(flat), mesh.start, mesh.end), colour=style.PALE, width=1.0)
    c.path(_strokes(place(flat + sway * moved[:, axes]), mesh.start, mesh.end), colour=colour, width=1.6)
    if seen is not None:
        _arrows(c, result.assembly, seen, shape / peak, axes, sway, place)
    return c.markup


def _axes(label: str, moved: FloatArray) -> list[int]:
    """Return the plane of the drawing: plan for torsion, else the elevation of the motion."""
    if label.startswith("torsion"):
        return [0, 1]
    if label.startswith(("fore_aft", "side_side")):
        return [int(label.startswith("side_side")), 2]
    return [int(np.argmax((moved[:, :2] ** 2).sum(axis=0))), 2]


def _strokes(at: FloatArray, start: npt.NDArray[np.intp], end: npt.NDArray[np.intp]) -> str:
    """Return the elements as one path, rounded to tenths of a pixel."""
    return "".join(
        f"M{at[a, 0]:.1f} {at[a, 1]:.1f}L{at[b, 0]:.1f} {at[b, 1]:.1f}"
        for a, b in zip(start, end, strict=True)
    )


def _arrows(
    c: Canvas, assembly: Assembly, seen: SeenShape, shape: ComplexArray, axes: list[int], sway: float,
    place: Callable[[FloatArray], FloatArray],
) -> None:  # fmt: skip
    """Draw the measured motion at the sensors, scaled and rotated to the model's by least squares."""
    sensors, measured = seen
    model = np.asarray(observation_matrix(assembly, sensors) @ shape)
    fitted = np.real(measured * (measured.conj() @ model) / (measured.conj() @ measured))
    points = sensor_positions(assembly, sensors)
    for sensor, at, value in zip(sensors, points, fitted, strict=True):
        along = np.asarray(sensor.direction) / np.linalg.norm(sensor.direction)
        if sensor.quantity != "motion" or np.abs(along[axes]).max() < 0.5:
            continue
        tail, tip = place(at[axes]), place(at[axes] + sway * value * along[axes])
        c.line(tail[0], tail[1], tip[0], tip[1], width=2.2)
        c.dot(tip[0], tip[1], radius=2.6)
