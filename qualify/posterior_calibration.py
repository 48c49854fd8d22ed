"""Simulation-based calibration (Talts et al. 2018): truths from the prior, poles with a record's covariance.

Usage: python qualify/posterior_calibration.py [n_twins]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from scipy.stats import binomtest, chisquare

from jackettwin.errors import NumericalError
from jackettwin.structure import Rayleigh, assemble, read_structure
from jackettwin.updating import Problem, Residuals, SupportModel, Target, family, single, support_model
from jackettwin.updating.extras import Extras
from jackettwin.updating.posterior import sample_posterior

OUT = Path(__file__).parents[1] / "docs" / "verification" / "posterior_calibration.md"
MODES = (1, 2, 4)
SECONDS = 600.0
DRAWS = 99
"""Ranks run from 0 to this."""


def twin_model() -> SupportModel:
    return support_model(
        assemble(read_structure("jacket15")),
        family=family("maxwell-3"),
        rayleigh=Rayleigh.minimum(0.0055, 0.1832),
        bounds={"k": (1e9, 3e10), "loss_factor": (0.02, 0.4), "c_side_side": (1e4, 2e5)},
        highest_mode=5,
        extras=Extras(("c_side_side",)),
    )


def observed(model: SupportModel, theta: np.ndarray, rng: np.random.Generator) -> Problem:
    """Return the poles of a truth as one record gives them: lognormal, with Au's long-data limits."""
    targets = []
    for mode, pole in zip(MODES, model.predict(theta, MODES).poles, strict=True):
        f, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
        cov_f, cov_zeta = (
            np.sqrt(zeta / (2 * np.pi * f * SECONDS)),
            1 / np.sqrt(2 * np.pi * zeta * f * SECONDS),
        )
        f, zeta = np.exp(rng.normal(np.log([f, zeta]), [cov_f, cov_zeta]))
        targets.append(Target(mode, f, cov_f * f, zeta, cov_zeta * zeta))
    return single(model, Residuals(tuple(targets), relative=False))


def main() -> None:
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    model = twin_model()
    names = [p.name for p in model.parameters]
    prior = single(model, Residuals((Target(1, 0.18, 0.01),), relative=False)).prior
    ranks, inside, refused = [], [], 0
    start = time.process_time()
    for i in range(number):
        rng = np.random.default_rng((7, i))
        z = prior.draw(1, rng)[0]
        try:
            posterior = sample_posterior(observed(model, np.exp(z), rng), particles=100, islands=3, seed=i)
        except NumericalError:
            refused += 1
            continue
        low, high = np.log(posterior.interval(0.9)).T
        inside.append((low <= z) & (z <= high))
        draws = posterior.log_theta[rng.choice(len(posterior.log_theta), DRAWS, replace=False)]
        ranks.append((draws < z).sum(axis=0))
        if i % 50 == 49:
            print(i + 1, np.mean(inside, axis=0), flush=True)
    cpu = (time.process_time() - start) / number
    rows = []
    for j, name in enumerate(names):
        hits = int(np.sum([row[j] for row in inside]))
        limits = binomtest(hits, len(inside)).proportion_ci(0.95)
        counts = np.histogram([r[j] for r in ranks], bins=10, range=(0, DRAWS + 1))[0]
        rows.append((name, hits / len(inside), limits.low, limits.high, chisquare(counts).pvalue))
    lines = [
        "# Calibration of the posterior",
        "",
        f"`python qualify/posterior_calibration.py {number}`: {number} twins, truths from the prior, f and ζ",
        f"of modes 1, 2, 4 drawn with the covariance of one {SECONDS:.0f} s record.",
        f"{refused} refused as not converged.",
        f"{cpu:.2f} CPU-s a posterior.",
        "",
        "| parameter | 90 % intervals cover | 95 % limits of that | ranks uniform, p |",
        "|---|---|---|---|",
        *(f"| {n} | {100 * c:.1f} % | {100 * a:.1f}–{100 * b:.1f} % | {p:.3f} |" for n, c, a, b, p in rows),
    ]
    OUT.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
