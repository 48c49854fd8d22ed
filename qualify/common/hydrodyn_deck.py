"""Input files of HydroDyn and SeaState 5 for a structure that stands still in waves.

The order of the items is that of the program's readers (SeaSt_ParseInput, HydroDyn_ParseInput and
ReadDriverInputFile, v5.0.0). Cylinders alone, without buoyancy.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from common.openfast_deck import Row, _rows
from jackettwin.structure import Structure


@dataclass(frozen=True)
class Water:
    """A sea and what its members do to it.

    ``waves`` is HydroDyn's WaveMod: ``1P0`` a regular wave with its crest at the start, 2 a random sea.
    Members thinner than ``slender_m`` are one piece each; ``grid`` are the points of SeaState's box along x,
    y and z. ``growth_m`` is thick, 1,325 kg/m³; ``axial`` the coefficients of drag, added mass and pressure
    on ends.
    """

    depth_m: float
    height_m: float
    period_s: float
    waves: str = "1P0"
    stretching: int = 0
    drag: float = 1.0
    added_mass: float = 1.0
    axial: tuple[float, float, float] = (0.0, 0.0, 0.0)
    growth_m: float = 0.0
    density_kg_m3: float = 1025.0
    duration_s: float = 60.0
    wave_step_s: float = 0.25
    piece_m: float = 0.5
    direction_deg: float = 0.0
    seed: int = 123456
    grid: tuple[int, int, int] = (21, 21, 31)
    slender_m: float = 0.0


def write_water(folder: Path, structure: Structure, water: Water) -> None:
    """Write ``hydrodyn.dat`` and ``seastate.dat``."""
    (folder / "seastate.dat").write_text(_seastate(structure, water), encoding="ascii")
    (folder / "hydrodyn.dat").write_text(_hydrodyn(structure, water), encoding="ascii")


def write_driver(folder: Path, water: Water, *, step_s: float) -> Path:
    """Write the driver's file of a structure at rest beside the two others; return it."""
    rows: list[Row | str] = [("False", "Echo"), "ENVIRONMENT", (9.80665, "Gravity")]
    rows += [(water.density_kg_m3, "WtrDens"), (water.depth_m, "WtrDpth"), (0.0, "MSL2SWL"), "HYDRODYN"]
    rows += [
        ('"hydrodyn.dat"', "HDInputFile"),
        ('"seastate.dat"', "SeaStateInputFile"),
        ('"out"', "OutRootName"),
    ]
    rows += [
        ("False", "Linearize"),
        (round(water.duration_s / step_s) + 1, "NSteps"),
        (step_s, "TimeInterval"),
    ]
    rows += [
        "PRP",
        (0, "PRPInputsMod"),
        (0, "NAddDOF"),
        (0.0, "PtfmRefzt"),
        ('"unused"', "PRPInputsFile"),
        "STEADY",
    ]
    rows += [("0 0 0 0 0 0", key) for key in ("uPRP", "uDotPRP", "uDotDotPRP")]
    path = folder / "driver.inp"
    path.write_text(_rows("HYDRODYN DRIVER", rows), encoding="ascii")
    return path


def _seastate(structure: Structure, water: Water) -> str:
    half = 1.0 + max(abs(v) for name in structure.nodes for v in structure.nodes[name][:2])
    rows: list[Row | str] = [("False", "Echo"), "ENVIRONMENT"]
    rows += [(water.density_kg_m3, "WtrDens"), (water.depth_m, "WtrDpth"), (0.0, "MSL2SWL"), "GRID"]
    rows += [(half, "X_HalfWidth"), (half, "Y_HalfWidth")]
    # a grid that rounding sinks below the bed has no pressure on its lowest level
    rows += [(water.depth_m - 1e-4, "Z_Depth")]
    rows += [
        *zip(water.grid, ("NX", "NY", "NZ"), strict=True),
        "WAVES",
        (water.waves, "WaveMod"),
        (water.stretching, "WaveStMod"),
    ]
    rows += [(0, "WvCrntMod"), (water.duration_s, "WaveTMax"), (water.wave_step_s, "WaveDT")]
    rows += [
        (water.height_m, "WaveHs"),
        (water.period_s, "WaveTp"),
        ('"DEFAULT"', "WavePkShp"),
        (0.0, "WvLowCOff"),
    ]
    rows += [
        (25.0 / water.period_s, "WvHiCOff"),
        (water.direction_deg, "WaveDir"),
        (0, "WaveDirMod"),
        (1, "WaveDirSpread"),
    ]
    rows += [(1, "WaveNDir"), (90, "WaveDirRange"), (water.seed, "WaveSeed(1)"), (1011121, "WaveSeed(2)")]
    rows += [("True", "WaveNDAmp"), ('""', "WvKinFile"), "2ND", ("False", "WvDiffQTF"), ("False", "WvSumQTF")]
    rows += [
        (v, key)
        for v, key in ((0, "WvLowCOffD"), (3.5, "WvHiCOffD"), (0.1, "WvLowCOffS"), (3.5, "WvHiCOffS"))
    ]
    rows += [
        "CONSTRAINED",
        (0, "ConstWaveMod"),
        (1, "CrestHmax"),
        (60, "CrestTime"),
        (0, "CrestXi"),
        (0, "CrestYi"),
    ]
    rows += ["CURRENT", (0, "CurrMod"), (0, "CurrSSV0"), ('"DEFAULT"', "CurrSSDir"), (20, "CurrNSRef")]
    rows += [
        (0, "CurrNSV0"),
        (0, "CurrNSDir"),
        (0, "CurrDIV"),
        (0, "CurrDIDir"),
        "MCF",
        (0, "MCFD"),
        "OUTPUT",
    ]
    rows += [("False", "SeaStSum"), (2, "OutSwtch"), ('"ES18.9e3"', "OutFmt"), ('"A18"', "OutSFmt")]
    rows += [(1, "NWaveElev"), (0, "WaveElevxi"), (0, "WaveElevyi"), (0, "NWaveKin"), (0, "WaveKinxi")]
    rows += [(0, "WaveKinyi"), (0, "WaveKinzi"), "CHANNELS"]
    return _rows("SEASTATE", rows) + '"Wave1Elev"\nEND\n'


def _hydrodyn(structure: Structure, water: Water) -> str:
    top = 2.0 * water.height_m
    level = structure.sea_level_z_m
    members = [
        m
        for m in structure.members
        if m.part != "tower" and min(structure.nodes[n][2] for n in (m.start, m.end)) - level < top
    ]
    names = sorted({n for m in members for n in (m.start, m.end)})
    joint = {name: k for k, name in enumerate(names, start=1)}
    sizes = sorted(
        {(s.outer_diameter_m, s.thickness_m) for m in members for s in (m.section_start, m.section_end)}
    )
    size = {one: k for k, one in enumerate(sizes, start=1)}
    lines = _rows("HYDRODYN", _floating()).rstrip().splitlines()
    lines += [
        "-- AXIAL",
        "1  NAxCoef",
        "AxCoefID AxCd AxCa AxCp",
        "(-)",
        "1 " + " ".join(map(str, water.axial)),
    ]
    lines += ["-- JOINTS", f"{len(names)}  NJoints", "JointID x y z AxID Ovrlp", "(-)"]
    for name in names:
        x, y, z = structure.nodes[name]
        lines.append(f"{joint[name]} {x:.6f} {y:.6f} {z - level:.6f} 1 0")
    lines += ["-- CYLINDERS", f"{len(sizes)}  NPropSetsCyl", "ID D t", "(-)"]
    lines += [f"{k} {d:.6f} {t:.6f}" for (d, t), k in size.items()]
    lines += ["-- RECTANGLES", "0  NPropSetsRec", "ID A B t", "(-)", "-- SIMPLE CYLINDER", "Cd", "(-)"]
    cd, ca = water.drag, water.added_mass
    # Cd, Ca, Cp without and with growth, axial ones of members zero, no buoyancy
    lines.append(f"{cd} {cd} {ca} {ca} 1 1 0 0 0 0 0 0 0 0")
    lines += ["-- SIMPLE RECTANGLE", "Cd", "(-)", " ".join(["0"] * 18)]
    for kind in ("Dpth", "Members"):
        for shape in ("Cyl", "Rec"):
            lines += [f"-- {kind} {shape}", f"0  NCoef{kind}{shape}", "-", "(-)"]
    lines += ["-- MEMBERS", f"{len(members)}  NMembers", "ID J1 J2 P1 P2 Geom Spin Div Coef Hst Pot", "(-)"]
    for k, m in enumerate(members, start=1):
        ends = (size[(s.outer_diameter_m, s.thickness_m)] for s in (m.section_start, m.section_end))
        whole = m.section_start.outer_diameter_m < water.slender_m
        piece = 1e3 if whole else water.piece_m
        lines.append(f"{k} {joint[m.start]} {joint[m.end]} {' '.join(map(str, ends))} 1 0 {piece} 1 1 False")
    lines += ["-- FILLED", "0  NFillGroups", "-", "(-)", "-- GROWTH"]
    bands = [(z, water.growth_m, 1325.0) for z in (2.0, -water.depth_m - 2.0)] if water.growth_m else []
    lines += [f"{len(bands)}  NMGDepths", "z t rho", "(-)", *(" ".join(map(str, band)) for band in bands)]
    lines += ["-- MEMBER OUTPUT", "0  NMOutputs", "-", "(-)", "-- JOINT OUTPUT", "0  NJOutputs", "0  JOutLst"]
    lines += [
        "-- OUTPUT",
        "False  HDSum",
        "False  OutAll",
        "2  OutSwtch",
        '"ES18.9e3"  OutFmt',
        '"A18"  OutSFmt',
    ]
    channels = ['"HydroFxi"\n"HydroFyi"\n"HydroFzi"', '"HydroMxi"\n"HydroMyi"\n"HydroMzi"']
    return "\n".join([*lines, "-- CHANNELS", *channels, "END", ""])


def _floating() -> list[Row | str]:
    """Return what HydroDyn asks of bodies that float: none does."""
    rows: list[Row | str] = [("False", "Echo"), "FLOATING", (0, "PotMod"), (0, "ExctnMod"), (0, "ExctnDisp")]
    rows += [(10, "ExctnCutOff"), (0, "PtfmYMod"), (0, "PtfmRefY"), (0.01, "PtfmYCutOff"), (36, "NExctnHdg")]
    rows += [(0, "RdtnMod"), (60, "RdtnTMax"), ('"DEFAULT"', "RdtnDT"), (1, "NBody"), (1, "NBodyMod")]
    rows += [('"unused"', "PotFile"), (1, "WAMITULEN")]
    rows += [(0, key) for key in ("PtfmRefxt", "PtfmRefyt", "PtfmRefzt", "PtfmRefztRot", "PtfmVol0")]
    rows += [(0, key) for key in ("PtfmCOBxt", "PtfmCOByt", "NAddDOF")]
    rows += ["2ND", *((0, key) for key in ("MnDrift", "NewmanApp", "DiffQTF", "SumQTF")), "ADDITIONAL"]
    rows += [(0, "AddF0")] * 6
    rows += [("0 0 0 0 0 0", key) for key in ("AddCLin", "AddBLin", "AddBQuad") for _ in range(6)]
    return [*rows, "STRIP", (0, "WaveDisp"), (0, "AMMod"), (0, "HstMod")]
