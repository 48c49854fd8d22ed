r"""Stress from strain gauges: rosettes, drift with temperature, jumps of the zero.

The strains of three gauges or more at angles θ from a direction give the plane strain there, least squares
where they are more than three,

.. math:: ε(θ) = ε_x \cos^2 θ + ε_y \sin^2 θ + γ \sin θ \cos θ, \qquad
          σ_x = \frac{E}{1 - ν^2} (ε_x + ν ε_y)

(plane stress on a free surface); one gauge gives σ = E ε, as in a bar. A gauge also reads what heat does to
it, in proportion to temperature, and its zero may jump when a cable or an amplifier is touched.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.errors import require, require_between
from jackettwin.intervals import NORMAL_90

STEEL_E_PA, STEEL_NU = 2.1e11, 0.3
_FLATTEST = 1e-3
"""Smallest over largest singular value of a rosette's angles that tell three strains apart."""
_JUMP = 10.0
"""Of a step beside its neighbours, in robust standard deviations of all, from which it is no motion."""
_BESIDE = 5
"""Samples before and after a step whose levels it must part: else it is a spike, which returns."""
_KEPT = 0.7
"""Share of a step that must last that long."""
_AVERAGED = 40
"""Pieces of a record whose means tell a drift with temperature: faster strain is motion."""


@dataclass(frozen=True)
class SteadyStrain:
    """A strain without jumps of its zero and without what temperature does to the gauge.

    Attributes
    ----------
    strain : (n,)
    jumps : (k,) numbers of the first samples after each jump
    sizes : (k,) of the jumps
    per_kelvin : strain that a kelvin makes; None where no temperature is told
    """

    strain: FloatArray
    jumps: IntArray
    sizes: FloatArray
    per_kelvin: float | None = None


def rosette_stress(
    strains: FloatArray,
    angles_rad: FloatArray,
    *,
    elastic_modulus_pa: float = STEEL_E_PA,
    poisson: float = STEEL_NU,
) -> FloatArray:
    """Return the stress (n,) [Pa] in the direction from which the gauges' angles are counted.

    Parameters
    ----------
    strains : (k, n) of one gauge, or of three or more at one place
    angles_rad : (k,)

    Raises
    ------
    InputError
        If the gauges do not tell the strain in that direction, or a constant of the material cannot be.
    """
    require_between("elastic_modulus_pa", elastic_modulus_pa, 1e9, 1e12, "Pa")
    require_between("poisson", poisson, 0.0, 0.49)
    if len(strains) == 1:
        require(
            abs(np.sin(angles_rad[0])) < _FLATTEST, "a gauge tells stress along itself only", field="angles",
            value=float(np.degrees(angles_rad[0])), allowed="0", remedy="give three gauges of a rosette",
        )  # fmt: skip
        return np.asarray(elastic_modulus_pa * strains[0])
    c, s = np.cos(angles_rad), np.sin(angles_rad)
    A = np.column_stack([c**2, s**2, s * c])
    sizes = np.linalg.svd(A, compute_uv=False)
    require(
        len(strains) >= A.shape[1] and sizes[-1] > _FLATTEST * sizes[0],
        "these gauges do not tell the plane strain", field="angles",
        value=", ".join(f"{a:g}" for a in np.degrees(angles_rad)), allowed="three directions or more",
        remedy="give the angles of a rosette, such as 0,45,90 or 0,60,120",
    )  # fmt: skip
    along, across, _ = np.linalg.pinv(A) @ strains
    return np.asarray(elastic_modulus_pa / (1.0 - poisson**2) * (along + poisson * across))


def steady_strain(
    strain: FloatArray, temperature_c: FloatArray | None = None, *, per_kelvin: float | None = None
) -> SteadyStrain:
    """Return a strain (n,) without jumps and without drift with temperature; samples may be missing (NaN).

    Jumps are steps from one sample to the next that no motion makes and that last. The drift is
    ``per_kelvin`` times the temperature, else as much as goes with it in the means of forty pieces, each
    piece between jumps at its own level. What of real stress goes with temperature is taken out with it.
    """
    known = np.isfinite(strain)
    at = np.flatnonzero(known)
    jumps, sizes = _jumps(strain[at], np.diff(at) == 1)
    found = strain.copy()
    level = np.zeros(at.size)
    for k, size in zip(jumps, sizes, strict=True):
        level[k:] += size
    found[known] -= level
    jumps = at[jumps]
    if temperature_c is None:
        return SteadyStrain(found, jumps, sizes)
    warm = np.where(np.isfinite(temperature_c), temperature_c, np.nanmean(temperature_c))
    if per_kelvin is None:
        per_kelvin = _slope(found, warm, known)
    return SteadyStrain(found - per_kelvin * (warm - warm.mean()), jumps, sizes, per_kelvin)


def _jumps(x: FloatArray, next_to: BoolArray) -> tuple[IntArray, FloatArray]:
    """Return where (k,) the zero of a series (n,) jumps, and by how much (k,).

    Parameters
    ----------
    next_to : (n - 1,) whether a step is of samples next to each other: across a gap motion goes on unseen
    """
    steps = np.diff(x)
    if steps.size < 2 * _BESIDE:
        return np.zeros(0, dtype=np.intp), np.zeros(0)
    # smooth motion goes on as it does beside
    odd = np.abs(steps[1:-1] - 0.5 * (steps[:-2] + steps[2:]))
    usual = float(np.quantile(odd, 0.9)) / NORMAL_90
    at, sizes = [], []
    # the steps beside a jump look odd, too
    most = odd >= maximum_filter1d(odd, 3)
    wide = np.flatnonzero((odd > _JUMP * usual) & most & next_to[1:-1]) + 1
    for k in wide if usual > 0.0 else ():
        before, after = x[max(0, k + 1 - _BESIDE) : k + 1], x[k + 1 : k + 1 + _BESIDE]
        size = float(steps[k] - 0.5 * (steps[k - 1] + steps[k + 1]))
        beside = np.delete(steps[max(0, k - _BESIDE) : k + 1 + _BESIDE], [min(int(k), _BESIDE)])
        lasts = float(np.median(after) - np.median(before)) - _BESIDE * float(np.median(beside))
        if min(len(before), len(after)) == _BESIDE and abs(size) > _JUMP * usual and lasts / size > _KEPT:
            at.append(int(k) + 1)
            sizes.append(size)
    return np.array(at, dtype=np.intp), np.array(sizes)


def _slope(strain: FloatArray, warm: FloatArray, known: FloatArray) -> float:
    """Return the strain that goes with a kelvin in the means of pieces; zero where the temperature rests."""
    pieces = np.array_split(np.flatnonzero(known), _AVERAGED)
    means = np.array([[strain[p].mean(), warm[p].mean()] for p in pieces if p.size])
    e, t = (median_filter(column, 3, mode="nearest") for column in means.T)
    away = t - t.mean()
    square = float(away @ away)
    return float(away @ e) / square if square > 0.0 else 0.0
