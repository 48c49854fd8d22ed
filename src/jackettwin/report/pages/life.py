"""The page on a structure's life: worst joints, life in 3-D, bands of damage, sources of what is unknown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.fatigue import WeldLife
from jackettwin.report.pages.page import Embedded, PageSection, Text, write_page
from jackettwin.report.table import UNKNOWN, Table
from jackettwin.report.view.page import ColouredQuantity, View, render_view
from jackettwin.structure import Assembly
from jackettwin.version import __version__

_WORST = 10
_LONGEST_YEARS = 1e4
"""At which the colours of life end."""


def life_quantity(assembly: Assembly, welds: Sequence[WeldLife]) -> ColouredQuantity:
    """Return the shortest life of the welds on every element: those of a brace at its ends, of a chord on it.

    An element without welds has the longest life that is drawn.
    """
    years: dict[str, float] = {}
    for one in welds:
        member = one.weld.chord if one.side == "chord" else one.weld.brace
        years[member] = min(years.get(member, _LONGEST_YEARS), one.life.life_years)
    names = [assembly.structure.members[m].name for m in assembly.mesh.member]
    values = np.array([years.get(name, _LONGEST_YEARS) for name in names])
    return ColouredQuantity("life, if all time is like the record", "years", values, log=True)


def worst_welds(welds: Sequence[WeldLife]) -> tuple[WeldLife, ...]:
    """Return the welds that a page names, of welds with the shortest life first.

    Those whose factors are doubtful, beyond their ranges, come after all others.
    """
    return tuple(sorted(welds, key=lambda one: bool(one.weld.doubts))[:_WORST])


def write_life_page(
    assembly: Assembly,
    welds: Sequence[WeldLife],
    path: Path,
    *,
    title: str,
    like: str,
    by_band: Sequence[Mapping[str, float]],
    unseen: Mapping[str, FloatArray],
    remarks: Sequence[str] = (),
) -> Path:
    """Write one self-contained HTML file; return its path.

    Parameters
    ----------
    welds : shortest life first
    by_band : of the worst welds, {band: share by which the damage falls without it}
    unseen : {sensor: what is not seen of the stress at the worst welds, over all of it (n,)}, ``""`` for now
    remarks : sentences under the first table

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    worst = worst_welds(welds)
    view = render_view(View(assembly, (life_quantity(assembly, welds),)))
    sections = [
        PageSection("Worst joints", (_worst(worst, like), Text(tuple(remarks), style="warnings"))),
        PageSection(
            "Life in 3-D",
            (Embedded("life", "Where is life short?", view, "Draw the structure coloured by life"),),
        ),
        PageSection("Damage by band", (_bands(worst, by_band),)),
        PageSection("Sources of uncertainty", (_sources(worst),)),
        PageSection("One more sensor", (_sensors(unseen),)),
    ]
    return write_page(sections, path, title=title, subtitle=f"like {like} · jackettwin {__version__}")


def _name(one: WeldLife) -> tuple[str, str, str]:
    return one.weld.node, one.weld.brace, f"{one.side}, {one.position}"


def _worst(worst: Sequence[WeldLife], like: str) -> Table:
    rows = []
    for one in worst:
        low, high = one.life.damage_interval_90
        per_year = one.life.median_damage / max(one.life.damage, 1e-300) / max(one.life.life_years, 1e-300)
        span = (f"{per_year * value / max(one.life.median_damage, 1e-300):.2g}" for value in (low, high))
        rows.append(
            (
                *_name(one),
                f"{one.z_m:.1f}",
                f"{1e-6 * one.largest_range_pa:.0f}",
                f"{one.life.life_years:.3g}" if np.isfinite(one.life.life_years) else UNKNOWN,
                " to ".join(span),
            )
        )
    heads = ("joint", "brace", "point", "z [m]", "largest range [MPa]", "design life [years]")
    caption = (
        f"Which welds have least life, if all time is like {like}? Those beyond the ranges of their factors "
        "come last. Damage of a year is by the mean of the tests, its interval that of 90 %."
    )
    return Table(caption, (*heads, "damage of a year"), tuple(rows), text_columns=3)


def _bands(worst: Sequence[WeldLife], by_band: Sequence[Mapping[str, float]]) -> Table:
    names = list(by_band[0]) if by_band else []
    rows = [
        (*_name(one), *(f"{round(100.0 * shares[name])}" for name in names))
        for one, shares in zip(worst, by_band, strict=True)
    ]
    caption = (
        "Which motion does the damage? By how much it falls without the motion of each band [%]; as cycles "
        "of one band ride on those of others, the shares add up to more than 100."
    )
    return Table(caption, ("joint", "brace", "point", *names), tuple(rows), text_columns=3)


def _sources(worst: Sequence[WeldLife]) -> Table:
    names = list(worst[0].life.variance_shares)
    rows = [
        (*_name(one), *(f"{100.0 * one.life.variance_shares.get(name, 0.0):.0f}" for name in names))
        for one in worst
    ]
    caption = "What makes life uncertain? Shares of the variance of ln damage [%]."
    return Table(caption, ("joint", "brace", "point", *names), tuple(rows), text_columns=3)


def _sensors(unseen: Mapping[str, FloatArray]) -> Table:
    rows = sorted(
        (
            (name or "none", f"{100.0 * float(np.median(share)):.1f}", f"{100.0 * float(share.max()):.1f}")
            for name, share in unseen.items()
        ),
        key=lambda row: float(row[1]),
    )
    caption = (
        "What would one more sensor buy? Standard deviation of the stress that sensors do not see, over that "
        "of all stress [%], at the worst welds. The structure's own uncertainty is not in it."
    )
    return Table(caption, ("one more", "median", "worst weld"), tuple(rows))
