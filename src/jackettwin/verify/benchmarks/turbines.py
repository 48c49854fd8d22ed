"""Rotor and tower of public reference turbines: IEA 15 MW, NREL 5 MW."""

from __future__ import annotations

from dataclasses import replace
from math import degrees, pi, radians, sqrt

import numpy as np

from jackettwin.loads import AIR_KG_M3, bending_blades, operating_point, read_rotor, steady_operation
from jackettwin.response import build_system, undamped_modes
from jackettwin.soil import clamped
from jackettwin.structure import (
    BladeStructure,
    Material,
    Member,
    PointMass,
    Reaction,
    Section,
    Structure,
    assemble,
)
from jackettwin.verify.rows import Computed

_WINDS = ("8.422147", "9.780037", "12.84800", "14.77807", "16.92050", "20.02994", "25")
"""Rows of the table of the rotor's performance [m/s]."""
_OPTIMAL = 8.0
"""Where the rotor turns at its optimal tip-speed ratio [m/s]."""
_COEFFICIENTS = ((6, 0), (6, 5), (6, 10), (8, 0), (8, 3), (9, 2), (5, 12), (7, -2))
"""Tip-speed ratios and pitches [°] of the table of coefficients, at its wind of 10.74 m/s."""
_TABLE_WIND = 10.74
_TURNS = ((1, 1), (2, 1), (6, 1), (6, 2))
"""Speeds over √(EI/mL⁴), and numbers of the flap modes, of the beam that turns."""
_RATED = 12.0
"""Above the rated wind speed, where pitch holds the power [m/s]."""


def turbine_benchmarks() -> Computed:
    """Return thrust, pitch and power of the one rotor, the other's tower, and a beam that turns."""
    return {**_iea15(), **_nrel5(), **_turning_beam()}


def _iea15() -> Computed:
    rotor, control = read_rotor("iea15")
    optimal = operating_point(rotor, control, _OPTIMAL)
    force = 0.5 * AIR_KG_M3 * pi * rotor.radius**2 * _OPTIMAL**2
    found: Computed = {
        "IEA15-C-power": optimal.power / (force * _OPTIMAL),
        "IEA15-C-thrust": optimal.thrust / force,
    }
    for text in _WINDS:
        wind = float(text)
        point = operating_point(rotor, control, wind, density=AIR_KG_M3)
        found[f"IEA15-thrust-{text}"] = 1e-6 * point.thrust
        if wind > _RATED:
            found[f"IEA15-pitch-{text}"] = degrees(point.pitch)
        else:
            found[f"IEA15-power-{text}"] = 1e-6 * point.power * control.efficiency
    for ratio, pitch in _COEFFICIENTS:
        speed = ratio * _TABLE_WIND / rotor.radius
        point = steady_operation(rotor, _TABLE_WIND, rotor_speed=speed, pitch=radians(pitch))
        push = 0.5 * AIR_KG_M3 * pi * rotor.radius**2 * _TABLE_WIND**2
        found[f"IEA15-C-power-{ratio}-{pitch}"] = point.power / (push * _TABLE_WIND)
        found[f"IEA15-C-thrust-{ratio}-{pitch}"] = point.thrust / push
    return found


def _turning_beam() -> Computed:
    """Return flap frequencies of a uniform beam that turns about its root, over √(EI/mL⁴)."""
    rotor, _ = read_rotor("iea15")
    length, even = float(rotor.blade.z[-1]), np.ones(81)
    beam = BladeStructure(np.linspace(0.0, length, 81), even, 1e10 * even, 4e10 * even, 0.0 * even, 0.0)
    turning, unit = replace(rotor, bending=beam, hub_radius=0.0, n_blades=1), sqrt(1e10 / length**4)
    found: Computed = {}
    for speed, mode in _TURNS:
        blades = bending_blades(turning, pitch=0.0, rotor_speed=speed * unit)
        flap = np.abs(blades.shape[:, 0]).max(axis=0) > np.abs(blades.shape[:, 1]).max(axis=0)
        omega = np.sqrt(np.linalg.eigvalsh(blades.stiffness[np.ix_(flap, flap)]))
        found[f"turning-beam-{speed}-{mode}"] = float(omega[mode - 1] / unit)
    return found


def _nrel5() -> Computed:
    """Return the tower of the NREL 5 MW turbine, clamped, below a rotor whose blades do not bend."""
    n, height = 30, 87.6
    steel = Material(210e9, shear_modulus_pa=80.8e9, density_kg_m3=8500.0)

    def section(share: float) -> Section:
        # walls of 27 and 19 mm, raised by 30 %
        return Section(6.0 + share * (3.87 - 6.0), 1.3 * (0.027 + share * (0.019 - 0.027)))

    nodes = {f"n{k}": (0.0, 0.0, height * k / n) for k in range(n + 1)}
    members = tuple(
        Member(f"m{k}", f"n{k}", f"n{k + 1}", section(k / n), section((k + 1) / n), steel) for k in range(n)
    )
    top = f"n{n}"
    # hub and blades at the hub, 5.019 m upwind of the tower's axis and 90 m up; the nacelle 1.9 m downwind
    about_shaft = 38.76e6
    rotor = PointMass(
        top, 110e3, (-5.01910, 0.0, 2.4), (about_shaft, 0.5 * about_shaft, 0.5 * about_shaft, 0.0, 0.0, 0.0)
    )
    nacelle = PointMass(top, 240e3, (1.9, 0.0, 1.75), (0.0, 0.0, 2607890.0 - 240e3 * 1.9**2, 0.0, 0.0, 0.0))
    tower = Structure("NREL 5 MW tower", nodes, members, masses=(rotor, nacelle), reactions=(Reaction("n0"),))
    bare = assemble(Structure("tower alone", nodes, members, reactions=(Reaction("n0"),)))
    vertical = bare.mass[2::6][:, 2::6]
    f = undamped_modes(build_system(assemble(tower, gravity=True), clamped(tower)), 2).frequency_hz
    # the rotor's inertia about its shaft slows side-side
    modes = dict(zip(("side-side", "fore-aft"), f, strict=True))
    return {
        "NREL5-tower-mass": float(vertical.sum()),
        **{f"NREL5-{k}-{who}": float(v) for k, v in modes.items() for who in ("ADAMS", "FAST")},
    }
