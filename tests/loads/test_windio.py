"""windIO files: both versions give one rotor, and what is missing or wrong is named by its place."""

from copy import deepcopy
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from jackettwin.errors import InputError
from jackettwin.files import read_yaml
from jackettwin.loads.aerodynamics.blades import Polar, blend_polars
from jackettwin.loads.aerodynamics.turbine_files import read_rotor

SHIPPED = Path(str(resources.files("jackettwin") / "data" / "rotors" / "iea15.yaml"))
DELETED = object()


@pytest.fixture(scope="module")
def first() -> dict[str, Any]:
    """What is read of the shipped file, which is of version 1."""
    data = read_yaml(SHIPPED, what="windIO file")
    parts = data["components"]
    return {
        "assembly": data["assembly"],
        "components": {
            "blade": {"outer_shape_bem": parts["blade"]["outer_shape_bem"]},
            "hub": parts["hub"],
            "nacelle": {"drivetrain": parts["nacelle"]["drivetrain"]},
        },
        "airfoils": data["airfoils"],
        "control": data["control"],
    }


def second(first: dict[str, Any], *, point: int) -> dict[str, Any]:
    """Return the same turbine as version 2.0 or 2.1 has it."""
    data = deepcopy(first)
    parts, control = data["components"], data["control"]["torque"]
    shape = parts["blade"].pop("outer_shape_bem")
    position = shape.pop("airfoil_position")
    shape["twist"]["values"] = np.degrees(shape["twist"]["values"]).tolist()
    shape["airfoils"] = [
        {"name": name, "spanwise_position": at, "configuration": ["default"], "weight": [1.0]}
        for name, at in zip(position["labels"], position["grid"], strict=True)
    ]
    parts["blade"] = {"reference_axis": shape.pop("reference_axis"), "outer_shape": shape}
    parts["hub"]["cone_angle"] = float(np.degrees(parts["hub"]["cone_angle"]))
    drivetrain = parts.pop("nacelle")["drivetrain"]
    drivetrain["uptilt"] = float(np.degrees(drivetrain["uptilt"]))
    parts["drivetrain"] = {"outer_shape": drivetrain}
    for foil in data["airfoils"]:
        foil["rthick"] = foil.pop("relative_thickness")
        for polar in foil["polars"]:
            sets = {new: polar.pop(old) for old, new in (("c_l", "cl"), ("c_d", "cd"))}
            for curve in sets.values():
                curve["grid"] = np.degrees(curve["grid"]).tolist()
            polar["re_sets"] = [sets]
    rpm = 30.0 / np.pi
    slow, fast = (float(control[key] * rpm) for key in ("VS_minspd", "VS_maxspd"))
    data["control"] = (
        {"torque": {"tsr": control["tsr"], "VS_minspd": slow, "VS_maxspd": fast}}
        if point == 0
        else {"optimal_tsr": control["tsr"], "min_rotor_speed": slow, "max_rotor_speed": fast}
    )
    return {"windIO_version": f"2.{point}", **data}


@pytest.mark.parametrize("point", [0, 1])
def test_both_versions_are_one_rotor(first: dict[str, Any], tmp_path: Path, point: int) -> None:
    path = tmp_path / "rotor.yaml"
    path.write_text(yaml.safe_dump(second(first, point=point)))
    (old, was), (new, now) = read_rotor("iea15"), read_rotor(path)
    # degrees and back: rounding only
    for key in ("z", "prebend", "chord", "twist", "relative_thickness", "weight", "cl", "cd"):
        np.testing.assert_allclose(getattr(new.blade, key), getattr(old.blade, key), rtol=1e-9, atol=1e-9)
    for key in ("n_blades", "hub_radius", "overhang", "hub_height", "tilt", "cone"):
        assert getattr(new, key) == pytest.approx(getattr(old, key), rel=1e-12)
    assert now.highest_speed_rad_s == pytest.approx(was.highest_speed_rad_s, rel=1e-12)
    assert now.tip_speed_ratio == was.tip_speed_ratio


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        ("components.hub", DELETED, "components.hub: windIO file lacks a part"),
        ("components.hub.diameter", DELETED, "components.hub.diameter: windIO file lacks a part"),
        ("components.hub.diameter", "eight", "components.hub.diameter: not a number in range .got 'eight'"),
        ("components.hub.cone_angle", 4.0, "components.hub.cone_angle: .*rad"),
        ("components.nacelle.drivetrain.uptilt", float("nan"), "uptilt: not a number in range"),
        ("components.nacelle.drivetrain", [], "components.nacelle.drivetrain.overhang: windIO file lacks"),
        ("components.blade.outer_shape_bem.chord.values", [5.0, 4.0], "chord: grid and values are no curve"),
        ("components.blade.outer_shape_bem.twist", DELETED, "outer_shape_bem.twist: windIO file lacks"),
        ("components.blade.outer_shape_bem.airfoil_position.labels", ["circular"], "do not follow each"),
        ("airfoils", [], "airfoils: not a list with entries"),
        ("airfoils.1.name", "other", "labels.2: no such airfoil .got 'SNL-FFA-W3-500'"),
        ("airfoils.0.polars", [], "airfoils.0.polars.0: windIO file lacks a part"),
        ("airfoils.0.polars.0.c_d.values", "x", "airfoils.0.polars.0.c_d.values: not a list of numbers"),
        ("assembly.number_of_blades", 30, "assembly.number_of_blades: .*allowed: 1 to 6"),
        ("control.torque.tsr", DELETED, "control.torque.tsr: windIO file lacks a part"),
        ("control.torque.VS_maxspd", 7.56e1, "control.torque.VS_maxspd: .*rev/min"),
    ],
)
def test_what_is_wrong_is_named(
    first: dict[str, Any], monkeypatch: pytest.MonkeyPatch, place: str, value: object, message: str
) -> None:
    data = deepcopy(first)
    at: Any = data
    *way, last = (int(key) if key.isdigit() else key for key in place.split("."))
    for key in way:
        at = at[key]
    if value is DELETED:
        del at[last]
    else:
        at[last] = value
    monkeypatch.setattr("jackettwin.loads.aerodynamics.turbine_files.read_yaml", lambda path, what: data)
    with pytest.raises(InputError, match=f"rotor.yaml: .*{message}"):
        read_rotor("rotor.yaml")


def test_polars_of_one_thickness_count_as_their_mean() -> None:
    """Two cylinders, as the NREL 5 MW blade has them, and a blade of one airfoil."""
    alpha = np.radians([-180.0, 0.0, 180.0])
    cylinders = [Polar(1.0, alpha, np.zeros(3), np.full(3, c)) for c in (0.5, 0.35)]
    thin = Polar(0.2, alpha, np.ones(3), np.full(3, 0.01))
    cl, cd = blend_polars([cylinders[0], thin, cylinders[1]], np.array([0.2, 1.0]))
    np.testing.assert_allclose(cd[:, 0], [0.01, 0.425])
    np.testing.assert_allclose(cl[:, 0], [1.0, 0.0])
    np.testing.assert_allclose(blend_polars([thin], np.array([0.3, 0.9]))[1], 0.01)
