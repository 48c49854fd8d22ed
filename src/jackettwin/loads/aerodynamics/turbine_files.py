"""Turbines from windIO YAML files, shipped ones by name."""

from __future__ import annotations

from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator

from jackettwin.arrays import FloatArray
from jackettwin.decks import windio_blade
from jackettwin.errors import InputError, did_you_mean, located
from jackettwin.files import Part, WindIO, find_file, read_yaml, windio
from jackettwin.loads.aerodynamics.blades import Blade, Polar, blend_polars, stall_delay
from jackettwin.loads.aerodynamics.rotor import Rotor
from jackettwin.loads.operation.bem import Control
from jackettwin.structure import BladeStructure

_STEEPEST = radians(30.0)
"""Largest tilt or cone angle [rad]; larger values are degrees given instead of radians."""


def read_rotor(name: str | Path, *, folder: Path | None = None) -> tuple[Rotor, Control]:
    """Return the rotor and the control limits of a windIO file, or of a shipped one (``iea15``).

    Airfoils are blended by relative thickness, then given the stall delay of rotation at the optimal
    tip-speed ratio; stations are those of the blade's twist. A relative path is relative to ``folder``.

    Raises
    ------
    InputError
        If the file is missing or lacks a required part.
    """
    path = find_file(name, "rotors", folder=folder)
    content = windio(read_yaml(path, what="windIO file"))
    with located(file=path):
        return _rotor(content), _control(content)


def _rotor(content: WindIO) -> Rotor:
    hub, drivetrain = content.root["components"]["hub"], content.drivetrain
    hub_radius = 0.5 * hub["diameter"].number(low=0.1, high=30.0)
    blade = _blade(content)
    r = hub_radius + blade.z
    lift = stall_delay(
        blade.cl,
        r=r,
        chord=blade.chord,
        relative_thickness=blade.relative_thickness,
        radius=float(r[-1]),
        tip_speed_ratio=content.speeds()[0],
    )
    steepest = _STEEPEST / content.angle
    return Rotor(
        blade=replace(blade, cl=lift),
        n_blades=int(content.root["assembly"]["number_of_blades"].number(low=1.0, high=6.0)),
        hub_radius=hub_radius,
        overhang=drivetrain["overhang"].number(low=-50.0, high=50.0),
        hub_height=drivetrain["distance_tt_hub"].number(low=-20.0, high=50.0),
        tilt=drivetrain["uptilt"].number(low=-steepest, high=steepest) * content.angle,
        cone=hub["cone_angle"].number(low=-steepest, high=steepest) * content.angle,
        bending=_bending(content),
    )


def _bending(content: WindIO) -> BladeStructure | None:
    """Return what the blades are made of; None where the file does not say, which most uses do not need."""
    try:
        return windio_blade(content)
    except InputError:
        return None


def _blade(content: WindIO) -> Blade:
    shape, axis = content.shape, content.axis
    span, twist = shape["twist"].curve()

    def at_stations(curve: Part) -> FloatArray:
        return np.asarray(np.interp(span, *curve.curve()))

    z, prebend, chord = at_stations(axis["z"]), at_stations(axis["x"]), at_stations(shape["chord"])
    for part, values, good in ((axis["z"], np.diff(z), "growing"), (shape["chord"], chord, "> 0")):
        if not (values > 0.0).all():
            raise InputError("out of range", field=part.place, value=float(values.min()), allowed=good)
    position, labels = content.airfoil_positions()
    used = _used(content, labels)
    thickness = np.asarray(
        PchipInterpolator(position, [content.thickness(used[label.name]) for label in labels])(span)
    )
    cl, cd = blend_polars(
        [Polar(content.thickness(used[name]), *content.polar(used[name])) for name in sorted(used)], thickness
    )
    weight = np.zeros_like(z)
    weight[:-1] += 0.5 * np.diff(z)
    weight[1:] += 0.5 * np.diff(z)
    return Blade(
        z=z,
        prebend=prebend,
        chord=chord,
        twist=twist * content.angle,
        relative_thickness=thickness,
        weight=weight,
        cl=cl,
        cd=cd,
    )


def _used(content: WindIO, labels: list[Part]) -> dict[str, Part]:
    """Return the airfoils that the blade uses."""
    known = {foil["name"].name: foil for foil in content.root["airfoils"].entries()}
    for label in labels:
        if label.name not in known:
            raise InputError(
                "no such airfoil",
                field=label.place,
                value=label.name,
                allowed=", ".join(known),
                remedy=did_you_mean(label.name, known) or "name one of these",
            )
    return {label.name: known[label.name] for label in labels}


def _control(content: WindIO) -> Control:
    tip_speed_ratio, lowest, highest = content.speeds()
    return Control(
        rated_power_w=content.root["assembly"]["rated_power"].number(low=1e3, high=1e9),
        tip_speed_ratio=tip_speed_ratio,
        lowest_speed_rad_s=lowest,
        highest_speed_rad_s=highest,
        wind_speeds_m_s=content.wind_speeds(),
    )
