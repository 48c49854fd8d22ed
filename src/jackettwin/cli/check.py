"""``jackettwin check``: every member under self-weight and given forces, to ISO 19902."""

from __future__ import annotations

from typing import Any

import click
import numpy as np
from rich.table import Table

from jackettwin.arrays import FloatArray
from jackettwin.checks import (
    ALL_CHECKS,
    EDITIONS,
    KINDS,
    BraceUse,
    DesignBasis,
    FrameUse,
    MemberUse,
    frame_use,
)
from jackettwin.cli.console import FiniteFloat, fixed, numbers_of, output, print_json
from jackettwin.cli.modes import support_option
from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.loads import (
    Coefficients,
    Water,
    morison_points,
    outside_pressure,
    still_water as still_water_loads,
)
from jackettwin.response import build_system, nodal_load, self_weight, static_displacement
from jackettwin.simulate import read_scenario, scenario_uses, water_notes
from jackettwin.structure import Assembly, assemble
from jackettwin.structure.check import few
from jackettwin.structure.forces import element_weight

_SHOWN = 15
"""Members in the terminal."""
_COMPONENTS = ("axial_n", "shear_y_n", "shear_z_n", "torsion_nm", "bending_y_nm", "bending_z_nm")
_JOINT_FORCES = ("N", "M in plane", "M out of plane")
_TRACE = 0.005
"""A share of a joint's class that rounds to nothing."""
_HEADINGS = ("N", "Vy", "Vz", "T", "My", "Mz")


@click.command("check")
@click.argument("structure", required=False)
@click.option("--scenario", help="Check the worst instant of a simulated scenario instead.")
@click.option("--support", help="As for `jackettwin modes`.")
@click.option(
    "--force",
    "forces",
    multiple=True,
    metavar="NODE=FX,FY,FZ[,MX,MY,MZ]",
    help="A factored force [N, N·m]; may be repeated.",
)
@click.option("--no-weight", is_flag=True, help="Leave the self-weight out.")
@click.option("--yield-strength", default=355e6, show_default=True, type=FiniteFloat(min=1e6), help="[Pa]")
@click.option(
    "--edition", default="2007", show_default=True, type=click.Choice(EDITIONS), help="Of ISO 19902."
)
@click.option(
    "--joints",
    default="load-path",
    show_default=True,
    type=click.Choice(("load-path", "conservative")),
    help="Class of tubular joints: by load path, or the weakest of K, Y and X.",
)
@click.option(
    "--still-water", is_flag=True, help="Buoyancy, and hydrostatic pressure on what is not flooded."
)
@click.option("--flooded", multiple=True, metavar="MEMBER|PART", help="With --still-water; may be repeated.")
@click.option(
    "--subdivide", type=click.IntRange(1, 1000), help="Elements a member; default: the structure's own."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def check_command(
    structure: str | None,
    scenario: str | None,
    support: str | None,
    forces: tuple[str, ...],
    no_weight: bool,
    yield_strength: float,
    edition: str,
    joints: str,
    still_water: bool,
    flooded: tuple[str, ...],
    subdivide: int | None,
    as_json: bool,
) -> None:
    """Check members and joints of STRUCTURE at rest under weight and forces given, or of a scenario."""
    basis = DesignBasis(yield_strength, edition, conservative_joints=joints == "conservative")
    if (structure is None) == (scenario is None):
        raise InputError(
            "give a structure or --scenario", field="STRUCTURE", remedy="keep exactly one of them"
        )
    if flooded and not still_water:
        raise InputError("needs --still-water", field="--flooded", value=flooded, remedy="add --still-water")
    if scenario is not None:
        if still_water:
            raise InputError("a scenario has its own water", field="--still-water", remedy="leave it out")
        chosen_scenario = read_scenario(scenario)
        use = scenario_uses(chosen_scenario, basis)
        _report(chosen_scenario.name, use, water_notes(chosen_scenario), as_json)
        return
    assert structure is not None
    assembly = assemble(read_structure(structure), subdivide=subdivide)
    held = support_option(support, assembly)
    load, along = nodal_load(assembly, dict(nodal_force(text) for text in forces)), None
    if not no_weight:
        load, along = load + self_weight(assembly), element_weight(assembly)
    pressure = None
    if still_water:
        load, along, pressure = _in_water(assembly, Water(flooded), load, along)
    u = static_displacement(build_system(assembly, held), load)
    use = frame_use(assembly, u, basis, along=along, pressure=pressure)
    _report(assembly.structure.name, use, [], as_json)


def _in_water(
    assembly: Assembly, water: Water, load: FloatArray, along: FloatArray | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return loads with buoyancy, and the pressure on the elements' ends; the bed is at the lowest foot."""
    structure = assembly.structure
    depth = structure.sea_level_z_m - min(structure.nodes[name][2] for name in structure.reaction_nodes)
    if not depth > 0.0:
        raise InputError(
            "the structure stands above still water",
            field="--still-water",
            value=structure.sea_level_z_m,
            allowed="sea_level_z_m above the lowest foot",
            remedy="state sea_level_z_m in the structure's file, or leave --still-water out",
        )
    coefficients = Coefficients()
    grid = morison_points(assembly, highest_z=0.0, lowest_z=-depth, coefficients=coefficients)
    wet = still_water_loads(assembly, grid, water)
    pressure = outside_pressure(assembly, water, density_kg_m3=coefficients.density_kg_m3, depth_m=depth)
    return load + wet.load, wet.along if along is None else along + wet.along, pressure


def _report(name: str, use: FrameUse, notes: list[str], as_json: bool) -> None:
    document = {
        "structure": name,
        "largest_von_mises_stress_pa": max(one.von_mises_pa for one in use.members),
        "members": [_row(one) for one in sorted(use.members, key=lambda one: -one.utilisation)],
        "joints": [_joint_row(one) for one in sorted(use.joints, key=lambda one: -one.utilisation)],
        "warnings": [*_warnings(use), *notes],
    }
    if as_json:
        print_json(document)
    else:
        _print(document)


def nodal_force(text: str) -> tuple[str, tuple[float, ...]]:
    """Return node and components of ``NODE=FX,FY,FZ``.

    Raises
    ------
    InputError
        If the text is not that.
    """
    node, _, numbers = text.partition("=")
    return node, numbers_of(numbers, "--force", "NODE=FX,FY,FZ[,MX,MY,MZ]", (3, 6), given=text)


def _row(use: MemberUse) -> dict[str, Any]:
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
    }


def _forces(six: FloatArray) -> dict[str, float]:
    return dict(zip(_COMPONENTS, map(float, six), strict=True))


def _joint_row(use: BraceUse) -> dict[str, Any]:
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
    }


def _warnings(use: FrameUse) -> list[str]:
    thin = [one.member for one in use.members if not one.covered]
    over = [one.member for one in use.members if one.utilisation > 1.0]
    joints = [f"{one.brace} at {one.node}" for one in use.joints if one.utilisation > 1.0]
    beyond = [(f"{one.brace} at {one.node}", why) for one in use.joints for why in one.joint.beyond_validity]
    found = []
    if thin:
        found.append(f"D/t above 120, beyond ISO 19902 13: {few(thin)}")
    if over:
        found.append(f"used above 1: {few(over)}")
    if joints:
        found.append(f"joints used above 1: {few(joints)}")
    if beyond:
        named = few(list(dict.fromkeys(name for name, _ in beyond)))
        found.append(f"joints beyond the ranges of ISO 19902 14.3.1 ({beyond[0][1]}, …): {named}")
    return found


def _print(document: dict[str, Any]) -> None:
    shown, left_out = document["members"][:_SHOWN], len(document["members"]) - _SHOWN
    use = Table("member", "part", "utilisation", "governed by", "K", r"L \[m]", title_justify="left")
    use.title = document["structure"]
    forces = Table(
        "member", "at", *_HEADINGS, title=r"section forces there \[kN, kN·m]", title_justify="left"
    )
    for row in shown:
        K, L = row["effective_length_factor"], row["column_length_m"]
        use.add_row(
            row["member"], row["part"], f"{row['utilisation']:.3f}", row["clause"], f"{K:g}", f"{L:.2f}"
        )
        governing = row["governing"]
        forces.add_row(
            row["member"],
            _place(governing["position"]),
            *(fixed(governing[name] / 1e3, 1) for name in _COMPONENTS),
        )
    output.print(use)
    output.print(forces)
    if left_out > 0:
        output.print(f"and {left_out} more members; --json has all of them, with the forces at both ends")
    _print_joints(document["joints"])
    output.print(f"largest von Mises stress {document['largest_von_mises_stress_pa'] / 1e6:.1f} MPa")
    for warning in document["warnings"]:
        output.print(f"warning: {warning}")


def _print_joints(rows: list[dict[str, Any]]) -> None:
    if not rows:
        return
    table = Table(
        "joint", "chord", "brace", "utilisation", "class", "β", "γ", "θ [°]", *_JOINT_FORCES,
        title="tubular joints, ISO 19902 14.3; forces in kN, kN·m", title_justify="left",
    )  # fmt: skip
    for row in rows[:_SHOWN]:
        kinds = " ".join(f"{kind} {share:.2f}" for kind, share in row["shares"].items() if share > _TRACE)
        table.add_row(
            *(row[name] for name in ("node", "chord", "brace")),
            f"{row['utilisation']:.3f}" + ("*" if row["beyond_validity"] else ""),
            kinds,
            *(fixed(row[name], digits) for name, digits in (("beta", 2), ("gamma", 1), ("theta_deg", 0))),
            *(fixed(row[name] / 1e3, 1) for name in ("axial_n", "in_plane_nm", "out_of_plane_nm")),
        )
    output.print(table)
    if any(row["beyond_validity"] for row in rows[:_SHOWN]):
        output.print("* beyond the ranges of 14.3.1; --json says in what")
    if len(rows) > _SHOWN:
        output.print(f"and {len(rows) - _SHOWN} more braces at joints; --json has all of them")


def _place(position: float) -> str:
    return {0.0: "start", 1.0: "end"}.get(position, f"{position:.2f} L")
