"""Bending blades from turbine files: windIO of both versions, or ElastoDyn's input and its blade file."""

from __future__ import annotations

from math import cos, radians, sin
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks.openfast import Deck, read_deck, to_float
from jackettwin.errors import located, require
from jackettwin.files import Part, WindIO, find_file, read_yaml, windio
from jackettwin.structure import BladeStructure, FlexibleRotor

DEFAULT_RATIO = 0.005
"""Structural damping of a blade whose file says nothing: half a percent, as reference turbines state."""
_EDGE, _FLAP = 15, 18
"""Where K44 and K55 stand in the 21 numbers of windIO's upper triangle."""


def read_flexible_rotor(source: str | Path, *, folder: Path | None = None) -> FlexibleRotor:
    """Return the bending rotor of a windIO file, a shipped one (``iea15``), or ElastoDyn's input (``.dat``).

    Raises
    ------
    InputError
        If the file is missing or does not say what the blades are made of.
    """
    if Path(source).suffix.lower() in (".dat", ".inp"):
        return _elastodyn(Path(source) if folder is None else folder / source)
    path = find_file(source, "rotors", folder=folder, also=" (windIO), or an ElastoDyn .dat file")
    content = windio(read_yaml(path, what="windIO file"))
    with located(file=path):
        return _windio(content)


def _windio(content: WindIO) -> FlexibleRotor:
    hub, drivetrain = content.root["components"]["hub"], content.drivetrain
    _require_three(int(content.root["assembly"]["number_of_blades"].number(low=1.0, high=6.0)))
    return FlexibleRotor(
        blade=windio_blade(content),
        hub_radius=0.5 * hub["diameter"].number(low=0.1, high=30.0),
        overhang=drivetrain["overhang"].number(low=-50.0, high=50.0),
        hub_height=drivetrain["distance_tt_hub"].number(low=-20.0, high=50.0),
        tilt=drivetrain["uptilt"].number() * content.angle,
        cone=hub["cone_angle"].number() * content.angle,
    )


def windio_blade(content: WindIO) -> BladeStructure:
    """Return what a windIO turbine's blades are made of.

    Raises
    ------
    InputError
        If the file does not say.
    """
    properties = _properties(content)
    grid, axis = properties.grid, content.axis["z"].curve()
    return BladeStructure(
        z=np.interp(grid, *axis) - axis[1][0],
        mass_kg_m=properties.mass,
        flap_n_m2=properties.flap,
        edge_n_m2=properties.edge,
        twist=np.interp(grid, *properties.twist.curve()) * content.angle,
        damping_ratio=DEFAULT_RATIO,
    )


class _Properties(NamedTuple):
    grid: FloatArray
    mass: FloatArray
    flap: FloatArray
    edge: FloatArray
    twist: Part


def _properties(content: WindIO) -> _Properties:
    blade = content.root["components"]["blade"]
    if content.newer:
        part = blade["structure"]["elastic_properties"]
        stiffness, inertia = part["stiffness_matrix"], part["inertia_matrix"]
        (grid, flap), (_, edge) = (_curve(stiffness, stiffness[key].value) for key in ("K55", "K44"))
        mass, twist = _curve(inertia, inertia["mass"].value), content.shape["twist"]
    else:
        part = blade["elastic_properties_mb"]["six_x_six"]
        stiffness, inertia, twist = part["stiff_matrix"], part["inertia_matrix"], part["twist"]
        (grid, flap), (_, edge) = (_curve(stiffness, _entry(stiffness, k)) for k in (_FLAP, _EDGE))
        mass = _curve(inertia, _entry(inertia, 0))
    return _Properties(grid, np.interp(grid, *mass), flap, edge, twist)


def _curve(part: Part, values: Any) -> tuple[FloatArray, FloatArray]:
    return Part({"grid": part["grid"].value, "values": values}, part.place).curve()


def _entry(part: Part, k: int) -> list[float]:
    """Return the k-th number of every matrix."""
    return [row[k].number() for row in part["values"].entries()]


def _elastodyn(path: Path) -> FlexibleRotor:
    deck = read_deck(path, "ElastoDyn file")
    with located(file=path):
        _require_three(int(deck.number("NumBl")))
        name = _either(deck, "BldFile1", "BldFile(1)")
        remedy = "give the one that names the blades"
        require(name, "not an ElastoDyn input file", field="BldFile1", remedy=remedy)
        tilt, overhang = radians(deck.number("ShftTilt")), deck.number("OverHang")
        hub_radius = deck.number("HubRad")
        blade = path.parent / name.replace("\\", "/")
        return FlexibleRotor(
            blade=read_elastodyn_blade(blade, length=deck.number("TipRad") - hub_radius),
            hub_radius=hub_radius,
            overhang=-overhang * cos(tilt),
            hub_height=deck.number("Twr2Shft") + overhang * sin(tilt),
            tilt=-tilt,
            cone=-radians(deck.number("PreCone(1)")),
            pitch=radians(deck.number("BlPitch(1)")),
        )


def _either(deck: Deck, *keywords: str) -> str:
    """Return the value before the first of some keywords that the file has; they changed with its format."""
    return next((value for key in keywords if (value := deck.scalar(key, ""))), "")


def read_elastodyn_blade(path: Path, *, length: float) -> BladeStructure:
    """Return the blade of an ElastoDyn blade file, ``length`` [m] from its root to the tip.

    Raises
    ------
    InputError
        If the file is missing or lacks its table.
    """
    deck = read_deck(path, "ElastoDyn blade file")
    with located(file=path):
        rows = deck.table_below("BlFract", int(deck.number("NBlInpSt")))
        require(rows, "table is missing", field="BlFract", remedy="give an ElastoDyn blade file")
        names = ("blfract", "strctwst", "bmassden", "flpstff", "edgstff")
        z, twist, mass, flap, edge = np.array([row.numbers(*names) for row in rows]).T
        factors = ("AdjBlMs", "AdjFlSt", "AdjEdSt")
        of_mass, of_flap, of_edge = (to_float(deck.scalar(key, "1"), key) for key in factors)
        percent = _either(deck, "BldFlDmp1", "BldFlDmp(1)")
        return BladeStructure(
            z=z * length,
            mass_kg_m=mass * of_mass,
            flap_n_m2=flap * of_flap,
            edge_n_m2=edge * of_edge,
            twist=np.radians(twist),
            damping_ratio=0.01 * to_float(percent, "BldFlDmp1") if percent else DEFAULT_RATIO,
        )


def _require_three(blades: int) -> None:
    require(
        blades == 3,
        "bending blades are modelled for three of them",
        field="number_of_blades",
        value=blades,
        allowed="3",
        remedy="leave blades: out",
    )
