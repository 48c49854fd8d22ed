"""``jackettwin fatigue forces``: life of welds by section forces that another program computed."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from jackettwin.caveats import Omission, omission_documents
from jackettwin.cli.console import Reply, answers, working
from jackettwin.cli.weld_options import STRONGEST_PA, USUAL_PA, details_option, edition_option, joint_options
from jackettwin.cli.weld_tables import OF_WELDS, lives_document, show_lives
from jackettwin.errors import located, look_up, require

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray
    from jackettwin.records import ReadTable

_UNEVEN = 0.01
_UNITS = {"n": 1.0, "nm": 1.0, "kn": 1e3, "knm": 1e3, "mn": 1e6, "mnm": 1e6}


@click.command("forces")
@click.argument("structure")
@click.argument("file", type=click.Path(path_type=Path))
@joint_options
@details_option
@edition_option
@answers
def forces_(
    structure: str, file: Path, curve: str, design_factor: float, details: Path | None, edition: str | None
) -> Reply:
    """Compute the life of welds by the section forces in FILE, assuming that all time is like it.

    FILE (Parquet, CSV, OpenFAST's .out or .outb) has columns MEMBER.start.axial_n, MEMBER.start.bending_y_nm,
    MEMBER.start.bending_z_nm and of the end likewise. With a SubDyn deck as STRUCTURE it may have SubDyn's
    own channels, M1N1FKze, M1N1MKxe, M1N1MKye. Joints whose braces are not all given are named.
    """
    from jackettwin.decks import member_outputs, read_structure
    from jackettwin.fatigue import models_at_height, read_details
    from jackettwin.records import read_table
    from jackettwin.simulate import given_life, given_sections
    from jackettwin.structure import assemble, few

    models = partial(models_at_height, design_factor=design_factor, edition=edition)
    model, tubes = models(curve), read_details(details, models)
    read = read_structure(structure)
    tubes.require_members(read)
    asked = member_outputs(Path(structure), read) if Path(structure).suffix == ".dat" else ()
    table = read_table(file)
    with located(file=file):
        data, step_s, warnings = _forces_of(table)
        with working("stresses at the welds"):
            given = given_sections(assemble(read), table.names, data, asked)
            found = given_life(given, step_s, model, tubes)
        ranges = [one.largest_range_pa for one in found.joints]
        widest = max([*ranges, *(one.largest_range_pa for one in found.tubes)], default=0.0)
        require(
            widest < STRONGEST_PA, f"no steel resists stress ranges of {widest / 1e6:.3g} MPa",
            field="columns", remedy="are the forces in the units that their columns name?",
        )  # fmt: skip
        if widest < USUAL_PA:
            warnings.append(
                f"no stress range is larger than {1e-6 * widest:.2g} MPa: are the forces in the units that "
                "their columns name?"
            )
    if found.unknown:
        warnings.append(
            f"{len(found.unknown)} joints or butt welds lack section forces: {few(list(found.unknown))}"
        )
    document = {
        "structure": read.name,
        "file": str(file),
        "edition": model(np.inf)[1].curve.edition,
        "curve": curve,
        "design_factor": design_factor,
        "duration_s": found.duration_s,
        "sections": sum(len(at) for at in given.places.values()),
        "unknown": list(found.unknown),
        **lives_document(found.joints, found.tubes, found.apart, before=warnings),
        "left_out": omission_documents(
            [
                Omission("other seas, winds and states: all time is assumed to be like this file"),
                Omission("loads along a member between the sections that are given: forces run straight"),
                *OF_WELDS,
            ]
        ),
    }
    return Reply(document, lambda: show_lives(document, file.name))


def _forces_of(table: ReadTable) -> tuple[FloatArray, float, list[str]]:
    """Return the columns in N and N·m (n_columns, n_samples), the step, and what a reader must know.

    Raises
    ------
    InputError
        If the file tells no even time, or has no instant at which every column is known.
    """
    if table.sample_rate_hz is not None:
        step = 1.0 / table.sample_rate_hz
    else:
        times = table.times_s
        require(
            times is not None and times.size > 1, "has no column of time", field="time_s",
            remedy="add time_s: the seconds of each row",
        )  # fmt: skip
        assert times is not None
        steps = np.diff(times)
        step = float(np.median(steps))
        require(
            step > 0.0 and bool(np.abs(steps - step).max() < _UNEVEN * step), "is not evenly spaced",
            field="time_s", value=f"{steps.min():g} to {steps.max():g} s", allowed="one step",
            remedy="export at a fixed step",
        )  # fmt: skip
    data = np.array([_scale(table, name) * row for name, row in zip(table.names, table.data, strict=True)])
    used = [i for i, row in enumerate(data) if np.isfinite(row).any()]
    whole = np.isfinite(data[used]).all(axis=0)
    require(
        whole.any(), "no row has all of the columns", field="columns", remedy="export the columns together"
    )
    missing = float(1.0 - whole.mean())
    said = f"{100 * missing:.2g} % of the rows are incomplete: gaps are bridged, damage scaled to the whole"
    return data[:, whole], step, [said] if missing else []


def _scale(table: ReadTable, name: str) -> float:
    """Return the factor to N and N·m of one of SubDyn's columns; others name their unit themselves.

    Raises
    ------
    InputError
        If the file states another unit.
    """
    from jackettwin.decks import SECTION_CHANNELS

    entry = table.channels.get(name)
    if not name.endswith(SECTION_CHANNELS) or entry is None or entry.unit is None:
        return 1.0
    said = "".join(c for c in entry.unit.lower() if c.isalpha())
    return look_up(_UNITS, said, "unit of force", field=name, remedy="let SubDyn write N and N*m")
