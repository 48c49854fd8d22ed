"""``jackettwin check``: every member under self-weight and given forces, to ISO 19902."""

from __future__ import annotations

from typing import Any

import click
from rich.table import Table

from jackettwin.arrays import FloatArray
from jackettwin.cli.console import fixed, output, print_json
from jackettwin.cli.modes import support_option
from jackettwin.errors import InputError
from jackettwin.response.static import nodal_load, self_weight, static_displacement
from jackettwin.response.system import build_system
from jackettwin.simulate import read_scenario
from jackettwin.simulate.members import scenario_uses
from jackettwin.structure import assemble, read_structure
from jackettwin.structure.check import few
from jackettwin.structure.forces import element_weight
from jackettwin.structure.iso19902 import CHECKS, EDITIONS
from jackettwin.structure.member_check import DesignBasis, MemberUse, member_uses

_SHOWN = 15
"""Members in the terminal."""
_COMPONENTS = ("axial_n", "shear_y_n", "shear_z_n", "torsion_nm", "bending_y_nm", "bending_z_nm")
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
@click.option(
    "--yield-strength", default=355e6, show_default=True, type=click.FloatRange(min=1e6), help="[Pa]"
)
@click.option(
    "--edition", default="2007", show_default=True, type=click.Choice(EDITIONS), help="Of ISO 19902."
)
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
    subdivide: int | None,
    as_json: bool,
) -> None:
    """Check every member of STRUCTURE at rest under its weight and the forces given, or of a scenario."""
    basis = DesignBasis(yield_strength, edition)
    if (structure is None) == (scenario is None):
        raise InputError(
            "give a structure or --scenario", field="STRUCTURE", remedy="keep exactly one of them"
        )
    if scenario is not None:
        chosen_scenario = read_scenario(scenario)
        _report(chosen_scenario.name, scenario_uses(chosen_scenario, basis), as_json)
        return
    assert structure is not None
    chosen = read_structure(structure)
    assembly = assemble(chosen, subdivide=subdivide)
    held = support_option(support, assembly)
    load = nodal_load(assembly, dict(nodal_force(text) for text in forces))
    along = None
    if not no_weight:
        load, along = load + self_weight(assembly), element_weight(assembly)
    u = static_displacement(build_system(assembly, held), load)
    _report(chosen.name, member_uses(assembly, u, basis, along=along), as_json)


def _report(name: str, uses: tuple[MemberUse, ...], as_json: bool) -> None:
    document = {
        "structure": name,
        "largest_von_mises_stress_pa": max(use.von_mises_pa for use in uses),
        "members": [_row(use) for use in sorted(uses, key=lambda use: -use.utilisation)],
        "warnings": _warnings(uses),
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
    try:
        return node, tuple(float(part) for part in numbers.split(","))
    except ValueError:
        raise InputError(
            "not NODE=FX,FY,FZ", field="--force", value=text, remedy="write e.g. tower_top=2e6,0,0"
        ) from None


def _row(use: MemberUse) -> dict[str, Any]:
    worst = use.worst
    return {
        "member": use.member,
        "part": use.part,
        "utilisation": use.utilisation,
        "check": use.check,
        "clause": CHECKS[use.check],
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


def _warnings(uses: tuple[MemberUse, ...]) -> list[str]:
    thin = [use.member for use in uses if not use.covered]
    over = [use.member for use in uses if use.utilisation > 1.0]
    found = []
    if thin:
        found.append(f"D/t above 120, beyond ISO 19902 13: {few(thin)}")
    if over:
        found.append(f"used above 1: {few(over)}")
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
    output.print(f"largest von Mises stress {document['largest_von_mises_stress_pa'] / 1e6:.1f} MPa")
    for warning in document["warnings"]:
        output.print(f"warning: {warning}")


def _place(position: float) -> str:
    return {0.0: "start", 1.0: "end"}.get(position, f"{position:.2f} L")
