"""Three modes with all gradients: the condensed model against the thesis's dense state-space eigenvalues.

Run by ``make bench``; prints a Markdown table. One BLAS thread; processor time, best of several runs, for the
machine may be shared.
n ≈ 950: jacket15 with two elements a member.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np

from jackettwin.decks import read_structure
from jackettwin.response.condensation.numbered_modes import Status, numbered_poles
from jackettwin.response.modes.modal import damped_modes
from jackettwin.response.state import state_matrix
from jackettwin.soil import family
from jackettwin.soil.laws.viscoelastic import Prony
from jackettwin.structure import Rayleigh, assemble
from jackettwin.updating import SupportModel, support_model

MODES = (1, 2, 4)
BATCH = 2000
POINTS = {
    "kelvin-voigt": [2.5e9, 7.6e8],
    "zener": [2.62e9, 8.65e8, 9.99e9],
    "maxwell-3": [3e9, 0.2],
    "springpot": [3e9, 0.06],
}


def best(action: Callable[[], object], repeats: int) -> float:
    action()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    return min(times)


def row(model: SupportModel, theta: np.ndarray) -> dict[str, float]:
    points, beside = model.points(theta[None]), model.points(theta[None] * 1.05)
    here = numbered_poles(model.condensed, points, MODES)
    assert (here.status == Status.CERTIFIED).all()
    rng = np.random.default_rng(0)
    many = model.points(theta * np.exp(0.2 * rng.standard_normal((BATCH, theta.size))))
    system = model.system(theta)
    exact = damped_modes(system, below_hz=0.95).eigenvalues
    error = max(np.abs(exact / pole - 1.0).min() for pole in here.poles[0])
    pencil = system.pencil
    if not all(isinstance(law, Prony) for law in model.laws(theta)):
        # no state matrix holds a springpot: the smallest there is, with a spring and a dashpot in its place
        pencil = pencil.with_laws([Prony(2.5e9, 7.6e8)] * len(pencil.groups))
    start = time.process_time()
    np.linalg.eig(state_matrix(pencil))
    dense = time.process_time() - start
    return {
        "dense": dense,
        "cold": best(lambda: numbered_poles(model.condensed, beside, MODES), 50),
        "warm": best(
            lambda: numbered_poles(model.condensed, beside, MODES, near=here, shape_slopes=True), 200
        ),
        "batch": BATCH / best(lambda: numbered_poles(model.condensed, many, MODES, near=here), 5),
        "error": float(error),
    }


def main() -> None:
    assembly = assemble(read_structure("jacket15"), subdivide=2)
    steel = Rayleigh.minimum(0.01, 0.1832)
    out = sys.stdout
    out.write(
        f"\nCondensed poles, n = {assembly.n_dof}, modes 1, 2, 4 with all gradients of poles and shapes\n\n"
    )
    out.write(
        "| law | dense eig [s] | cold + certificate [ms] | × | warm [ms] | × | batched [1/s] | error |\n"
    )
    out.write("|---|---|---|---|---|---|---|---|\n")
    for name, theta in POINTS.items():
        model = support_model(assembly, family=family(name), rayleigh=steel, highest_mode=5)
        r = row(model, np.array(theta))
        dense, cold, warm = r["dense"], r["cold"], r["warm"]
        ratio = [f"{dense / t:,.0f}" for t in (cold, warm)]
        out.write(
            f"| {name} | {dense:.2f} | {1e3 * cold:.2f} | {ratio[0]} "
            f"| {1e3 * warm:.3f} | {ratio[1]} | {r['batch']:,.0f} | {r['error']:.1e} |\n"
        )


if __name__ == "__main__":
    main()
