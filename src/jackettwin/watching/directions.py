"""What a change may look like before anybody has seen one: directions over quantities, and sizes.

The weights of all directions of both kinds and of the scatter add up to one: they are the stakes of one bet.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray

PAIR = 0.08
"""Two modes whose frequencies differ by less are a pair: the two bending modes of a nearly round
structure."""
SIZES = {
    "frequency": (0.0007, 0.0014, 0.0028, 0.0056, 0.0112, 0.0225, 0.045),
    "damping": (0.12, 0.24, 0.48, 0.96),
}
"""Sizes of a step in the logarithm that are bet on, each give or take a third: below the first nothing is
worth an alarm, beyond the last one any prior finds it."""
SIZE_WEIGHTS = {
    "frequency": (0.12, 0.26, 0.24, 0.16, 0.1, 0.07, 0.05),
    "damping": (0.3, 0.4, 0.2, 0.1),
}
"""Small steps take the longest: most of the stake is on them."""
_WIDTH = 1.0 / 3.0
SHARES = {"frequency": 0.7, "damping": 0.2, "scatter": 0.1}
"""Stakes of the kinds of change."""
_FALLING = {"frequency": 0.7, "damping": 0.4}
"""Share of the stake on falling values: what breaks or is washed out is softer, and damps more."""
_ANY = 0.1
"""Share of a kind's stake on a change in no particular direction."""


@dataclass(frozen=True)
class Directions:
    """Steps that are bet on.

    Attributes
    ----------
    kind : "frequency" or "damping"
    names : (n,) of the directions; the last is "any"
    members : (n, m) which quantities move
    vectors : (n − 1, m) of those with a direction
    log_weights : (n,) ln of the stakes
    sizes, widths : (n_sizes,) steps δ ~ N(size, width²) along a vector, with
    log_size_weights : (n_sizes,)
    """

    kind: str
    names: tuple[str, ...]
    members: BoolArray
    vectors: FloatArray
    log_weights: FloatArray
    sizes: FloatArray
    widths: FloatArray
    log_size_weights: FloatArray


def directions_of(
    kind: str,
    labels: tuple[str, ...],
    typical_hz: FloatArray,
    patterns: Mapping[str, FloatArray] | None = None,
) -> Directions:
    """Return each mode alone, each close pair, all modes alike, given patterns, and any.

    Parameters
    ----------
    typical_hz : (m,) frequencies, by which pairs are found
    patterns : {name: (m,)}, optional
        Changes of the logarithms that a model expects; only their direction counts, falling or rising.
    """
    m = len(labels)
    named: list[tuple[str, FloatArray, float]] = [
        (label, np.eye(m)[q], 1.0) for q, label in enumerate(labels)
    ]
    order = np.argsort(typical_hz)
    for i, j in zip(order, order[1:], strict=False):
        if typical_hz[j] / typical_hz[i] < 1.0 + PAIR:
            pair = np.zeros(m)
            pair[[i, j]] = 1.0
            named.append((f"{labels[i]} and {labels[j]}", pair, 2.0))
    if m > 1:
        named.append(("all modes", np.ones(m), 2.0))
    for name, pattern in (patterns or {}).items():
        largest = float(np.max(np.abs(pattern)))
        if largest > 0.0:
            named.append((name, np.asarray(pattern, dtype=np.float64) / largest, 1.0))
    weights = np.array([weight for *_, weight in named])
    stakes = np.append((1.0 - _ANY) * weights / weights.sum(), _ANY) if m > 1 else np.array([0.9, 0.1])
    vectors = np.array([vector for _, vector, _ in named])
    size, share = np.array(SIZES[kind]), np.array(SIZE_WEIGHTS[kind])
    falling = _FALLING[kind]
    return Directions(
        kind,
        (*(name for name, *_ in named), "any"),
        np.vstack([vectors != 0.0, np.ones((1, m), dtype=np.bool_)]),
        vectors,
        np.log(SHARES[kind] * stakes),
        np.concatenate([-size, size]),
        _WIDTH * np.concatenate([size, size]),
        np.log(np.concatenate([falling * share, (1.0 - falling) * share])),
    )


def log_bayes_factors(directions: Directions, info: FloatArray, score: FloatArray) -> FloatArray:
    r"""Return ln of the Bayes factors of every begin and direction against no change, (n_begins, n).

    With a = uᵀAu and c = uᵀb of a direction u, and δ ~ N(μ, v²),

    .. math:: \ln BF = -\tfrac12 \ln(1 + a v^2) + \frac{c^2 v^2 + 2cμ - aμ^2}{2(1 + a v^2)}

    Parameters
    ----------
    info, score : (n_begins, m, m), (n_begins, m) A and b of the steps of each quantity
    """
    u = directions.vectors
    along = log_along(directions, np.einsum("di,tij,dj->td", u, info, u), score @ u.T)
    half = len(directions.sizes) // 2
    both = np.logaddexp(directions.log_size_weights[:half], directions.log_size_weights[half:])
    free = _any(info, score, directions.sizes[half:])
    return np.concatenate([along, np.logaddexp.reduce(free + both, axis=-1)[:, None]], axis=1)


def log_along(directions: Directions, a: FloatArray, c: FloatArray) -> FloatArray:
    """Return ln of the Bayes factors of changes whose shape has a and c, over the sizes; of any shape."""
    a, c, mu, v2 = a[..., None], c[..., None], directions.sizes, directions.widths**2
    wide = 1.0 + a * v2
    each = -0.5 * np.log(wide) + 0.5 * (c * c * v2 + 2.0 * c * mu - a * mu * mu) / wide
    return np.asarray(np.logaddexp.reduce(each + directions.log_size_weights, axis=-1))


def _any(info: FloatArray, score: FloatArray, stds: FloatArray) -> FloatArray:
    """Return ln of the Bayes factors of δ ~ N(0, std²·I), (n_begins, n_stds)."""
    values, vectors = np.linalg.eigh(info)
    turned = np.einsum("tij,ti->tj", vectors, score) ** 2
    wide = 1.0 + values[:, None, :] * stds[:, None] ** 2
    return np.asarray(0.5 * np.sum(turned[:, None, :] * stds[:, None] ** 2 / wide - np.log(wide), axis=-1))
