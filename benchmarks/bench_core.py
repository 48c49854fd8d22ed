"""Speed of the core: assembly and modes of the reference jacket at three mesh sizes.

Bars: sparse assembly within 50 ms at 5,000 degrees of freedom; a springpot's modes as fast as Maxwell's.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from statistics import median
from time import process_time

from jackettwin.decks import read_structure
from jackettwin.response.condensation.condensed import condense
from jackettwin.response.modes.modal import damped_modes, undamped_modes
from jackettwin.response.system import build_system
from jackettwin.soil import on_translations, pinned
from jackettwin.soil.laws.viscoelastic import Springpot, kelvin_voigt, maxwell_3, zener
from jackettwin.structure import Rayleigh, assemble

LAWS = {
    "kelvin-voigt": kelvin_voigt(2.5e9, 7.6e8),
    "zener": zener(2.62e9, 8.65e8, 9.99e9),
    "maxwell-3": maxwell_3(2.5e9, 0.2, 0.183),
    "springpot": Springpot(2.5e9, 0.1, 1.15),
}
BELOW_HZ = (0.8, 1.5, 3.0)


def milliseconds(work: Callable[[], object], repeats: int = 5) -> float:
    """Median CPU time."""
    times = []
    for _ in range(repeats):
        start = process_time()
        work()
        times.append(1e3 * (process_time() - start))
    return median(times)


def main() -> None:
    structure, rayleigh = read_structure("jacket15"), Rayleigh.minimum(0.01, 0.1832)
    for subdivide in (1, 4, 8):
        assembly = assemble(structure, subdivide=subdivide)
        work: Callable[[], object] = partial(assemble, structure, subdivide=subdivide)
        report(f"assemble, {assembly.n_dof} DOFs", milliseconds(work))
        free = build_system(assembly, pinned(structure))
        report("  ten undamped modes", milliseconds(partial(undamped_modes, free, 10)))
        for name, law in LAWS.items():
            system = build_system(assembly, on_translations(structure, law), rayleigh=rayleigh)
            for below_hz in BELOW_HZ:
                work = partial(damped_modes, system, below_hz=below_hz)
                report(f"  damped modes below {below_hz:g} Hz, {name}", milliseconds(work, 3))
        system = build_system(assembly, on_translations(structure, LAWS["zener"]), rayleigh=rayleigh)
        report("  condensed to the feet", milliseconds(partial(condense, system, below_hz=0.95)))


def report(what: str, time_ms: float) -> None:
    sys.stdout.write(f"{what:52s} {time_ms:9.2f} ms\n")


if __name__ == "__main__":
    main()
