"""Where sensors sit and what they see of the structure's motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from jackettwin.errors import InputError, did_you_mean
from jackettwin.structure import beam
from jackettwin.structure.assemble import Assembly


@dataclass(frozen=True)
class Sensor:
    """A sensor on a node, or on the tower axis at a height above the mean sea level.

    ``direction`` need not be a unit vector; it is normalised.
    """

    channel: str
    direction: tuple[float, float, float]
    node: str | None = None
    height_m: float | None = None


def observation_matrix(assembly: Assembly, sensors: tuple[Sensor, ...]) -> sp.csr_array:
    """Return (n_sensors, assembly.n_dof): a sensor's motion from the structure's.

    Between nodes the beam's cubic shape functions interpolate.

    Raises
    ------
    InputError
        If a sensor names no place, an unknown node, a height off the tower axis, or no direction.
    """
    rows = [_row(assembly, sensor) for sensor in sensors]
    return sp.csr_array(sp.vstack(rows)) if rows else sp.csr_array((0, assembly.n_dof))


def _row(assembly: Assembly, sensor: Sensor) -> sp.csr_array:
    direction = np.asarray(sensor.direction, dtype=np.float64)
    length = np.linalg.norm(direction)
    if not length > 0.0:
        raise InputError(
            "direction must not be zero",
            field=f"sensors.{sensor.channel}.direction",
            value=sensor.direction,
            remedy="give a vector in global axes, e.g. [1, 0, 0]",
        )
    if (sensor.node is None) == (sensor.height_m is None):
        raise InputError(
            "give node or height_m", field=f"sensors.{sensor.channel}", remedy="keep exactly one of them"
        )
    if sensor.node is not None:
        if sensor.node not in assembly.structure.nodes:
            raise InputError(
                "no such node",
                field=f"sensors.{sensor.channel}.node",
                value=sensor.node,
                remedy=did_you_mean(sensor.node, assembly.structure.nodes) or "name a node, or give height_m",
            )
        motion = assembly.expand[assembly.mesh.node_dofs(sensor.node)[:3]]
    else:
        motion = _on_axis(assembly, sensor)
    return sp.csr_array((direction / length)[None, :] @ motion)


def _on_axis(assembly: Assembly, sensor: Sensor) -> sp.csr_array:
    """Return (3, n_dof): the translation of the point of the tower axis at the sensor's height."""
    mesh, structure = assembly.mesh, assembly.structure
    x, y, _ = structure.nodes[structure.top_node]
    z = structure.sea_level_z_m + float(sensor.height_m or 0.0)
    a, b = mesh.coordinates[mesh.start], mesh.coordinates[mesh.end]
    tolerance = 1e-6 * max(1.0, float(np.ptp(mesh.coordinates[:, 2])))
    on_axis = (np.abs(np.hstack([a[:, :2], b[:, :2]]) - [x, y, x, y]) < tolerance).all(axis=1)
    low, high = np.minimum(a[:, 2], b[:, 2]), np.maximum(a[:, 2], b[:, 2])
    hits = np.flatnonzero(on_axis & (low - tolerance <= z) & (z <= high + tolerance))
    if hits.size == 0:
        sea = structure.sea_level_z_m
        reach = (
            f"{low[on_axis].min() - sea:.6g} to {high[on_axis].max() - sea:.6g} m" if on_axis.any() else None
        )
        raise InputError(
            "height is not on the tower axis",
            field=f"sensors.{sensor.channel}.height_m",
            value=sensor.height_m,
            allowed=reach,
            remedy="give a height above sea level on the vertical members under the top node, or name a node",
        )
    e = int(hits[-1])
    xi = float(np.clip((z - a[e, 2]) / (b[e, 2] - a[e, 2]), 0.0, 1.0))
    R = mesh.axes[e]
    T = np.zeros((12, 12))
    for block in range(0, 12, 3):
        T[block : block + 3, block : block + 3] = R
    local = beam.translation_shape(xi, float(mesh.properties.L[e]), float(mesh.properties.Phi[e]))
    rows = assembly.expand[mesh.element_dofs()[e]]
    return sp.csr_array(sp.csr_array(R.T @ local @ T) @ rows)
