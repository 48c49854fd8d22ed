"""``jackettwin check``: every member under self-weight and given forces, to ISO 19902."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jackettwin.caveats import Omission
from jackettwin.checks import EDITIONS
from jackettwin.cli.check_document import check_document
from jackettwin.cli.check_tables import show_check
from jackettwin.cli.console import FiniteFloat, Reply, answers, numbers_of, working
from jackettwin.cli.modes import pile_model_option, supported_option
from jackettwin.errors import InputError, look_up, require

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray
    from jackettwin.checks import DesignBasis, FrameUse, GroutUse, SheetLine, VortexUse
    from jackettwin.response import System
    from jackettwin.soil import PileModel, PileUse
    from jackettwin.structure import Structure


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
@click.option(
    "--sheet",
    metavar="MEMBER|NODE:BRACE",
    help="The calculation of a member, or of a brace's joint, line by line, for a checker.",
)
@click.option(
    "--pile-resistance",
    default=1.25,
    show_default=True,
    type=FiniteFloat(1.0, 5.0),
    help="Partial factor on the axial capacity of piles: 1.5 under permanent and variable actions.",
)
@click.option(
    "--grout",
    type=click.Path(dir_okay=False, path_type=Path),
    help="A YAML file of the grouted connections of piles with feet or sleeves, to be checked.",
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
    grout: Path | None,
    wind: float | None,
    current: float | None,
    subdivide: int | None,
) -> Reply:
    """Check members and joints of STRUCTURE, or of a scenario.

    STRUCTURE is at rest under its weight and the forces given, or under those that --combinations factors.
    """
    from jackettwin.checks import DesignBasis

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
            wind=wind,
            current=current,
        )
        return _combined(
            combinations, structure, support, pile_model, subdivide, basis, pile_resistance, grout, sheet
        )
    if (structure is None) == (scenario is None):
        raise InputError(
            "give a structure or --scenario", field="STRUCTURE", remedy="keep exactly one of them"
        )
    if flooded and not still_water:
        raise InputError("needs --still-water", field="--flooded", value=flooded, remedy="add --still-water")
    if scenario is not None:
        at_rest = "belongs to a structure at rest"
        _refuse(at_rest, "leave it out: a scenario has its own water", still_water=still_water or None)
        _refuse(at_rest, "name the structure", wind=wind, current=current, grout=grout)
        return _of_scenario(scenario, basis, sheet)
    assert structure is not None
    return _at_rest(
        structure,
        (support, pile_model),
        subdivide,
        basis,
        forces=dict(nodal_force(text) for text in forces),
        weight=not no_weight,
        flooded=flooded if still_water else None,
        resistance=pile_resistance,
        grout=grout,
        flows=(wind, current),
        sheet=sheet,
    )


def _of_scenario(scenario: str, basis: DesignBasis, sheet: str | None) -> Reply:
    """Return the worst use of each member and joint in a simulated scenario."""
    from jackettwin.simulate import read_scenario, scenario_uses, water_notes

    chosen = read_scenario(scenario)
    use = scenario_uses(chosen, basis)
    missing = _left_out(chosen.asset.structure)
    return _reply(chosen.name, use, water_notes(chosen), missing, sheet=_sheet(sheet, use, basis))


def _at_rest(
    source: str,
    held_by: tuple[str | None, PileModel | None],
    subdivide: int | None,
    basis: DesignBasis,
    *,
    forces: dict[str, tuple[float, ...]],
    weight: bool,
    flooded: tuple[str, ...] | None,
    resistance: float,
    grout: Path | None,
    flows: tuple[float | None, float | None],
    sheet: str | None,
) -> Reply:
    """Return the use of a structure at rest.

    ``flooded`` is None out of water; ``flows`` are the speeds of wind and current [m/s].
    """
    from jackettwin.checks import frame_use, vortex_uses
    from jackettwin.decks import read_structure
    from jackettwin.loads import Water
    from jackettwin.response import build_system, nodal_load, self_weight, static_displacement, undamped_modes
    from jackettwin.simulate import water_at_rest
    from jackettwin.structure import assemble, element_weight, posture

    assembly = assemble(read_structure(source), subdivide=subdivide)
    stands, held = supported_option(held_by[0], assembly, held_by[1])
    if stands is not assembly.structure:
        assembly = assemble(stands, subdivide=subdivide)
    load, along, pressure = nodal_load(assembly, forces), None, None
    if weight:
        load, along = load + self_weight(assembly), element_weight(assembly)
    if flooded is not None:
        wet, wet_along, pressure = water_at_rest(assembly, Water(flooded))
        load, along = load + wet, wet_along if along is None else along + wet_along
    system = build_system(assembly, held)
    u = static_displacement(system, load)
    use = frame_use(assembly, u, basis, along=along, pressure=pressure)
    piles = _piles(*held_by, system, u, basis, resistance)
    vortices: tuple[VortexUse, ...] = ()
    if flows != (None, None):
        lowest = float(undamped_modes(system, 1).frequency_hz[0])
        vortices = vortex_uses(stands, wind_m_s=flows[0], current_m_s=flows[1], first_frequency_hz=lowest)
    return _reply(
        stands.name,
        use,
        list(posture(stands)),
        _left_out(stands, flows, piles, grout),
        piles=piles,
        grouted=_grouted(grout, system, u),
        vortices=vortices,
        sheet=_sheet(sheet, use, basis),
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
    resistance: float,
    grout: Path | None,
    sheet: str | None,
) -> Reply:
    """Return the envelope of a file of combinations, with each one's own worst use."""
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
    piles: dict[str, PileUse] = {}
    grouted: dict[str, GroutUse] = {}
    for case, u in found.at_rest.items():
        assert system is not None
        with working(f"piles in {case}"):
            for one in _piles(support, pile_model, system, u, basis, resistance):
                known = piles.get(one.foot)
                if known is None or one.worst > known.worst:
                    piles[one.foot] = replace(one, case=case)
        for use in _grouted(grout, system, u):
            if use.foot not in grouted or use.utilisation > grouted[use.foot].utilisation:
                grouted[use.foot] = replace(use, case=case)
    listed = _left_out(stands, piles=tuple(piles.values()), grout=grout)
    missing = tuple(one for one in listed if "partial action factors" not in one.what)
    if (piles or grouted) and len(found.at_rest) < len(found.each):
        missing = (*missing, Omission("piles and grout in combinations of scenarios", "ISO 19902 17, 15.1"))
    return _reply(
        name,
        found.envelope,
        [],
        missing,
        piles=tuple(piles.values()),
        grouted=tuple(grouted.values()),
        sheet=_sheet(sheet, found.envelope, basis),
        combinations=found.each,
    )


def _sheet(name: str | None, use: FrameUse, basis: DesignBasis) -> tuple[SheetLine, ...] | None:
    """Return the calculation of a member or a joint; None if none is requested."""
    from jackettwin.checks import calculation_sheet, joint_sheet

    if name is None:
        return None
    joints = {f"{one.node}:{one.brace}": one for one in use.joints}
    if ":" in name:
        joint = look_up(joints, name, "joint, NODE:BRACE,", field="--sheet")
        return joint_sheet(joint, conservative=basis.conservative_joints)
    members = {one.member: one for one in use.members}
    return calculation_sheet(look_up(members, name, "member", field="--sheet"), basis)


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


def _grouted(path: Path | None, system: System, u: FloatArray) -> tuple[GroutUse, ...]:
    """Return the use of the grouted connections of a file; none without one."""
    from jackettwin.checks import grout_uses, read_grouted
    from jackettwin.soil import head_forces

    if path is None:
        return ()
    assembly = system.assembly
    moved = {foot: u[assembly.dofs(foot)] for foot in assembly.structure.reaction_nodes}
    connections = read_grouted(path, tuple(moved))
    held = {spring.node for spring in system.support.springs}
    for foot in connections:
        require(
            foot in held,
            "the force of a foot that does not move is not known here",
            field="--grout",
            value=foot,
            remedy="put the feet on springs: --support",
        )
    return grout_uses(connections, head_forces(system.support, moved))


def _left_out(
    stands: Structure | None,
    flows: tuple[float | None, float | None] = (None, None),
    piles: tuple[PileUse, ...] = (),
    grout: Path | None = None,
) -> tuple[Omission, ...]:
    """Return what a check of a structure, None for scenarios without a common one, omits."""
    from jackettwin.checks import left_out

    frame = () if stands is None else left_out(stands)
    return (*frame, *_flows_left_out(*flows), *_piles_left_out(piles), *_grout_left_out(grout))


def _grout_left_out(path: Path | None) -> tuple[Omission, ...]:
    """Return the omitted parts of the check of grouted connections, and how to include them."""
    if path is None:
        return (Omission("grouted connections: give a structure at rest and --grout FILE", "ISO 19902 15.1"),)
    what = "grouted connections: bending, torsion, fatigue and grout in the early age; piles count as upright"
    return (Omission(what, "ISO 19902 15.1"),)


def _piles_left_out(piles: tuple[PileUse, ...]) -> tuple[Omission, ...]:
    """Return the omitted parts of the check of piles, and how to include them."""
    if not piles:
        how = "piles: give --support FOUNDATION with layers, piles lumped at their heads"
        return (Omission(how, "ISO 19902 17"),)
    return (
        Omission(
            "piles: group effects, cycles and set-up beyond the foundation's `curves`, weight of piles and "
            "plug, driving; the structure is supported by the ground's initial stiffness",
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


def nodal_force(text: str) -> tuple[str, tuple[float, ...]]:
    """Return node and components of ``NODE=FX,FY,FZ``.

    Raises
    ------
    InputError
        If the text has another form.
    """
    node, _, numbers = text.partition("=")
    return node, numbers_of(numbers, "--force", "NODE=FX,FY,FZ[,MX,MY,MZ]", (3, 6), given=text)


def _reply(*about: Any, **further: Any) -> Reply:
    """Return the document of a check, and how it is printed."""
    document = check_document(*about, **further)
    return Reply(document, lambda: show_check(document))
