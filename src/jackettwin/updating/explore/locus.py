"""Root locus of a support model: poles of its modes as a parameter varies between its bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import did_you_mean, require
from jackettwin.response import NumberedModes, damping_ratio
from jackettwin.soil import Parameter
from jackettwin.updating.explore.branches import branches
from jackettwin.updating.model import SupportModel


@dataclass(frozen=True)
class Locus:
    """Poles of modes as a parameter varies.

    Attributes
    ----------
    parameter : Parameter
        Its bounds are the ends of the locus. A law's parameter of several tie groups is that of the first
        group; the others vary in proportion.
    modes : mode numbers of the branches at ``origin``
    values : (n,) ascending values of the parameter
    poles : (n, n_modes) λ [rad/s], NaN where a branch no longer oscillates
    origin : index of the point from which the branches were tracked
    """

    parameter: Parameter
    modes: tuple[int, ...]
    values: FloatArray
    poles: ComplexArray
    origin: int

    @property
    def frequency_hz(self) -> FloatArray:
        """|λ|/2π, (n, n_modes)."""
        return np.asarray(np.abs(self.poles) / (2.0 * pi))

    @property
    def damping_ratio(self) -> FloatArray:
        """−Re λ/|λ|, (n, n_modes)."""
        return damping_ratio(self.poles)

    def most_damped(self, branch: int) -> tuple[float, float]:
        """Return the value at the largest damping ratio of a branch, and the ratio; NaN without one."""
        ratio = self.damping_ratio[:, branch]
        if np.isnan(ratio).all():
            return float("nan"), float("nan")
        place = int(np.nanargmax(ratio))
        return float(self.values[place]), float(ratio[place])


def root_locus(model: SupportModel, theta: FloatArray, parameter: str, modes: tuple[int, ...]) -> Locus:
    """Return the poles of modes as a parameter varies from its lower to its upper bound.

    Parameters
    ----------
    theta : (n_parameters,) point from which the branches are tracked and at which they are numbered
    parameter : str
        A parameter of the model, or of its law; in the latter case those of all tie groups vary by the same
        factor.
    modes : mode numbers, on pinned supports

    Raises
    ------
    InputError
        If the model has no such parameter, or none of the modes oscillates at the point.
    """
    columns = moving(model, parameter)
    model, followed = model.reaching(max(modes)), tuple(range(1, max(modes) + 1))
    z0 = np.log(theta)
    group = [model.parameters[i] for i in columns]
    low = max(np.log(p.low) - z for p, z in zip(group, z0[columns], strict=True))
    high = min(np.log(p.high) - z for p, z in zip(group, z0[columns], strict=True))

    def at(shift: float, near: NumberedModes | None) -> NumberedModes:
        moved = z0.copy()
        moved[columns] += shift
        found = model.predict_many(np.exp(moved)[None], followed, near=near)
        along = found.slopes[:, :, columns].sum(axis=2, keepdims=True)
        return replace(found, slopes=along)

    low, high = min(float(low), 0.0), max(float(high), 0.0)
    found = branches(at, 0.0, low, high)
    first = theta[columns[0]]
    values = first * np.exp(found.z)
    values[found.origin] = first
    bounded = Parameter(parameter, float(values[0]), float(values[-1]), group[0].unit)
    return Locus(bounded, modes, values, found.poles[:, np.array(modes) - 1], found.origin)


def moving(model: SupportModel, name: str) -> list[int]:
    """Return the indices of a parameter: one, or those of every tie group if it belongs to the law.

    Raises
    ------
    InputError
        If the model has no such parameter.
    """
    names = [p.name for p in model.parameters]
    own = [i for i, known in enumerate(names) if known == name]
    of_law = [i for i, known in enumerate(names) if known in {name + s for s in model.tie_groups.suffixes}]
    found = own or (of_law if name in model.family.names else [])
    known = list(dict.fromkeys([*names, *model.family.names]))
    remedy = did_you_mean(name, known)
    require(
        found, "no such parameter", field="parameter", value=name, allowed=", ".join(known), remedy=remedy
    )
    return found
