"""Starting points given by the user, by names of parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import require
from jackettwin.updating.problem import Problem


def given_points(problem: Problem, points: Sequence[Mapping[str, float]]) -> FloatArray:
    """Return starting points as z = ln θ, (n, d).

    A name stands for the parameter of that name and for those with the suffix of a tie group or state: ``k``
    for ``k_horizontal`` and ``k_vertical``, unless these are given. A parameter that is not given starts from
    the median of its prior, or from the middle of its bounds.

    Parameters
    ----------
    points : sequence of {parameter: value}

    Raises
    ------
    InputError
        If there is no point, a name is not that of a parameter, or a value is outside the bounds.
    """
    require(
        points, "there must be a start", field="update.starts", value=[], remedy="give points, or a number"
    )
    return np.array([_point(problem, point, f"update.starts[{i}]") for i, point in enumerate(points)])


def _point(problem: Problem, point: Mapping[str, float], field: str) -> FloatArray:
    names = [p.name for p in problem.parameters]
    for name in point:
        require(
            any(_stands_for(problem, name, own) for own in names),
            "no such parameter to start from",
            field=f"{field}.{name}",
            value=name,
            allowed=", ".join(names),
        )
    z = []
    for p in problem.parameters:
        said = max((name for name in point if _stands_for(problem, name, p.name)), key=len, default=None)
        value = (p.median or float(np.sqrt(p.low * p.high))) if said is None else point[said]
        require(
            p.low <= value <= p.high,
            "a start is outside the bounds",
            field=f"{field}.{said}",
            value=value,
            allowed=f"{p.low:g} to {p.high:g} {p.unit}",
            remedy="move the start, or widen update.bounds",
        )
        z.append(np.log(value))
    return np.array(z)


def points_of(problem: Problem, points: Sequence[Mapping[str, float]]) -> tuple[Mapping[str, float], ...]:
    """Return the points whose names are all parameters of the problem, since several laws share one list."""
    names = [p.name for p in problem.parameters]
    return tuple(
        point for point in points if all(any(_stands_for(problem, n, own) for own in names) for n in point)
    )


def _stands_for(problem: Problem, name: str, parameter: str) -> bool:
    """Tell whether a name stands for a parameter; ``c`` does not stand for the rotor's ``c_fore_aft``."""
    beside = tuple(p.name for p in problem.model.nuisance.parameters)
    ties = () if parameter.startswith(beside) and beside else (f"{name}_",)
    return parameter == name or parameter.startswith((*ties, f"{name}@"))
