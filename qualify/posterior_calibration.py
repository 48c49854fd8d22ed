"""Simulation-based calibration (Talts et al. 2018): truths from the prior, poles with a record's covariance.

Usage: python qualify/posterior_calibration.py [n_twins]
"""

from __future__ import annotations

import time

import numpy as np
from common.cases import Result, cases
from common.command import arguments
from common.page import percent, write_page
from scipy.stats import binomtest, chisquare

from jackettwin.decks import read_structure
from jackettwin.errors import NumericalError
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, assemble
from jackettwin.updating import Problem, Residuals, SupportModel, Target, single, support_model
from jackettwin.updating.nuisance_parameters import NuisanceParameters
from jackettwin.updating.posterior.smc import sample_posterior

MODES = (1, 2, 4)
SECONDS = 600.0
DRAWS = 99
"""Ranks run from 0 to this."""
PARTICLES = (100, 200)
"""Of each of three islands; the second if the first do not agree, as an update does."""


def twin_model() -> SupportModel:
    return support_model(
        assemble(read_structure("jacket15")),
        family=family("maxwell-3"),
        rayleigh=Rayleigh.minimum(0.0055, 0.1832),
        bounds={"k": (1e9, 3e10), "loss_factor": (0.02, 0.4), "c_side_side": (1e4, 2e5)},
        highest_mode=5,
        nuisance=NuisanceParameters(("c_side_side",)),
    )


def observed(model: SupportModel, theta: np.ndarray, rng: np.random.Generator) -> Problem:
    """Return the poles of a truth as one record gives them: lognormal, with Au's long-data limits."""
    targets = []
    for mode, pole in zip(MODES, model.predict(theta, MODES).poles, strict=True):
        f, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
        cov_f, cov_zeta = long_data_limits(f, zeta, SECONDS)
        f, zeta = np.exp(rng.normal(np.log([f, zeta]), [cov_f, cov_zeta]))
        targets.append(Target(mode, f, cov_f * f, zeta, cov_zeta * zeta))
    return single(model, Residuals(tuple(targets), relative=False))


def twin(model: SupportModel, case: int) -> Result:
    """Return the ranks of the true parameters among draws, and whether 90 % intervals hold them."""
    rng = np.random.default_rng((7, case))
    prior = single(model, Residuals((Target(1, 0.18, 0.01),), relative=False)).prior
    z = prior.draw(1, rng)[0]
    problem = observed(model, np.exp(z), rng)
    start = time.process_time()
    for particles in PARTICLES:
        try:
            posterior = sample_posterior(problem, particles=particles, islands=3, seed=case)
        except NumericalError:
            continue
        low, high = np.log(posterior.interval(0.9)).T
        draws = posterior.log_theta[rng.choice(len(posterior.log_theta), DRAWS, replace=False)]
        return {
            "inside": ((low <= z) & (z <= high)).tolist(),
            "ranks": (draws < z).sum(axis=0).tolist(),
            "doubled": particles != PARTICLES[0],
            "cpu_s": time.process_time() - start,
        }
    return {"inside": None, "cpu_s": time.process_time() - start}


def main() -> None:
    number = arguments(__doc__, number=1000).number
    model = twin_model()
    found = cases("posterior_calibration", number, lambda case: twin(model, case))
    known = [r for r in found if r["inside"] is not None]
    rows = []
    for j, name in enumerate(p.name for p in model.parameters):
        hits = sum(r["inside"][j] for r in known)
        limits = binomtest(hits, len(known)).proportion_ci(0.95)
        counts = np.histogram([r["ranks"][j] for r in known], bins=20, range=(0, DRAWS + 1))[0]
        rows.append(
            f"| {name} | {100 * hits / len(known):.1f} % | {percent(limits.low, limits.high)} "
            f"| {chisquare(counts).pvalue:.3f} |"
        )
    write_page(
        "posterior_calibration",
        [
            "# Calibration of the posterior",
            "",
            f"`python qualify/posterior_calibration.py {number}`: {number} twins, truths from the prior,",
            f"f and ζ of modes {', '.join(map(str, MODES))} drawn with the covariance of {SECONDS:.0f} s.",
            f"{sum(r['doubled'] for r in known)} were sampled twice because three islands of {PARTICLES[0]}",
            f"did not agree, {number - len(known)} were rejected as not converged after that.",
            f"{np.mean([r['cpu_s'] for r in found]):.2f} CPU-s a posterior.",
            "",
            "| parameter | coverage of 90 % intervals | its 95 % limits | ranks uniform, 20 bins, p |",
            "|---|---|---|---|",
            *rows,
        ],
    )


if __name__ == "__main__":
    main()
