"""The support laws that can be updated: their parameters, bounds and how to build them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError, did_you_mean
from jackettwin.soil.viscoelastic import Law, Springpot, kelvin_voigt, maxwell_3, zener

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Parameter:
    """A positive number updated in log space between two bounds."""

    name: str
    low: float
    high: float
    unit: str

    def __post_init__(self) -> None:
        if not 0.0 < self.low < self.high:
            raise InputError(
                "bounds are reversed or not positive",
                field=f"bounds.{self.name}",
                value=[self.low, self.high],
                allowed="0 < low < high",
                remedy="give [low, high]",
            )


@dataclass(frozen=True)
class Family:
    """A law with free parameters.

    ``build(values, reference_hz)`` returns the law; ``reference_hz`` is where storage stiffness and loss
    factor are stated.
    """

    name: str
    parameters: tuple[Parameter, ...]
    build: Callable[[FloatArray, float], Law]


# Bounds of the thesis, (8.6)–(8.10).
_K = (1e7, 1e14, "N/m")
_C = (1e4, 1e14, "N·s/m")

FAMILIES: Mapping[str, Family] = {
    family.name: family
    for family in (
        Family(
            "kelvin-voigt",
            (Parameter("k", *_K), Parameter("c", *_C)),
            lambda v, _: kelvin_voigt(float(v[0]), float(v[1])),
        ),
        Family(
            "zener",
            (Parameter("k0", *_K), Parameter("c", *_C), Parameter("k1", *_K)),
            lambda v, _: zener(float(v[0]), float(v[1]), float(v[2])),
        ),
        Family(
            "maxwell-3",
            (Parameter("k", *_K), Parameter("loss_factor", 1e-4, 0.6, "-")),
            lambda v, f0: maxwell_3(float(v[0]), float(v[1]), f0),
        ),
        Family(
            "springpot",
            (Parameter("k", *_K), Parameter("alpha", 1e-4, 0.5, "-")),
            lambda v, f0: Springpot(float(v[0]), float(v[1]), 2.0 * pi * f0),
        ),
    )
}

DEFAULT_LAWS = ("kelvin-voigt", "zener", "maxwell-3")


def family(name: str) -> Family:
    """Look a law up.

    Raises
    ------
    InputError
        If the name is unknown.
    """
    if name not in FAMILIES:
        raise InputError(
            "unknown law",
            field="law",
            value=name,
            allowed=", ".join(FAMILIES),
            remedy=did_you_mean(name, FAMILIES),
        )
    return FAMILIES[name]


def law_slopes(
    build: Callable[[FloatArray], Law], theta: FloatArray, s: complex
) -> npt.NDArray[np.complex128]:
    """Return ∂D(s)/∂ln θ for each parameter, by central differences of the law alone.

    A step of 1e-5 in the logarithm leaves a relative error of about 1e-10.
    """
    h = 1e-5
    slopes = np.empty(theta.size, dtype=np.complex128)
    for j in range(theta.size):
        up, down = theta.copy(), theta.copy()
        up[j] *= np.exp(h)
        down[j] *= np.exp(-h)
        slopes[j] = (build(up).stiffness(s) - build(down).stiffness(s)) / (2.0 * h)
    return slopes
