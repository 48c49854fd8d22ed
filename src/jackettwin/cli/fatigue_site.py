"""``jackettwin fatigue site``: life of joints over the bins of a site, with its design basis."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from jackettwin.caveats import Omission, omission_documents
from jackettwin.cli.cache import keeping
from jackettwin.cli.console import Reply, answers, messages, progress, say
from jackettwin.cli.weld_options import edition_option, joint_options
from jackettwin.cli.weld_tables import POINT, SHOWN, SIDE, show_welds
from jackettwin.files import atomic_path
from jackettwin.intervals import QUANTILES
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.response import System
    from jackettwin.study import Site, SiteLife, SiteWeld
    from jackettwin.twin import TwinConfig
    from jackettwin.updating import Update

_LEFT_OUT = (
    Omission("weather within a bin beside its turbulence and phases: bins must be narrow"),
    Omission("starts, stops, faults, transport and installation", "IEC 61400-3-1 (2019), 7.4"),
    Omission("butt welds, flanges, grout and castings: only joints of tubes are summed over bins"),
    Omission("joints in several planes: each plane is assessed separately"),
    Omission("crack growth, inspections and repairs"),
)


@click.command("site")
@click.argument("site", type=click.Path(path_type=Path))
@joint_options
@edition_option
@click.option(
    "--basis", "page", type=click.Path(path_type=Path),
    help="Write the design basis with its results to this file, as Markdown.",
)  # fmt: skip
@click.option("--fresh", is_flag=True, help="Ignore stored identifications and fits of earlier runs.")
@answers
def site_(
    site: Path, curve: str, design_factor: float, edition: str | None, page: Path | None, fresh: bool
) -> Reply:
    """Compute the life of joints from the bins of wind, sea and state in SITE.

    SITE (YAML) names the scenario that all bins share and the share of time of each bin. Bins without records
    are simulated; variants of the scenario stand beside it, under the same seeds.
    """
    from jackettwin.fatigue import basis_page, design_basis, models_at_height, read_details
    from jackettwin.study import read_site, site_life

    models = partial(models_at_height, design_factor=design_factor, edition=edition)
    model, read = models(curve), read_site(site)
    known = _known(read, fresh)
    with progress(len(read.bins) * (1 + len(read.variants)), site.name) as step:
        found = site_life(read, model, read_details(None, models), known=known, step=step)
    left_out = omission_documents(_LEFT_OUT)
    files = [site, read.scenario, *([] if read.twin is None else [read.twin])]
    files += [record for i in range(len(read.bins)) for record in read.records(i)]
    files += [] if edition is None or not Path(edition).is_file() else [Path(edition)]
    basis = design_basis(files, model, left_out)
    joints = [_weld(read, found, one) for one in found.welds]
    document = {
        "site": str(site),
        "edition": model(np.inf)[1].curve.edition,
        "curve": curve,
        "design_factor": design_factor,
        "years": read.years,
        "age_years": read.age_years,
        "target_index": read.target_index,
        "share": read.share,
        "bins": [
            {
                **one.model_dump(include={"share", "state", "speed_m_s", "hs_m", "tp_s", "misalignment_deg"}),
                "source": "records" if one.records else "simulation",
                "number": number,
            }
            for one, number in zip(read.bins, found.numbers, strict=True)
        ],
        "joints": joints,
        "warnings": _warnings(read, found),
        "left_out": left_out,
        "design_basis": basis,
    }
    if page is not None:
        with atomic_path(page) as temporary:
            table = Table("", _BASIS, joints[:SHOWN])
            temporary.write_text(basis_page(site.stem, basis, [table.heads, *table.cells]), encoding="utf-8")
    return Reply(document, lambda: _show(document))


def _known(read: Site, fresh: bool) -> tuple[TwinConfig, Update, System] | None:
    """Return the site's twin, its update and its most probable structure; None without one."""
    from jackettwin.study import count_steps, updated, updated_systems
    from jackettwin.twin import read_twin

    if read.twin is None:
        return None
    config = read_twin(str(read.twin))
    with progress(count_steps(config), config.name) as step:
        update = updated(config, progress=step, keep=keeping(fresh=fresh))
    return config, update, updated_systems(update)[0]


def _weld(site: Site, life: SiteLife, one: SiteWeld) -> dict[str, Any]:
    w, total = one.one, sum(one.variances.values())
    low, mid, high = (left if np.isfinite(left := one.remaining.quantile(p)) else None for p in QUANTILES)
    by_state: dict[str, float] = {}
    for own, share in zip(site.bins, one.by_bin, strict=True):
        by_state[own.state] = by_state.get(own.state, 0.0) + float(share)
    years = np.arange(0.0, max(site.years - site.age_years, 0.0) + 1.0)
    return {
        "joint": w.weld.node,
        "chord": w.weld.chord,
        "brace": w.weld.brace,
        "side": w.side,
        "position": one.position,
        "z_m": w.z_m,
        "environment": w.environment,
        "damage_per_year": one.rate,
        "life_years": one.life_years,
        "life_years_by_variant": {name: lives.get(w.place) for name, lives in life.variants.items()},
        "remaining_years": {"p05": low, "p50": mid, "p95": high},
        "reliability_index": one.remaining.reliability_index,
        "reliability_index_by_year": [one.remaining.later(y).reliability_index for y in years],
        "year_of_target": one.remaining.year_of_index(site.target_index),
        "variance_shares": {name: v / total for name, v in one.variances.items()},
        "damage_by_bin": one.by_bin,
        "damage_by_state": by_state,
        "beyond_validity": list(w.weld.warnings),
    }


def _warnings(site: Site, life: SiteLife) -> list[str]:
    found = []
    if site.share < 1.0 - 1e-6:
        found.append(f"the bins have {100 * site.share:.3g} % of all time; the rest is taken to do no damage")
    if all(number == 1 for number in life.numbers):
        found.append("each bin has one simulation or record: what weather adds to the variance is not known")
    outside = sum(bool(one.one.weld.warnings) for one in life.welds)
    if outside:
        found.append(
            f"{outside} of {len(life.welds)} welds are beyond the validity ranges of Efthymiou's factors"
        )
    return found


_YEARS = TableColumn("years to target", "year_of_target", ".0f")
_COLUMNS = (
    *SIDE,
    *POINT,
    TableColumn("life [years]", "life_years", ".3g"),
    TableColumn("index now", "reliability_index", ".2f"),
    _YEARS,
)
_BASIS = (
    *SIDE,
    POINT[1],
    TableColumn("damage a year", "damage_per_year", ".3g"),
    TableColumn("life [years]", "life_years", ".3g"),
    TableColumn("reliability index now", "reliability_index", ".2f"),
    _YEARS,
    TableColumn("beyond validity", lambda row: "yes" if row["beyond_validity"] else "no"),
)


def _show(document: dict[str, Any]) -> None:
    rows = document["joints"]
    show_welds(f"life over {len(document['bins'])} bins", _COLUMNS, rows)
    if rows and len(rows[0]["life_years_by_variant"]) > 1:
        worst = rows[0]
        lives = ", ".join(
            f"{name} {years:.3g}" for name, years in worst["life_years_by_variant"].items() if years
        )
        say(f"life of {worst['brace']} at {worst['joint']} in years: {lives}")
    for warning in document["warnings"]:
        messages.print(f"warning: {warning}")
