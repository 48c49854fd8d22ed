"""Blind prediction of ζ4: soil that loses the same at every frequency, by a law that no fit contains.

Usage: python qualify/prediction.py [n_truths] [n_intervals]
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
from jackettwin.structure import Assembly, Rayleigh, assemble
from jackettwin.updating import Residuals, Target, single, support_model
from jackettwin.updating.search.solutions import search

MODES = (1, 2, 4)
STEEL = Rayleigh.minimum(0.0055, 0.1832)
LAWS = ("maxwell-3", "kelvin-voigt", "zener")
SECONDS = 600.0
BOUNDS = {"k": (5e8, 3e10), "loss_factor": (0.01, 0.5)}
"""Truths are drawn from the prior of the fit: log-uniform."""


def truth_poles(assembly: Assembly, k: float, loss_factor: float) -> np.ndarray:
    """Return the poles of modes 1, 2, 4 on springpots: the loss factor is the same at every frequency."""
    model = support_model(assembly, family=family("springpot"), rayleigh=STEEL, highest_mode=5)
    return model.predict(np.array([k, 2.0 / np.pi * np.arctan(loss_factor)]), MODES).poles


def fit(assembly: Assembly, law: str, f: np.ndarray, zeta: np.ndarray) -> float:
    """Return ζ4 of the best solution to near-exact f1, f2, f4 and ζ1."""
    model = support_model(assembly, family=family(law), rayleigh=STEEL, highest_mode=5)
    targets = (Target(1, f[0], damping_ratio=zeta[0]), Target(2, f[1]), Target(4, f[2]))
    found = search(single(model, Residuals(targets, relative=True)), starts=16)
    best = next((s for s in found.solutions if not s.locked_damper), found.solutions[0])
    return float(best.damping_ratio[2])


def drawn(rng: np.random.Generator) -> tuple[float, float]:
    """Return stiffness and loss factor of a truth."""
    k, loss_factor = np.exp(rng.uniform(*np.log(list(zip(*BOUNDS.values(), strict=True)))))
    return float(k), float(loss_factor)


def truth(assembly: Assembly, case: int) -> Result:
    """Return each law's error of ζ4 from near-exact data."""
    start = time.process_time()
    poles = truth_poles(assembly, *drawn(np.random.default_rng((11, case))))
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    return {
        "errors": {law: fit(assembly, law, f, zeta) / zeta[2] - 1.0 for law in LAWS},
        "cpu_s": time.process_time() - start,
    }


def observed(poles: np.ndarray, rng: np.random.Generator) -> tuple[Target, ...]:
    """Return f1, f2, f4 and ζ1 as one record gives them."""
    first, *others = as_measured(MODES, poles, SECONDS, rng)
    return (first, *(Target(t.mode, t.frequency_hz, t.frequency_std_hz) for t in others))


def prediction(assembly: Assembly, case: int) -> Result:
    """Return the rank of the true ζ4 among the default law's predictions from one record."""
    start = time.process_time()
    rng = np.random.default_rng((11, case))
    poles = truth_poles(assembly, *drawn(rng))
    model = support_model(assembly, family=family("maxwell-3"), rayleigh=STEEL, bounds=BOUNDS, highest_mode=5)
    posterior = sampled(single(model, Residuals(observed(poles, rng), relative=False)), case)
    rank = None
    if posterior is not None:
        predicted = posterior.poles[:, 2]
        rank = float(np.mean(-predicted.real / np.abs(predicted) < -poles[2].real / np.abs(poles[2])))
    return {"rank": rank, "cpu_s": time.process_time() - start}


def main() -> None:
    given = arguments(__doc__, number=50, intervals=400)
    number, intervals = given.number, given.intervals
    assembly = assemble(read_structure("jacket15"))
    found = cases("prediction", number, lambda case: truth(assembly, case))
    ranks = [
        r["rank"]
        for r in cases("prediction", intervals, lambda case: prediction(assembly, case), part="_intervals")
        if r["rank"] is not None
    ]
    hits = sum(0.05 <= rank <= 0.95 for rank in ranks)
    limits = binomtest(hits, len(ranks)).proportion_ci(0.95)
    rows = []
    for law in LAWS:
        e = 100 * np.array([r["errors"][law] for r in found])
        rows.append(
            f"| {law} | {np.median(e):+.1f} % | {np.median(np.abs(e)):.1f} % | {np.abs(e).max():.1f} % |"
        )
    write_page(
        "prediction",
        [
            "# Blind prediction of ζ4",
            "",
            f"`python qualify/prediction.py {number} {intervals}`: {number} truths on springpots,",
            "k 5e8 to 3e10 N/m, loss factor 0.01 to 0.5 at every frequency; f1, f2, f4 and ζ1 fitted, ζ4",
            "predicted.",
            "",
            "| law | median error | median size of error | worst |",
            "|---|---|---|---|",
            *rows,
            "",
            f"With the covariances of a {SECONDS:.0f} s record the default law's 90 % interval contains",
            f"ζ4 in {hits} of {len(ranks)} such truths, {100 * hits / len(ranks):.1f} % (95 % limits",
            f"{percent(limits.low, limits.high)}): below it in {sum(r < 0.05 for r in ranks)}, above it in",
            f"{sum(r > 0.95 for r in ranks)}; {intervals - len(ranks)} refused as not converged.",
        ],
    )


if __name__ == "__main__":
    main()
