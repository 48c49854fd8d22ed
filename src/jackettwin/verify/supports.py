"""Chapter 8 of the thesis: the jacket on viscoelastic feet."""

from __future__ import annotations

from functools import cache

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.decks import read_structure
from jackettwin.response import build_system, undamped_modes
from jackettwin.soil import Prony, family, on_translations
from jackettwin.structure import Assembly, Rayleigh, assemble
from jackettwin.updating import (
    Residuals,
    SupportModel,
    Target,
    Update,
    numbered_modes,
    single,
    support_model,
    update,
)
from jackettwin.verify.rows import Computed

MODES = (1, 2, 4)
T6_1 = ((1, 0.1819, 0.0127), (2, 0.1838, None), (4, 0.7362, None))
"""Modes identified: number, frequency [Hz] and damping ratio."""
KELVIN_VOIGT = ((2.5e9, 7.6e8), (1.1e8, 1e12))
"""k [N/m] and c [N·s/m] of Tables 8.1 and 8.3.

Table 8.3 prints no c: it is so large that the damped poles are those of pinned feet.
"""
ZENER = ((4.4e9, 3.76e9, 6.14e12), (2.62e9, 8.65e8, 9.99e9))
"""k0, k1 [N/m] and c [N·s/m] of Tables 8.5 and 8.7, in the order of the family's parameters."""
FIGURE_8_1_K0, FIGURE_8_1_K1 = 8.92e7, 1e13


def own_parameters() -> Computed:
    """Return the modes that the thesis's own parameters give, and the ends of figure 8.1."""
    computed: Computed = {}
    points = {
        "T8.1": ("kelvin-voigt", KELVIN_VOIGT[0]),
        "T8.5": ("zener", ZENER[0]),
        "T8.7": ("zener", ZENER[1]),
    }
    for key, (law, theta) in points.items():
        modes = _model(law).exact_modes(np.array(theta), MODES)
        computed |= _frequencies(key, modes.frequency_hz)
        computed[f"{key}-zeta1"], _, computed[f"{key}-zeta4"] = map(float, modes.damping_ratio)
    computed["T8.5-f4-corrected"] = computed["T8.5-f4"]
    locked = np.array(KELVIN_VOIGT[1])
    model = _model("kelvin-voigt")
    computed |= _frequencies("T8.3-damped", model.exact_modes(locked, MODES).frequency_hz)
    undamped = undamped_modes(model.system(locked), 3).frequency_hz
    return (
        computed | {f"T8.3-undamped-{k}": float(f) for k, f in enumerate(undamped, start=1)} | _figure_8_1()
    )


def fit(law: str) -> Computed:
    """Return the errors of a fit to Table 6.1, and of one that takes its first mode for mode 2."""
    model = _model(law)
    result, swapped = fitted(model, table_6_1()), fitted(model, table_6_1(swapped=True))
    errors = _errors(result)
    return {
        **{f"fit-{law}-f{mode}": error for mode, error in zip(MODES, errors, strict=True)},
        f"fit-{law}-zeta1": abs(float(result.best.damping_ratio[0]) / 0.0127 - 1.0),
        f"fit-{law}-swapped": max(_errors(swapped)),
        f"fit-{law}-zeta4": float(result.modes.damping_ratio[2]),
    }


def table_6_1(swapped: bool = False) -> Residuals:
    """Return the targets of Table 6.1 with the cost (8.4); ``swapped`` takes its first mode for mode 2."""
    number = {1: 2, 2: 1, 4: 4} if swapped else {1: 1, 2: 2, 4: 4}
    return Residuals(tuple(Target(number[m], f, damping_ratio=zeta) for m, f, zeta in T6_1), relative=True)


def fitted(model: SupportModel, residuals: Residuals) -> Update:
    """Return the multi-start fit that ``verify`` shows."""
    return update(single(model, residuals), starts=12, seed=0)


def elastic_f1(assembly: Assembly, k: float) -> float:
    """Return the first undamped frequency [Hz] on springs of stiffness ``k`` [N/m]."""
    support = on_translations(assembly.structure, Prony(k0=k))
    return float(undamped_modes(build_system(assembly, support), 1).frequency_hz[0])


def _figure_8_1() -> Computed:
    """Return the ends of figure 8.1 and its limits against the reference systems (undamped steel)."""
    assembly, _ = reference_jacket()
    model = support_model(assembly, family=family("zener"), rayleigh=Rayleigh())
    low, high = (
        float(model.exact_modes(np.array([FIGURE_8_1_K0, c, FIGURE_8_1_K1]), (1,)).frequency_hz[0])
        for c in (1e-2, 1e17)
    )
    return {
        "F8.1-start": low,
        "F8.1-end": high,
        "F8.1-limit-0": (elastic_f1(assembly, FIGURE_8_1_K0), low),
        "F8.1-limit-inf": (elastic_f1(assembly, FIGURE_8_1_K0 + FIGURE_8_1_K1), high),
    }


@cache
def reference_jacket() -> tuple[Assembly, Rayleigh]:
    """Return the jacket and its steel's damping: 1 % at the first frequency on pinned feet."""
    assembly = assemble(read_structure("jacket15"))
    return assembly, Rayleigh.minimum(0.01, float(numbered_modes(assembly, 1).frequency_hz[0]))


def _model(law: str) -> SupportModel:
    assembly, rayleigh = reference_jacket()
    return support_model(assembly, family=family(law), rayleigh=rayleigh)


def _frequencies(key: str, frequency_hz: FloatArray) -> Computed:
    return {f"{key}-f{mode}": float(f) for mode, f in zip(MODES, frequency_hz, strict=True)}


def _errors(result: Update) -> list[float]:
    measured = [f for _, f, _ in T6_1]
    return [abs(float(f) / m - 1.0) for f, m in zip(result.best.frequency_hz, measured, strict=True)]
