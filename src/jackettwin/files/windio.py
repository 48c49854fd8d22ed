"""windIO turbine files of both versions in one form, and what is missing in them by its place.

Version 2 renames parts of version 1 and measures angles in degrees and speeds in rev/min. Here everything
leaves in version 1's units, rad and rad/s, whatever the file says.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError

_REMEDY = "give a windIO turbine (version 1 or 2) with blade, airfoils, hub, drivetrain and control"


@dataclass(frozen=True)
class Part:
    """A value of a file and where it stands in it."""

    value: Any
    place: str = ""

    def __getitem__(self, key: str | int) -> Part:
        """Return a part of this one.

        Raises
        ------
        InputError
            If it is not there.
        """
        place = f"{self.place}.{key}" if self.place else str(key)
        keyed = isinstance(self.value, dict) if isinstance(key, str) else isinstance(self.value, list)
        if not keyed or (key not in self.value if isinstance(key, str) else not 0 <= key < len(self.value)):
            raise InputError("windIO file lacks a part", field=place, remedy=_REMEDY)
        return Part(self.value[key], place)

    def __contains__(self, key: str) -> bool:
        """Return whether there is such a part."""
        return isinstance(self.value, dict) and key in self.value

    def entries(self) -> Iterator[Part]:
        """Return the entries of a list."""
        if not isinstance(self.value, list) or not self.value:
            raise InputError("not a list with entries", field=self.place, remedy=_REMEDY)
        return (self[k] for k in range(len(self.value)))

    @property
    def name(self) -> str:
        """The value as a name."""
        return str(self.value)

    def number(self, *, low: float = -np.inf, high: float = np.inf) -> float:
        """Return a finite number between limits.

        Raises
        ------
        InputError
            If it is none, or beyond them.
        """
        value = float(self.value) if _is_number(self.value) else np.nan
        if not low <= value <= high or not np.isfinite(value):
            raise InputError(
                "not a number in range",
                field=self.place,
                value=self.value,
                allowed=None if np.isinf([low, high]).all() else f"{low:g} to {high:g}",
                remedy="check it and its unit: version 1 has rad and rad/s, version 2 degrees and rev/min",
            )
        return value

    def numbers(self) -> FloatArray:
        """Return an array of finite numbers.

        Raises
        ------
        InputError
            If it is none.
        """
        if not isinstance(self.value, list) or not all(map(_is_number, self.value)):
            raise InputError("not a list of numbers", field=self.place, value=self.value, remedy=_REMEDY)
        return np.array(self.value, dtype=np.float64)

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Return ``grid`` and ``values`` of a curve; the grid grows.

        Raises
        ------
        InputError
            If they differ in length, or the grid does not grow.
        """
        grid, values = self["grid"].numbers(), self["values"].numbers()
        if grid.size != values.size or grid.size < 2 or np.any(np.diff(grid) <= 0.0):
            raise InputError(
                "grid and values are no curve",
                field=self.place,
                value=[int(grid.size), int(values.size)],
                allowed="two points or more, as many values, the grid growing",
            )
        return grid, values


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and bool(np.isfinite(value))


@dataclass(frozen=True)
class WindIO:
    """Where a version keeps its parts, and its units in rad and rad/s."""

    root: Part
    newer: bool

    @property
    def angle(self) -> float:
        """An angle's unit [rad]."""
        return pi / 180.0 if self.newer else 1.0

    @property
    def shape(self) -> Part:
        """The blade's outer shape."""
        return self.root["components"]["blade"]["outer_shape" if self.newer else "outer_shape_bem"]

    @property
    def axis(self) -> Part:
        """The blade's reference axis."""
        return (self.root["components"]["blade"] if self.newer else self.shape)["reference_axis"]

    @property
    def drivetrain(self) -> Part:
        """Tilt, overhang and height of the hub."""
        parts = self.root["components"]
        return parts["drivetrain"]["outer_shape"] if self.newer else parts["nacelle"]["drivetrain"]

    def airfoil_positions(self) -> tuple[FloatArray, list[Part]]:
        """Return where along the blade which airfoil stands.

        Raises
        ------
        InputError
            If the positions do not grow, or are not as many as the airfoils.
        """
        if self.newer:
            part = self.shape["airfoils"]
            names = [one["name"] for one in part.entries()]
            at = np.array([one["spanwise_position"].number() for one in part.entries()])
        else:
            part = self.shape["airfoil_position"]
            names, at = list(part["labels"].entries()), part["grid"].numbers()
        if at.size != len(names) or at.size < 2 or np.any(np.diff(at) <= 0.0):
            raise InputError(
                "airfoils do not follow each other",
                field=part.place,
                value=at.tolist(),
                allowed="two or more, each farther out than the last",
            )
        return at, names

    def polar(self, airfoil: Part) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return angles [rad], lift and drag of an airfoil's first polar."""
        first = airfoil["polars"][0]
        if self.newer:
            first = first["re_sets"][0]
        lift, drag = ("cl", "cd") if self.newer else ("c_l", "c_d")
        grid, c_l = first[lift].curve()
        return grid * self.angle, c_l, np.interp(grid, *first[drag].curve())

    def thickness(self, airfoil: Part) -> float:
        """Return thickness over chord."""
        return airfoil["rthick" if self.newer else "relative_thickness"].number(low=0.0, high=1.0)

    def speeds(self) -> tuple[float, float, float]:
        """Return the optimal tip-speed ratio, and the lowest and highest rotor speed [rad/s]."""
        control = self.root["control"]
        if self.newer and "torque" not in control:  # version 2.1
            keys, at = ("optimal_tsr", "min_rotor_speed", "max_rotor_speed"), control
        else:
            keys, at = ("tsr", "VS_minspd", "VS_maxspd"), control["torque"]
        unit = 2.0 * pi / 60.0 if self.newer else 1.0
        fastest = 10.0 / unit  # rad/s: no rotor worth a jacket turns so fast
        low, high = (at[key].number(low=0.0, high=fastest) * unit for key in keys[1:])
        return at[keys[0]].number(low=1.0, high=20.0), low, high

    def wind_speeds(self) -> tuple[float, float] | None:
        """Return the wind speeds between which the turbine produces [m/s]; None if the file does not say."""
        control = self.root["control"]
        if "supervisory" not in control:
            return None
        at = control["supervisory"]
        if "Vin" not in at or "Vout" not in at:
            return None
        low, high = (at[key].number(low=0.0, high=100.0) for key in ("Vin", "Vout"))
        return low, high


def windio(data: Any) -> WindIO:
    """Return a windIO file's content with its version."""
    return WindIO(Part(data), newer=str(data.get("windIO_version", "1")).startswith("2"))
