"""Turbines from windIO YAML files, shipped ones by name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator

from jackettwin.errors import InputError
from jackettwin.files import find_file, read_yaml
from jackettwin.loads.bem import Control
from jackettwin.loads.blades import Blade, Polar, blend_polars, stall_delay
from jackettwin.loads.rotor import Rotor

FloatArray = npt.NDArray[np.float64]


def read_rotor(name: str | Path, *, folder: Path | None = None) -> tuple[Rotor, Control]:
    """Return the rotor and the control limits of a windIO file, or of a shipped one (``iea15``).

    Airfoils are blended by relative thickness, then given the stall delay of rotation at the optimal
    tip-speed ratio; stations are those of the blade's twist. A relative path is relative to ``folder``.

    Raises
    ------
    InputError
        If the file is missing or lacks a part that is needed.
    """
    path = find_file(name, "rotors", folder=folder)
    data = read_yaml(path, what="windIO file")
    try:
        return _rotor(data), _control(data)
    except KeyError as missing:
        raise InputError(
            "windIO file lacks a part",
            file=path,
            field=str(missing.args[0]),
            remedy="give a windIO (ontology v1) turbine with outer_shape_bem, airfoils, hub and drivetrain",
        ) from None


def _rotor(data: dict[str, Any]) -> Rotor:
    parts = data["components"]
    hub, drivetrain = parts["hub"], parts["nacelle"]["drivetrain"]
    hub_radius = 0.5 * float(hub["diameter"])
    blade = _blade(parts["blade"]["outer_shape_bem"], data["airfoils"])
    r = hub_radius + blade.z
    lift = stall_delay(
        blade.cl,
        r=r,
        chord=blade.chord,
        relative_thickness=blade.relative_thickness,
        radius=float(r[-1]),
        tip_speed_ratio=_control(data).tip_speed_ratio,
    )
    return Rotor(
        blade=replace(blade, cl=lift),
        n_blades=int(data["assembly"]["number_of_blades"]),
        hub_radius=hub_radius,
        overhang=float(drivetrain["overhang"]),
        hub_height=float(drivetrain["distance_tt_hub"]),
        tilt=float(drivetrain["uptilt"]),
        cone=float(hub["cone_angle"]),
    )


def _blade(shape: dict[str, Any], airfoils: list[dict[str, Any]]) -> Blade:
    span = np.asarray(shape["twist"]["grid"], dtype=np.float64)

    def at_stations(curve: dict[str, Any]) -> FloatArray:
        return np.asarray(np.interp(span, curve["grid"], curve["values"]))

    axis = shape["reference_axis"]
    z, prebend = at_stations(axis["z"]), at_stations(axis["x"])
    by_name = {airfoil["name"]: airfoil for airfoil in airfoils}
    used = [by_name[label] for label in shape["airfoil_position"]["labels"]]
    position = shape["airfoil_position"]["grid"]
    thickness = np.asarray(PchipInterpolator(position, [foil["relative_thickness"] for foil in used])(span))
    cl, cd = blend_polars([_polar(by_name[name]) for name in sorted({a["name"] for a in used})], thickness)
    weight = np.zeros_like(z)
    weight[:-1] += 0.5 * np.diff(z)
    weight[1:] += 0.5 * np.diff(z)
    return Blade(
        z=z,
        prebend=prebend,
        chord=at_stations(shape["chord"]),
        twist=at_stations(shape["twist"]),
        relative_thickness=thickness,
        weight=weight,
        cl=cl,
        cd=cd,
    )


def _polar(airfoil: dict[str, Any]) -> Polar:
    polar = airfoil["polars"][0]
    alpha = np.asarray(polar["c_l"]["grid"], dtype=np.float64)
    drag = np.interp(alpha, polar["c_d"]["grid"], polar["c_d"]["values"])
    lift = np.asarray(polar["c_l"]["values"], dtype=np.float64)
    return Polar(float(airfoil["relative_thickness"]), alpha, lift, drag)


def _control(data: dict[str, Any]) -> Control:
    torque = data["control"]["torque"]
    return Control(
        rated_power_w=float(data["assembly"]["rated_power"]),
        tip_speed_ratio=float(torque["tsr"]),
        lowest_speed_rad_s=float(torque["VS_minspd"]),
        highest_speed_rad_s=float(torque["VS_maxspd"]),
    )
