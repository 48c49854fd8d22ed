"""The report's sections on what is known: intervals, verdicts, predictions, whose damping it is."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.report import figures_posterior as draw
from jackettwin.report.numbers import UNKNOWN, fixed, scientific, words
from jackettwin.report.page import Block, Plot, Table, Text
from jackettwin.report.summary import shown_update
from jackettwin.twin import TwinResult
from jackettwin.updating import Update, law_probability
from jackettwin.updating.budget import SOURCES
from jackettwin.updating.update import Uncertainty


def what_is_known(result: TwinResult) -> list[Block]:
    """Return verdicts, next measurements, posterior, profiles, predictions and the laws' comparison."""
    known = [(u, u.uncertainty) for u in result.updates if u.uncertainty is not None]
    if not known:
        return []
    blocks: list[Block] = [Text(tuple(f"{u.law}: {_status(k)}" for u, k in known))]
    for u, k in known:
        blocks.append(_verdicts(u, k))
    shown = shown_update(result)
    if shown.uncertainty is not None:
        blocks += _of_one(shown, shown.uncertainty, {m.mode: m.label for m in result.measured})
    probability = law_probability(result.updates)
    if probability is not None and len(probability) > 1:
        caption = "How likely each law is given the data; dashed: before them. Evidence, not fit."
        blocks.append(Plot("law_comparison", caption, draw.law_comparison(probability)))
    return blocks


def whose_damping(result: TwinResult) -> list[Block]:
    """Return the damping budget of the update that is shown."""
    if not result.updates:
        return []
    u = shown_update(result)
    interval = (
        "bars: 90 % intervals" if u.budget.damping_ratio_interval_90 is not None else "no intervals known"
    )
    modelled = draw.modelled_sources(u.budget)
    absent = [source for s, source in enumerate(SOURCES) if s not in modelled]
    unknown = f" Not modelled, so not known: {', '.join(absent)}." if absent else ""
    caption = f"{u.law}: whose damping each mode has, {interval}.{unknown}"
    return [Plot("damping_budget", caption, draw.damping_budget(result.measured, u.budget))]


def _status(k: Uncertainty) -> str:
    if k.posterior is None:
        return f"no posterior: {k.status}. The intervals are Laplace's approximation."
    p = k.posterior
    return (
        f"posterior of {len(p.log_theta)} draws, R-hat at most {p.convergence.rhat.max():.3f}, "
        f"at least {min(p.convergence.ess_bulk.min(), p.convergence.ess_tail.min()):.0f} effective, "
        f"log evidence {p.log_evidence:.2f} ± {p.log_evidence_std:.2f}"
        f"{'.' if p.evidence_known else ': its runs do not agree, so that laws are not compared by it.'}"
    )


def _verdicts(u: Update, k: Uncertainty) -> Table:
    rows = [
        (
            v.name,
            v.verdict,
            v.reason,
            v.verdict_before,
            fixed(v.ratio, 2),
            scientific(float(k.median[i])),
            f"{scientific(float(k.interval_90[i, 0]))} … {scientific(float(k.interval_90[i, 1]))}",
        )
        for i, v in enumerate(k.verdicts)
    ]
    columns = (
        "parameter",
        "verdict",
        "why",
        "expected before",
        "std after/before [-]",
        "median",
        "90 % interval",
    )
    return Table(
        f"{u.law}: what the data tell of each parameter (SI units).", columns, tuple(rows), 4, folded=False
    )


def _of_one(u: Update, k: Uncertainty, labels: Mapping[int, str]) -> list[Block]:
    blocks: list[Block] = [
        Plot(
            "posterior",
            f"{u.law}: draws from the posterior on logarithmic axes; line: before the data; dotted: 90 %.",
            draw.corner(u, k),
        ),
        Plot(
            "profiles",
            f"{u.law}: profiles of the posterior density, priors included. Below the dashed line: 90 %.",
            draw.profiles(u, k),
        ),
        _predictions(u, k, labels),
    ]
    if k.next_measurements:
        rows = [(m.what, fixed(m.gain_nats, 2)) for m in k.next_measurements]
        caption = f"{u.law}: which further measurement would tell most, by expected information."
        blocks.append(Table(caption, ("measurement", "gain [nat]"), tuple(rows), 1))
    return blocks


def _predictions(u: Update, k: Uncertainty, labels: Mapping[int, str]) -> Table:
    q = k.predictive
    rows = [
        (
            words(labels.get(mode, f"mode {mode}")),
            _span(q.frequency_hz[:, i], 1.0, 4),
            _span(q.undamped_hz[:, i], 1.0, 4),
            _span(q.damping_ratio[:, i], 100.0, 2),
        )
        for i, mode in enumerate(q.modes)
    ]
    columns = ("mode", "f [Hz]", "undamped f [Hz]", "ζ [%]")
    return Table(f"{u.law}: predictions, 90 % intervals of the posterior.", columns, tuple(rows), 1)


def _span(draws: FloatArray, factor: float, decimals: int) -> str:
    kept = draws[~np.isnan(draws)]
    if kept.size == 0:
        return UNKNOWN
    low, high = factor * np.quantile(kept, [0.05, 0.95])
    return f"{fixed(low, decimals)} … {fixed(high, decimals)}"
