"""Bending blades from turbine files: windIO of both versions, or ElastoDyn's input and its blade file."""

from __future__ import annotations

from math import cos, radians, sin
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks.openfast_tables import Deck, SubdynRow, number, to_float
from jackettwin.errors import InputError, located
from jackettwin.files import find_file, read_yaml
from jackettwin.files.windio import Part, WindIO, windio
from jackettwin.files.yaml import read_text
from jackettwin.structure.blades import BladeStructure
from jackettwin.structure.rotor_modes import FlexibleRotor

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
    properties = _properties(content)
    grid, axis = properties.grid, content.axis["z"].curve()
    blade = BladeStructure(
        z=np.interp(grid, *axis) - axis[1][0],
        mass_kg_m=properties.mass,
        flap_n_m2=properties.flap,
        edge_n_m2=properties.edge,
        twist=np.interp(grid, *properties.twist.curve()) * content.angle,
        damping_ratio=DEFAULT_RATIO,
    )
    return FlexibleRotor(
        blade=blade,
        hub_radius=0.5 * hub["diameter"].number(low=0.1, high=30.0),
        overhang=drivetrain["overhang"].number(low=-50.0, high=50.0),
        hub_height=drivetrain["distance_tt_hub"].number(low=-20.0, high=50.0),
        tilt=drivetrain["uptilt"].number() * content.angle,
        cone=hub["cone_angle"].number() * content.angle,
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
    deck = Deck(path, tuple(read_text(path, what="ElastoDyn file").splitlines()))
    _require_three(int(_value(deck, "NumBl")))
    name = next((s for key in ("BldFile1", "BldFile(1)") if (s := deck.scalar(key, ""))), "")
    if not name:
        raise InputError(
            "not an ElastoDyn input file",
            file=path,
            field="BldFile1",
            remedy="give the one that names the blades",
        )
    tilt, overhang = radians(_value(deck, "ShftTilt")), _value(deck, "OverHang")
    hub_radius = _value(deck, "HubRad")
    blade = path.parent / name.replace("\\", "/")
    return FlexibleRotor(
        blade=read_elastodyn_blade(blade, length=_value(deck, "TipRad") - hub_radius),
        hub_radius=hub_radius,
        overhang=-overhang * cos(tilt),
        hub_height=_value(deck, "Twr2Shft") + overhang * sin(tilt),
        tilt=-tilt,
        cone=-radians(_value(deck, "PreCone(1)")),
        pitch=radians(_value(deck, "BlPitch(1)")),
    )


def read_elastodyn_blade(path: Path, *, length: float) -> BladeStructure:
    """Return the blade of an ElastoDyn blade file, ``length`` [m] from its root to the tip.

    Raises
    ------
    InputError
        If the file is missing or lacks its table.
    """
    deck = Deck(path, tuple(read_text(path, what="ElastoDyn blade file").splitlines()))
    rows = _stations(deck)
    columns = {
        key: np.array([number(row, key, path) for row in rows])
        for key in ("blfract", "strctwst", "bmassden", "flpstff", "edgstff")
    }
    factors = {key: to_float(deck.scalar(key, "1"), path, key) for key in ("AdjBlMs", "AdjFlSt", "AdjEdSt")}
    ratio = next((s for key in ("BldFlDmp1", "BldFlDmp(1)") if (s := deck.scalar(key, ""))), "")
    with located(file=path):
        return BladeStructure(
            z=columns["blfract"] * length,
            mass_kg_m=columns["bmassden"] * factors["AdjBlMs"],
            flap_n_m2=columns["flpstff"] * factors["AdjFlSt"],
            edge_n_m2=columns["edgstff"] * factors["AdjEdSt"],
            twist=np.radians(columns["strctwst"]),
            damping_ratio=0.01 * to_float(ratio, path, "BldFlDmp1") if ratio else DEFAULT_RATIO,
        )


def _stations(deck: Deck) -> list[SubdynRow]:
    """Return the rows of the distributed properties: their table stands apart from its count."""
    for at, line in enumerate(deck.lines):
        header = line.lower().split()
        if header[:1] == ["blfract"]:
            count = int(_value(deck, "NBlInpSt"))
            found = [deck.lines[k].split() for k in range(at + 2, min(at + 2 + count, len(deck.lines)))]
            return [
                SubdynRow(dict(zip(header, row, strict=False)) | {"#": str(at + 3 + k)}, deck.path)
                for k, row in enumerate(found)
            ]
    raise InputError(
        "table is missing", file=deck.path, field="BlFract", remedy="give an ElastoDyn blade file"
    )


def _value(deck: Deck, keyword: str) -> float:
    text = deck.scalar(keyword, "")
    if not text:
        raise InputError(
            "keyword is missing", file=deck.path, field=keyword, remedy="give an ElastoDyn input file"
        )
    return to_float(text, deck.path, keyword)


def _require_three(blades: int) -> None:
    if blades != 3:
        raise InputError(
            "bending blades are modelled for three of them",
            field="number_of_blades",
            value=blades,
            allowed="3",
            remedy="leave blades: out",
        )
