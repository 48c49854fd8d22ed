"""The appendix on the update: all laws, the posterior, all solutions."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jackettwin.intervals import interval_90
from jackettwin.report.figures import posterior as draw
from jackettwin.report.pages.page import Block, Plot, Text
from jackettwin.report.table import Table
from jackettwin.report.tables import updating as tables
from jackettwin.report.tables.numbers import UNKNOWN, fixed, words
from jackettwin.soil import parameter_words
from jackettwin.study import TwinResult
from jackettwin.updating import Uncertainty, Update, recommended

_SHOWN = 4
"""Largest number of parameter columns in the table of tolerances."""


def every_law(result: TwinResult) -> list[Block]:
    """Return modes and parameters of every law at its best fit, with damped and undamped frequencies."""
    if not result.updates:
        return []
    blocks: list[Block] = [tables.key_table(result), tables.parameter_table(result.updates)]
    if result.relaxations:
        blocks.append(tables.relaxation_table(result))
    text = (
        "A very strong dashpot does not move and acts as a rigid support: the damped frequencies agree "
        "although the undamped structure is wrong. Differences beyond 5 % are flagged as locked dampers."
    )
    return [*blocks, Text((text,)), tables.damped_undamped_table(result)]


def posterior(result: TwinResult) -> list[Block]:
    """Return the sampling of the posterior, its draws, its profiles and its predictions."""
    known = [(u, u.uncertainty) for u in result.updates if u.uncertainty is not None]
    if not known:
        return []
    blocks: list[Block] = [Text(tuple(f"{u.law}: {_status(k)}" for u, k in known))]
    shown = recommended(result.updates)
    if shown is None or shown.uncertainty is None:
        return blocks
    k = shown.uncertainty
    return [
        *blocks,
        Plot(
            "correlation",
            f"{shown.law}: how are the parameters correlated? Draws from the posterior on logarithmic axes; "
            "line: prior; dotted: 90 %.",
            draw.corner(shown, k),
        ),
        Plot(
            "profiles",
            f"{shown.law}: how accurately do the data determine each parameter? Profiles of the posterior "
            "density; below the dashed line: 90 %.",
            draw.profiles(shown, k),
        ),
        _predictions(shown, k, result),
    ]


def tolerances(result: TwinResult) -> list[Block]:
    """Return the tolerances of drawings and sea: prior, posterior, and effect on the ground."""
    u = recommended(result.updates)
    place = [other is u for other in result.updates]
    s = result.scrutiny[place.index(True)] if u is not None and result.scrutiny else None
    if u is None or s is None or not s.influences:
        return []
    known = {one.tolerance.name: one.tolerance.words for one in s.influences}
    names = [parameter_words(p.name) for p in u.problem.parameters][:_SHOWN]
    rows = [
        (
            one.tolerance.words,
            one.tolerance.settled_by,
            ", ".join(known.get(name, name) for name in one.alike) or UNKNOWN,
            f"{one.tolerance.std:.3g} {'' if one.tolerance.unit == '-' else one.tolerance.unit}".strip(),
            f"{one.mean * one.tolerance.std:+.2g} (σ {one.std * one.tolerance.std:.2g})".replace("-", "−"),
            *(
                f"{100.0 * np.expm1(e):+.2g} ({r:.2f})".replace("-", "−")
                for e, r in zip(one.effect[:_SHOWN], one.settled[:_SHOWN], strict=True)
            ),
        )
        for one in s.influences
    ]
    columns = ("tolerance", "settle it", "like", "σ before", "after", *(f"{name} [%]" for name in names))
    caption = (
        f"{u.law}: what are the effects of the tolerances of drawings, weighing and sea? For each parameter "
        "its change due to one σ and, in brackets, the factor on its σ if that tolerance were known; like: "
        "not distinguished by these data."
    )
    text = "Checks of all measured values, and possible explanations of outlying ones, are in result.json."
    return [Text((text,)), Table(caption, columns, tuple(rows), text_columns=3)]


def every_solution(result: TwinResult) -> list[Block]:
    """Return all distinct solutions of each law, and the completeness of the search."""
    if not result.updates:
        return []
    said = tuple(f"{u.law}: {u.search.statement}" for u in result.updates)
    return [Text(said), *(tables.solutions_table(result, u) for u in result.updates)]


def _status(k: Uncertainty) -> str:
    if k.posterior is None:
        return f"no posterior: {k.status}. The intervals are Laplace's approximation."
    p = k.posterior
    return (
        f"posterior of {len(p.log_theta)} draws, R-hat at most {p.convergence.rhat.max():.3f}, "
        f"at least {min(p.convergence.ess_bulk.min(), p.convergence.ess_tail.min()):.0f} effective, "
        f"log evidence {p.log_evidence:.2f} (standard deviation {p.log_evidence_std:.2f})"
        f"{'.' if p.evidence_known else ': its runs disagree, so that it is not used to compare laws.'}"
    )


def _predictions(u: Update, k: Uncertainty, result: TwinResult) -> Table:
    q, labels = k.predictive, {m.mode: m.label for m in result.measured}
    rows = [
        (
            words(labels.get(mode, result.labels[mode - 1])),
            _span(q.frequency_hz[:, i], 1.0, 4),
            _span(q.undamped_hz[:, i], 1.0, 4),
            _span(q.damping_ratio[:, i], 100.0, 2),
        )
        for i, mode in enumerate(q.modes)
    ]
    columns = ("mode", "f [Hz]", "undamped f [Hz]", "ζ [%]")
    return Table(
        f"{u.law}: predictions of all modes, measured or not, with 90 % intervals.", columns, tuple(rows), 1
    )


def _span(draws: npt.NDArray[np.float64], factor: float, decimals: int) -> str:
    known = interval_90(factor * draws)
    return UNKNOWN if known is None else f"{fixed(known[0], decimals)} – {fixed(known[2], decimals)}"
