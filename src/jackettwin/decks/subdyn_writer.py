"""Structures to OpenFAST SubDyn input files, in the format of OpenFAST 5.

A deck holds what SubDyn knows: joints, circular beams and beams of any section, rigid links, concentrated
masses, reactions with the static stiffness and mass of what is below them, and the damping that another deck
has stated. Names that are not whole numbers become numbers.
"""

from __future__ import annotations

from itertools import groupby
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.decks.subdyn import DeckDamping
from jackettwin.decks.subdyn_members import deck_axes
from jackettwin.errors import InputError, require
from jackettwin.files import atomic_path
from jackettwin.structure import (
    Beam,
    BeamSection,
    Material,
    PointMass,
    Reaction,
    Section,
    Structure,
    body_from_static_moments,
    rigid_body_mass,
)
from jackettwin.structure.mesh import beam_axes

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_FEMMOD = {"euler-bernoulli": 1, "timoshenko": 3}
_DOFS = ("x", "y", "z", "tx", "ty", "tz")
_ZERO_ROW = "   ".join(["0.0"] * 6)
_MODES = 24
_UNKNOWN = DeckDamping((0.01,), 0.0, 0.0, np.zeros((6, 6)))
"""Of a structure that is of no deck: a guess, which the command says."""

Tube = tuple[Material, Section]


def write_subdyn(structure: Structure, path: Path, damping: DeckDamping | None = None) -> tuple[Path, ...]:
    """Write a SubDyn input file, and one SSI file for each different reaction; return the files.

    Parameters
    ----------
    damping : of the deck that the structure is of; otherwise 1 % of each internal mode

    Raises
    ------
    InputError
        If the structure has no interface nodes.
    """
    if not structure.interface_nodes:
        raise InputError(
            "SubDyn needs interface joints",
            field="interface_nodes",
            value=[],
            remedy="name the nodes under the tower",
        )
    _require_known(structure)
    grounds = {
        r.node: ssi_text(r) for r in structure.reactions if r.stiffness is not None or r.mass is not None
    }
    names = {
        text: f"{path.stem}_ssi_{k}.dat" for k, text in enumerate(dict.fromkeys(grounds.values()), start=1)
    }
    ssi_files = {node: names[text] for node, text in grounds.items()}
    files = {path: subdyn_text(structure, ssi_files, damping or _UNKNOWN)}
    files |= {path.with_name(name): text for text, name in names.items()}
    for target, text in files.items():
        with atomic_path(target) as temporary:
            temporary.write_text(text, encoding="utf-8")
    return tuple(files)


def _require_known(structure: Structure) -> None:
    """Refuse what the tables written here do not hold."""
    turning = [link.follower for link in structure.rigid_links if link.release]
    others = [*(f"{e.kind} {e.name}" for e in structure.elements), *(f"hinge {name}" for name in turning)]
    if others:
        raise InputError(
            "only tubes, beams and rigid links can be written to a deck",
            field="members",
            value=others[0] if len(others) == 1 else others[:5],
            remedy="edit the deck itself",
        )
    for b in structure.beams:
        require(
            structure.beam == "euler-bernoulli" or max(b.section.A_x, b.section.A_y) < inf,
            "SubDyn's Timoshenko beams need shear areas",
            field=f"members.{b.name}",
            value=b.shape,
            remedy="give shear_area_x_m2 and shear_area_y_m2, or beam: euler-bernoulli",
        )


def subdyn_text(structure: Structure, ssi_files: dict[str, str], damping: DeckDamping) -> str:
    """Return a SubDyn input file.

    Parameters
    ----------
    ssi_files : {reaction node: name of its SSI file}
    """
    joints, members = _numbers(structure.nodes), _numbers(m.name for m in structure.bars)
    tubes: dict[Tube, int] = {}
    for m in structure.members:
        for section in (m.section_start, m.section_end):
            tubes.setdefault((m.material, section), len(tubes) + 1)
    beams: dict[tuple[Material, BeamSection], int] = {}
    for b in structure.beams:
        beams.setdefault((b.material, b.section), len(beams) + 1)
    sections = [
        _control(structure, damping),
        _joints(structure, joints),
        _reactions(structure, joints, ssi_files),
        _table("INTERFACE JOINTS: 1/0 for Locked (to the TP)/Free DOF @each Interface Joint", "NInterf",
               "IJointID TPID ItfTDXss ItfTDYss ItfTDZss ItfRDXss ItfRDYss ItfRDZss",
               [f"{joints[node]} 1 1 1 1 1 1 1" for node in structure.interface_nodes]),
        _members(structure, joints, members, tubes, beams),
        _table("CIRCULAR BEAM CROSS-SECTION PROPERTIES", "NPropSetsCyl",
               "PropSetID YoungE ShearG MatDens XsecD XsecT",
               [f"{k} {_n(m.youngs_modulus_pa)} {_n(m.shear_modulus_pa)} {_n(m.density_kg_m3)} "
                f"{_n(s.outer_diameter_m)} {_n(s.thickness_m)}" for (m, s), k in tubes.items()]),
        _table("RECTANGULAR BEAM CROSS-SECTION PROPERTIES", "NPropSetsRec",
               "PropSetID YoungE ShearG MatDens XsecSa XsecSb XsecT", []),
        _table("ARBITRARY BEAM CROSS-SECTION PROPERTIES", "NXPropSets",
               "PropSetID YoungE ShearG MatDens XsecA XsecAsx XsecAsy XsecJxx XsecJyy XsecJ0 XsecJt",
               [_beam_row(k, m, s) for (m, s), k in beams.items()]),
        _table("CABLE PROPERTIES", "NCablePropSets", "PropSetID EA MatDens T0 CtrlChannel", []),
        _table("RIGID LINK PROPERTIES", "NRigidPropSets", "PropSetID MatDens",
               ["1 0.0"] if structure.rigid_links else []),
        _table("SPRING ELEMENT PROPERTIES", "NSpringPropSets", "PropSetID k11 k12 k13 k14 k15 k16 k22 "
               "k23 k24 k25 k26 k33 k34 k35 k36 k44 k45 k46 k55 k56 k66", []),
        _table("MEMBER COSINE MATRICES COSM(i,j)", "NCOSMs",
               "COSMID COSM11 COSM12 COSM13 COSM21 COSM22 COSM23 COSM31 COSM32 COSM33", []),
        _masses(structure, joints),
        _output(),
    ]  # fmt: skip
    return "\n".join(line for section in sections for line in section) + "\n"


def ssi_text(reaction: Reaction) -> str:
    """Return an SSI file: upper triangles of stiffness and mass, one entry a line."""
    lines = ["! stiffness and mass of what holds a reaction joint, static; SI units"]
    for letter, matrix in (("K", reaction.stiffness), ("M", reaction.mass)):
        values = np.zeros((6, 6)) if matrix is None else np.array(matrix)
        lines += [f"{_n(values[i, j])}   {letter}{_DOFS[i]}{_DOFS[j]}" for i in range(6) for j in range(i, 6)]
    return "\n".join(lines) + "\n"


def _numbers(names: Iterable[str]) -> dict[str, int]:
    """Return {name: number}: the names themselves if all are whole numbers."""
    known = list(names)
    if all(name.isdecimal() and int(name) > 0 for name in known) and len(set(map(int, known))) == len(known):
        return {name: int(name) for name in known}
    return {name: k for k, name in enumerate(known, start=1)}


def _n(value: float) -> str:
    """Return the shortest text that reads back as the same number."""
    return repr(float(value))


def _ruled(title: str) -> str:
    return f"{'-' * 12} {title} ".ljust(88, "-")


def _table(title: str, keyword: str, header: str, rows: Sequence[str]) -> list[str]:
    units = " ".join("(-)" for _ in header.split())
    return [_ruled(title), f"{len(rows):>6}   {keyword:<16}- Number of rows", header, units, *rows]


def _control(structure: Structure, damping: DeckDamping) -> list[str]:
    percent = ", ".join(f"{100.0 * ratio:.15g}" for ratio in damping.modal or (0.0,))
    factors, matrix = (damping.alpha, damping.beta), np.asarray(damping.interface)
    way = 2 if matrix.any() else int(any(factors))
    values = (
        ("False", "Echo", "Echo input data (flag)"),
        ('"DEFAULT"', "SDdeltaT", "Local Integration Step"),
        ("3", "IntMethod", "Integration Method [1/2/3/4 = RK4/AB4/ABM4/AM2]"),
        ("True", "SttcSolve", "Solve dynamics about static equilibrium point"),
        _ruled("FEA and CRAIG-BAMPTON PARAMETERS"),
        (f"{_FEMMOD[structure.beam]}", "FEMMod", "Element model [1= Euler-Bernoulli; 3= 2-node Timoshenko]"),
        (f"{structure.subdivide}", "NDiv", "Number of sub-elements per member"),
        (f"{_MODES}", "Nmodes", "Number of internal modes to retain"),
        (percent, "JDampings", "Damping Ratios for each retained mode (% of critical)"),
        (f"{way}", "GuyanDampMod", "Guyan damping {0=none, 1=Rayleigh Damping, 2=user specified matrix}"),
        (", ".join(map(_n, factors)), "RayleighDamp", "Mass and stiffness proportional damping coefficients"),
        ("6", "GuyanDampSize", "Guyan damping matrix [only if GuyanDampMod=2]"),
        *("   " + "   ".join(_n(value) for value in row) for row in matrix),
        _ruled("INITIAL RIGID-BODY POSITION [floating structures only]"),
        "RBSurge RBSway RBHeave RBRoll RBPitch RBYaw",
        "(m) (m) (m) (deg) (deg) (deg)",
        _ZERO_ROW,
    )  # fmt: skip
    return [
        _ruled("SubDyn MultiMember Support Structure Input File"),
        f"{structure.name}; z = 0 is the mean sea level",
        _ruled("SIMULATION CONTROL"),
        *(row if isinstance(row, str) else f"{row[0]:>12}   {row[1]:<14}- {row[2]}" for row in values),
    ]


def _joints(structure: Structure, joints: dict[str, int]) -> list[str]:
    sea = structure.sea_level_z_m
    header = "JointID JointXss JointYss JointZss JointType JointDirX JointDirY JointDirZ JointStiff"
    rows = [
        f"{joints[name]} {_n(x)} {_n(y)} {_n(z - sea)} 1 0.0 0.0 0.0 0.0"
        for name, (x, y, z) in structure.nodes.items()
    ]
    return _table("STRUCTURE JOINTS: joints connect structure members", "NJoints", header, rows)


def _reactions(structure: Structure, joints: dict[str, int], ssi_files: dict[str, str]) -> list[str]:
    header = "RJointID RctTDXss RctTDYss RctTDZss RctRDXss RctRDYss RctRDZss SSIfile"
    rows = [
        f'{joints[r.node]} {" ".join(str(int(f)) for f in r.fixed)} "{ssi_files.get(r.node, "")}"'
        for r in structure.reactions
    ]
    return _table(
        "BASE REACTION JOINTS: 1/0 for Locked/Free DOF @ each Reaction Node", "NReact", header, rows
    )


def _members(
    structure: Structure,
    joints: dict[str, int],
    members: dict[str, int],
    tubes: dict[Tube, int],
    beams: dict[tuple[Material, BeamSection], int],
) -> list[str]:
    rows = [
        f"{members[m.name]} {joints[m.start]} {joints[m.end]} {tubes[m.material, m.section_start]} "
        f"{tubes[m.material, m.section_end]} 1c 0.0"
        for m in structure.members
    ]
    rows += [
        f"{members[b.name]} {joints[b.start]} {joints[b.end]} {beams[b.material, b.section]} "
        f"{beams[b.material, b.section]} 4 {_n(_spin_deg(structure, b))}"
        for b in structure.beams
    ]
    first = max(members.values(), default=0) + 1
    rows += [
        f"{first + k} {joints[link.leader]} {joints[link.follower]} 1 1 3 0.0"
        for k, link in enumerate(structure.rigid_links)
    ]
    header = "MemberID MJointID1 MJointID2 MPropSetID1 MPropSetID2 MType MSpin/COSMID"
    return _table("MEMBERS", "NMembers", header, rows)


def _beam_row(number: int, m: Material, s: BeamSection) -> str:
    """Return a property set of a beam; SubDyn looks at its shear areas only where shear bends it."""
    shear = (min(s.A_x, s.A), min(s.A_y, s.A))
    numbers = (
        m.youngs_modulus_pa,
        m.shear_modulus_pa,
        m.density_kg_m3,
        s.A,
        *shear,
        s.I_x,
        s.I_y,
        s.I_p,
        s.J,
    )
    return f"{number} {' '.join(map(_n, numbers))}"


def _spin_deg(structure: Structure, b: Beam) -> float:
    """Return by how much a section is turned from SubDyn's own axes about its member."""
    start, end = (np.array(structure.nodes[node]) for node in (b.start, b.end))
    x, (_, deck_x, deck_y) = beam_axes(start, end, b.twist_rad)[1], deck_axes(start, end, 0.0)
    return float(np.degrees(np.arctan2(x @ deck_y, x @ deck_x)))


def _masses(structure: Structure, joints: dict[str, int]) -> list[str]:
    """Return one concentrated mass a joint: several bodies on one become one."""
    by_joint = sorted((m for m in structure.masses if rigid_body_mass(m).any()), key=lambda m: joints[m.node])
    rows = []
    for node, bodies in groupby(by_joint, key=lambda m: m.node):
        body = _joined(list(bodies))
        values = (body.mass_kg, *body.inertia_kg_m2, *body.cg_offset_m)
        rows.append(f"{joints[node]} {' '.join(map(_n, values))}")
    header = "CMJointID JMass JMXX JMYY JMZZ JMXY JMXZ JMYZ MCGX MCGY MCGZ"
    return _table("JOINT ADDITIONAL CONCENTRATED MASSES", "NCmass", header, rows)


def _joined(bodies: list[PointMass]) -> PointMass:
    if len(bodies) == 1:
        return bodies[0]
    M = sum((rigid_body_mass(body) for body in bodies), np.zeros((6, 6)))
    return body_from_static_moments(
        node=bodies[0].node,
        mass_kg=float(M[0, 0]),
        static_moment_kg_m=(float(M[1, 5]), float(M[2, 3]), float(M[0, 4])),
        inertia_about_node_kg_m2=(
            float(M[3, 3]), float(M[4, 4]), float(M[5, 5]), float(M[3, 4]), float(M[3, 5]), float(M[4, 5]),
        ),
    )  # fmt: skip


def _output() -> list[str]:
    switches = (
        ("True", "SumPrint", "Output a Summary File (flag)"),
        ("0", "OutCBModes", "Output Guyan and Craig-Bampton modes"),
        ("0", "OutFEMModes", "Output first 30 FEM modes"),
        ("False", "OutCOSM", "Output cosine matrices with the selected output member forces (flag)"),
        ("False", "OutAll", "Output all members' end forces (flag)"),
        ("2", "OutSwtch", "Output requested channels to: 1=<rootname>.SD.out; 2=<rootname>.out; 3=both"),
        ("True", "TabDelim", "Generate a tab-delimited output (flag)"),
        ("1", "OutDec", "Decimation of output"),
        ('"ES15.6e2"', "OutFmt", "Output format for numerical results"),
        ('"A15"', "OutSFmt", "Output format for header strings"),
        _ruled("MEMBER OUTPUT LIST"),
        ("0", "NMOutputs", "Number of members whose forces will be output (-)"),
        "MemberID NOutCnt NodeCnt",
        "(-) (-) (-)",
        _ruled("SSOutList"),
        '"IntfFXss, IntfFYss, IntfFZss, IntfMXss, IntfMYss, IntfMZss"',
        "END of output channels and end of file (END must appear in the first 3 columns of this line)",
    )
    return [
        _ruled("OUTPUT: SUMMARY & OUTFILE"),
        *(row if isinstance(row, str) else f"{row[0]:>12}   {row[1]:<14}- {row[2]}" for row in switches),
    ]
