"""Input files of OpenFAST 5 for a turbine in ElastoDyn on a foundation of ours.

The order of the items is that of the program's readers (FAST_ReadPrimaryFile, and ReadPrimaryFile,
ReadTowerFile and ReadBladeFile of ElastoDyn_IO.f90, v5.0.0).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import scipy.linalg as la

from jackettwin.structure import Structure
from jackettwin.structure.blades import BladeStructure
from jackettwin.structure.masses import body_from_static_moments, rigid_transfer
from jackettwin.structure.model import PointMass
from jackettwin.structure.rotor_modes import FlexibleRotor, rotor_modes

FloatArray = npt.NDArray[np.float64]
Row = tuple[object, str]

BLADE_NODES, TOWER_NODES = 50, 60
STUB_M = 0.02
"""Height of a tower that is inside the superelement."""


@dataclass(frozen=True)
class Turbine:
    """A rotor and its nacelle: kg, kg·m², m from the tower top."""

    rotor: FlexibleRotor
    nacelle_kg: float
    nacelle_x: float
    nacelle_z: float
    nacelle_yaw_inertia: float
    bearing_kg: float
    hub_kg: float
    hub_inertia: float

    def body(self, node: str) -> PointMass:
        """Return nacelle, hub and rigid blades as one body on ``node``."""
        M = rotor_modes(self.rotor).rigid.copy()
        r = self.rotor
        for mass, place in (
            (self.nacelle_kg, (self.nacelle_x, 0.0, self.nacelle_z)),
            (self.hub_kg, (-r.overhang, 0.0, r.hub_height)),
            (self.bearing_kg, (0.0, 0.0, 0.0)),
        ):
            moved = rigid_transfer(np.array(place))[:3]
            M += mass * moved.T @ moved
        # ElastoDyn's nacelle has inertia about the vertical alone, its hub about the shaft
        M[5, 5] += self.nacelle_yaw_inertia - self.nacelle_kg * self.nacelle_x**2
        shaft = np.array([np.cos(r.tilt), 0.0, -np.sin(r.tilt)])
        M[3:, 3:] += self.hub_inertia * np.outer(shaft, shaft)
        return body_from_static_moments(
            node=node,
            mass_kg=float(M[0, 0]),
            static_moment_kg_m=(float(M[1, 5]), 0.0, float(M[0, 4])),
            inertia_about_node_kg_m2=(M[3, 3], M[4, 4], M[5, 5], M[3, 4], M[3, 5], M[4, 5]),
            part="rna",
        )


@dataclass(frozen=True)
class Run:
    """What OpenFAST is asked: bending blades or rigid ones, and linearisation or a free decay.

    ``offset_m`` moves the tower top fore-aft and to the side at the start, from ``rest``: surge, sway and
    heave [m], roll, pitch and yaw [rad] of the interface, then of the tower top.
    """

    flexible: bool = False
    linearise: bool = False
    duration_s: float = 120.0
    step_s: float = 0.01
    offset_m: float = 0.0
    rest: tuple[float, ...] = (0.0,) * 12
    sub: int = 2
    """2 is ExtPtfm, 1 is SubDyn, 0 is neither."""
    wind: bool = False
    """Whether inflow.dat and aero.dat blow on it."""
    fixed: bool = False
    """Whether nothing of it moves."""
    rotor_rpm: float = 0.0
    """At which the rotor turns, whatever it is blown with."""
    water: bool = False
    """Whether it stands in the sea of seastate.dat, with the members of hydrodyn.dat."""
    tower_damping_percent: float = 0.0
    """Of the clamped tower's four shapes, critical damping being 100."""
    gauges: tuple[int, ...] = ()
    """Nodes of the tower, from 1 at its bottom to TOWER_NODES, whose local motion can be asked for."""
    channels: tuple[str, ...] = ("YawBrTDxp", "YawBrTDyp", "YawBrTAxp", "YawBrTAyp", "PtfmSurge", "PtfmSway")
    """Of ElastoDyn that are written."""


def write_case(
    folder: Path, structure: Structure, turbine: Turbine, run: Run, *, foundation: str, depth_m: float
) -> Path:
    """Write the files of a case beside its foundation's; return the ``.fst``.

    Of an interface at the tower's top ElastoDyn's own tower is a stiff stub without mass.
    """
    base = structure.nodes[structure.interface_nodes[0]][2] - structure.sea_level_z_m
    inside = structure.interface_nodes == (structure.top_node,)
    texts = {
        "case.fst": _primary(run, foundation, depth_m),
        "elastodyn.dat": _elastodyn(structure, turbine, run, base),
        "tower.dat": _stub() if inside else _tower(structure, turbine, run.tower_damping_percent),
        "blade.dat": _blade(turbine.rotor),
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="ascii")
    return folder / "case.fst"


def _rows(title: str, rows: list[Row | str]) -> str:
    """Return a file: two lines of title, then values before keywords under headings."""
    lines = [f"------- {title} -------", "written by jackettwin's qualification"]
    for row in rows:
        lines.append(f"{'-' * 20} {row}" if isinstance(row, str) else f"{row[0]}  {row[1]}  - ")
    return "\n".join(lines) + "\n"


def _primary(run: Run, foundation: str, depth_m: float) -> str:
    unused = '"unused"'
    linear = run.linearise
    duration = 2.0 * run.step_s if linear else run.duration_s
    rows: list[Row | str] = ["SIMULATION CONTROL", ("False", "Echo"), ('"FATAL"', "AbortLevel")]
    rows += [
        (duration, "TMax"),
        (run.step_s, "DT"),
        (1 if run.fixed else 3, "ModCoupling"),
        (2, "InterpOrder"),
        (2, "NumCrctn"),
    ]
    rows += [(1.0, "RhoInf"), (1e-4, "ConvTol"), (6, "MaxConvIter"), (99999, "DT_UJac"), (1e6, "UJacSclFact")]
    rows += ["FEATURE SWITCHES", (1, "NRotors"), (1, "CompElast")]
    rows += [(int(run.wind), "CompInflow"), (2 * run.wind, "CompAero")]
    rows += [(0, "CompServo"), (int(run.water), "CompSeaSt"), (int(run.water), "CompHydro")]
    rows += [(run.sub, "CompSub"), (0, "CompMooring")]
    rows += [(0, "CompIce"), (0, "CompSoil"), (0, "MHK"), ("F", "MirrorRotor")]
    rows += [
        "ENVIRONMENT",
        (9.80665, "Gravity"),
        (1.225, "AirDens"),
        (1025.0, "WtrDens"),
        (1.5e-5, "KinVisc"),
    ]
    rows += [
        (335.0, "SpdSound"),
        (103500.0, "Patm"),
        (1700.0, "Pvap"),
        (depth_m, "WtrDpth"),
        (0.0, "MSL2SWL"),
    ]
    rows += ["INPUT FILES", ('"elastodyn.dat"', "EDFile")]
    rows += [(unused, f"BDBldFile({k})") for k in (1, 2, 3)]
    rows += [('"inflow.dat"', "InflowFile"), ('"aero.dat"', "AeroFile")]
    rows += [(unused, "ServoFile"), ('"seastate.dat"', "SeaStFile"), ('"hydrodyn.dat"', "HydroFile")]
    rows += [(f'"{foundation}"', "SubFile")]
    rows += [(unused, key) for key in ("MooringFile", "IceFile", "SoilFile")]
    rows += [
        "OUTPUT",
        ("False", "SumPrint"),
        (10.0, "SttsTime"),
        (99999, "ChkptTime"),
        (run.step_s, "DT_Out"),
    ]
    rows += [(0.0, "TStart"), (1, "OutFileFmt"), ("True", "TabDelim"), ('"ES18.9E3"', "OutFmt")]
    rows += [
        "LINEARIZATION",
        (linear, "Linearize"),
        ("False", "CalcSteady"),
        (3, "TrimCase"),
        (1e-3, "TrimTol"),
    ]
    rows += [(0.01, "TrimGain"), (0, "Twr_Kdmp"), (0, "Bld_Kdmp"), (1, "NLinTimes"), (run.step_s, "LinTimes")]
    rows += [(0, "LinInputs"), (0, "LinOutputs"), ("False", "LinOutJac"), ("False", "LinOutMod")]
    rows += ["VISUALIZATION", (0, "WrVTK"), (1, "VTK_type"), ("False", "VTK_fields"), (15, "VTK_fps")]
    return _rows("OpenFAST INPUT FILE", rows)


def _elastodyn(structure: Structure, turbine: Turbine, run: Run, base: float) -> str:
    r = turbine.rotor
    bends = str(run.flexible)
    tip = r.hub_radius + float(r.blade.z[-1])
    top = structure.nodes[structure.top_node][2] - structure.sea_level_z_m
    inside = top == base
    top += STUB_M if inside else 0.0
    overhang = -r.overhang / np.cos(r.tilt)
    rows: list[Row | str] = ["SIMULATION CONTROL", ("False", "Echo"), (3, "Method"), ('"default"', "DT")]
    rows += ["DEGREES OF FREEDOM", (bends, "FlapDOF1"), (bends, "FlapDOF2"), (bends, "EdgeDOF")]
    rows += [("False", key) for key in ("PitchDOF", "TeetDOF", "DrTrDOF", "GenDOF", "YawDOF")]
    bends = not (run.fixed or inside)
    rows += [(str(bends), key) for key in ("TwFADOF1", "TwFADOF2", "TwSSDOF1", "TwSSDOF2")]
    rows += [(str(not run.fixed), f"Ptfm{key}DOF") for key in ("Sg", "Sw", "Hv", "R", "P", "Y")]
    rows += ["INITIAL CONDITIONS", (0.0, "OoPDefl"), (0.0, "IPDefl")]
    rows += [(np.degrees(r.pitch), f"BlPitch({k})") for k in (1, 2, 3)]
    rows += [(0.0, "TeetDefl"), (0.0, "Azimuth"), (run.rotor_rpm, "RotSpeed"), (0.0, "NacYaw")]
    if inside:
        # the platform is drawn aside instead of a tower that does not bend
        run = replace(run, rest=(run.rest[0] + run.offset_m, run.rest[1] + run.offset_m, *run.rest[2:]))
        run = replace(run, offset_m=0.0, rest=(*run.rest[:6], *run.rest[:6]))
    bend = np.subtract(run.rest[6:8], run.rest[:2]) - (top - base) * np.array([run.rest[4], -run.rest[3]])
    rows += [(run.offset_m + bend[0], "TTDspFA"), (run.offset_m + bend[1], "TTDspSS")]
    rows += [(run.rest[k], f"Ptfm{key}") for k, key in enumerate(("Surge", "Sway", "Heave"))]
    rows += [(np.degrees(run.rest[3 + k]), f"Ptfm{key}") for k, key in enumerate(("Roll", "Pitch", "Yaw"))]
    rows += ["TURBINE CONFIGURATION", (3, "NumBl"), (tip, "TipRad"), (r.hub_radius, "HubRad")]
    rows += [(-np.degrees(r.cone), f"PreCone({k})") for k in (1, 2, 3)]
    rows += [(0.0, key) for key in ("HubCM", "UndSling", "Delta3", "AzimB1Up")]
    rows += [(overhang, "OverHang"), (0.0, "ShftGagL"), (-np.degrees(r.tilt), "ShftTilt")]
    rows += [(turbine.nacelle_x, "NacCMxn"), (0.0, "NacCMyn"), (turbine.nacelle_z, "NacCMzn")]
    rows += [(0.0, "NcIMUxn"), (0.0, "NcIMUyn"), (0.0, "NcIMUzn")]
    rows += [(r.hub_height - overhang * np.sin(-r.tilt), "Twr2Shft"), (top, "TowerHt"), (base, "TowerBsHt")]
    rows += [(0.0, "PtfmCMxt"), (0.0, "PtfmCMyt"), (base, "PtfmCMzt")]
    rows += [(0.0, "PtfmRefxt"), (0.0, "PtfmRefyt"), (base, "PtfmRefzt"), *_masses(turbine)]
    rows += _details(run.gauges)
    outputs = [f'"{key}"' for key in run.channels]
    return _rows("ELASTODYN INPUT FILE", rows) + "\n".join([*outputs, "END", "----", ""])


def _masses(turbine: Turbine) -> list[Row | str]:
    rows: list[Row | str] = ["MASS AND INERTIA"]
    rows += [(0.0, f"{key}({k})") for key in ("TipMass", "PBrIner", "BlPIner") for k in (1, 2, 3)]
    rows += [(turbine.hub_kg, "HubMass"), (turbine.hub_inertia, "HubIner"), (0.0, "HubIner_Teeter")]
    rows += [(0.0, "GenIner"), (turbine.nacelle_kg, "NacMass"), (turbine.nacelle_yaw_inertia, "NacYIner")]
    rows += [(turbine.bearing_kg, "YawBrMass"), (0.0, "PtfmMass")]
    rows += [(0.0, f"Ptfm{key}Iner") for key in ("R", "P", "Y", "XY", "YZ", "XZ")]
    return rows


def _details(gauges: tuple[int, ...]) -> list[Row | str]:
    teeter = ("TeetMod", "TeetDmpP", "TeetDmp", "TeetCDmp", "TeetSStP", "TeetHStP", "TeetSSSp", "TeetHSSp")
    friction = ("YawFrctMod", "M_CSmax", "M_FCSmax", "M_MCSmax", "M_CD", "M_FCD", "M_MCD")
    rows: list[Row | str] = ["BLADE", (BLADE_NODES, "BldNodes")]
    rows += [('"blade.dat"', f"BldFile{k}") for k in (1, 2, 3)]
    rows += ["ROTOR-TEETER", *((0, key) for key in teeter)]
    rows += ["YAW-FRICTION", *((0, key) for key in (*friction, "sig_v", "sig_v2", "OmgCut"))]
    rows += ["DRIVETRAIN", (100.0, "GBoxEff"), (1.0, "GBRatio"), (1e12, "DTTorSpr"), (0.0, "DTTorDmp")]
    rows += ["FURLING", ("False", "Furling"), ('"unused"', "FurlFile")]
    rows += ["TOWER", (TOWER_NODES, "TwrNodes"), ('"tower.dat"', "TwrFile")]
    rows += ["OUTPUT", ("False", "SumPrint"), (1, "OutFile"), ("True", "TabDelim"), ('"ES10.3E2"', "OutFmt")]
    rows += [(0.0, "TStart"), (1, "DecFact"), (len(gauges), "NTwGages")]
    rows += [(", ".join(map(str, gauges or (1,))), "TwrGagNd"), (0, "NBlGages")]
    return [*rows, (1, "BldGagNd"), ("", "OutList")]


def _tower(structure: Structure, turbine: Turbine, damping_percent: float) -> str:
    """Return the tower's file, its shapes those of the clamped tower under the turbine."""
    fraction, mass, stiffness = _tower_stations(structure)
    rows: list[Row | str] = ["TOWER PARAMETERS", (fraction.size, "NTwInpSt")]
    rows += [(damping_percent, f"Twr{side}Dmp({k})") for side in ("FA", "SS") for k in (1, 2)]
    rows += ["ADJUSTMENT", *((1.0, f"{side}StTunr({k})") for side in ("FA", "SS") for k in (1, 2))]
    rows += [(1.0, "AdjTwMa"), (1.0, "AdjFASt"), (1.0, "AdjSSSt")]
    table = ["-- DISTRIBUTED", "HtFract TMassDen TwFAStif TwSSStif", "(-) (kg/m) (Nm^2) (Nm^2)"]
    table += [f"{f:.9f} {m:.9e} {k:.9e} {k:.9e}" for f, m, k in zip(fraction, mass, stiffness, strict=True)]
    body = turbine.body(structure.top_node)
    lines = [_rows("ELASTODYN TOWER", rows).rstrip(), *table]
    for side, across in (("FA", 0), ("SS", 1)):
        lines.append(f"-- {side} SHAPES")
        for k, shape in enumerate(_tower_shapes(structure, body, across), start=1):
            lines += [f"{c:.9f}  Tw{side}M{k}Sh({p})" for p, c in zip(range(2, 7), shape, strict=True)]
    return "\n".join([*lines, "-- CONCENTRATED", "0  NTwCMass", ""])


def _stub() -> str:
    """Return a tower of two stations that weighs nothing and does not bend."""
    rows: list[Row | str] = ["TOWER PARAMETERS", (2, "NTwInpSt")]
    rows += [(0.0, f"Twr{side}Dmp({k})") for side in ("FA", "SS") for k in (1, 2)]
    rows += ["ADJUSTMENT", *((1.0, f"{side}StTunr({k})") for side in ("FA", "SS") for k in (1, 2))]
    rows += [(1.0, "AdjTwMa"), (1.0, "AdjFASt"), (1.0, "AdjSSSt")]
    lines = [_rows("ELASTODYN TOWER", rows).rstrip(), "-- DISTRIBUTED"]
    lines += ["HtFract TMassDen TwFAStif TwSSStif", "(-) (kg/m) (Nm^2) (Nm^2)"]
    lines += [f"{f} 1.0 1.0e12 1.0e12" for f in (0.0, 1.0)]
    for side in ("FA", "SS"):
        lines.append(f"-- {side} SHAPES")
        lines += [f"{float(p == 2)}  Tw{side}M{k}Sh({p})" for k in (1, 2) for p in range(2, 7)]
    return "\n".join([*lines, "-- CONCENTRATED", "0  NTwCMass", ""])


def _tower_stations(structure: Structure) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return height fraction, mass [kg/m] and EI [N·m²] of the tower, members of constant section."""
    from jackettwin.structure.mesh import discretise

    mesh = discretise(structure)
    part = np.array([structure.members[m].part for m in mesh.member]) == "tower"
    z = np.array([mesh.coordinates[mesh.start[part], 2], mesh.coordinates[mesh.end[part], 2]])
    p, bottom, top = mesh.properties, z.min(), z.max()
    order = np.argsort(z[0])
    ends = (np.sort(z, axis=0)[:, order] - bottom) / (top - bottom)
    # steps between members: two stations a hair apart
    ends = ends + np.array([[1e-6], [-1e-6]])
    ends[0, 0], ends[1, -1] = 0.0, 1.0
    mass, stiffness = (values[part][order] for values in (p.rho * p.A, p.E * p.I))
    return ends.T.ravel(), np.repeat(mass, 2), np.repeat(stiffness, 2)


def _tower_shapes(structure: Structure, body: PointMass, across: int) -> list[FloatArray]:
    """Return the coefficients of x² to x⁶ of the first two modes of the clamped tower, 1 at its top."""
    from jackettwin.structure import assemble
    from jackettwin.structure.cut import at_interface
    from jackettwin.structure.model import Reaction

    tower = at_interface(structure.with_masses((body,)))[1]
    assert tower is not None
    base = structure.interface_nodes[0]
    assembly = assemble(_standing(tower, Reaction(base)), subdivide=2)
    held = assembly.dofs(base)
    free = np.setdiff1d(np.arange(assembly.n_dof), held)
    K, M = (matrix[free][:, free].toarray() for matrix in (assembly.stiffness, assembly.mass))
    _, modes = la.eigh(K, M, subset_by_index=(0, 5))
    nodes = assembly.mesh.coordinates[:, 2]
    u = np.zeros((assembly.n_dof, 6))
    u[free] = modes
    moved = (assembly.expand @ u).reshape(len(nodes), 6, -1)
    x = (nodes - nodes.min()) / np.ptp(nodes)
    chosen = np.flatnonzero(np.abs(moved[:, across]).max(axis=0) > np.abs(moved[:, 1 - across]).max(axis=0))
    return [_polynomial(x, moved[:, across, k]) for k in chosen[:2]]


def _standing(tower: Structure, reaction: object) -> Structure:

    return replace(tower, reactions=(reaction,))


def _polynomial(x: FloatArray, shape: FloatArray) -> FloatArray:
    powers = x[:, None] ** np.arange(2, 7)
    top = int(np.argmax(x))
    # the sum of the coefficients is one: c2 = 1 − Σ others
    rest = powers[:, 1:] - powers[:, :1]
    others = np.linalg.lstsq(rest, shape / shape[top] - powers[:, 0], rcond=None)[0]
    return np.concatenate([[1.0 - others.sum()], others])


def _blade(rotor: FlexibleRotor) -> str:
    blade: BladeStructure = rotor.blade
    rows: list[Row | str] = ["BLADE PARAMETERS", (blade.z.size, "NBlInpSt")]
    ratio = 100.0 * blade.damping_ratio
    rows += [(ratio, "BldFlDmp1"), (ratio, "BldFlDmp2"), (ratio, "BldEdDmp1")]
    rows += ["ADJUSTMENT", (1.0, "FlStTunr1"), (1.0, "FlStTunr2")]
    rows += [(1.0, "AdjBlMs"), (1.0, "AdjFlSt"), (1.0, "AdjEdSt")]
    lines = [_rows("ELASTODYN BLADE", rows).rstrip(), "-- DISTRIBUTED"]
    lines += ["BlFract StrcTwst BMassDen FlpStff EdgStff", "(-) (deg) (kg/m) (Nm^2) (Nm^2)"]
    columns = (
        blade.z / blade.z[-1],
        np.degrees(blade.twist),
        blade.mass_kg_m,
        blade.flap_n_m2,
        blade.edge_n_m2,
    )
    lines += [" ".join(f"{v:.9e}" for v in row) for row in np.array(columns).T]
    lines.append("-- BLADE MODE SHAPES")
    for name, shape in _blade_shapes(blade):
        lines += [f"{c:.9f}  {name}Sh({p})" for p, c in zip(range(2, 7), shape, strict=True)]
    return "\n".join([*lines, ""])


def _blade_shapes(blade: BladeStructure) -> list[tuple[str, FloatArray]]:
    """Return ElastoDyn's polynomials: of an untwisted blade, which it twists itself."""
    from jackettwin.structure.blades import blade_modes

    modes = blade_modes(replace(blade, twist=np.zeros_like(blade.twist)), 4, pitch=0.0)
    flap = np.abs(modes.shape[:, 0]).max(axis=0) > np.abs(modes.shape[:, 1]).max(axis=0)
    x = np.concatenate([[0.0], modes.z / blade.z[-1]])

    def fitted(k: int, direction: int) -> FloatArray:
        shape = np.concatenate([[0.0], modes.shape[:, direction, k]])
        # one at the tip, half an element beyond the last middle
        tip = shape[-1] + (shape[-1] - shape[-2]) / (x[-1] - x[-2]) * (1.0 - x[-1])
        return _polynomial(np.append(x, 1.0), np.append(shape, tip))

    first, second = np.flatnonzero(flap)[:2]
    edge = np.flatnonzero(~flap)[0]
    return [
        ("BldFl1", fitted(int(first), 0)),
        ("BldFl2", fitted(int(second), 0)),
        ("BldEdg", fitted(int(edge), 1)),
    ]
