r"""Drift of parameters over days: one slope fitted to the data of all days, with its interval.

.. math:: \ln θ(t) = \ln θ_0 + t \ln g

The slope ln g is fitted together with all parameters to all days (:class:`jackettwin.updating.joint.Growth`).
Errors of the model that are common to all days are additional unknowns: more days do not average them out,
and a constant error is not mistaken for a drift. If the scatter of the days exceeds their uncertainty, the
interval is multiplied by the root of χ² per degree of freedom (Birge 1932).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.intervals import NORMAL_90, NORMAL_95
from jackettwin.updating.joint import GROWTH
from jackettwin.updating.posterior.laplace import log_covariance
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.descent import descend


@dataclass(frozen=True)
class Drift:
    """A common slope of some parameters over days.

    Attributes
    ----------
    names : names of all parameters; the last is the slope
    z : (d,) ln θ at day zero, and the slope ln g per day
    covariance : (d, d) of z
    scatter : float
        Root of χ² per degree of freedom, at least 1; the covariance includes its square.
    """

    names: tuple[str, ...]
    z: FloatArray
    covariance: FloatArray
    scatter: float

    @property
    def slope_per_day(self) -> float:
        """Change of ln θ per day."""
        return float(self.z[-1])

    @property
    def std_per_day(self) -> float:
        """Standard deviation of the slope."""
        return float(np.sqrt(self.covariance[-1, -1]))

    @property
    def interval_90(self) -> tuple[float, float]:
        """Central 90 % interval of the slope."""
        half = NORMAL_90 * self.std_per_day
        return self.slope_per_day - half, self.slope_per_day + half

    @property
    def detected(self) -> bool:
        """Whether the 95 % interval of the slope excludes zero (one false alarm in twenty)."""
        return abs(self.slope_per_day) > NORMAL_95 * self.std_per_day

    def line(self, name: str, days: FloatArray) -> FloatArray:
        """Return a parameter with drift at some days, (n_days, 3): median and ends of the 90 % interval."""
        i = self.names.index(name)
        along = np.zeros((days.size, self.z.size))
        along[:, i], along[:, -1] = 1.0, days
        half = NORMAL_90 * np.sqrt(np.einsum("ti,ij,tj->t", along, self.covariance, along))
        middle = along @ self.z
        return np.asarray(np.exp(np.stack([middle, middle - half, middle + half], axis=1)))


def find_drift(problem: Problem, start: FloatArray) -> Drift:
    """Return the slope that fits the data of all days.

    Parameters
    ----------
    problem : Problem
        Problem of all days, with a :class:`~jackettwin.updating.joint.Growth`.
    start : (d − 1,) ln θ of the other parameters

    Raises
    ------
    InputError
        If the problem has no growing parameter, or its data have no standard deviations.
    """
    names = tuple(p.name for p in problem.parameters)
    if names[-1] != GROWTH or not problem.weighted:
        raise InputError("no slope to fit, or no standard deviations", field="parameters", value=list(names))
    end = descend(problem, np.append(start, 0.0))
    r = problem.evaluate(end.z, None)[0][: problem.n_data]
    freedom = problem.n_data - len(names)
    scatter = float(np.sqrt(max(1.0, float(r @ r) / freedom))) if freedom > 0 else 1.0
    return Drift(names, end.z, scatter**2 * log_covariance(problem, np.exp(end.z)), scatter)
