"""Structures that nothing was tuned on: SubDyn decks on 6×6 pile heads, truths drawn from the heads' priors.

Each twin is a file that goes through ``jackettwin update``: poles of five modes with the covariance of one
record in, parameters and their intervals out.

Usage: python qualify/unseen_structures.py [n_twins of each structure]
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
import yaml
from common.cases import Result, cases
from common.command import arguments
from common.page import percent, write_page
from scipy.stats import binomtest

from jackettwin.decks import read_structure
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.soil import family
from jackettwin.soil.files import read_support
from jackettwin.structure import Rayleigh, assemble
from jackettwin.study import run_twin
from jackettwin.twin import read_twin
from jackettwin.updating import SupportModel, support_model
from jackettwin.updating.prior import BoxPrior

DECKS = Path(__file__).parent / "decks"
STRUCTURES = ("oc3_tripod", "oc4_jacket")
LAW = "maxwell-3"
MODES = (1, 2, 3, 4, 5)
SECONDS = 600.0
STEEL = {"ratio": 0.005, "frequency_hz": 0.3}


def true_model(name: str) -> SupportModel:
    """Return the deck on its pile heads, as the twin file describes it."""
    structure = read_structure(DECKS / f"{name}.dat")
    return support_model(
        assemble(structure),
        family=family(LAW),
        rayleigh=Rayleigh.minimum(STEEL["ratio"], STEEL["frequency_hz"]),
        tie="horizontal-vertical",
        heads=read_support(DECKS / "piles.yaml", structure),
        informed=True,
        highest_mode=max(MODES) + 1,
    )


def targets(poles: np.ndarray, rng: np.random.Generator) -> list[dict[str, float]]:
    """Return poles as one record gives them: lognormal, with Au's long-data limits."""
    rows = []
    for mode, pole in zip(MODES, poles, strict=True):
        f, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
        cov_f, cov_zeta = long_data_limits(f, zeta, SECONDS)
        f, zeta = np.exp(rng.normal(np.log([f, zeta]), [cov_f, cov_zeta]))
        rows.append(
            {
                "mode": mode,
                "frequency_hz": float(f),
                "frequency_std_hz": float(cov_f * f),
                "damping_ratio": float(zeta),
                "damping_ratio_std": float(cov_zeta * zeta),
            }
        )
    return rows


def twin(models: dict[str, SupportModel], case: int) -> Result:
    """Return which true parameters the 90 % intervals of one twin hold."""
    start = time.process_time()
    name = STRUCTURES[case % len(STRUCTURES)]
    rng = np.random.default_rng((23, case))
    prior = BoxPrior.of(models[name].parameters)
    theta = np.exp(prior.draw(1, rng)[0])
    document = {
        "structure": str(DECKS / f"{name}.dat"),
        "damping": {"rayleigh": STEEL},
        "support": {"tie": "horizontal-vertical", "stiffness": str(DECKS / "piles.yaml")},
        "targets": targets(models[name].predict(theta, MODES).poles, rng),
        "update": {"damping_of": "all"},
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "twin.yaml"
        path.write_text(yaml.safe_dump(document), encoding="utf-8")
        result = run_twin(read_twin(path), laws=(LAW,))
    known = result.updates[0].uncertainty
    assert known is not None
    low, high = known.interval_90.T
    return {
        "structure": name,
        "parameters": [p.name for p in result.updates[0].problem.parameters],
        "theta": theta.tolist(),
        "inside": ((low <= theta) & (theta <= high)).tolist(),
        "verdicts": [v.verdict for v in known.verdicts],
        "status": known.status,
        "solutions": len(result.updates[0].solutions),
        "cpu_s": time.process_time() - start,
    }


def rows(found: list[Result]) -> list[str]:
    """Return a line for each structure and parameter."""
    lines = []
    for name in STRUCTURES:
        own = [r for r in found if r["structure"] == name]
        for j, parameter in enumerate(own[0]["parameters"]):
            hits = sum(r["inside"][j] for r in own)
            limits = binomtest(hits, len(own)).proportion_ci(0.95)
            verdicts = [r["verdicts"][j] for r in own]
            counts = ", ".join(f"{verdicts.count(v)} {v}" for v in ("identified", "weak", "unidentified"))
            lines.append(
                f"| {name} | {parameter} | {hits} of {len(own)} ({percent(limits.low, limits.high, 0)}) "
                f"| {counts} |"
            )
    return lines


def main() -> None:
    number = len(STRUCTURES) * arguments(__doc__, each=20).each
    models = {name: true_model(name) for name in STRUCTURES}
    found = cases("unseen_structures", number, lambda case: twin(models, case))
    inside = sum(sum(r["inside"]) for r in found)
    total = sum(len(r["inside"]) for r in found)
    limits = binomtest(inside, total).proportion_ci(0.95)
    write_page(
        "unseen_structures",
        [
            "# Unseen structures",
            "",
            f"`python qualify/unseen_structures.py {number // len(STRUCTURES)}`: OpenFAST's OC3 tripod and",
            "OC4 jacket as SubDyn decks with the NREL 5 MW turbine's tower and mass on top",
            "(`qualify/decks`), on 6×6 pile heads. Truths from the heads' priors; f and ζ of modes",
            f"1 to {max(MODES)} with the covariance of {SECONDS:.0f} s; each twin a file, run as",
            f"`jackettwin update` runs it: {LAW}, four parameters.",
            f"{np.mean([r['cpu_s'] for r in found]):.1f} CPU-s a twin,"
            f" {max(r['cpu_s'] for r in found):.1f} at most;"
            f" {sum(r['status'] != 'ok' for r in found)} posteriors did not converge.",
            "",
            f"90 % intervals contain the true value in {inside} of {total} "
            f"({percent(limits.low, limits.high)}).",
            "",
            "| structure | parameter | inside (95 % limits) | verdicts |",
            "|---|---|---|---|",
            *rows(found),
        ],
    )


if __name__ == "__main__":
    main()
