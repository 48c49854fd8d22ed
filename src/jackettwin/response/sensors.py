"""Where sensors sit and what they see of the structure's motion: displacement, inclination or strain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, did_you_mean, require_between
from jackettwin.structure import Assembly, beam
from jackettwin.structure.forces import tube_radius

Seen = Literal["motion", "inclination", "strain"]
_ACROSS = 0.1
"""Least part of a strain gauge's direction that is across its member: 6° from the axis."""


@dataclass(frozen=True)
class Sensor:
    """A sensor on a node, on a member, or on the tower axis at a height above the mean sea level.

    Attributes
    ----------
    direction : (3,) in global axes; it need not be a unit vector
        Of motion, the way it points. Of an inclination, the horizontal way a mast leans that reads positive:
        leaning towards x is turning about y. Of a strain, where on the section the gauge is, seen from its
        centre; it measures along the member.
    position : float
        Share of the member's length from its first node.
    quantity : {"motion", "inclination", "strain"}
        Motion is displacement, velocity or acceleration, of which modes have the same shape.
    """

    channel: str
    direction: tuple[float, float, float]
    node: str | None = None
    height_m: float | None = None
    member: str | None = None
    position: float = 0.5
    quantity: Seen = "motion"


def sees(quantity: str) -> Seen:
    """Return what a sensor of a measured quantity sees of the structure's displacement."""
    match quantity:
        case "inclination" | "strain" as deformation:
            return deformation
        case _:
            return "motion"


def observation_matrix(assembly: Assembly, sensors: tuple[Sensor, ...]) -> sp.csr_array:
    """Return (n_sensors, assembly.n_dof): what sensors see [m, rad or –] of the structure's displacement.

    Between nodes the beam's own shape functions interpolate.

    Raises
    ------
    InputError
        If a sensor names no place, an unknown one, a height off the tower axis, or no direction.
    """
    rows = [_row(assembly, sensor) for sensor in sensors]
    return sp.csr_array(sp.vstack(rows)) if rows else sp.csr_array((0, assembly.n_dof))


def sensor_positions(assembly: Assembly, sensors: Sequence[Sensor]) -> FloatArray:
    """Return where sensors sit, (n_sensors, 3) [m], z above the mean sea level.

    Raises
    ------
    InputError
        If a sensor names a place that the structure does not have.
    """
    mesh, structure = assembly.mesh, assembly.structure
    places = []
    for sensor in sensors:
        if sensor.node is not None:
            places.append(np.asarray(structure.nodes[sensor.node], dtype=np.float64))
            continue
        e, xi = _on_member(assembly, sensor) if sensor.member is not None else _on_axis(assembly, sensor)
        a, b = mesh.coordinates[mesh.start[e]], mesh.coordinates[mesh.end[e]]
        places.append(a + xi * (b - a))
    return np.array(places).reshape(-1, 3) - [0.0, 0.0, structure.sea_level_z_m]


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
    if sum(place is not None for place in (sensor.node, sensor.height_m, sensor.member)) != 1:
        raise InputError(
            "give node, height_m or member",
            field=f"sensors.{sensor.channel}",
            remedy="keep exactly one of them",
        )
    direction = direction / length
    if sensor.quantity == "inclination":
        direction = _axis_of_lean(sensor, direction)
    if sensor.node is not None:
        return sp.csr_array(direction[None, :] @ _of_node(assembly, sensor, sensor.node))
    e, xi = _on_member(assembly, sensor) if sensor.member is not None else _on_axis(assembly, sensor)
    seen = _seen_between(assembly, sensor, e, xi, direction)
    return sp.csr_array(seen[None, :] @ assembly.expand[assembly.mesh.element_dofs()[e]])


def _axis_of_lean(sensor: Sensor, direction: FloatArray) -> FloatArray:
    """Return the axis about which a mast turns that leans towards a direction."""
    if abs(direction[2]) > 1e-6:
        raise InputError(
            "an inclination is a lean to one side",
            field=f"sensors.{sensor.channel}.direction",
            value=sensor.direction,
            remedy="give the horizontal direction that reads positive, e.g. [1, 0, 0]",
        )
    return np.array([-direction[1], direction[0], 0.0])


def _of_node(assembly: Assembly, sensor: Sensor, node: str) -> sp.csr_array:
    """Return (3, n_dof): translations or rotations of a node."""
    if node not in assembly.structure.nodes:
        raise InputError(
            "no such node",
            field=f"sensors.{sensor.channel}.node",
            value=node,
            remedy=did_you_mean(node, assembly.structure.nodes) or "name a node, or give height_m",
        )
    if sensor.quantity == "strain":
        raise InputError(
            "strain is a member's, not a node's",
            field=f"sensors.{sensor.channel}.node",
            value=node,
            remedy="give member and position, or height_m on the tower",
        )
    dofs = assembly.mesh.node_dofs(node)
    return sp.csr_array(assembly.expand[dofs[3:] if sensor.quantity == "inclination" else dofs[:3]])


def _seen_between(assembly: Assembly, sensor: Sensor, e: int, xi: float, direction: FloatArray) -> FloatArray:
    """Return (12,): what a sensor sees of the displacements of an element's ends, in global axes."""
    mesh, R = assembly.mesh, assembly.mesh.axes[e]
    L, Phi = float(mesh.properties.L[e]), float(mesh.properties.Phi[e])
    local = R @ direction
    if sensor.quantity == "strain":
        across = np.hypot(local[1], local[2])
        if across < _ACROSS:
            raise InputError(
                "a strain gauge's direction points from the section's centre to the gauge",
                field=f"sensors.{sensor.channel}.direction",
                value=sensor.direction,
                remedy="give a vector across the member",
            )
        y, z = tube_radius(mesh.properties)[e] / across * local[1:]
        seen = beam.strain_shape(xi, L, float(y), float(z), Phi)
    elif sensor.quantity == "inclination":
        seen = local @ beam.rotation_shape(xi, L, Phi)
    else:
        seen = local @ beam.translation_shape(xi, L, Phi)
    return np.asarray(seen.reshape(4, 3) @ R).ravel()


def _on_member(assembly: Assembly, sensor: Sensor) -> tuple[int, float]:
    """Return the element that holds a sensor on a member, and where in it, 0 to 1."""
    names = [member.name for member in assembly.structure.members]
    if sensor.member not in names:
        raise InputError(
            "no such member",
            field=f"sensors.{sensor.channel}.member",
            value=sensor.member,
            remedy=did_you_mean(str(sensor.member), names) or "name a member of the structure",
        )
    require_between(f"sensors.{sensor.channel}.position", sensor.position, 0.0, 1.0)
    elements = np.flatnonzero(assembly.mesh.member == names.index(sensor.member))
    pieces = sensor.position * elements.size
    k = min(int(pieces), elements.size - 1)
    return int(elements[k]), pieces - k


def _on_axis(assembly: Assembly, sensor: Sensor) -> tuple[int, float]:
    """Return the element of the tower axis at the sensor's height, and where in it, 0 to 1."""
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
    return e, float(np.clip((z - a[e, 2]) / (b[e, 2] - a[e, 2]), 0.0, 1.0))
