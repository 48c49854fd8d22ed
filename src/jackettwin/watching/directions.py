r"""Directions and sizes of possible changes, chosen before any is seen.

The prior weights (``stakes``) of all directions of all kinds and of the scatter sum to one. A ramp that began
at τ and continues is a sum of small steps at the onsets retained since τ. With increments w,
:math:`a = \sum_{jk} w_j w_k u^T A_{jk} u` and :math:`c = \sum_j w_j u^T b_j` of a ramp along u replace a and
c of a step. A ramp dated as a step would appear to begin in its middle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.watching.kernels import log_any, log_mixed
from jackettwin.watching.memory import Bank

PAIR = 0.08
"""Relative difference of frequencies below which two modes are a pair:
the two bending modes of a nearly round structure."""
SIZES = {
    "frequency": (0.0007, 0.0014, 0.0028, 0.0056, 0.0112, 0.0225, 0.045),
    "damping": (0.12, 0.24, 0.48, 0.96),
    "angle": (0.04, 0.08, 0.16, 0.32),
}
"""Tested sizes of steps of the logarithm, or of rotations [rad], each with a spread of about a third. Smaller
steps do not merit an alarm; larger ones are detected with any prior."""
SIZE_WEIGHTS = {
    "frequency": (0.12, 0.26, 0.24, 0.16, 0.1, 0.07, 0.05),
    "damping": (0.3, 0.4, 0.2, 0.1),
    "angle": (0.3, 0.3, 0.2, 0.2),
}
"""Weights of the sizes; small steps take longest to detect and therefore have the largest weights."""
_WIDTH = 1.0 / 3.0
SHARES = {"frequency": 0.7, "damping": 0.2, "angle": 0.1, "scatter": 0.1}
"""Prior weights of the kinds of change, normalised over the kinds that are monitored."""
_FALLING = {"frequency": 0.7, "damping": 0.4, "angle": 0.5}
"""Share of the weight given to falling values: damage and scour reduce the stiffness of a structure and raise
its damping."""
_ANY = 0.1
"""Share of a kind's weight given to a change in an arbitrary direction."""
_PATTERNED = 0.4
"""Share of the remaining weight given to the causes of a model, if there is one."""
_ALIKE = 0.9
"""Cosine above which patterns are merged into one direction, with little effect on the Bayes factor."""
NOT_TESTED = -1e9
"""Ln of the weight of what is not tested."""
_MOVES = 0.1
"""Share of the largest change in a pattern below which a quantity counts as unchanged."""


@dataclass(frozen=True)
class Directions:
    """Directions and sizes of the steps that are tested.

    Attributes
    ----------
    kind : "frequency", "damping" or "angle"
    names : (n,) names of the directions; the last is "any"
    members : (n, m) bool, which quantities change
    vectors : (n − 1, m) directions, without "any"
    log_weights : (n,) ln of the prior weights
    sizes, widths : (n_sizes,) steps δ ~ N(size, width²) along a vector
    log_size_weights : (n − 1, n_sizes) ln of the weights of the sizes along each vector
    """

    kind: str
    names: tuple[str, ...]
    members: BoolArray
    vectors: FloatArray
    log_weights: FloatArray
    sizes: FloatArray
    widths: FloatArray
    log_size_weights: FloatArray

    @property
    def all_size_weights(self) -> FloatArray:
        """Ln of the weights of the sizes that are tested along any vector, (n_sizes,)."""
        return np.asarray(np.atleast_2d(self.log_size_weights).max(axis=0))

    def testing(self, chosen: BoolArray) -> Directions:
        """Return the directions with some of the sizes (n − 1, n_sizes); no other gets their weight."""
        return replace(self, log_size_weights=np.where(chosen, self.log_size_weights, NOT_TESTED))


@dataclass(frozen=True)
class Pattern:
    """Changes of the logarithms of all modes' frequencies (m,) that a model expects from a cause.

    Only their direction counts; ``weight`` is the prior weight relative to other patterns.
    """

    name: str
    change: FloatArray
    weight: float = 1.0


def directions_of(
    kind: str, labels: tuple[str, ...], typical_hz: FloatArray, patterns: Sequence[Pattern] = ()
) -> Directions:
    """Return single modes, close pairs, all modes together, distinct patterns, and an arbitrary direction.

    Parameters
    ----------
    typical_hz : (m,) frequencies, from which pairs are recognised
    patterns : changes that a model expects
    """
    m = len(labels)
    named = [Pattern(label, np.eye(m)[q], 1.0) for q, label in enumerate(labels)]
    order = np.argsort(typical_hz)
    for i, j in zip(order, order[1:], strict=False):
        if typical_hz[j] / typical_hz[i] < 1.0 + PAIR:
            named.append(Pattern(f"{labels[i]} and {labels[j]}", np.eye(m)[i] + np.eye(m)[j], 2.0))
    if m > 1:
        named.append(Pattern("all modes", np.ones(m), 2.0))
    expected = _joined(patterns)
    general = np.array([p.weight for p in named])
    own = np.array([p.weight for p in expected])
    share = _PATTERNED if expected else 0.0
    weights = np.concatenate([(1.0 - share) * general / general.sum(), share * own / max(own.sum(), 1e-300)])
    stakes = np.append((1.0 - _ANY) * weights, _ANY)
    vectors = np.array([p.change for p in (*named, *expected)])
    size, of_size = np.array(SIZES[kind]), np.array(SIZE_WEIGHTS[kind])
    falling = _FALLING[kind]
    return Directions(
        kind,
        (*(p.name for p in (*named, *expected)), "any"),
        np.vstack([np.abs(vectors) > _MOVES, np.ones((1, m), dtype=np.bool_)]),
        vectors,
        np.log(SHARES[kind] * stakes),
        np.concatenate([-size, size]),
        _WIDTH * np.concatenate([size, size]),
        np.tile(np.log(np.concatenate([falling * of_size, (1.0 - falling) * of_size])), (len(vectors), 1)),
    )


def _joined(patterns: Sequence[Pattern]) -> tuple[Pattern, ...]:
    """Return distinct patterns, scaled to a largest change of one, with the weights of similar ones added.

    Their signs are chosen so that values rise, as for single modes; the weights of the sizes account for
    falling values.
    """
    groups: list[list[Pattern]] = []
    for one in sorted(patterns, key=lambda p: -p.weight):
        near = next((g for g in groups if abs(_cosine(g[0].change, one.change)) > _ALIKE), None)
        if near is None:
            groups.append([one])
        else:
            near.append(one)
    out = []
    for group in groups:
        first = group[0].change
        upwards = first * np.sign(first[np.argmax(np.abs(first))]) / np.abs(first).max()
        name = group[0].name if len(group) == 1 else f"{group[0].name} (or {len(group) - 1} alike)"
        out.append(Pattern(name, upwards, sum(p.weight for p in group)))
    return tuple(out)


def _cosine(one: FloatArray, other: FloatArray) -> float:
    return float(one @ other / np.sqrt((one @ one) * (other @ other)))


def log_bayes_factors(directions: Directions, info: FloatArray, score: FloatArray) -> FloatArray:
    r"""Return ln of the Bayes factors of every onset and direction against no change, (n_begins, n).

    With a = uᵀAu and c = uᵀb of a direction u, and δ ~ N(μ, v²),

    .. math:: \ln BF = -\tfrac12 \ln(1 + a v^2) + \frac{c^2 v^2 + 2cμ - aμ^2}{2(1 + a v^2)}

    Parameters
    ----------
    info, score : (n_begins, m, m), (n_begins, m) A and b of steps at each onset
    """
    u = directions.vectors
    along = log_along(directions, np.einsum("di,tij,dj->td", u, info, u), score @ u.T)
    half = len(directions.sizes) // 2
    both = np.logaddexp(*np.split(directions.all_size_weights, 2))
    free = np.empty(len(info))
    log_any(np.ascontiguousarray(info), np.ascontiguousarray(score), directions.sizes[half:], both, free)
    return np.concatenate([along, free[:, None]], axis=1)


def log_along(directions: Directions, a: FloatArray, c: FloatArray) -> FloatArray:
    """Return ln of the Bayes factors of changes with given a and c, averaged over sizes, shaped like a.

    The last axis of both is that of the directions.
    """
    return _mixed(directions, directions.log_size_weights, a, c)


def _mixed(directions: Directions, log_weights: FloatArray, a: FloatArray, c: FloatArray) -> FloatArray:
    out = np.empty(a.shape)
    weights = np.atleast_2d(log_weights)  # states stored by earlier versions have those of all vectors
    log_mixed(a.ravel(), c.ravel(), directions.sizes, directions.widths**2, weights, out.ravel())
    return out


def increments(days: FloatArray, now: float) -> FloatArray:
    """Return the increments of ramps from each onset until now, (n, n): w[i, j] at onset j of a ramp from i.

    Examples
    --------
    >>> increments(np.array([0.0, 1.0, 3.0]), 4.0)[0]  # the ramp at mid-span: 1/8, 4/8, 7/8
    array([0.125, 0.375, 0.375])
    """
    middle = 0.5 * (days + np.append(days[1:], now))
    span = np.maximum(now - days, 1e-9)
    level = np.clip((middle - days[:, None]) / span[:, None], 0.0, 1.0)
    return np.asarray(np.triu(np.diff(level, axis=1, prepend=0.0)))


def log_ramps(directions: Directions, u: FloatArray, bank: Bank, days: FloatArray, now: float) -> FloatArray:
    """Return ln of the Bayes factors of ramps and of steps along u, by onset, (2, n)."""
    if bank.cross is None:
        raise ValueError("a bank without what ramps are judged by")
    lower = np.einsum("i,tbij,j->tb", u, bank.cross, u)
    info = lower + np.tril(lower, -1).T
    score, w = bank.score @ u, increments(days, now)
    a = np.stack([np.einsum("ij,jk,ik->i", w, info, w), np.diag(info)])
    return _mixed(directions, directions.all_size_weights[None], a, np.stack([w @ score, score]))
