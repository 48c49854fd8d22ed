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
    PageFile,
    Reply,
    answers,
    messages,
    progress,
    show_table,
    working,
)
from jackettwin.cli.fatigue_forces import forces_
from jackettwin.cli.fatigue_series import strain_, stress_
from jackettwin.cli.fatigue_site import site_
from jackettwin.cli.weld_options import details_option, edition_option, joint_options
from jackettwin.cli.weld_tables import OF_WELDS, lives_document, show_lives
from jackettwin.errors import InputError, did_you_mean, located
from jackettwin.report import Table

if TYPE_CHECKING:
    from jackettwin.fatigue import ModelsAtHeight
    from jackettwin.study import RecordLife

_OF_RECORDS = (
    Omission("other seas, winds and states: all time is assumed to be like this record"),
    Omission("errors of the model beyond its tolerances: other geometry, other damage, joints that yield"),
    Omission("slow forces that neither a sensor nor the record's stated wind and sea show"),
    Omission("the mean drag of wind and waves in the shares of K, Y and X joints"),
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
fatigue_command.add_command(forces_)
fatigue_command.add_command(stress_)
fatigue_command.add_command(strain_)


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
    with located(file=file):
        factors, outside = concentration(joint, kind)
    warnings = [one.text for one in outside]
    rows = [factors_document(one, kind) for one in factors]
    document = {"class": kind, "braces": rows, "warnings": warnings}

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


@fatigue_command.command("scenario")
@click.argument("scenario")
@joint_options
@details_option
@edition_option
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
    document = {
        "scenario": read.name,
        "edition": model(np.inf)[1].curve.edition,
        "curve": curve,
        "design_factor": design_factor,
        "duration_s": found.duration_s,
        **lives_document(found.joints, found.tubes, found.apart),
        "left_out": omission_documents(
            [
                Omission("other seas, winds and states: all time is assumed to be like this scenario"),
                *OF_WELDS,
            ]
        ),
    }
    return Reply(document, lambda: show_lives(document, read.name))


@fatigue_command.command("record")
@click.argument("twin")
@click.argument("record", type=click.Path(path_type=Path))
@joint_options
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
@details_option
@edition_option
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
    from jackettwin.study import count_steps, life_of_record, readings_and_weather, updated, with_record
    from jackettwin.twin import read_twin

    models = partial(models_at_height, design_factor=design_factor, edition=edition)
    model, tubes = models(curve), read_details(details, models)
    config = with_record(read_twin(twin, records_follow=True), record)
    tubes.require_members(config.structure)
    readings, weather = readings_and_weather(config, record, feel_gravity=feel_gravity)
    with progress(count_steps(config), config.name) as step:
        update = updated(config, progress=step, keep=keeping(fresh=fresh))
    with working("stresses at the welds"):
        found = life_of_record(
            config, update, readings, weather, model, draws=draws, supports=supports, details=tubes
        )
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
        **lives_document(found.welds, found.tubes, found.apart, after=(_FROM_SENSORS,)),
        "left_out": omission_documents([*_OF_RECORDS, *OF_WELDS]),
    }
    if report is not None:
        document["report"] = str(_report(found, model, report, config.name, record.name, document))
    return Reply(document, lambda: show_lives(document, record.name))


def _report(
    found: RecordLife, models: ModelsAtHeight, path: Path, name: str, like: str, document: dict[str, Any]
) -> Path:
    """Write the page of a record's life."""
    from jackettwin.report.pages.life import worst_welds, write_life_page
    from jackettwin.study import candidates, damage_by_band, with_one_more

    worst, assembly = worst_welds(found.welds), found.estimate.model.assembly
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


_FROM_SENSORS = (
    "stress from sensors rests on simplified waves and modes: what it missed on simulated jackets is in "
    "docs/verification/fatigue.md; the slow thrust of a working rotor is expected, not measured, unless a "
    "sensor feels it (--feel-gravity, inclination, strain)"
)
