"""Damping by source, of soil and rotor, on twins of known truth, and the thesis's first pair.

Usage: python qualify/damping_budget.py [n_twins]
"""

from __future__ import annotations

import time

import numpy as np
from common.cases import Result, cases
from common.command import arguments
from common.measured import as_measured, sampled
from common.page import percent, write_page
from scipy.stats import binomtest

from jackettwin.decks import read_structure
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, assemble
from jackettwin.updating import Residuals, SupportModel, Target, single, support_model
from jackettwin.updating.budget import SOURCES, budget_of_draws, damping_budget, damping_sources
from jackettwin.updating.nuisance_parameters import NuisanceParameters
from jackettwin.updating.search.solutions import search

MODES = (1, 2, 4)
SECONDS = 600.0
SHOWN = ("soil", "rotor")
BOUNDS = {"k": (1e9, 3e10), "loss_factor": (0.02, 0.4), "c_fore_aft": (2e3, 5e4), "c_side_side": (2e4, 3e5)}
PAIRS = ((0.0127, 0.059), (0.059, 0.0127))
"""ζ1 and ζ2 of thesis table 6.1, in both assignments."""


def twin_model(bounds: dict[str, tuple[float, float]]) -> SupportModel:
    return support_model(
        assemble(read_structure("jacket15")),
        family=family("maxwell-3"),
        rayleigh=Rayleigh.minimum(0.0055, 0.1832),
        bounds=bounds,
        highest_mode=5,
        nuisance=NuisanceParameters(("c_fore_aft", "c_side_side")),
    )


def twin(model: SupportModel, case: int) -> Result:
    """Return for each mode and source whether the 90 % interval holds the true damping ratio."""
    start = time.process_time()
    rng = np.random.default_rng((17, case))
    low, high = (np.log([getattr(p, side) for p in model.parameters]) for side in ("low", "high"))
    theta = np.exp(rng.uniform(low, high))
    targets = as_measured(MODES, model.predict(theta, MODES).poles, SECONDS, rng)
    posterior = sampled(single(model, Residuals(targets, relative=False)), case)
    if posterior is None:
        return {"inside": None, "cpu_s": time.process_time() - start}
    value, draws = damping_budget(model, theta, MODES).damping_ratio, np.exp(posterior.log_theta[::3])
    found = model.predict_many(draws, MODES, slopes=False)
    parts = damping_sources(model, model.points(draws).plain(), found)
    interval = budget_of_draws(MODES, parts).damping_ratio_interval_90
    assert interval is not None
    inside = (interval[..., 0] <= value) & (value <= interval[..., 1])
    return {"inside": inside.tolist(), "cpu_s": time.process_time() - start}


def first_pair(pair: tuple[float, float]) -> str:
    """Return the row of one assignment: the best solution to f1, f2, f4 and ζ1, ζ2."""
    model = twin_model({"k": (1e9, 1e11), "c_fore_aft": (1e3, 1e6), "c_side_side": (1e3, 1e6)})
    targets = (
        Target(1, 0.1819, 0.0008, pair[0], 0.1 * pair[0]),
        Target(2, 0.1838, 0.0008, pair[1], 0.1 * pair[1]),
        Target(4, 0.7362, 0.004),
    )
    best = search(single(model, Residuals(targets, relative=False)), starts=8).solutions[0]
    by_source = damping_budget(model, best.theta, (1, 2)).damping_ratio
    shares = by_source[:, SOURCES.index("rotor")] / by_source.sum(axis=1)
    got = " | ".join(
        f"{100 * z:.2f} % ({z / wanted - 1:+.1%}), {share:.0%}"
        for z, wanted, share in zip(best.damping_ratio[:2], pair, shares, strict=True)
    )
    return f"| {100 * pair[0]:.2f} %, {100 * pair[1]:.2f} % | {got} |"


def main() -> None:
    number = arguments(__doc__, number=200).number
    model = twin_model(BOUNDS)
    found = cases("damping_budget", number, lambda case: twin(model, case))
    inside = np.array([r["inside"] for r in found if r["inside"] is not None])
    rows = []
    for i, mode in enumerate(MODES):
        for source in SHOWN:
            hits = int(inside[:, i, SOURCES.index(source)].sum())
            limits = binomtest(hits, len(inside)).proportion_ci(0.95)
            share = f"{100 * hits / len(inside):.0f} % ({percent(limits.low, limits.high, 0)})"
            rows.append(f"| {mode} | {source} | {share} |")
    write_page(
        "damping_budget",
        [
            "# Damping by source",
            "",
            f"`python qualify/damping_budget.py {number}`: {number} twins, soil and nacelle dashpots drawn",
            f"from their priors, f and ζ of modes {', '.join(map(str, MODES))} drawn with the covariance of",
            f"one {SECONDS:.0f} s record; {number - len(inside)} refused as not converged.",
            f"{np.mean([r['cpu_s'] for r in found]):.1f} CPU-s a twin.",
            "",
            "Share of 90 % intervals that contain the true value, with its 95 % limits:",
            "",
            "| mode | source | its damping ratio |",
            "|---|---|---|",
            *rows,
            "",
            "The first pair of thesis table 6.1, which no support at the feet can reproduce:",
            "",
            "| measured ζ1, ζ2 | ζ1 found, the rotor's share | ζ2 found, the rotor's share |",
            "|---|---|---|",
            *map(first_pair, PAIRS),
        ],
    )


if __name__ == "__main__":
    main()
