"""Composition of a record's damage: frequency bands, and the benefit of one more sensor."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import NumericalError
from jackettwin.fatigue import POSITIONS, SIDES, ModelsAtHeight, WeldLife, count
from jackettwin.response import Sensor, observation_matrix
from jackettwin.sensing import MotionEstimate, spread_of, steady_smoother
from jackettwin.structure import Structure
from jackettwin.twin import WeldMap

_SLOW = 0.4
"""Of the first frequency, below which motion is quasi-static."""
_APART = 0.7
"""Of the first frequency, and its multiple, between which lies the first pair; waves are below it."""
_TILT_STD_RAD, _STRAIN_STD = 1e-5, 1e-7
"""Noise of an inclinometer and of a strain gauge."""


def bands(first_hz: float) -> Mapping[str, tuple[float, float]]:
    """Return the bands [Hz] of quasi-static motion, waves, first pair, and higher modes."""
    edges = (0.0, _SLOW * first_hz, _APART * first_hz, first_hz / _APART, np.inf)
    names = ("quasi-static", "waves", "first modes", "second and higher modes")
    return dict(zip(names, zip(edges, edges[1:], strict=False), strict=True))


def damage_by_band(
    estimate: MotionEstimate, chart: WeldMap, models: ModelsAtHeight, worst: WeldLife
) -> dict[str, float]:
    """Return by which share a weld's damage falls without each band, at its worst point.

    Of the smoothed motion. Shares overlap, as cycles of one band ride on those of others.
    """
    joint, brace = _place(chart, worst)
    motion = estimate.mean()
    series = chart.stress(joint, motion, [brace])[0, SIDES.index(worst.side), POSITIONS.index(worst.position)]
    structure = estimate.model.assembly.structure
    curve = models(worst.z_m - structure.sea_level_z_m)[1].curve
    thickness = worst.weld.thickness_m[SIDES.index(worst.side)]

    def damage(values: FloatArray) -> float:
        cycles = count(values)
        return curve.damage(cycles.ranges, cycles.numbers, thickness_m=thickness)

    return lost_without(
        series, estimate.readings.step_s, bands(float(estimate.model.omega[0]) / (2.0 * np.pi)), damage
    )


def lost_without(
    series: FloatArray,
    step_s: float,
    bands_hz: Mapping[str, tuple[float, float]],
    damage: Callable[[FloatArray], float],
) -> dict[str, float]:
    """Return by which share the damage of a series (n,) falls without the motion of each band."""
    spectrum = np.fft.rfft(series)
    f, whole, found = np.fft.rfftfreq(series.size, step_s), damage(series), {}
    for name, (low, high) in bands_hz.items():
        left = np.where((f >= low) & (f < high) & (f > 0.0), 0.0, spectrum)
        found[name] = 1.0 - damage(np.fft.irfft(left, series.size)) / max(whole, 1e-300)
    return found


def with_one_more(
    estimate: MotionEstimate, chart: WeldMap, welds: tuple[WeldLife, ...], sensors: Mapping[str, Sensor]
) -> dict[str, FloatArray]:
    """Return what sensors do not see of the nominal stresses, over all of it, with one more of each.

    Standard deviations of the largest component of nominal stress at welds (n_welds,), and under ``""`` as it
    is now. Noise of an accelerometer is that of the record's, of other sensors a usual one.
    """
    rows = np.array([_largest(estimate, chart, weld) for weld in welds])
    found = {"": spread_of(rows, estimate.covariance)}
    moving = np.sqrt(found[""] ** 2 + (estimate.mean() @ rows.T).var(axis=0))
    model, smoother, readings = estimate.model, estimate.smoother, estimate.readings
    for name, sensor in sensors.items():
        seen = observation_matrix(model.assembly, (sensor,)).toarray()
        derivative = 2 if sensor.quantity == "motion" else 0
        row = estimate.of_state(model.motion_rows(seen, np.zeros_like(seen), (derivative,)))
        noise = {"inclination": _TILT_STD_RAD, "strain": _STRAIN_STD}.get(sensor.quantity)
        variance = float(smoother.R.min()) if noise is None else noise**2
        try:
            more = steady_smoother(
                smoother.F, smoother.Q, np.vstack([smoother.C, row]), np.append(smoother.R, variance)
            )
        except NumericalError:
            continue
        found[name] = spread_of(rows, replace(estimate, smoother=more, readings=readings).covariance)
    return {name: spread / moving for name, spread in found.items()}


def candidates(structure: Structure) -> dict[str, Sensor]:
    """Return sensors that one could add: lean, strain and motion of the tower's base, strain of a leg."""
    base, x, y = structure.interface_nodes[0], (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    found = {
        f"inclinometer at the tower's base, {way}": Sensor("new", d, node=base, quantity="inclination")
        for way, d in (("x", x), ("y", y))
    }
    towers = [m.name for m in structure.members if m.part == "tower"]
    if towers:
        for way, d in (("x", x), ("y", y)):
            found[f"strain gauge at the tower's base, {way}"] = Sensor(
                "new", d, member=towers[0], position=0.0, quantity="strain"
            )
    for node in structure.reaction_nodes[:1]:
        legs = [m.name for m in structure.members if node in (m.start, m.end)]
        found[f"strain gauge on {legs[0]}"] = Sensor("new", x, member=legs[0], quantity="strain")
    for way, d in (("x", x), ("y", y)):
        found[f"accelerometer at the tower's base, {way}"] = Sensor("new", d, node=base)
    return found


def _place(chart: WeldMap, one: WeldLife) -> tuple[int, int]:
    """Return the number of a weld's joint, and of its brace there."""
    return next(
        (j, b)
        for j, joint in enumerate(chart.joints)
        for b, weld in enumerate(joint.welds)
        if (weld.node, weld.brace) == (one.weld.node, one.weld.brace)
    )


def _largest(estimate: MotionEstimate, chart: WeldMap, one: WeldLife) -> FloatArray:
    """Return the row (n_coordinates,) of the nominal stress that varies most."""
    joint, brace = _place(chart, one)
    rows = chart.rows[joint][brace]
    return np.asarray(rows[int((estimate.mean() @ rows.T).var(axis=0).argmax())])
