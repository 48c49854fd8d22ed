"""``jackettwin check``: every member under self-weight and given forces, to ISO 19902."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from jackettwin.caveats import Omission, omission_documents, omission_sentences
from jackettwin.checks import EDITIONS
from jackettwin.cli.console import FiniteFloat, Reply, answers, numbers_of, say, say_all, show_table, working
from jackettwin.cli.modes import pile_model_option, supported_option
from jackettwin.errors import InputError, look_up
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray
    from jackettwin.checks import BraceUse, DesignBasis, FrameUse, MemberUse, SheetLine, VortexUse
    from jackettwin.response import System
    from jackettwin.soil import PileModel, PileUse
    from jackettwin.structure import Assembly


_SHOWN = 15
"""Number of members shown on the terminal."""
_COMPONENTS = ("axial_n", "shear_y_n", "shear_z_n", "torsion_nm", "bending_y_nm", "bending_z_nm")
_HEAD = ("x_n", "y_n", "z_n", "x_nm", "y_nm", "z_nm")
_TRACE = 0.005
"""Share of a joint's class below which it is not shown."""
_HEADINGS = ("N", "Vy", "Vz", "T", "My", "Mz")


@click.command("check")
@click.argument("structure", required=False)
@click.option("--scenario", help="Check the worst instant of a simulated scenario instead.")
@click.option(
    "--combinations",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Check the envelope of the factored combinations of a YAML file.",
)
@click.option("--support", help="As for `jackettwin modes`.")
@pile_model_option
@click.option(
    "--force",
    "forces",
    multiple=True,
    metavar="NODE=FX,FY,FZ[,MX,MY,MZ]",
    help="A factored force [N, N·m]; may be repeated.",
)
@click.option("--no-weight", is_flag=True, help="Neglect the self-weight.")
@click.option("--yield-strength", default=355e6, show_default=True, type=FiniteFloat(min=1e6), help="[Pa]")
@click.option(
    "--edition", default="2007", show_default=True, type=click.Choice(EDITIONS), help="Of ISO 19902."
)
@click.option(
    "--joints",
    default="load-path",
    show_default=True,
    type=click.Choice(("load-path", "conservative")),
    help="Classification of tubular joints: by load path, or the weakest of K, Y and X.",
)
@click.option(
    "--still-water",
    is_flag=True,
    help="Add buoyancy, and hydrostatic pressure on members that are not flooded.",
)
@click.option("--flooded", multiple=True, metavar="MEMBER|PART", help="With --still-water; may be repeated.")
@click.option(
    "--joint-forces",
    default="node",
    show_default=True,
    type=click.Choice(("node", "face")),
    help="Braces' forces where axes meet, or where they meet the chord's wall.",
)
@click.option(
    "--effective-lengths",
    default="one",
    show_default=True,
    type=click.Choice(("one", "class")),
    help="K of braces: 1, or by class, table 13.5-1.",
)
@click.option("--tensile-strength", type=FiniteFloat(min=1e6), help="f_u of chords [Pa]: f_y ≤ 0.8 f_u.")
@click.option("--sheet", metavar="MEMBER", help="The calculation of a member, line by line, for a checker.")
@click.option(
    "--pile-resistance",
    default=1.25,
    show_default=True,
    type=FiniteFloat(1.0, 5.0),
    help="Partial factor on the axial capacity of piles: 1.5 under permanent and variable actions.",
)
@click.option(
    "--wind",
    type=FiniteFloat(0.0, 150.0),
    help="Mean wind speed [m/s] to screen members in air for vortex-induced vibrations.",
)
@click.option(
    "--current", type=FiniteFloat(0.0, 10.0), help="Current speed [m/s] to screen members in water likewise."
)
@click.option(
    "--subdivide", type=click.IntRange(1, 1000), help="Elements per member; default: the structure's own."
)
@answers
def check_command(
    structure: str | None,
    scenario: str | None,
    combinations: Path | None,
    support: str | None,
    pile_model: PileModel | None,
    forces: tuple[str, ...],
    no_weight: bool,
    yield_strength: float,
    edition: str,
    joints: str,
    joint_forces: str,
    effective_lengths: str,
    tensile_strength: float | None,
    still_water: bool,
    flooded: tuple[str, ...],
    sheet: str | None,
    pile_resistance: float,
    wind: float | None,
    current: float | None,
    subdivide: int | None,
) -> Reply:
    """Check members and joints of STRUCTURE, or of a scenario.

    STRUCTURE is at rest under its weight and the forces given, or under those that --combinations factors.
    """
    from jackettwin.checks import DesignBasis, frame_use, left_out, vortex_uses
    from jackettwin.decks import read_structure
    from jackettwin.loads import Water
    from jackettwin.response import build_system, nodal_load, self_weight, static_displacement, undamped_modes
    from jackettwin.simulate import read_scenario, scenario_uses, water_at_rest, water_notes
    from jackettwin.structure import assemble, element_weight

    basis = DesignBasis(
        yield_strength,
        edition,
        conservative_joints=joints == "conservative",
        tensile_strength_pa=tensile_strength,
        by_class=effective_lengths == "class",
        joints_at_face=joint_forces == "face",
    )
    if combinations is not None:
        _refuse(
            "belongs to actions that are not combined",
            "leave it out: the file of combinations has the actions",
            scenario=scenario,
            force=forces or None,
            no_weight=no_weight or None,
            still_water=still_water or None,
            flooded=flooded or None,
            sheet=sheet,
            wind=wind,
            current=current,
        )
        return _combined(combinations, structure, support, pile_model, subdivide, basis)
    if (structure is None) == (scenario is None):
        raise InputError(
            "give a structure or --scenario", field="STRUCTURE", remedy="keep exactly one of them"
        )
    if flooded and not still_water:
        raise InputError("needs --still-water", field="--flooded", value=flooded, remedy="add --still-water")
    if scenario is not None:
        at_rest = "belongs to a structure at rest"
        _refuse(at_rest, "leave it out: a scenario has its own water", still_water=still_water or None)
        _refuse(at_rest, "name the structure", wind=wind, current=current, sheet=sheet)
        chosen_scenario = read_scenario(scenario)
        use = scenario_uses(chosen_scenario, basis)
        stands = chosen_scenario.asset.structure
        missing = (*left_out(stands), *_flows_left_out(None, None), *_piles_left_out(()))
        return _answer(chosen_scenario.name, use, water_notes(chosen_scenario), missing)
    assert structure is not None
    assembly = assemble(read_structure(structure), subdivide=subdivide)
    stands, held = supported_option(support, assembly, pile_model)
    if stands is not assembly.structure:
        assembly = assemble(stands, subdivide=subdivide)
    load, along = nodal_load(assembly, dict(nodal_force(text) for text in forces)), None
    if not no_weight:
        load, along = load + self_weight(assembly), element_weight(assembly)
    pressure = None
    if still_water:
        wet, wet_along, pressure = water_at_rest(assembly, Water(flooded))
        load, along = load + wet, wet_along if along is None else along + wet_along
    system = build_system(assembly, held)
    u = static_displacement(system, load)
    use = frame_use(assembly, u, basis, along=along, pressure=pressure)
    piles = _piles(support, pile_model, system, u, basis, pile_resistance)
    missing = (*left_out(assembly.structure), *_flows_left_out(wind, current), *_piles_left_out(piles))
    vortices: tuple[VortexUse, ...] = ()
    if wind is not None or current is not None:
        lowest = float(undamped_modes(system, 1).frequency_hz[0])
        vortices = vortex_uses(
            assembly.structure, wind_m_s=wind, current_m_s=current, first_frequency_hz=lowest
        )
    return _answer(
        assembly.structure.name,
        use,
        [],
        missing,
        piles=piles,
        vortices=vortices,
        sheet=_sheet(sheet, assembly, use, basis),
    )


def _refuse(problem: str, remedy: str, **given: object) -> None:
    """Refuse options that do not belong to what is checked."""
    for name, value in given.items():
        if value is not None:
            raise InputError(problem, field=f"--{name.replace('_', '-')}", remedy=remedy)


def _combined(
    path: Path,
    structure: str | None,
    support: str | None,
    pile_model: PileModel | None,
    subdivide: int | None,
    basis: DesignBasis,
) -> Reply:
    """Return the envelope of a file of combinations, with each one's own worst use."""
    from jackettwin.checks import left_out
    from jackettwin.decks import read_structure
    from jackettwin.response import build_system
    from jackettwin.simulate import combined_uses, read_combinations
    from jackettwin.structure import assemble

    file, system = read_combinations(path), None
    name, stands = path.stem, None
    if structure is not None:
        assembly = assemble(read_structure(structure), subdivide=subdivide)
        stands, held = supported_option(support, assembly, pile_model)
        system = build_system(assemble(stands, subdivide=subdivide), held)
        name = stands.name
    with working(f"combinations of {path.name}"):
        found = combined_uses(file, basis, system)
    omissions = () if stands is None else left_out(stands)
    factored = [one for one in omissions if "partial action factors" not in one.what]
    missing = (*factored, *_flows_left_out(None, None), *_piles_left_out(()))
    return _answer(name, found.envelope, [], missing, combinations=found.each)


def _sheet(
    name: str | None, assembly: Assembly, use: FrameUse, basis: DesignBasis
) -> tuple[SheetLine, ...] | None:
    """Return the calculation of a member; None if none is requested."""
    from jackettwin.checks import calculation_sheet

    if name is None:
        return None
    members = {one.name: one for one in assembly.structure.members}
    member = look_up(members, name, "member", field="--sheet")
    return calculation_sheet(member, next(one for one in use.members if one.member == name), basis)


def _piles(
    support: str | None,
    model: PileModel | None,
    system: System,
    u: FloatArray,
    basis: DesignBasis,
    resistance: float,
) -> tuple[PileUse, ...]:
    """Return the use of every pile of a foundation whose piles are lumped at their heads."""
    from jackettwin.soil import head_forces, named_foundation, pile_use

    ground = named_foundation(support)
    if ground is None or ground.curves is None or (model or ground.pile_model) == "members":
        return ()
    assembly = system.assembly
    moved = {foot: u[assembly.dofs(foot)] for foot in assembly.structure.reaction_nodes}
    return tuple(
        pile_use(foot, ground.pile, ground.curves, force, basis=basis, resistance=resistance)
        for foot, force in head_forces(system.support, moved).items()
    )


def _piles_left_out(piles: tuple[PileUse, ...]) -> tuple[Omission, ...]:
    """Return the omitted parts of the check of piles, and how to include them."""
    if not piles:
        how = "piles: give --support FOUNDATION with layers, piles lumped at their heads"
        return (Omission(how, "ISO 19902 17"),)
    return (
        Omission(
            "piles: group effects, cyclic degradation along the axis, set-up, the weight of piles and plug, "
            "yielding steel and driving; the structure is supported by the ground's initial stiffness",
            "ISO 19902 17",
        ),
    )


def _flows_left_out(wind: float | None, current: float | None) -> tuple[Omission, ...]:
    """Return the omitted parts of the screening for vortices, and how to include them."""
    found = []
    if wind is None:
        found.append(Omission("vortices in air: give a structure and --wind", "EN 1991-1-4 E.1"))
    if current is None:
        found.append(Omission("vortices in water: give a structure and --current", "DNV-RP-C205 9"))
    if wind is not None or current is not None:
        what = "vortices: the response beyond the onset, marine growth, waves and neighbouring members"
        found.append(Omission(what, "DNV-RP-C205 9"))
    return tuple(found)


def _answer(
    name: str,
    use: FrameUse,
    notes: list[str],
    missing: tuple[Omission, ...],
    *,
    piles: tuple[PileUse, ...] = (),
    vortices: tuple[VortexUse, ...] = (),
    sheet: tuple[SheetLine, ...] | None = None,
    combinations: Mapping[str, FrameUse] | None = None,
) -> Reply:
    members = sorted(use.members, key=lambda one: (not one.covered, -one.utilisation))
    joints = sorted(use.joints, key=lambda one: (bool(one.joint.beyond_validity), -one.utilisation))
    document = {
        "structure": name,
        "largest_von_mises_stress_pa": max(one.von_mises_pa for one in use.members),
        "members": [_row(one) for one in members],
        "joints": [_joint_row(one) for one in joints],
        "combinations": [_combination_row(case, one) for case, one in (combinations or {}).items()],
        "sheet": None if sheet is None else [line._asdict() for line in sheet],
        "piles": [_pile_row(one) for one in sorted(piles, key=lambda one: -one.axial)],
        "vortices": [_vortex_row(one) for one in vortices],
        "warnings": [*_warnings(use), *_pile_warnings(piles), *_vortex_warnings(vortices), *notes],
        "left_out": omission_documents(missing),
    }
    return Reply(document, lambda: _show(document))


def _combination_row(case: str, use: FrameUse) -> dict[str, Any]:
    """Return the largest uses of a combination within the ranges of their rules."""
    members = [one for one in use.members if one.covered]
    joints = [one for one in use.joints if not one.joint.beyond_validity]
    member = max(members, key=lambda one: one.utilisation, default=None)
    joint = max(joints, key=lambda one: one.utilisation, default=None)
    return {
        "combination": case,
        "member": None if member is None else member.member,
        "utilisation": None if member is None else member.utilisation,
        "joint": None if joint is None else f"{joint.brace} at {joint.node}",
        "joint_utilisation": None if joint is None else joint.utilisation,
    }


def nodal_force(text: str) -> tuple[str, tuple[float, ...]]:
    """Return node and components of ``NODE=FX,FY,FZ``.

    Raises
    ------
    InputError
        If the text has another form.
    """
    node, _, numbers = text.partition("=")
    return node, numbers_of(numbers, "--force", "NODE=FX,FY,FZ[,MX,MY,MZ]", (3, 6), given=text)


def _row(use: MemberUse) -> dict[str, Any]:
    from jackettwin.checks import ALL_CHECKS

    worst = use.worst
    return {
        "member": use.member,
        "part": use.part,
        "utilisation": use.utilisation,
        "check": use.check,
        "clause": ALL_CHECKS[use.check],
        "by_check": dict(use.by_check),
        "effective_length_factor": use.buckling.K,
        "column_length_m": use.buckling.L,
        "governing": {"position": worst.position} | _forces(worst.forces),
        "start": _forces(worst.end_forces[0]),
        "end": _forces(worst.end_forces[1]),
        "von_mises_stress_pa": use.von_mises_pa,
        "covered": use.covered,
        "combination": use.case or None,
    }


def _forces(six: FloatArray) -> dict[str, float]:
    return dict(zip(_COMPONENTS, map(float, six), strict=True))


def _joint_row(use: BraceUse) -> dict[str, Any]:
    from jackettwin.checks import KINDS

    joint = use.joint
    return {
        "node": use.node,
        "chord": use.chord,
        "brace": use.brace,
        "utilisation": use.utilisation,
        "kind": use.kind,
        "shares": dict(zip(KINDS, use.shares, strict=True)),
        "axial_n": use.forces[0],
        "in_plane_nm": use.forces[1],
        "out_of_plane_nm": use.forces[2],
        "strength_factor": use.Q_u,
        "chord_factor": use.Q_f,
        "beta": joint.beta,
        "gamma": joint.gamma,
        "tau": joint.t / joint.T,
        "theta_deg": float(np.degrees(joint.theta)),
        "gap_m": joint.gap if np.isfinite(joint.gap) else None,
        "beyond_validity": list(joint.beyond_validity),
        "can_factor": joint.can_factor,
        "can_short_m": joint.can_short_m,
        "to_brace": use.to_brace if np.isfinite(use.to_brace) else None,
        "combination": use.case or None,
    }


def _pile_row(use: PileUse) -> dict[str, Any]:
    steel, capacity = use.steel, use.capacity
    return {
        "foot": use.foot,
        "axial_utilisation": use.axial,
        "capacity_compression_n": capacity.compression_n,
        "capacity_tension_n": capacity.tension_n,
        "plugged": capacity.plugged,
        "stands": use.stands,
        "head_displacement_m": use.head_m,
        "head_rotation_rad": use.rotation_rad,
        "steel_utilisation": None if steel is None else steel.utilisation,
        "steel_check": None if steel is None else steel.check,
        "steel_depth_m": use.steel_depth_m,
        "steel_forces": None if steel is None else _forces(steel.worst.forces),
        "head_force": dict(zip(_HEAD, map(float, use.force), strict=True)),
    }


def _pile_warnings(uses: tuple[PileUse, ...]) -> list[str]:
    from jackettwin.structure import few

    over = [use.foot for use in uses if use.axial > 1.0 or (use.steel and use.steel.utilisation > 1.0)]
    fallen = [use.foot for use in uses if not use.stands]
    found = [f"piles used above 1: {few(over)}"] if over else []
    return found + ([f"the ground cannot carry the piles of {few(fallen)}"] if fallen else [])


def _vortex_row(use: VortexUse) -> dict[str, Any]:
    from jackettwin.checks import CLAUSES

    return {
        **use._asdict(),
        "onset_m_s": use.onset_m_s,
        "ratio": use.ratio,
        "excites": use.direction,
        "clause": CLAUSES[use.medium],
    }


def _vortex_warnings(uses: tuple[VortexUse, ...]) -> list[str]:
    from jackettwin.checks import CLAUSES
    from jackettwin.structure import few

    found = []
    for medium, clause in CLAUSES.items():
        names = [use.member for use in uses if use.medium == medium and use.ratio >= 1.0]
        if names:
            found.append(f"vortices may excite members in {medium} ({clause}): {few(names)}")
    return found


def _warnings(use: FrameUse) -> list[str]:
    from jackettwin.structure import few

    # rows beyond a rule's range are last in the tables and not in the headline
    thin = [one.member for one in use.members if not one.covered]
    over = [one.member for one in use.members if one.covered and one.utilisation > 1.0]
    joints = [
        f"{one.brace} at {one.node}"
        for one in use.joints
        if one.utilisation > 1.0 and not one.joint.beyond_validity
    ]
    short = [f"{one.brace} at {one.node}" for one in use.joints if one.joint.can_short_m > 0.0]
    beyond = [(f"{one.brace} at {one.node}", why) for one in use.joints for why in one.joint.beyond_validity]
    found = []
    if thin:
        found.append(f"D/t above 120, beyond ISO 19902 13: {few(thin)}")
    if over:
        found.append(f"used above 1: {few(over)}")
    if joints:
        found.append(f"joints used above 1: {few(joints)}")
    if short:
        found.append(f"cans shorter than ISO 19902 14.2.2 asks: {few(short)}")
    if beyond:
        named = few(list(dict.fromkeys(name for name, _ in beyond)))
        found.append(f"joints beyond the ranges of ISO 19902 14.3.1 ({beyond[0][1]}, …): {named}")
    return found


def _show(document: dict[str, Any]) -> None:
    members = document["members"]
    show_table(Table(document["structure"], _USE, members[:_SHOWN]))
    if not all(row["covered"] for row in members[:_SHOWN]):
        say("* D/t above 120, beyond 13.1")
    if document["combinations"]:
        show_table(Table("combinations", _COMBINATIONS, document["combinations"]))
    show_table(Table("section forces there [kN, kN·m]", _SECTION_FORCES, members[:_SHOWN]))
    if len(members) > _SHOWN:
        more = len(members) - _SHOWN
        say(f"and {more} more members; --json has all of them, with the forces at both ends")
    if document["joints"]:
        _show_joints(document["joints"])
    if document["piles"]:
        show_table(
            Table("piles, ISO 19902 17 and 13; forces on their heads in MN", _PILES, document["piles"])
        )
    if document["vortices"]:
        show_table(Table("vortices, by reduced velocity", _VORTICES, document["vortices"][:_SHOWN]))
    if document["sheet"] is not None:
        show_table(Table("calculation, ISO 19902 clause 13", _SHEET, document["sheet"]))
    say(f"largest von Mises stress {document['largest_von_mises_stress_pa'] / 1e6:.1f} MPa")
    say_all(document["warnings"], "warning")
    say_all(omission_sentences(document["left_out"]), "left out")


def _show_joints(rows: list[dict[str, Any]]) -> None:
    show_table(Table("tubular joints, ISO 19902 14.3; forces in kN, kN·m", _JOINTS, rows[:_SHOWN]))
    if any(row["beyond_validity"] for row in rows[:_SHOWN]):
        say("* beyond the ranges of 14.3.1; --json gives the reason")
    if len(rows) > _SHOWN:
        say(f"and {len(rows) - _SHOWN} more braces at joints; --json has all of them")


def _governing(name: str) -> Callable[[dict[str, Any]], float]:
    return lambda row: row["governing"][name]


_PLACES = {0.0: "start", 1.0: "end"}
_USE = (
    TableColumn("member", "member"),
    TableColumn("part", "part"),
    TableColumn("utilisation", lambda row: f"{row['utilisation']:.3f}{'' if row['covered'] else '*'}"),
    TableColumn("governed by", "clause"),
    TableColumn("K", "effective_length_factor", "g"),
    TableColumn("L [m]", "column_length_m", ".2f"),
)
_COMBINATIONS = (
    TableColumn("combination", "combination"),
    TableColumn("member", "member"),
    TableColumn("utilisation", "utilisation", ".3f"),
    TableColumn("joint", "joint"),
    TableColumn("utilisation", "joint_utilisation", ".3f"),
)
_SECTION_FORCES = (
    TableColumn("member", "member"),
    TableColumn("at", lambda row: _PLACES.get(at := row["governing"]["position"], f"{at:.2f} L")),
    *(
        TableColumn(heading, _governing(name), ",.1f", 1e-3)
        for heading, name in zip(_HEADINGS, _COMPONENTS, strict=True)
    ),
)
_JOINTS = (
    TableColumn("joint", "node"),
    TableColumn("chord", "chord"),
    TableColumn("brace", "brace"),
    TableColumn(
        "utilisation", lambda row: f"{row['utilisation']:.3f}{'*' if row['beyond_validity'] else ''}"
    ),
    TableColumn(
        "class",
        lambda row: " ".join(
            f"{kind} {share:.2f}" for kind, share in row["shares"].items() if share > _TRACE
        ),
    ),
    TableColumn("β", "beta", ".2f"),
    TableColumn("γ", "gamma", ".1f"),
    TableColumn("θ [°]", "theta_deg", ".0f"),
    TableColumn("N", "axial_n", ",.1f", 1e-3),
    TableColumn("M in plane", "in_plane_nm", ",.1f", 1e-3),
    TableColumn("M out of plane", "out_of_plane_nm", ",.1f", 1e-3),
)
_SHEET = (
    TableColumn("", "symbol"),
    TableColumn("formula", "formula"),
    TableColumn("value", "value", ".5g"),
    TableColumn("unit", "unit"),
    TableColumn("clause", "clause"),
)
_PILES = (
    TableColumn("foot", "foot"),
    TableColumn("axial use", "axial_utilisation", ".3f"),
    TableColumn("steel use", "steel_utilisation", ".3f"),
    TableColumn("at depth [m]", "steel_depth_m", ".1f"),
    TableColumn("head moves [mm]", "head_displacement_m", ".1f", 1e3),
    TableColumn("capacity ↓ [MN]", "capacity_compression_n", ".1f", 1e-6),
    TableColumn("↑ [MN]", "capacity_tension_n", ".1f", 1e-6),
    TableColumn("Fz", lambda row: row["head_force"]["z_n"], ".2f", 1e-6),
    TableColumn("Fx", lambda row: row["head_force"]["x_n"], ".2f", 1e-6),
    TableColumn("Fy", lambda row: row["head_force"]["y_n"], ".2f", 1e-6),
)
_VORTICES = (
    TableColumn("member", "member"),
    TableColumn("in", "medium"),
    TableColumn("D [m]", "diameter_m", ".2f"),
    TableColumn("f [Hz]", "frequency_hz", ".3g"),
    TableColumn("V_R", "reduced_velocity", ".2f"),
    TableColumn("onset", "onset", ".2f"),
    TableColumn("from [m/s]", "onset_m_s", ".2f"),
    TableColumn("excites", "excites"),
    TableColumn("by", "clause"),
)
