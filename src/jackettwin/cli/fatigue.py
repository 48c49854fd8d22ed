"""``jackettwin fatigue``: cycles, stress concentration, damage and life of welds."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from jackettwin.caveats import Omission, omission_documents
from jackettwin.cli.cache import keeping
from jackettwin.cli.console import (
    CommandGroup,
    FiniteFloat,
    PageFile,
    Reply,
    answers,
    messages,
    progress,
    say,
    show_table,
    working,
)
from jackettwin.cli.fatigue_site import site_
from jackettwin.cli.weld_tables import POINT, SIDE, show_welds
from jackettwin.errors import InputError, did_you_mean, look_up, require
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray
    from jackettwin.fatigue import Cycles, Environment, ModelsAtHeight, TubeLife, WeldLife
    from jackettwin.study import RecordLife

_UNITS = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "N/mm^2": 1e6, "ksi": 6.894757293168e6}
_STRONGEST_PA = 2e9
"""Stress range above which the unit must be wrong."""
_WEAKEST_PA = 1e4
"""Stress range below which the unit is probably wrong."""
_N_EQ = 1e7
_OF_WELDS = (
    Omission("cans: butt welds stand at nodes, where the model changes a wall"),
    Omission("cones between tubes, seams within a member, piles in the ground"),
    Omission("flanges, grout and castings that --details does not name"),
    Omission("joints in several planes: each plane is assessed separately"),
    Omission("crack growth"),
)
_OF_RECORDS = (
    Omission("other seas, winds and states: all time is assumed to be like this record"),
    Omission("errors of the model beyond its tolerances: other geometry, other damage, joints that yield"),
    Omission("slow forces that neither a sensor nor the record's stated wind and sea show"),
    Omission("buoyancy and mean thrust in the shares of K, Y and X joints"),
    Omission("bending blades"),
)


class _Fatigue(CommandGroup):
    """A group that treats arguments TWIN and RECORD as those of its command ``record``."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse arguments; if the first is a file or a shipped twin, it is TWIN."""
        from jackettwin.twin import shipped_twins

        named = next((a for a in args if not a.startswith("-")), None)
        if named is not None and named not in self.commands:
            known = (*self.commands, *shipped_twins())
            if not (Path(named).suffix or Path(named).exists() or named in known or args[0] != named):
                remedy = did_you_mean(named, known) or "jackettwin fatigue --help lists the commands"
                problem = InputError(
                    "is no command, no file and no shipped twin", field="fatigue", value=named,
                    allowed=", ".join(known), remedy=remedy,
                )  # fmt: skip
                raise click.UsageError(str(problem), ctx)
            args = ["record", *args]
        return super().parse_args(ctx, args)


@click.group("fatigue", cls=_Fatigue)
def fatigue_command() -> None:
    """Count cycles, and compute damage and life of welds."""


fatigue_command.add_command(site_)


def curve_options(command: Any) -> Any:
    """Add the options that choose an S-N curve."""
    edition = click.option(
        "--edition", default=None, help="A shipped set of S-N curves or a YAML file; default: the newest."
    )
    return edition(command)


@fatigue_command.command("stress")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--column", required=True, metavar="NAME", help="Column of FILE with the stress.")
@click.option("--curve", default="T", show_default=True, help="S-N curve: B1 … W3, T.")
@click.option(
    "--environment",
    default="air",
    show_default=True,
    type=click.Choice(("air", "cathodic", "free-corrosion")),
)
@click.option(
    "--unit",
    type=click.Choice(tuple(_UNITS)),
    help="Unit of the stress; default: the file's, the end of the column's name, else MPa.",
)
@click.option(
    "--thickness-mm",
    type=FiniteFloat(min=1.0, max=1000.0),
    help="Thickness of the plate; default: no effect of thickness.",
)
@curve_options
@answers
def stress(
    file: Path,
    column: str,
    curve: str,
    environment: Environment,
    unit: str | None,
    thickness_mm: float | None,
    edition: str | None,
) -> Reply:
    """Count the cycles of a stress series in FILE, and sum their damage.

    Cycles are counted by rainflow, unclosed ones as half cycles. Damage is Miner's sum over the series.
    """
    from jackettwin.fatigue import equivalent_range, read_curve

    chosen = read_curve(curve, environment, *(() if edition is None else (edition,)))
    values, taken = _stress_of(file, column, unit)
    with working("counting cycles"):
        cycles, scale, warnings = _counted(values, file, column)
    widest = float(cycles.ranges.max(initial=0.0))
    require(
        widest < _STRONGEST_PA,
        f"no steel resists stress ranges of {widest / 1e6:.3g} MPa",
        file=file,
        field=column,
        value=f"in {taken}",
        remedy="state the unit with --unit" + (" Pa" if 1e4 < widest / _UNITS[taken] < _STRONGEST_PA else ""),
    )
    if 0.0 < widest < _WEAKEST_PA:
        warnings.append(f"no range is larger than {widest:.3g} Pa: is the stress in {taken}? (--unit)")
    thickness = None if thickness_mm is None else 1e-3 * thickness_mm
    damage = scale * chosen.damage(cycles.ranges, cycles.numbers, thickness_m=thickness)
    document = {
        "file": str(file),
        "column": column,
        "unit": taken,
        "curve": curve,
        "environment": environment,
        "edition": chosen.edition,
        "cycles_full": int(cycles.full.size),
        "cycles_half": int(cycles.half.size),
        "largest_range_mpa": 1e-6 * widest,
        "n_eq": _N_EQ,
        "equivalent_range_mpa": {
            f"m{m}": 1e-6 * scale ** (1.0 / m) * equivalent_range(cycles, m, _N_EQ) for m in (3, 5)
        },
        "damage": damage,
        "damage_by_cycles": 0.0 if not cycles.full.size else scale * _closed(chosen, cycles, thickness),
        "warnings": warnings,
        "left_out": omission_documents([Omission("mean stress"), Omission("the order of cycles")]),
    }
    return Reply(document, lambda: _show_stress(document))


def _closed(chosen: Any, cycles: Cycles, thickness: float | None) -> float:
    return float(chosen.damage(cycles.full, np.ones(cycles.full.size), thickness_m=thickness))


def _stress_of(file: Path, column: str, unit: str | None) -> tuple[FloatArray, str]:
    """Return a column of a file in pascals, and the unit in which it was read."""
    from jackettwin.records import read_table

    table = read_table(file)
    rows = dict(zip(table.names, table.data, strict=True))
    values = look_up(rows, column, "column", file=file, field="--column")
    said = table.channels.get(column)
    named = next((u for u in _UNITS if column.lower().endswith(f"_{u.lower()}")), None)
    stated = (table.unit if said is None or said.unit is None else said.unit) or named
    if unit is None and stated is not None and stated not in _UNITS:
        raise InputError(
            "is not a unit of stress", file=file, field=column, value=stated, allowed=", ".join(_UNITS),
            remedy="state it with --unit",
        )  # fmt: skip
    taken = unit or stated or "MPa"
    if unit and stated in _UNITS and _UNITS[stated] != _UNITS[unit]:
        raise InputError(
            f"the file or the column's name states {stated}",
            file=file,
            field="--unit",
            value=unit,
            remedy="omit the option",
        )
    return np.asarray(values, dtype=float) * _UNITS[taken], taken


def _counted(values: FloatArray, file: Path, column: str) -> tuple[Cycles, float, list[str]]:
    """Return the cycles across gaps, the factor for the missing time, and warnings."""
    from jackettwin.fatigue import count

    known = np.isfinite(values)
    require(known.any(), "contains no numbers", file=file, field=column, remedy="export the file again")
    if known.all():
        return count(values), 1.0, []
    # the series did get from one side of a gap to the other: its slow cycles are counted across
    missing = float(1.0 - known.mean())
    said = f"{100 * missing:.2g} % of the samples are missing: gaps are bridged, damage scaled to the whole"
    return count(values[known]), 1.0 / (1.0 - missing), [said]


def _show_stress(document: dict[str, Any]) -> None:
    for warning in document["warnings"]:
        messages.print(f"warning: {warning}")
    m3, m5 = (document["equivalent_range_mpa"][m] for m in ("m3", "m5"))
    say(
        f"{document['column']}: {document['cycles_full']} cycles and {document['cycles_half']} half cycles, "
        f"largest range {document['largest_range_mpa']:.4g} MPa"
    )
    say(f"equivalent range of {_N_EQ:.0e} cycles: {m3:.4g} MPa (m = 3), {m5:.4g} MPa (m = 5)")
    say(
        f"damage {document['damage']:.4g} by {document['edition']}, curve {document['curve']}, "
        f"{document['environment']}"
    )


@fatigue_command.command("scf")
@click.argument("file", type=click.Path(path_type=Path))
@answers
def scf(file: Path) -> Reply:
    """Compute the stress concentration factors of one tubular joint.

    FILE (YAML or JSON) contains class (y, x, k or kt), chord_diameter_m, chord_thickness_m, chord_length_m,
    fixity, braces with diameter_m, thickness_m and angle_deg, and gap_m (kt: gaps_m of three braces).
    """
    from jackettwin.fatigue import concentration, factors_document, read_joint

    kind, joint = read_joint(file)
    factors, warnings = concentration(joint, kind)
    rows = [factors_document(one, kind) for one in factors]
    document = {"class": kind, "braces": rows, "warnings": list(warnings)}

    def show() -> None:
        for warning in warnings:
            messages.print(f"warning: {warning}")
        flat = [
            (str(i), load, place, f"{value:.3f}")
            for i, row in enumerate(rows, start=1)
            for load, places in row.items()
            for place, value in places.items()
        ]
        show_table(Table("stress concentration", ("brace", "load", "place", "factor"), flat))

    return Reply(document, show)


def _details_option(command: Any) -> Any:
    """Add the option that names the file of details of tubes."""
    said = "File (YAML or JSON) of butt_welds, and of details of tubes with their factors."
    return click.option("--details", type=click.Path(path_type=Path), help=said)(command)


@fatigue_command.command("scenario")
@click.argument("scenario")
@click.option("--curve", default="T", show_default=True, help="S-N curve of tubular joints.")
@click.option(
    "--design-factor", default=1.0, show_default=True, type=FiniteFloat(min=1.0, max=10.0),
    help="Design fatigue factor.",
)  # fmt: skip
@_details_option
@curve_options
@answers
def scenario_(
    scenario: str, curve: str, design_factor: float, details: Path | None, edition: str | None
) -> Reply:
    """Compute the life of joints and butt welds of tubes, assuming that all time is like SCENARIO.

    They are in air above the splash zone, corrode freely in it, and are cathodically protected below it.
    """
    from jackettwin.fatigue import models_at_height, read_details
    from jackettwin.simulate import read_scenario, scenario_life

    read = read_scenario(scenario)
    models = partial(models_at_height, design_factor=design_factor, edition=edition)
    model, tubes = models(curve), read_details(details, models)
    with working("stresses at the welds"):
        found = scenario_life(read, model, tubes)
    rows = [_weld(one) for one in found.joints]
    document = {
        "scenario": read.name,
        "edition": model(np.inf)[1].curve.edition,
        "curve": curve,
        "design_factor": design_factor,
        "duration_s": found.duration_s,
        "joints": rows,
        "welds": [_tube(one) for one in found.tubes],
        "warnings": [*_warnings(rows), *_tube_warnings(found.tubes, found.apart)],
        "left_out": omission_documents(
            [
                Omission("other seas, winds and states: all time is assumed to be like this scenario"),
                *_OF_WELDS,
            ]
        ),
    }
    return Reply(document, lambda: _show_welds(document, read.name))


@fatigue_command.command("record")
@click.argument("twin")
@click.argument("record", type=click.Path(path_type=Path))
@click.option("--curve", default="T", show_default=True, help="S-N curve of tubular joints.")
@click.option(
    "--design-factor", default=1.0, show_default=True, type=FiniteFloat(min=1.0, max=10.0),
    help="Design fatigue factor.",
)  # fmt: skip
@click.option(
    "--draws", default=2, show_default=True, type=click.IntRange(1, 200),
    help="Number of motions for each support, whose damage is averaged.",
)  # fmt: skip
@click.option(
    "--supports", default=3, show_default=True, type=click.IntRange(1, 100),
    help="Number of probable supports of the updated twin.",
)  # fmt: skip
@click.option(
    "--feel-gravity", is_flag=True, help="Accelerometers measure constant acceleration, and so tilt."
)
@click.option("--fresh", is_flag=True, help="Ignore stored identifications and fits of earlier runs.")
@click.option("--report", type=PageFile(), help="Also write a page, in a folder that exists.")
@_details_option
@curve_options
@answers
def record_(
    twin: str,
    record: Path,
    curve: str,
    design_factor: float,
    draws: int,
    supports: int,
    feel_gravity: bool,
    fresh: bool,
    report: Path | None,
    details: Path | None,
    edition: str | None,
) -> Reply:
    """Compute the life of joints and butt welds from the sensors of RECORD.

    All time is assumed to be like it. The supports of TWIN are updated first, by its records or targets,
    otherwise by RECORD.
    """
    from jackettwin.fatigue import models_at_height, read_details
    from jackettwin.study import count_steps, life_of_record, sensed, updated, with_record
    from jackettwin.twin import read_twin

    models = partial(models_at_height, design_factor=design_factor, edition=edition)
    model, tubes = models(curve), read_details(details, models)
    config = with_record(read_twin(twin), record)
    tubes.require_members(config.structure)
    readings, weather = sensed(config, record, feel_gravity=feel_gravity)
    with progress(count_steps(config), config.name) as step:
        update = updated(config, progress=step, keep=keeping(fresh=fresh))
    with working("stresses at the welds"):
        found = life_of_record(
            config, update, readings, weather, model, draws=draws, supports=supports, details=tubes
        )
    rows = [_weld(one) for one in found.welds]
    document = {
        "twin": config.name,
        "record": record.name,
        "law": update.law,
        "edition": model(np.inf)[1].curve.edition,
        "curve": curve,
        "design_factor": design_factor,
        "duration_s": found.duration_s,
        "forces": [
            {"name": f.name, "level": f.level, "rate_hz": f.rate / (2.0 * np.pi)}
            for f in found.estimate.levels.forces
        ],
        "noise": np.sqrt(found.estimate.levels.noise),
        "joints": rows,
        "welds": [_tube(one) for one in found.tubes],
        "warnings": [*_warnings(rows), *_tube_warnings(found.tubes, found.apart), _FROM_SENSORS],
        "left_out": omission_documents([*_OF_RECORDS, *_OF_WELDS]),
    }
    if report is not None:
        document["report"] = str(_report(found, model, report, config.name, record.name, document))
    return Reply(document, lambda: _show_welds(document, record.name))


def _report(
    found: RecordLife, models: ModelsAtHeight, path: Path, name: str, like: str, document: dict[str, Any]
) -> Path:
    """Write the page of a record's life."""
    from jackettwin.report.pages.life import WORST, write_life_page
    from jackettwin.study import candidates, damage_by_band, with_one_more

    worst, assembly = found.welds[:WORST], found.estimate.model.assembly
    with working("the page"):
        by_band = [damage_by_band(found.estimate, found.chart, models, one) for one in worst]
        unseen = with_one_more(found.estimate, found.chart, worst, candidates(assembly.structure))
        return write_life_page(
            assembly,
            found.welds,
            path,
            title=f"{name}: life of welds",
            like=like,
            by_band=by_band,
            unseen=unseen,
            remarks=document["warnings"],
        )


def _weld(one: WeldLife) -> dict[str, Any]:
    weld = one.weld
    return {
        "joint": weld.node,
        "chord": weld.chord,
        "brace": weld.brace,
        "side": one.side,
        "position": one.position,
        "z_m": one.z_m,
        "environment": one.environment,
        "scf": weld.scf,
        **_life(one),
    }


def _tube(one: TubeLife) -> dict[str, Any]:
    weld = one.weld
    return {
        "weld": weld.name,
        "kind": weld.kind,
        "member": weld.member,
        "member_position": weld.position,
        "position": one.position,
        "z_m": weld.z_m,
        "outer_diameter_m": weld.section.outer_diameter_m,
        "thickness_m": weld.section.thickness_m,
        "environment": one.environment,
        "curve": one.curve,
        "scf": weld.scf,
        **_life(one),
    }


def _life(one: WeldLife | TubeLife) -> dict[str, Any]:
    life = one.life
    return {
        "largest_range_mpa": 1e-6 * one.largest_range_pa,
        "damage": life.damage,
        "damage_by_point": one.damage_by_point,
        "damage_interval_90": list(life.damage_interval_90),
        "life_years": life.life_years if np.isfinite(life.life_years) else None,
        "variance_shares": life.variance_shares,
        "beyond_validity": list(one.weld.warnings),
    }


def _tube_warnings(tubes: tuple[TubeLife, ...], apart: tuple[str, ...]) -> list[str]:
    from jackettwin.structure import few

    said = [f"{one.weld.name}: {text}" for one in tubes for text in one.weld.warnings]
    found = [f"{len(said)} butt welds are beyond the range of their factors: {few(said)}"] if said else []
    if apart:
        found.append(
            "no butt weld where the walls of tubes in line do not meet, as of a stepped taper: "
            f"{few(list(apart))} (--details can name them)"
        )
    return found


def _warnings(rows: list[dict[str, Any]]) -> list[str]:
    from jackettwin.structure import few

    outside = [row for row in rows if row["beyond_validity"]]
    if not outside:
        return []
    named = few(list(dict.fromkeys(f"{row['brace']} at {row['joint']}" for row in outside)))
    return [
        f"{len(outside)} of {len(rows)} welds are beyond the validity ranges of Efthymiou's factors: {named}"
    ]


_FROM_SENSORS = (
    "stress from sensors rests on simplified waves and modes: what it missed on simulated jackets is in "
    "docs/verification/fatigue.md; the slow thrust of a working rotor is expected, not measured, unless a "
    "sensor feels it (--feel-gravity, inclination, strain)"
)

_COLUMNS = (
    *SIDE,
    *POINT,
    TableColumn("largest range [MPa]", "largest_range_mpa", ".1f"),
    TableColumn("life [years]", "life_years", ".3g"),
    TableColumn("within ranges", lambda row: "no" if row["beyond_validity"] else "yes"),
)

_TUBE_COLUMNS = (
    TableColumn("weld", "weld"),
    TableColumn("kind", "kind"),
    *POINT,
    TableColumn("curve", "curve"),
    TableColumn("factor", "scf", ".2f"),
    TableColumn("largest range [MPa]", "largest_range_mpa", ".1f"),
    TableColumn("life [years]", "life_years", ".3g"),
)


def _show_welds(document: dict[str, Any], like: str) -> None:
    shown = (
        ("joints", f"life if all time is like {like}", _COLUMNS),
        ("welds", "butt welds and details of tubes", _TUBE_COLUMNS),
    )
    for key, title, columns in shown:
        if document[key]:
            show_welds(title, columns, document[key])
    for warning in document["warnings"]:
        messages.print(f"warning: {warning}")
