"""The support laws that can be updated: their parameters, bounds and how to build them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, did_you_mean
from jackettwin.soil.coefficients import ALPHA, BRANCHES, K0, K_ALPHA, OMEGA0, C
from jackettwin.soil.viscoelastic import (
    MAXWELL_3_BRANCHES,
    MAXWELL_3_TILT,
    Law,
    Springpot,
    kelvin_voigt,
    maxwell_3,
    maxwell_3_scale,
    maxwell_3_times,
    zener,
)


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
    factor are stated. ``rows(values, reference_hz)`` returns the numbers of many laws at once, (n, width)
    as in :mod:`jackettwin.soil.coefficients`, and d row/d ln θ (n, width, n_parameters). ``relaxes`` says
    whether a structure on it has real poles; a springpot's relaxation is a continuum.
    """

    name: str
    parameters: tuple[Parameter, ...]
    build: Callable[[FloatArray, float], Law]
    rows: Callable[[FloatArray, float], tuple[FloatArray, FloatArray]]
    relaxes: bool = True

    def __reduce__(self) -> tuple[Callable[[str], Family], tuple[str]]:
        """A law crosses processes by its name: every process has the same laws."""
        return family, (self.name,)


def _kelvin_voigt(values: FloatArray, _: float) -> Law:
    return kelvin_voigt(float(values[0]), float(values[1]))


def _kelvin_voigt_rows(values: FloatArray, _: float) -> tuple[FloatArray, FloatArray]:
    rows, slopes = _empty(values, branches=0)
    rows[:, K0], rows[:, C] = values.T
    slopes[:, K0, 0], slopes[:, C, 1] = values.T
    return rows, slopes


def _zener(values: FloatArray, _: float) -> Law:
    return zener(float(values[0]), float(values[1]), float(values[2]))


def _zener_rows(values: FloatArray, _: float) -> tuple[FloatArray, FloatArray]:
    rows, slopes = _empty(values, branches=1)
    k0, c, k1 = values.T
    tau = c / k1
    rows[:, K0], rows[:, BRANCHES], rows[:, BRANCHES + 1] = k0, k1, tau
    slopes[:, K0, 0], slopes[:, BRANCHES, 2] = k0, k1
    slopes[:, BRANCHES + 1, 1], slopes[:, BRANCHES + 1, 2] = tau, -tau
    return rows, slopes


def _maxwell_3(values: FloatArray, reference_hz: float) -> Law:
    return maxwell_3(float(values[0]), float(values[1]), reference_hz)


def _maxwell_3_rows(values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
    rows, slopes = _empty(values, branches=3)
    k, eta = values.T
    s, response, w = maxwell_3_scale(eta)
    # η times derivatives by η; those of the weights first
    dw = MAXWELL_3_TILT * np.multiply.outer(eta, np.arange(3.0))
    d_response = (w * dw) @ MAXWELL_3_BRANCHES
    ds = s * (1.0 - (d_response.imag - eta * (response.real + d_response.real)) * s / eta)
    # k0 = k/(1 + sR), k_j = s w_j k0
    shrink = 1.0 / (1.0 + s * response.real)
    dk0 = -(ds * response.real + s * d_response.real) * shrink
    k0 = k * shrink
    rows[:, K0] = k0
    rows[:, BRANCHES::2] = (s * k0)[:, None] * w
    rows[:, BRANCHES + 1 :: 2] = maxwell_3_times(reference_hz)
    slopes[:, K0, 0], slopes[:, BRANCHES::2, 0] = k0, rows[:, BRANCHES::2]
    slopes[:, K0, 1] = k0 * dk0
    slopes[:, BRANCHES::2, 1] = rows[:, BRANCHES::2] * ((ds / s + dk0)[:, None] + dw)
    return rows, slopes


def _springpot(values: FloatArray, reference_hz: float) -> Law:
    return Springpot(float(values[0]), float(values[1]), 2.0 * pi * reference_hz)


def _springpot_rows(values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
    rows, slopes = _empty(values, branches=0)
    rows[:, K_ALPHA], rows[:, ALPHA] = values.T
    rows[:, OMEGA0] = 2.0 * pi * reference_hz
    slopes[:, K_ALPHA, 0], slopes[:, ALPHA, 1] = values.T
    return rows, slopes


def _empty(values: FloatArray, *, branches: int) -> tuple[FloatArray, FloatArray]:
    rows = np.zeros((len(values), BRANCHES + 2 * branches))
    rows[:, OMEGA0] = 1.0
    return rows, np.zeros((*rows.shape, values.shape[1]))


# Bounds of the thesis, (8.6)–(8.10).
_K = (1e7, 1e14, "N/m")
_C = (1e4, 1e14, "N·s/m")

FAMILIES: Mapping[str, Family] = {
    family.name: family
    for family in (
        Family(
            "kelvin-voigt",
            (Parameter("k", *_K), Parameter("c", *_C)),
            _kelvin_voigt,
            _kelvin_voigt_rows,
        ),
        Family(
            "zener",
            (Parameter("k0", *_K), Parameter("c", *_C), Parameter("k1", *_K)),
            _zener,
            _zener_rows,
        ),
        Family(
            "maxwell-3",
            (Parameter("k", *_K), Parameter("loss_factor", 1e-4, 0.6, "-")),
            _maxwell_3,
            _maxwell_3_rows,
        ),
        Family(
            "springpot",
            (Parameter("k", *_K), Parameter("alpha", 1e-4, 0.5, "-")),
            _springpot,
            _springpot_rows,
            relaxes=False,
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
            value=name,
            allowed=", ".join(FAMILIES),
            remedy=did_you_mean(name, FAMILIES),
        )
    return FAMILIES[name]
