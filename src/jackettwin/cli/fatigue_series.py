"""``jackettwin fatigue stress`` and ``strain``: cycles and damage of one measured series."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click
import numpy as np

from jackettwin.caveats import Omission, omission_documents
from jackettwin.cli.console import FiniteFloat, Reply, answers, messages, numbers_of, say, working
from jackettwin.cli.weld_options import STRONGEST_PA, edition_option
from jackettwin.errors import InputError, look_up, require
from jackettwin.quantities import known_units, plain_unit, to_si

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray
    from jackettwin.fatigue import Cycles, Environment, SNCurve
    from jackettwin.records import ReadTable

_UNITS = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "N/mm^2": 1e6, "psi": 6894.757293168, "ksi": 6.894757293168e6}
_STRAIN_UNITS = {unit: to_si("strain", unit) for unit in known_units("strain")}
_WEAKEST_PA = 1e4
"""Stress range below which the unit is probably wrong."""
_USUAL_PA = (1e6, 1e9)
"""Between which the largest range of a series usually lies."""
_N_EQ = 1e7
_GAP_STEPS = 10.0
"""Of the usual step, from which a step between rows is a gap: shorter ones hide no cycle that counts."""
_EVEN = 0.1
"""Of a step, by which all may differ for a spectrum."""
_ONE_CYCLE, _FEWEST = 0.5, 100
"""Share of all damage that the largest cycle of so many or more does, from which it is said."""
_ROSETTE = (1, 3, 4)
"""How many gauges may stand at one place."""
_HOT_K = 1e-4
"""Strain of a kelvin: beyond it a drift is no gauge's; steel expands by 1.2e-5."""


def _of_series(command: Any) -> Any:
    """Add the options of a weld at which a series was measured."""
    options = (
        click.option("--curve", default="T", show_default=True, help="S-N curve: B1 … W3, T."),
        click.option(
            "--environment",
            default="air",
            show_default=True,
            type=click.Choice(("air", "cathodic", "free-corrosion")),
        ),
        click.option(
            "--thickness-mm",
            type=FiniteFloat(min=1.0, max=1000.0),
            help="Thickness of the plate; default: no effect of thickness.",
        ),
        edition_option,
    )
    for option in reversed(options):
        command = option(command)
    return command


@click.command("stress")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--column", required=True, metavar="NAME", help="Column of FILE with the stress.")
@click.option(
    "--unit",
    type=click.Choice(tuple(_UNITS)),
    help="Unit of the stress; default: the file's, the end of the column's name, else MPa.",
)
@_of_series
@answers
def stress_(
    file: Path,
    column: str,
    unit: str | None,
    curve: str,
    environment: Environment,
    thickness_mm: float | None,
    edition: str | None,
) -> Reply:
    """Count the cycles of a stress series in FILE, and sum their damage.

    Cycles are counted by rainflow, unclosed ones as half cycles. Damage is Miner's sum over the series.
    """
    from jackettwin.fatigue import read_curve
    from jackettwin.records import read_table

    chosen = read_curve(curve, environment, *(() if edition is None else (edition,)))
    table = read_table(file)
    taken = _unit_of(table, file, column, unit, _UNITS, "MPa", "stress")
    values = _column(table, file, column) * _UNITS[taken.name]
    document = {"file": str(file), "column": column, "unit": taken.name}
    document |= _counted(values, table, file, column, taken, chosen, thickness_mm, warnings=[])
    return Reply(document, lambda: _show(document))


@click.command("strain")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--column", "columns", required=True, multiple=True, metavar="NAME",
    help="Column of FILE with a gauge's strain; again for each gauge of a rosette.",
)  # fmt: skip
@click.option(
    "--angles", metavar="DEG,…", default="0", show_default=True,
    help="Of the gauges, from the direction in which stress is counted: across the weld.",
)  # fmt: skip
@click.option(
    "--unit",
    type=click.Choice(tuple(_STRAIN_UNITS)),
    help="Unit of the strain; default: the file's, the end of the column's name, else um/m.",
)
@click.option("--temperature", metavar="NAME", help="Column of FILE with the gauges' temperature [°C].")
@click.option(
    "--per-kelvin", type=FiniteFloat(min=-100.0, max=100.0), metavar="UM/M",
    help="Strain that a kelvin makes [µm/m]; default: what goes with --temperature.",
)  # fmt: skip
@click.option(
    "--elastic-modulus-gpa", default=210.0, show_default=True, type=FiniteFloat(min=1.0, max=1000.0),
    help="Of the steel.",
)  # fmt: skip
@click.option("--poisson", default=0.3, show_default=True, type=FiniteFloat(min=0.0, max=0.49))
@click.option(
    "--scf", default=1.0, show_default=True, type=FiniteFloat(min=1.0, max=100.0),
    help="Stress of the weld over that at the gauge.",
)  # fmt: skip
@_of_series
@answers
def strain_(
    file: Path,
    columns: tuple[str, ...],
    angles: str,
    unit: str | None,
    temperature: str | None,
    per_kelvin: float | None,
    elastic_modulus_gpa: float,
    poisson: float,
    scf: float,
    curve: str,
    environment: Environment,
    thickness_mm: float | None,
    edition: str | None,
) -> Reply:
    """Count the stress cycles of a strain gauge or a rosette in FILE, and sum their damage.

    Jumps of a gauge's zero are taken out, and drift with temperature where a column tells it. One gauge
    measures along itself; three or four at one place, with their angles, tell the stress across the weld.
    """
    from jackettwin.fatigue import read_curve, rosette_stress, steady_strain
    from jackettwin.records import read_table

    chosen = read_curve(curve, environment, *(() if edition is None else (edition,)))
    require(
        len(columns) in _ROSETTE, "one gauge, or three or four of a rosette", field="--column",
        value=", ".join(columns), remedy="repeat --column for each gauge",
    )  # fmt: skip
    turned = numbers_of(angles, "--angles", "an angle for each gauge", (len(columns),))
    require(
        per_kelvin is None or temperature is not None, "needs the temperature", field="--per-kelvin",
        value=per_kelvin, remedy="name its column with --temperature",
    )  # fmt: skip
    table = read_table(file)
    warm = None if temperature is None else _column(table, file, temperature)
    known = None if per_kelvin is None else 1e-6 * per_kelvin
    gauges, strains, warnings = [], [], list[str]()
    units = [_unit_of(table, file, name, unit, _STRAIN_UNITS, "um/m", "strain") for name in columns]
    for name, (taken, _) in zip(columns, units, strict=True):
        found = steady_strain(_column(table, file, name) * _STRAIN_UNITS[taken], warm, per_kelvin=known)
        per = found.per_kelvin
        require(
            per is None or abs(per) < _HOT_K, f"would strain by {1e6 * (per or 0.0):.3g} µm/m a kelvin",
            file=file, field=name, value=f"in {taken}", allowed=f"below {1e6 * _HOT_K:g}",
            remedy="state the strain's unit with --unit, or the gauge's own drift with --per-kelvin",
        )  # fmt: skip
        gauges.append(
            {
                "column": name,
                "unit": taken,
                "jumps_um_m": [1e6 * size for size in found.sizes],
                "jumps_at": found.jumps.tolist(),
                "per_kelvin_um_m": None if per is None else 1e6 * per,
            }
        )
        if found.jumps.size:
            sizes = ", ".join(f"{1e6 * size:+.3g}" for size in found.sizes[:5])
            more = "" if found.sizes.size <= 5 else ", …"
            warnings.append(
                f"{name}: {found.sizes.size} jumps of its zero are taken out ({sizes}{more} µm/m)"
            )
        if per and known is None:
            warnings.append(
                f"{name}: {1e6 * per:.3g} µm/m a kelvin go with the temperature and are taken out, "
                "real stress that does so with them (--per-kelvin)"
            )
        strains.append(found.strain)
    values = scf * rosette_stress(
        np.array(strains),
        np.radians(turned),
        elastic_modulus_pa=1e9 * elastic_modulus_gpa,
        poisson=poisson,
    )
    name = ", ".join(columns)
    document: dict[str, Any] = {"file": str(file), "column": name, "unit": units[0].name}
    document |= {"gauges": gauges, "angles_deg": list(turned), "scf": scf}
    document |= _counted(
        values,
        table,
        file,
        name,
        max(units, key=lambda u: u.assumed),
        chosen,
        thickness_mm,
        warnings=warnings,
    )
    return Reply(document, lambda: _show(document))


class _Unit(NamedTuple):
    """Unit of a column, and whether nothing states it."""

    name: str
    assumed: bool = False


def _counted(
    values: FloatArray,
    table: ReadTable,
    file: Path,
    column: str,
    unit: _Unit,
    chosen: SNCurve,
    thickness_mm: float | None,
    *,
    warnings: list[str],
) -> dict[str, Any]:
    """Return cycles and damage of a stress series (n,) [Pa] as JSON has them."""
    from jackettwin.fatigue import equivalent_range

    with working("counting cycles"):
        cycles, scale, said = _across_gaps(values, table.times_s, file, column)
    widest = float(cycles.ranges.max(initial=0.0))
    require(
        widest < STRONGEST_PA,
        f"no steel resists stress ranges of {widest / 1e6:.3g} MPa",
        file=file,
        field=column,
        value=f"in {unit.name}",
        remedy=_other_unit(widest, unit.name),
    )
    weak = f"no range is larger than {widest:.3g} Pa"
    require(
        not unit.assumed or widest == 0.0 or widest > _WEAKEST_PA, f"no unit is stated, and {weak}",
        file=file, field=column, value=f"in {unit.name}", remedy="state the unit with --unit",
    )  # fmt: skip
    warnings = [*warnings, *said]
    if unit.assumed:
        warnings.append(f"no unit of {column} is stated: {unit.name} is assumed (--unit)")
    if 0.0 < widest < _WEAKEST_PA:
        warnings.append(f"{weak}: is the series in {unit.name}? (--unit)")
    if widest == 0.0:
        warnings.append(f"{column} is constant: is its sensor dead?")
    thickness = None if thickness_mm is None else 1e-3 * thickness_mm
    damage = scale * chosen.damage(cycles.ranges, cycles.numbers, thickness_m=thickness)
    largest = scale * float(chosen.damage(np.array([widest]), np.ones(1), thickness_m=thickness))
    if cycles.ranges.size > _FEWEST and largest > _ONE_CYCLE * damage:
        share = 100.0 * min(largest / damage, 1.0)
        warnings.append(f"one cycle of {1e-6 * widest:.3g} MPa does {share:.0f} % of the damage: a spike?")
    closed = 0.0
    if cycles.full.size:
        closed = scale * float(chosen.damage(cycles.full, np.ones(cycles.full.size), thickness_m=thickness))
    return {
        "curve": chosen.name,
        "environment": chosen.environment,
        "edition": chosen.edition,
        "cycles_full": int(cycles.full.size),
        "cycles_half": int(cycles.half.size),
        "largest_range_mpa": 1e-6 * widest,
        "n_eq": _N_EQ,
        "equivalent_range_mpa": {
            f"m{m}": 1e-6 * scale ** (1.0 / m) * equivalent_range(cycles, m, _N_EQ) for m in (3, 5)
        },
        "equivalent_range_by_spectrum_mpa": _by_spectrum(values, table),
        "damage": damage,
        "damage_by_cycles": closed,
        "warnings": warnings,
        "left_out": omission_documents([Omission("mean stress"), Omission("the order of cycles")]),
    }


def _column(table: ReadTable, file: Path, column: str) -> FloatArray:
    rows = dict(zip(table.names, table.data, strict=True))
    return np.asarray(look_up(rows, column, "column", file=file, field="--column"), dtype=float)


def _unit_of(
    table: ReadTable,
    file: Path,
    column: str,
    unit: str | None,
    units: dict[str, float],
    usual: str,
    what: str,
) -> _Unit:
    """Return the unit of a column: the option's, the file's, that of its name, or the usual one."""
    _column(table, file, column)
    said = table.channels.get(column)
    named = next((u for u in units if column.lower().endswith(f"_{u.lower().replace('/', '_')}")), None)
    stated = (table.unit if said is None or said.unit is None else said.unit) or named
    if stated is not None and stated not in units and plain_unit(stated) in units:
        stated = plain_unit(stated)
    if unit is None and stated is not None and stated not in units:
        raise InputError(
            f"is not a unit of {what}", file=file, field=column, value=stated, allowed=", ".join(units),
            remedy="state it with --unit",
        )  # fmt: skip
    if unit and stated in units and units[stated] != units[unit]:
        raise InputError(
            f"the file or the column's name states {stated}",
            file=file,
            field="--unit",
            value=unit,
            remedy="omit the option",
        )
    stated = unit or stated
    return _Unit(usual, assumed=True) if stated is None else _Unit(stated)


def _other_unit(widest_pa: float, unit: str) -> str:
    """Return which unit would make a series that is too strong in one as strong as welds are."""
    if unit not in _UNITS:
        return "state the unit with --unit"
    number = widest_pa / _UNITS[unit]
    fitting = [name for name, size in _UNITS.items() if _USUAL_PA[0] < number * size < _USUAL_PA[1]]
    return f"state its own unit, as --unit {fitting[0]}" if fitting else "convert it to a unit of --unit"


def _across_gaps(
    values: FloatArray, times_s: FloatArray | None, file: Path, column: str
) -> tuple[Cycles, float, list[str]]:
    """Return the cycles across gaps, the factor for the missing time, and warnings.

    A gap is samples without a number, or rows that are not there.
    """
    from jackettwin.fatigue import count

    known = np.isfinite(values)
    require(known.any(), "contains no numbers", file=file, field=column, remedy="export the file again")
    missing = 1.0 - float(known.mean()) * (1.0 - _rows_missing(times_s))
    # the series did get from one side of a gap to the other: its slow cycles are counted across
    said = f"{100 * missing:.2g} % of the samples are missing: gaps are bridged, damage scaled to the whole"
    return count(values[known]), 1.0 / (1.0 - missing), [said] if missing else []


def _by_spectrum(values: FloatArray, table: ReadTable) -> dict[str, float] | None:
    """Return the equivalent ranges by Dirlik's formula, which counts nothing.

    None where samples are missing, do not follow each other evenly, or nothing moves.
    """
    from jackettwin.fatigue import dirlik

    steps = np.zeros(0) if table.times_s is None else np.diff(table.times_s)
    if table.sample_rate_hz is None and not steps.size:
        return None
    h = float(np.median(steps)) if table.sample_rate_hz is None else 1.0 / table.sample_rate_hz
    even = not steps.size or bool(np.abs(steps - h).max() < _EVEN * h)
    if not even or not np.isfinite(values).all() or values.size <= _FEWEST or np.ptp(values) == 0.0:
        return None
    S = np.asarray(2.0 * h / values.size * np.abs(np.fft.rfft(values - values.mean())) ** 2, dtype=float)
    f, seconds = np.asarray(np.fft.rfftfreq(values.size, h), dtype=float), h * values.size
    return {f"m{m}": 1e-6 * (seconds * dirlik(f, S, m) / _N_EQ) ** (1.0 / m) for m in (3, 5)}


def _rows_missing(times_s: FloatArray | None) -> float:
    """Return the share of the time in which no row stands, where others follow each other by a usual step."""
    if times_s is None or times_s.size <= _FEWEST:
        return 0.0
    steps = np.diff(times_s)
    usual = float(np.median(steps))
    gaps = steps[steps > _GAP_STEPS * usual]
    if not usual > 0.0 or not gaps.size:
        return 0.0
    return float((gaps - usual).sum() / (steps.sum() + usual))


def _show(document: dict[str, Any]) -> None:
    for warning in document["warnings"]:
        messages.print(f"warning: {warning}")
    m3, m5 = (document["equivalent_range_mpa"][m] for m in ("m3", "m5"))
    say(
        f"{document['column']}: {document['cycles_full']} cycles and {document['cycles_half']} half cycles, "
        f"largest range {document['largest_range_mpa']:.4g} MPa"
    )
    say(f"equivalent range of {_N_EQ:.0e} cycles: {m3:.4g} MPa (m = 3), {m5:.4g} MPa (m = 5)")
    by_spectrum = document["equivalent_range_by_spectrum_mpa"]
    if by_spectrum is not None:
        say(
            f"by its spectrum, as of a stationary stress (Dirlik): {by_spectrum['m3']:.4g} MPa (m = 3), "
            f"{by_spectrum['m5']:.4g} MPa (m = 5)"
        )
    say(
        f"damage {document['damage']:.4g} by {document['edition']}, curve {document['curve']}, "
        f"{document['environment']}"
    )
