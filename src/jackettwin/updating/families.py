"""The support laws that can be updated: their parameters, bounds and how to build them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError, did_you_mean
from jackettwin.soil.coefficients import ALPHA, BRANCHES, K0, K_ALPHA, C, law_rows
from jackettwin.soil.viscoelastic import (
    MAXWELL_3_WEIGHTS,
    Law,
    Springpot,
    kelvin_voigt,
    maxwell_3,
    maxwell_3_scale,
    zener,
)

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Parameter:
    """A positive number updated in log space between two bounds.

    Its prior is flat in ln θ, or lognormal with a median and a standard deviation of ln θ, cut at the bounds.
    """

    name: str
    low: float
    high: float
    unit: str
    median: float | None = None
    log_std: float | None = None

    def __post_init__(self) -> None:
        self._check_prior()
        if not 0.0 < self.low < self.high:
            raise InputError(
                "bounds are reversed or not positive",
                field=f"bounds.{self.name}",
                value=[self.low, self.high],
                allowed="0 < low < high",
                remedy="give [low, high]",
            )

    def _check_prior(self) -> None:
        if self.median is None and self.log_std is None:
            return
        if self.median is None or self.log_std is None or self.log_std <= 0.0:
            raise InputError(
                "a lognormal prior needs a median and a positive log_std",
                field=f"priors.{self.name}",
                value={"median": self.median, "log_std": self.log_std},
            )
        if not self.low <= self.median <= self.high:
            raise InputError(
                "the prior's median lies outside the bounds",
                field=f"priors.{self.name}",
                value=self.median,
                allowed=f"{self.low:g} to {self.high:g}",
                remedy="change update.bounds or update.priors",
            )


@dataclass(frozen=True)
class Family:
    """A law with free parameters.

    ``build(values, reference_hz)`` returns the law; ``reference_hz`` is where storage stiffness and loss
    factor are stated. ``slopes(values, reference_hz, row)`` fills d row/d ln θ, (width, n_parameters), of the
    law's row of numbers (:mod:`jackettwin.soil.coefficients`).
    """

    name: str
    parameters: tuple[Parameter, ...]
    build: Callable[[FloatArray, float], Law]
    slopes: Callable[[FloatArray, float, FloatArray], FloatArray]

    def row(self, values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
        """Return the law's row (width,) and its derivatives d row/d ln θ (width, n_parameters)."""
        row = law_rows([self.build(values, reference_hz)])[0]
        return row, self.slopes(values, reference_hz, row)


def _kelvin_voigt_slopes(values: FloatArray, _: float, row: FloatArray) -> FloatArray:
    slopes = np.zeros((row.size, 2))
    slopes[K0, 0], slopes[C, 1] = values
    return slopes


def _zener_slopes(values: FloatArray, _: float, row: FloatArray) -> FloatArray:
    slopes = np.zeros((row.size, 3))
    tau = row[BRANCHES + 1]
    slopes[K0, 0], slopes[BRANCHES, 2] = values[0], values[2]
    slopes[BRANCHES + 1, 1], slopes[BRANCHES + 1, 2] = tau, -tau
    return slopes


def _maxwell_3_slopes(values: FloatArray, reference_hz: float, row: FloatArray) -> FloatArray:
    eta = float(values[1])
    s, response = maxwell_3_scale(eta, reference_hz)
    ds = eta * response.imag / (response.imag - eta * response.real) ** 2
    slopes = np.zeros((row.size, 2))
    slopes[K0, 0] = row[K0]
    slopes[BRANCHES::2, 0] = row[BRANCHES::2]
    # k0 = k/(1 + sR), k_j = s w_j k0
    shrink = 1.0 / (1.0 + s * response.real)
    slopes[K0, 1] = -row[K0] * response.real * shrink * ds
    slopes[BRANCHES::2, 1] = row[K0] * np.array(MAXWELL_3_WEIGHTS) * shrink * ds
    return slopes


def _springpot_slopes(values: FloatArray, _: float, row: FloatArray) -> FloatArray:
    slopes = np.zeros((row.size, 2))
    slopes[K_ALPHA, 0], slopes[ALPHA, 1] = values
    return slopes


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
            _kelvin_voigt_slopes,
        ),
        Family(
            "zener",
            (Parameter("k0", *_K), Parameter("c", *_C), Parameter("k1", *_K)),
            lambda v, _: zener(float(v[0]), float(v[1]), float(v[2])),
            _zener_slopes,
        ),
        Family(
            "maxwell-3",
            (Parameter("k", *_K), Parameter("loss_factor", 1e-4, 0.6, "-")),
            lambda v, f0: maxwell_3(float(v[0]), float(v[1]), f0),
            _maxwell_3_slopes,
        ),
        Family(
            "springpot",
            (Parameter("k", *_K), Parameter("alpha", 1e-4, 0.5, "-")),
            lambda v, f0: Springpot(float(v[0]), float(v[1]), 2.0 * pi * f0),
            _springpot_slopes,
        ),
    )
}

DEFAULT_LAWS = ("maxwell-3", "kelvin-voigt", "zener", "springpot")
"""The first is the default: soil loses about as much at every frequency, and this law does, too."""


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
