"""Verdicts and evidence against quadrature: what data identify of two or three parameters, and what not.

Usage: python qualify/identifiability.py
"""

from __future__ import annotations

import itertools
import time
from functools import reduce

import numpy as np
from common.cases import Result, cases
from common.command import arguments
from common.page import write_page
from scipy.special import logsumexp

from jackettwin.decks import read_structure
from jackettwin.errors import NumericalError
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, assemble
from jackettwin.updating import Problem, Residuals, SupportModel, Target, single, support_model
from jackettwin.updating.nuisance_parameters import NuisanceParameters
from jackettwin.updating.posterior.identifiability import USABLE, WEAK, identifiability, verdict_of
from jackettwin.updating.posterior.smc import sample_posterior

MODES = (1, 2, 4)
DASHPOT = "c_side_side"
LAWS = {
    "kelvin-voigt": {"k": (1e8, 1e11), "c": (1e6, 1e10)},
    "maxwell-3": {"k": (1e8, 1e11), "loss_factor": (1e-3, 0.6)},
    "springpot": {"k": (1e8, 1e11), "alpha": (1e-3, 0.4)},
    "maxwell-3 and a dashpot": {"k": (1e8, 1e11), "loss_factor": (1e-3, 0.6), DASHPOT: (1e3, 1e6)},
}
STIFFNESS = (5e8, 3e9, 3e10)
LOSS = 0.1
ROTOR = 3e4
PRECISION = {"one record": (4e-3, 0.3), "a hundred": (1e-3, 0.04), "a glance": (2e-2, 1.0)}
DATA = ("f1 f2 f4 ζ1", "f1 f2 f4", "ζ1")
GRID = {2: 101, 3: 31}
DEPTH = 16.0
"""Nats below the largest weight that quadrature leaves out."""
TWO = tuple(itertools.product(tuple(LAWS)[:3], STIFFNESS, DATA, PRECISION.items()))
THREE = tuple(
    itertools.product(
        tuple(LAWS)[3:], STIFFNESS[:1], (DATA[0], DATA[0] + " ζ2"), tuple(PRECISION.items())[:1]
    )
)
PROBLEMS = TWO + THREE
EDGE = 0.05
"""A ratio nearer than this to a limit (relative) may fall on either side."""


def truth(law: str, k: float) -> np.ndarray:
    own = {
        "kelvin-voigt": [LOSS * k / (2 * np.pi * 0.18)],
        "maxwell-3": [LOSS],
        "springpot": [2 / np.pi * LOSS],
        "maxwell-3 and a dashpot": [LOSS, ROTOR],
    }
    return np.array([k, *own[law]])


def targets(data: str, f: np.ndarray, zeta: np.ndarray, precision: tuple[float, float]) -> tuple[Target, ...]:
    rows = []
    for mode, f_m, zeta_m in zip(MODES, f, zeta, strict=True):
        has_f, has_zeta = f"f{mode}" in data, f"ζ{mode}" in data
        rows.append(
            Target(
                mode,
                f_m if has_f else None,
                precision[0] * f_m if has_f else None,
                zeta_m if has_zeta else None,
                precision[1] * zeta_m if has_zeta else None,
            )
        )
    return tuple(row for row in rows if row.frequency_hz is not None or row.damping_ratio is not None)


def quadrature(problem: Problem, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Return each θ's posterior over prior standard deviation, the factor of its 90 % interval, and ln Z.

    A grid over the whole box, then finer ones over what carries weight.
    """
    low, high = problem.prior.low, problem.prior.high
    grid = GRID[low.size]
    for _ in range(4):
        axes = [np.linspace(a, b, grid) for a, b in zip(low, high, strict=True)]
        z = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, low.size)
        ends = [np.where((x == x[0]) | (x == x[-1]), 0.5, 1.0) for x in axes]
        log_w = problem.log_likelihood(z, problem.anchor(centre))[0] + problem.prior.log_density(z)
        log_w += np.log(reduce(np.multiply.outer, ends)).ravel()
        cell = np.prod((high - low) / (grid - 1))
        seen = z[log_w > log_w.max() - DEPTH]
        step = (high - low) / (grid - 1)
        closer = np.maximum(seen.min(axis=0) - step, low), np.minimum(seen.max(axis=0) + step, high)
        if ((closer[1] - closer[0]) > 0.7 * (high - low)).all():
            break
        low, high = closer
    log_z = float(logsumexp(log_w))
    weight = np.exp(log_w - log_z)
    mean = weight @ z
    ratio = np.sqrt(weight @ (z - mean) ** 2) / problem.prior.std
    return ratio, np.exp(np.diff(_ends(weight, axes))[:, 0]), log_z + float(np.log(cell))


def _ends(weight: np.ndarray, axes: list[np.ndarray]) -> np.ndarray:
    """Return the 5th and 95th percentile of each ln θ, (n, 2), from weights on a grid."""
    share = weight.reshape([x.size for x in axes])
    found = []
    for j, x in enumerate(axes):
        alone = share.sum(axis=tuple(i for i in range(len(axes)) if i != j))
        below = np.cumsum(0.5 * (alone[1:] + alone[:-1]))
        found.append(np.interp([0.05, 0.95], np.r_[0.0, below] / below[-1], x))
    return np.array(found)


def right(found: str, exact: str, ratio: float, factor: float) -> bool:
    """Return whether the verdicts agree, or a number by quadrature lies on its limit."""
    at_limit = abs(ratio / WEAK - 1.0) < EDGE or abs(factor / USABLE - 1.0) < EDGE
    return at_limit or found == exact


def judged(models: dict[str, SupportModel], case: int) -> Result:
    """Return the verdicts and the evidence of one problem beside those of quadrature."""
    start = time.process_time()
    law, k, data, (name, precision) = PROBLEMS[case]
    theta = truth(law, k)
    poles = models[law].predict(theta, MODES).poles
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    problem = single(models[law], Residuals(targets(data, f, zeta, precision), relative=False))
    about = f"{law}, k {k:.0e}, {data}, {name}"
    try:
        posterior = sample_posterior(problem, particles=150, seed=case + 1)
    except NumericalError:
        return {"about": about, "refused": True, "cpu_s": time.process_time() - start}
    verdicts = identifiability(problem, posterior.log_theta)
    ratio, factor, log_z = quadrature(problem, np.log(theta))
    return {
        "about": about,
        "refused": False,
        "names": [p.name for p in problem.parameters],
        "found": [(v.verdict, v.ratio, v.interval_factor) for v in verdicts],
        "exact": [
            (verdict_of(r, f, v.decided_by), r, f)
            for v, r, f in zip(verdicts, ratio.tolist(), factor.tolist(), strict=True)
        ],
        "log_evidence_error": posterior.log_evidence - log_z,
        "log_evidence_std": posterior.log_evidence_std,
        "cpu_s": time.process_time() - start,
    }


def evidence_row(found: list[Result]) -> str:
    """Return how far ln Z is off."""
    apart = np.abs([r["log_evidence_error"] for r in found])
    stated = max(r["log_evidence_std"] for r in found)
    return (
        f"| {len(found[0]['names'])} | {len(found)} | {np.median(apart):.3f} | {np.quantile(apart, 0.9):.3f} "
        f"| {apart.max():.3f} | {(apart < 0.1).sum()} | {stated:.3f} |"
    )


def main() -> None:
    arguments(__doc__)
    assembly = assemble(read_structure("jacket15"))
    steel = Rayleigh.minimum(0.0055, 0.1832)
    models: dict[str, SupportModel] = {
        law: support_model(
            assembly,
            family=family(law.split()[0]),
            rayleigh=steel,
            bounds=bounds,
            highest_mode=5,
            nuisance=NuisanceParameters((DASHPOT,)) if DASHPOT in bounds else None,
        )
        for law, bounds in LAWS.items()
    }
    every = cases("identifiability", len(PROBLEMS), lambda case: judged(models, case))
    found = [r for r in every if not r["refused"]]
    counts: dict[str, list[int]] = {word: [0, 0] for word in ("identified", "weak", "unidentified")}
    wrong = []
    for r in found:
        for name, (said, *about), (verdict, ratio, factor) in zip(
            r["names"], r["found"], r["exact"], strict=True
        ):
            good = right(said, verdict, ratio, factor)
            counts[verdict][0] += 1
            counts[verdict][1] += good
            if not good:
                numbers = "ratio {:.2f}, interval ×{:.3g}".format(*about)
                wrong.append(f"- {r['about']}: {name} {numbers} for {ratio:.2f}, ×{factor:.3g}")
    total, agreed = (sum(tally[i] for tally in counts.values()) for i in (0, 1))
    write_page(
        "identifiability",
        [
            "# Identifiability verdicts and evidence",
            "",
            f"`python qualify/identifiability.py`: {len(TWO)} problems of two parameters (three laws,",
            f"three stiffnesses, sets of data and precisions each) and {len(THREE)} of three (a law and a",
            "dashpot in the rotor); verdicts and ln Z by quadrature over the prior.",
            f"{len(PROBLEMS) - len(found)} refused as not converged.",
            f"Right verdicts: {agreed} of {total} ({100 * agreed / total:.1f} %).",
            "",
            "ln Z of 4 × 150 particles, the default of an update, less that of quadrature:",
            "",
            "| parameters | problems | median | nine of ten | most | within 0.1 | largest stated deviation |",
            "|---|---|---|---|---|---|---|",
            *(evidence_row([r for r in found if len(r["names"]) == d]) for d in GRID),
            "",
            "| by quadrature | parameters | right |",
            "|---|---|---|",
            *(f"| {word} | {n} | {ok} |" for word, (n, ok) in counts.items()),
            "",
            *wrong,
        ],
    )


if __name__ == "__main__":
    main()
