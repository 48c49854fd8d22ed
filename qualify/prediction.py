"""Blind prediction of ζ4: soil that loses the same at every frequency, by a law that no fit contains.

Usage: python qualify/prediction.py [n_truths]
"""

from __future__ import annotations

import sys
import time

import numpy as np
from common.cases import Result, cases
from common.page import percent, write_page
from scipy.stats import binomtest

from jackettwin.structure import Assembly, Rayleigh, assemble, read_structure
from jackettwin.updating import Residuals, Target, family, single, support_model
from jackettwin.updating.posterior import sample_posterior
from jackettwin.updating.solutions import search

MODES = (1, 2, 4)
STEEL = Rayleigh.minimum(0.0055, 0.1832)
LAWS = ("maxwell-3", "kelvin-voigt", "zener")
SECONDS = 600.0


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


def covered(assembly: Assembly, f: np.ndarray, zeta: np.ndarray, rng: np.random.Generator, seed: int) -> bool:
    """Return whether the predictive 90 % interval of ζ4 from one record contains the truth."""
    bounds = {"k": (5e8, 3e10), "loss_factor": (0.01, 0.5)}
    model = support_model(assembly, family=family("maxwell-3"), rayleigh=STEEL, bounds=bounds, highest_mode=5)
    cov_f, cov_zeta = np.sqrt(zeta / (2 * np.pi * f * SECONDS)), 1 / np.sqrt(2 * np.pi * zeta * f * SECONDS)
    f_seen, zeta_seen = (
        f * np.exp(cov_f * rng.standard_normal(3)),
        zeta * np.exp(cov_zeta * rng.standard_normal(3)),
    )
    targets = (
        Target(1, f_seen[0], cov_f[0] * f_seen[0], zeta_seen[0], cov_zeta[0] * zeta_seen[0]),
        Target(2, f_seen[1], cov_f[1] * f_seen[1]),
        Target(4, f_seen[2], cov_f[2] * f_seen[2]),
    )
    posterior = sample_posterior(
        single(model, Residuals(targets, relative=False)), particles=100, islands=3, seed=seed
    )
    poles = posterior.poles[:, 2]
    low, high = np.quantile(-poles.real / np.abs(poles), [0.05, 0.95])
    return bool(low <= zeta[2] <= high)


def truth(assembly: Assembly, case: int) -> Result:
    """Return each law's error of ζ4, and whether the default law's interval from one record holds it."""
    start = time.process_time()
    rng = np.random.default_rng((11, case))
    k, loss_factor = np.exp(rng.uniform(np.log([5e8, 0.01]), np.log([3e10, 0.5])))
    poles = truth_poles(assembly, k, loss_factor)
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    return {
        "errors": {law: fit(assembly, law, f, zeta) / zeta[2] - 1.0 for law in LAWS},
        "inside": covered(assembly, f, zeta, rng, case),
        "cpu_s": time.process_time() - start,
    }


def main() -> None:
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    assembly = assemble(read_structure("jacket15"))
    found = cases("prediction", number, lambda case: truth(assembly, case))
    hits = sum(r["inside"] for r in found)
    limits = binomtest(hits, number).proportion_ci(0.95)
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
            f"`python qualify/prediction.py {number}`: {number} truths on springpots, k 5e8 to 3e10 N/m,",
            "loss factor 0.01 to 0.5 at every frequency; f1, f2, f4 and ζ1 fitted, ζ4 predicted.",
            "",
            "| law | median error | median size of error | worst |",
            "|---|---|---|---|",
            *rows,
            "",
            f"With the covariances of a {SECONDS:.0f} s record the default law's 90 % interval contains",
            f"ζ4 in {hits} of {number} cases (95 % limits {percent(limits.low, limits.high, 0)}).",
        ],
    )


if __name__ == "__main__":
    main()
