"""Bending blades from files: a uniform beam through ElastoDyn's, one rotor from both windIO versions."""

from importlib import resources
from pathlib import Path

import numpy as np
import pytest
import yaml

from jackettwin.decks.blade_files import read_elastodyn_blade, read_flexible_rotor
from jackettwin.errors import InputError
from jackettwin.files import read_yaml
from jackettwin.structure.blades import blade_modes

L, MASS, FLAP, EDGE = 60.0, 300.0, 2e9, 5e9
SHIPPED = Path(str(resources.files("jackettwin") / "data" / "rotors" / "iea15.yaml"))

BLADE = """------- ELASTODYN V1.00.* INDIVIDUAL BLADE INPUT FILE -----
a beam of one section
---------------------- BLADE PARAMETERS --------------------
3                      NBlInpSt    - Number of blade input stations (-)
0.8                    {ratio}   - Blade flap mode #1 structural damping in percent of critical (%)
---------------------- BLADE ADJUSTMENT FACTORS ------------
1.0                    FlStTunr1   - Blade flapwise modal stiffness tuner, 1st mode (-)
1.5                    AdjBlMs     - Factor to adjust blade mass density (-)
2.0                    AdjFlSt     - Factor to adjust blade flap stiffness (-)
0.5                    AdjEdSt     - Factor to adjust blade edge stiffness (-)
---------------------- DISTRIBUTED BLADE PROPERTIES --------
{header}
{units}
{rows}
---------------------- BLADE MODE SHAPES -------------------
1.0   BldFl1Sh(2) - Flap mode 1, coeff of x^2
"""

TURBINE = """------- ELASTODYN INPUT FILE -------
three blades
3                      NumBl       - Number of blades (-)
62.0                   TipRad      - The distance from the rotor apex to the blade tip (meters)
2.0                    HubRad      - The distance from the rotor apex to the blade root (meters)
-2.5                   PreCone(1)  - Blade 1 cone angle (degrees)
-5.0                   OverHang    - Distance from yaw axis to rotor apex (meters)
-6.0                   ShftTilt    - Rotor shaft tilt angle (degrees)
1.75                   Twr2Shft    - Vertical distance from the tower-top to the rotor shaft (meters)
90.0                   BlPitch(1)  - Blade 1 initial pitch (degrees)
"blades/blade.dat"     BldFile1    - Name of file containing properties for blade 1 (quoted string)
"""


def write_blade(path: Path, *, ratio: str = "BldFlDmp1", axis: bool = True) -> Path:
    """Write the beam, with the column of older versions (pitch axis) or without."""
    names = ["BlFract", *(["PitchAxis"] if axis else []), "StrcTwst", "BMassDen", "FlpStff", "EdgStff"]
    rows = [[x, *([0.25] if axis else []), 10.0, MASS / 1.5, FLAP / 2.0, EDGE / 0.5] for x in (0.0, 0.5, 1.0)]
    text = BLADE.format(
        ratio=ratio,
        header="   ".join(names),
        units="   ".join("(-)" for _ in names),
        rows="\n".join("  ".join(f"{v:.6E}" for v in row) for row in rows),
    )
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(("ratio", "axis"), [("BldFlDmp1", True), ("BldFlDmp(1)", False)])
def test_a_beam_of_one_section_through_elastodyn_s_blade_file(tmp_path: Path, ratio: str, axis: bool) -> None:
    """ω = (1.8751/L)² √(EI/m) of both axes with the adjustment factors; old and new keywords, tables."""
    blade = read_elastodyn_blade(write_blade(tmp_path / "blade.dat", ratio=ratio, axis=axis), length=L)
    np.testing.assert_allclose(blade.mass_kg_m, MASS)
    np.testing.assert_allclose(blade.flap_n_m2, FLAP)
    np.testing.assert_allclose(blade.edge_n_m2, EDGE)
    np.testing.assert_allclose(blade.twist, np.radians(10.0))
    np.testing.assert_allclose(blade.z, [0.0, 30.0, 60.0])
    assert blade.damping_ratio == pytest.approx(0.008)
    omega = blade_modes(blade, 2, pitch=0.0).omega
    wanted = [(1.8751041 / L) ** 2 * np.sqrt(stiffness / MASS) for stiffness in (FLAP, EDGE)]
    np.testing.assert_allclose(omega, wanted, rtol=5e-3)


def test_elastodyn_s_turbine_says_where_the_blades_are(tmp_path: Path) -> None:
    """Tilted up by 6°: the apex lies 5 cos 6° before the yaw axis, 5 sin 6° above the shaft there."""
    write_blade(tmp_path / "blades" / "blade.dat")
    (tmp_path / "turbine.dat").write_text(TURBINE, encoding="utf-8")
    rotor = read_flexible_rotor("turbine.dat", folder=tmp_path)
    assert rotor.blade.z[-1] == pytest.approx(60.0)
    assert (rotor.hub_radius, rotor.pitch) == pytest.approx((2.0, np.pi / 2.0))
    assert rotor.tilt == pytest.approx(np.radians(6.0))
    assert rotor.cone == pytest.approx(np.radians(2.5))
    assert rotor.overhang == pytest.approx(5.0 * np.cos(np.radians(6.0)))
    assert rotor.hub_height == pytest.approx(1.75 + 5.0 * np.sin(np.radians(6.0)))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("3                      NumBl", "2                      NumBl", "three of them"),
        ('"blades/blade.dat"     BldFile1', '"blades/blade.dat"     Unknown', "not an ElastoDyn input file"),
        ("-6.0                   ShftTilt", "-6.0                   Other", "ShftTilt"),
        ("blades/blade.dat", "blades/missing.dat", "ElastoDyn blade file"),
    ],
)
def test_what_lacks_in_elastodyn_s_files_is_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    write_blade(tmp_path / "blades" / "blade.dat")
    (tmp_path / "turbine.dat").write_text(TURBINE.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_flexible_rotor("turbine.dat", folder=tmp_path)


def test_a_blade_file_without_its_table_is_refused(tmp_path: Path) -> None:
    path = write_blade(tmp_path / "blade.dat")
    path.write_text(path.read_text(encoding="utf-8").replace("BlFract", "Nothing"), encoding="utf-8")
    with pytest.raises(InputError, match="table is missing"):
        read_elastodyn_blade(path, length=L)


def version_2(data: dict) -> dict:
    """Return the shipped turbine, of version 1, as version 2.0 has it: degrees, and columns by name."""
    blade, parts = data["components"]["blade"], data["components"]
    shape, elastic = blade["outer_shape_bem"], blade["elastic_properties_mb"]["six_x_six"]
    K, M = (np.array(elastic[key]["values"]) for key in ("stiff_matrix", "inertia_matrix"))
    twist = {
        "grid": elastic["twist"]["grid"],
        "values": np.degrees(elastic["twist"]["values"]).tolist(),
    }
    matrices = {
        "stiffness_matrix": {
            "grid": elastic["stiff_matrix"]["grid"],
            "K44": K[:, 15].tolist(),
            "K55": K[:, 18].tolist(),
        },
        "inertia_matrix": {"grid": elastic["inertia_matrix"]["grid"], "mass": M[:, 0].tolist()},
    }
    drivetrain = parts["nacelle"]["drivetrain"]
    return {
        "windIO_version": "2.0",
        "assembly": data["assembly"],
        "components": {
            "blade": {
                "reference_axis": shape["reference_axis"],
                "outer_shape": {"twist": twist, "airfoils": []},
                "structure": {"elastic_properties": matrices},
            },
            "hub": parts["hub"] | {"cone_angle": float(np.degrees(parts["hub"]["cone_angle"]))},
            "drivetrain": {"outer_shape": drivetrain | {"uptilt": float(np.degrees(drivetrain["uptilt"]))}},
        },
    }


def test_both_versions_of_windio_give_one_rotor(tmp_path: Path) -> None:
    path = tmp_path / "two.yaml"
    path.write_text(yaml.safe_dump(version_2(read_yaml(SHIPPED, what="windIO file"))), encoding="utf-8")
    one, two = read_flexible_rotor("iea15"), read_flexible_rotor(path)
    for name in ("z", "mass_kg_m", "flap_n_m2", "edge_n_m2", "twist"):
        np.testing.assert_allclose(getattr(two.blade, name), getattr(one.blade, name), rtol=1e-12, atol=1e-12)
    for name in ("hub_radius", "overhang", "hub_height", "tilt", "cone", "pitch"):
        assert getattr(two, name) == pytest.approx(getattr(one, name))
