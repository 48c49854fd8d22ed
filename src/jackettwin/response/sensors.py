"""Sensors: their positions and the quantity they measure (displacement, inclination or strain).

An installed package adds a kind of sensor by an entry point in ``jackettwin.sensors`` that is a
:class:`SensorKind`; twin files and scenarios name it as the ``quantity`` of a sensor.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, did_you_mean, located, look_up, require, require_between
from jackettwin.plugins import plugins_of_type
from jackettwin.structure import Assembly, beam, tube_radius

PLUGINS = "jackettwin.sensors"
"""Entry points of packages that add kinds of sensors: each is a :class:`SensorKind`."""
_ACROSS = 0.1
"""Smallest component of a strain gauge's direction perpendicular to its member: 6° from the axis."""


class ElementPlace(NamedTuple):
    """A point in a beam element.

    Attributes
    ----------
    xi : share of the element's length from its first end
    length_m, shear, radius_m : L, the shear factor Φ and the tube's outer radius
    axes : (3, 3) rows are the element's axes, along it first
    """

    xi: float
    length_m: float
    shear: float
    radius_m: float
    axes: FloatArray


@dataclass(frozen=True)
class SensorKind:
    """A kind of sensor: the quantity it measures as a function of the structure's displacement.

    Attributes
    ----------
    name : str
        ``quantity`` of the sensors in a twin file.
    on_element : function of an :class:`ElementPlace` and the sensor's direction, a global unit vector
        Returns the row (12,) on translations and rotations of the element's ends, in the element's axes.
    on_node : function of the direction, optional
        Returns the row (6,) on a node's translations and rotations in global axes; None if the quantity does
        not follow from the motion of a node.
    recorded_as : str
        Quantity of the channel when such a sensor is simulated.
    """

    name: str
    on_element: Callable[[ElementPlace, FloatArray], FloatArray]
    on_node: Callable[[FloatArray], FloatArray] | None
    recorded_as: str


@dataclass(frozen=True)
class Sensor:
    """A sensor on a node, on a member, or on the tower axis at a height above the mean sea level.

    Attributes
    ----------
    direction : (3,) in global axes; it need not be a unit vector
        For motion, the measured direction. For an inclination, the horizontal direction of a lean that reads
        positive; leaning towards x is a rotation about y. For a strain, the direction from the centre of the
        section to the gauge, which measures along the member.
    position : float
        Share of the member's length from its first node.
    quantity : str
        A name of :func:`sensor_kinds`. Motion is displacement, velocity or acceleration, in all of which
        modes have the same shape.
    """

    channel: str
    direction: tuple[float, float, float]
    node: str | None = None
    height_m: float | None = None
    member: str | None = None
    position: float = 0.5
    quantity: str = "motion"


def _motion(at: ElementPlace, direction: FloatArray) -> FloatArray:
    return np.asarray(at.axes @ direction @ beam.translation_shape(at.xi, at.length_m, at.shear))


def _inclination(at: ElementPlace, direction: FloatArray) -> FloatArray:
    axis = at.axes @ _axis_of_lean(direction)
    return np.asarray(axis @ beam.rotation_shape(at.xi, at.length_m, at.shear))


def _axis_of_lean(direction: FloatArray) -> FloatArray:
    """Return the axis of rotation of a mast that leans towards a direction."""
    require(
        abs(direction[2]) <= 1e-6,
        "the direction of an inclination must be horizontal",
        field="direction",
        value=direction.tolist(),
        remedy="give the horizontal direction that reads positive, e.g. [1, 0, 0]",
    )
    return np.array([-direction[1], direction[0], 0.0])


def _strain(at: ElementPlace, direction: FloatArray) -> FloatArray:
    local = at.axes @ direction
    across = float(np.hypot(local[1], local[2]))
    require(
        across >= _ACROSS,
        "the direction of a strain gauge must point from the section's centre to the gauge",
        field="direction",
        value=direction.tolist(),
        remedy="give a vector across the member",
    )
    y, z = at.radius_m / across * local[1:]
    return beam.strain_shape(at.xi, at.length_m, float(y), float(z), at.shear)


SENSOR_KINDS = {
    kind.name: kind
    for kind in (
        SensorKind("motion", _motion, lambda d: np.concatenate([d, np.zeros(3)]), "acceleration"),
        SensorKind(
            "inclination",
            _inclination,
            lambda d: np.concatenate([np.zeros(3), _axis_of_lean(d)]),
            "inclination",
        ),
        SensorKind("strain", _strain, None, "strain"),
    )
}


def sensor_kinds() -> dict[str, SensorKind]:
    """Return every kind of sensor by its name, those of installed packages included."""
    added = plugins_of_type(PLUGINS, SensorKind).values()
    return {**SENSOR_KINDS, **{kind.name: kind for kind in added}}


def sees(quantity: str) -> str:
    """Return the kind of sensor that measures a quantity of a record: strain, inclination, else motion."""
    return quantity if quantity in sensor_kinds() else "motion"


def observation_matrix(assembly: Assembly, sensors: tuple[Sensor, ...]) -> sp.csr_array:
    """Return the matrix (n_sensors, assembly.n_dof) from displacements to sensor readings [m, rad or –].

    Between nodes the shape functions of the beam elements are used.

    Raises
    ------
    InputError
        If a sensor has no position, an unknown one, a height off the tower axis, or no direction.
    """
    rows = [_row(assembly, sensor) for sensor in sensors]
    return sp.csr_array(sp.vstack(rows)) if rows else sp.csr_array((0, assembly.n_dof))


def sensor_positions(assembly: Assembly, sensors: Sequence[Sensor]) -> FloatArray:
    """Return the positions of sensors, (n_sensors, 3) [m], z above the mean sea level.

    Raises
    ------
    InputError
        If a sensor names a node or member that the structure does not have.
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
    require(
        length > 0.0,
        "direction must not be zero",
        field=f"sensors.{sensor.channel}.direction",
        value=sensor.direction,
        remedy="give a vector in global axes, e.g. [1, 0, 0]",
    )
    require(
        sum(place is not None for place in (sensor.node, sensor.height_m, sensor.member)) == 1,
        "give node, height_m or member",
        field=f"sensors.{sensor.channel}",
        remedy="keep exactly one of them",
    )
    with located(field=f"sensors.{sensor.channel}"):
        kind = SENSOR_KINDS.get(sensor.quantity) or look_up(
            sensor_kinds(), sensor.quantity, "kind of sensor", field="quantity"
        )
        if sensor.node is not None:
            return _of_node(assembly, sensor.node, kind, direction / length)
    e, xi = _on_member(assembly, sensor) if sensor.member is not None else _on_axis(assembly, sensor)
    mesh = assembly.mesh
    R, p = mesh.axes[e], mesh.properties
    place = ElementPlace(xi, float(p.L[e]), float(p.Phi[e]), float(tube_radius(p)[e]), R)
    with located(field=f"sensors.{sensor.channel}"):
        seen = (kind.on_element(place, direction / length).reshape(4, 3) @ R).ravel()
    return sp.csr_array(seen[None, :] @ assembly.expand[mesh.element_dofs()[e]])


def _of_node(assembly: Assembly, node: str, kind: SensorKind, direction: FloatArray) -> sp.csr_array:
    """Return the row (1, n_dof) of a sensor on a node."""
    require(
        node in assembly.structure.nodes,
        "no such node",
        field="node",
        value=node,
        remedy=did_you_mean(node, assembly.structure.nodes) or "name a node, or give height_m",
    )
    if kind.on_node is None:
        raise InputError(
            f"{kind.name} is measured on a member, not on a node",
            field="node",
            value=node,
            remedy="give member and position, or height_m on the tower",
        )
    return sp.csr_array(kind.on_node(direction)[None, :] @ assembly.expand[assembly.mesh.node_dofs(node)])


def _on_member(assembly: Assembly, sensor: Sensor) -> tuple[int, float]:
    """Return the element of a sensor on a member, and the position in it, 0 to 1."""
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
    """Return the element of the tower axis at the sensor's height, and the position in it, 0 to 1."""
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
