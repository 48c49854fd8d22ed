"""Verdicts against quadrature: what two parameters' data identify, weakly identify and leave open.

Usage: python qualify/identifiability.py
"""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
from scipy.special import softmax

from jackettwin.errors import NumericalError
from jackettwin.structure import Rayleigh, assemble, read_structure
from jackettwin.updating import Problem, Residuals, SupportModel, Target, family, single, support_model
from jackettwin.updating.identifiability import IDENTIFIED, WEAK, identifiability, verdict_of
from jackettwin.updating.posterior import sample_posterior

OUT = Path(__file__).parents[1] / "docs" / "verification" / "identifiability.md"
MODES = (1, 2, 4)
LAWS = {
    "kelvin-voigt": {"k": (1e8, 1e11), "c": (1e6, 1e10)},
    "maxwell-3": {"k": (1e8, 1e11), "loss_factor": (1e-3, 0.6)},
    "springpot": {"k": (1e8, 1e11), "alpha": (1e-3, 0.4)},
}
STIFFNESS = (5e8, 3e9, 3e10)
LOSS = 0.1
PRECISION = {"one record": (4e-3, 0.3), "a hundred": (1e-3, 0.04), "a glance": (2e-2, 1.0)}
DATA = ("f1 f2 f4 ζ1", "f1 f2 f4", "ζ1")
GRID = 121
EDGE = 0.05
"""A ratio nearer than this to a limit (relative) may fall on either side."""


def truth(law: str, k: float) -> np.ndarray:
    loss = {"kelvin-voigt": LOSS * k / (2 * np.pi * 0.18), "maxwell-3": LOSS, "springpot": 2 / np.pi * LOSS}
    return np.array([k, loss[law]])


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


def exact_ratio(problem: Problem, centre: np.ndarray) -> np.ndarray:
    """Return posterior over prior standard deviation of each ln θ by quadrature over the whole box."""
    axes = [np.linspace(a, b, GRID) for a, b in zip(problem.prior.low, problem.prior.high, strict=True)]
    z = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    weight = softmax(problem.log_likelihood(z, problem.anchor(centre))[0])
    mean = weight @ z
    return np.sqrt(weight @ (z - mean) ** 2) / problem.prior.std


def right(found: float, exact: float) -> bool:
    """Return whether the verdicts agree, or the exact ratio lies on a limit."""
    at_limit = any(abs(exact / limit - 1.0) < EDGE for limit in (IDENTIFIED, WEAK))
    return at_limit or verdict_of(found) == verdict_of(exact)


def main() -> None:
    assembly = assemble(read_structure("jacket15"))
    steel = Rayleigh.minimum(0.0055, 0.1832)
    models: dict[str, SupportModel] = {
        law: support_model(assembly, family=family(law), rayleigh=steel, bounds=bounds, highest_mode=5)
        for law, bounds in LAWS.items()
    }
    counts: dict[str, list[int]] = {word: [0, 0] for word in ("identified", "weak", "unidentified")}
    cases, refused, wrong = 0, 0, []
    for law, k, data, (name, precision) in itertools.product(LAWS, STIFFNESS, DATA, PRECISION.items()):
        theta = truth(law, k)
        poles = models[law].predict(theta, MODES).poles
        f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
        problem = single(models[law], Residuals(targets(data, f, zeta, precision), relative=False))
        cases += 1
        try:
            posterior = sample_posterior(problem, particles=100, islands=3, seed=cases)
        except NumericalError:
            refused += 1
            continue
        exact = exact_ratio(problem, np.log(theta))
        for verdict, ratio in zip(identifiability(problem, posterior.log_theta), exact, strict=True):
            tally = counts[verdict_of(float(ratio))]
            tally[0] += 1
            tally[1] += right(verdict.ratio, float(ratio))
            if not right(verdict.ratio, float(ratio)):
                wrong.append(
                    f"{law}, k {k:.0e}, {data}, {name}: {verdict.name} {verdict.ratio:.2f} for {ratio:.2f}"
                )
    total, good = (sum(tally[i] for tally in counts.values()) for i in (0, 1))
    lines = [
        "# Identifiability verdicts",
        "",
        f"`python qualify/identifiability.py`: {cases} problems of two parameters (three laws, three",
        "stiffnesses, sets of data and precisions each); the right verdict by quadrature over the prior.",
        f"{refused} refused as not converged. Right: {good} of {total} ({100 * good / total:.1f} %).",
        "",
        "| by quadrature | parameters | right |",
        "|---|---|---|",
        *(f"| {word} | {n} | {ok} |" for word, (n, ok) in counts.items()),
        "",
        *(f"- {line}" for line in wrong),
    ]
    OUT.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
