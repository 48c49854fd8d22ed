"""Drift of soil stiffness from day to day: false alarms, coverage and power on planted twins.

Usage: python qualify/drift.py [n_twins]
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from common.command import arguments
from scipy.stats import binomtest

from jackettwin.decks import read_structure
from jackettwin.identification.maximum_likelihood.mode_drift import long_data_limits
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, assemble
from jackettwin.updating import Residuals, SupportModel, Target, joint, support_model
from jackettwin.updating.drift import Drift, find_drift
from jackettwin.updating.joint import Growth

OUT = Path(__file__).parents[1] / "docs" / "verification" / "drift.md"
MODES, DAYS = (1, 2, 4), 10
SECONDS = 86400.0
"""Of records a day."""
MODEL_ERROR = 0.005
CHANGES = (0.0, -0.05, -0.10, -0.20)
"""Of the stiffness from the first day to the last."""


def twin(model: SupportModel, change: float, seed: int) -> Drift:
    """Return what is found in ten days of records of one planted twin."""
    rng = np.random.default_rng((17, seed))
    k, loss = np.exp(rng.uniform(np.log([1e9, 0.03]), np.log([1e10, 0.3])))
    off = MODEL_ERROR * rng.standard_normal(len(MODES))
    slope = np.log1p(change) / (DAYS - 1)
    states = {}
    for day in range(DAYS):
        poles = model.predict(np.array([k * np.exp(slope * day), loss]), MODES).poles
        f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
        # what no method can beat (Au 2014), in a day of records
        f_std, zeta_std = long_data_limits(f, zeta, SECONDS)
        f_seen = f * np.exp(off + f_std * rng.standard_normal(len(MODES)))
        zeta_seen = zeta * np.exp(zeta_std * rng.standard_normal(len(MODES)))
        targets = tuple(
            Target(m, a, s * a, b, t * b)
            for m, a, s, b, t in zip(MODES, f_seen, f_std, zeta_seen, zeta_std, strict=True)
        )
        states[str(day)] = (Residuals(targets, relative=False), {})
    days = {name: float(name) for name in states}
    errors = {f"f{mode}": MODEL_ERROR for mode in MODES}
    problem = joint(model, states, errors=errors, growth=Growth(("k",), days, 2.0 / (DAYS - 1)))
    return find_drift(problem, np.log([3e9, 0.1, *(1.0 for _ in errors)]))


def main() -> None:
    number = arguments(__doc__, number=400).number
    model = support_model(
        assemble(read_structure("jacket15")),
        family=family("maxwell-3"),
        rayleigh=Rayleigh.minimum(0.0055, 0.1832),
        bounds={"k": (3e8, 3e10), "loss_factor": (0.01, 0.6)},
        highest_mode=5,
    )
    lines = [
        "# Drift of soil stiffness",
        "",
        f"`python qualify/drift.py {number}`: {number} twins, k 1e9 to 1e10 N/m, loss factor 0.03 to 0.3,",
        f"the model's frequencies {100 * MODEL_ERROR:g} % off, the same every day; f and ζ of modes",
        f"{', '.join(map(str, MODES))} on {DAYS} days, as precise as a day of",
        "records allows. Alarm: the 95 % interval of the slope excludes zero.",
        "",
        "| change of k in all | alarms | 95 % limits | 90 % intervals that contain the slope |",
        "|---|---|---|---|",
    ]
    for change in CHANGES:
        found = [twin(model, change, seed) for seed in range(number)]
        alarms = sum(drift.detected for drift in found)
        true = np.log1p(change) / (DAYS - 1)
        covered = sum(drift.interval_90[0] <= true <= drift.interval_90[1] for drift in found)
        limits = binomtest(alarms, number).proportion_ci(0.95)
        lines.append(
            f"| {100 * change:+.0f} % | {100 * alarms / number:.1f} % | {100 * limits.low:.1f} to "
            f"{100 * limits.high:.1f} % | {100 * covered / number:.1f} % |"
        )
        print(lines[-1], flush=True)
    OUT.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
