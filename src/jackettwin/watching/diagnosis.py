r"""Diagnosis of a change: probability and size of each cause, and causes that cannot be distinguished.

The innovations since an onset contain all information on a step δ of all quantities:
A = Σ hhᵀ/s and b = Σ hν/s. A cause with direction J and size θ has the likelihood ratio

.. math:: Λ = \exp(θ J^T b - \tfrac12 θ^2 J^T A J)

relative to no change. Its evidence is the mean of Λ over its sizes, over the draws of J and over onsets. The
alternative "something else" is a step in an arbitrary direction. Further measurements are ranked by the
information that their values are expected to give on the cause.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc, ndtri

from jackettwin.arrays import FloatArray
from jackettwin.intervals import QUANTILES
from jackettwin.watching.causes import SOMETHING_ELSE, Cause
from jackettwin.watching.change import Change
from jackettwin.watching.directions import SIZES
from jackettwin.watching.scatter import STRONGER

INSEPARABLE = 2.0
"""Distance in standard deviations of data and model below which causes cannot be distinguished."""
CLEAR = 0.5
"""Probability of a cause from which it is at least as likely as all others together."""
_OTHER_PRIOR = 1.0
UNEXPLAINED = 0.02
"""Probability of a deviation from a cause's effect below which that cause does not explain all."""
_SECOND, _FIRSTS = 0.02, 3
"""Probability that another change began with a first one, and number of likeliest causes that are tried as
the first: changes are decades apart, but a storm or works at sea may do two things."""
_ORDER, _FAR = 1.0, 1e3
"""Range of ln size taken for one order of magnitude, and a number beyond any such order."""
TAIL = {1.0: 0.68, 3.0: 0.22, 9.0: 0.1}
"""Errors of a model's directions, as multiples of the usual error, and their probabilities. Of some five
hundred directions compared, 68 % were within the usual error and 90 % within three times it
(docs/verification/directions.md)."""
_SCALED, _SHAPED, _LEAST_SCALE, _FACTORS = 0.05, 0.25, 0.05, 99
"""Spread of ln of the scale of a cause's effect from which its size is as uncertain, largest share of the
draws' variance that is of their shape, smallest scale over the mean that has a logarithm, and number of
equally likely factors."""
_LOUDER_TOO, _NO_SIGN = 0.05, -3.0
"""Probability that the scatter of a changed structure's records increases too, and ln of the evidence for it
below which this is not considered."""
SHIFTS = (0.1, 0.3, 1.0)
"""Shares of the largest shift that may accompany increased noise; the shift depends on the sensor."""


@dataclass(frozen=True)
class CauseVerdict:
    """One cause, its probability and size.

    Attributes
    ----------
    size, interval_90 : size in ``unit``, given that this is the cause; NaN for a cause without a size
    alike : names of further causes of the same effect
    """

    cause: str
    probability: float
    size: float
    interval_90: tuple[float, float]
    unit: str
    alike: tuple[str, ...] = ()


@dataclass(frozen=True)
class Diagnosis:
    """Probable causes of a change.

    Attributes
    ----------
    verdicts : causes in order of probability, including "something else"
    inseparable : groups of likely causes that these quantities do not distinguish
    explained : probability of a change that differs at least as much from what the likeliest cause does; NaN
        for a cause without a size and for two together
    """

    verdicts: tuple[CauseVerdict, ...]
    inseparable: tuple[tuple[str, ...], ...]
    explained: float = float("nan")


def diagnose(
    change: Change, causes: Sequence[Cause], kinds: Sequence[str], alone: Collection[str] = ()
) -> Diagnosis:
    """Return the probabilities of causes after a change.

    Parameters
    ----------
    kinds : (m,) kind of each quantity
    alone : names of causes that are not tried together with another
    """
    sensor = next((cause for cause in causes if cause.louder.size), None)
    states = [(0.0, change), *([] if sensor is None else _in_noise(change, sensor))]
    judged = [_judge(states, cause, kinds) for cause in causes]
    free = [weight + _something(known, kinds) for weight, known in states]
    other = np.logaddexp.reduce(free)
    priors = np.log([cause.prior for cause in causes] + [_OTHER_PRIOR])
    evidence = np.array([*(found[0] for found in judged), float(other)]) + priors
    sized = [k for k in np.argsort(-evidence) if k < len(causes) and not causes[k].louder.size]
    # a step looks like noise until its onset is met: what counts is the noise beside a change of any kind
    noisy = states[int(np.argmax(free))][1]
    explained = explained_share(noisy, causes[sized[0]], kinds) if sized else float("nan")
    two: dict[str, float] = {}
    if explained < UNEXPLAINED or evidence.argmax() == len(causes):
        tried = [k for k in sized if causes[k].name not in alone]
        two = _of_two(noisy, [causes[k] for k in tried], evidence[tried], kinds)
    evidence = np.append(evidence, [*two.values()])
    probability = np.exp(evidence - np.logaddexp.reduce(evidence)).tolist()
    told = [(c.name, *found[1:], c.unit, c.alike) for c, found in zip(causes, judged, strict=True)]
    told += [(name, np.nan, (np.nan, np.nan), "-", ()) for name in (SOMETHING_ELSE, *two)]
    verdicts = [CauseVerdict(one[0], p, *one[1:]) for one, p in zip(told, probability, strict=True)]
    ordered = tuple(sorted(verdicts, key=lambda v: -v.probability))
    likely = [c for c, p in zip(causes, probability, strict=False) if p > 0.02]
    if not sized or ordered[0].cause != causes[sized[0]].name:
        explained = float("nan")
    return Diagnosis(ordered, _groups(change, likely, {v.cause: v for v in ordered}, kinds), explained)


def _of_two(
    change: Change, causes: Sequence[Cause], evidence: FloatArray, kinds: Sequence[str]
) -> dict[str, float]:
    r"""Return ln of the evidence of two causes together by their names, each pair once.

    With X = A⁻¹b of the likeliest onset, a size θ of the first, and the effect of the second normal with
    mean μ and covariance C over its sizes of one order of magnitude and its directions, X is

    .. math:: N(θJ + μ, A^{-1} + θ^2 RR^T + C)

    The evidence of the first alone is multiplied by the ratio of the mean of these densities to that without
    a second.

    Parameters
    ----------
    causes, evidence : with a size, the likeliest first, and ln of their evidence and prior
    """
    best = _best(change)
    noise = _inverse(change.info[best : best + 1])[0]
    seen = noise @ change.score[best]
    share = [_SECOND * cause.prior / sum(one.prior for one in causes) for cause in causes]
    seconds = [_as_normals(cause, kinds) for cause in causes]
    found: dict[str, float] = {}
    for i, first in enumerate(causes[:_FIRSTS]):
        # every other size still finds one as well known as a direction
        sizes, logs, alone = first.sizes[::2], first.log_size_weights[::2], list[float]()
        off = seen - first.steps(sizes)
        both: list[list[float]] = [[] for _ in causes]
        for times, weight in TAIL.items():
            root = _misfit(first, kinds, times)
            wide = noise + sizes[:, None, None] ** 2 * (root @ root.T)
            prior = logs + np.log(weight)
            alone.append(float(np.logaddexp.reduce(prior + _log_density(off, wide))))
            for k, of_order in enumerate(seconds):
                for ln_share, mean, spread in of_order:
                    own = prior + ln_share + _log_density(off - mean, wide + spread)
                    both[k].append(float(np.logaddexp.reduce(own)))
        for k, second in enumerate(causes):
            if k > i or k >= _FIRSTS:
                more = np.logaddexp.reduce(both[k]) - np.logaddexp.reduce(alone)
                found[f"{first.name} and {second.name}"] = float(evidence[i] + np.log(share[k]) + more)
    return found


def _as_normals(cause: Cause, kinds: Sequence[str]) -> list[tuple[float, FloatArray, FloatArray]]:
    """Return a cause's effect as normals: ln of the weight, mean (m,) and covariance (m, m) of each.

    Each is of the sizes of one sign and order of magnitude, of which uniform ones are nearly normal.
    """
    found, root = [], _misfit(cause, kinds)
    order = np.sign(cause.sizes) * (_FAR + np.floor(np.log(np.abs(cause.sizes)) / _ORDER))
    for one in np.unique(order):
        sizes, logs = cause.sizes[order == one], cause.log_size_weights[order == one]
        ln_share = np.logaddexp.reduce(logs)
        weight, steps = np.exp(logs - ln_share), cause.steps(sizes)
        mean = weight @ steps
        spread = (weight[:, None] * (steps - mean)).T @ (steps - mean)
        found.append((float(ln_share), mean, spread + (weight @ sizes**2) * (root @ root.T)))
    return found


def _log_density(off: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return ln of the normal density of deviations (n, m) with covariances (n, m, m), but for a constant."""
    square = np.einsum("si,si->s", off, np.linalg.solve(covariance, off[..., None])[..., 0])
    return np.asarray(-0.5 * (square + np.linalg.slogdet(covariance)[1]))


def explained_share(change: Change, cause: Cause, kinds: Sequence[str]) -> float:
    r"""Return the probability of a change that differs at least as much from what a cause does.

    With X = A⁻¹b of the likeliest onset and the size θ that fits best,

    .. math:: χ^2 = (X - θJ)^T (A^{-1} + θ^2 RR^T)^{-1} (X - θJ)

    has a degree of freedom less than there are quantities; the direction misses by the usual or more, each
    with its share. A cause may be the likeliest of all and not be all: two changes at once have none.
    """
    if len(kinds) < 2:
        return 1.0
    best = _best(change)
    noise = _inverse(change.info[best : best + 1])[0]
    off = noise @ change.score[best] - cause.steps(cause.sizes)
    total = 0.0
    for times, share in TAIL.items():
        root = _misfit(cause, kinds, times)
        wide = noise + cause.sizes[:, None, None] ** 2 * (root @ root.T)
        square = np.einsum("si,si->s", off, np.linalg.solve(wide, off[..., None])[..., 0])
        total += share * float(chdtrc(len(kinds) - 1, square.min()))
    return total


def _judge(
    states: Sequence[tuple[float, Change]], cause: Cause, kinds: Sequence[str]
) -> tuple[float, float, tuple[float, float]]:
    """Return ln of the evidence, and median and 90 % interval of the size.

    Parameters
    ----------
    states : pairs of ln weight and change, first for the usual noise and then for increased noise
    """
    if cause.louder.size:
        change = states[0][1]
        return _noisy(change, cause, _begins(change)), np.nan, (np.nan, np.nan)
    by_size = _by_size(states, cause, kinds)
    low, mid, high = _size_quantiles(states, cause, kinds, by_size)
    return float(np.logaddexp.reduce(by_size)), mid, (low, high)


def _by_size(states: Sequence[tuple[float, Change]], cause: Cause, kinds: Sequence[str]) -> FloatArray:
    """Return ln of the evidence of each size with its prior, (n_sizes,)."""
    by_state = []
    for weight, change in states:
        by_miss = [
            _likelihood(change.info, change.score, cause, kinds, times) + np.log(share)
            for times, share in TAIL.items()
        ]
        logs = np.logaddexp.reduce(by_miss, axis=0) + _begins(change)[:, None]
        by_state.append(weight + np.logaddexp.reduce(logs, axis=0) + cause.log_size_weights)
    return np.asarray(np.logaddexp.reduce(by_state, axis=0))


def _size_quantiles(
    states: Sequence[tuple[float, Change]], cause: Cause, kinds: Sequence[str], by_size: FloatArray
) -> tuple[float, float, float]:
    r"""Return the quantiles of the size.

    Feet of uncertain stiffness scale the effect of a softer ground by a factor that no change of modes tells
    from the size. With s of a draw its scale, :math:`J_d^T A J / J^T A J`, lognormal, a = sθ is what the
    change tells, by directions J_d/s, and θ is a/s. Normal directions alone leave no room for a stiff ground,
    whose loss by half moves modes as little as a fifth of the likely one.
    """
    sizes, logs = cause.sizes, by_size
    scaled = _scaled(states[0][1], cause)
    if scaled is not None:
        spread, draws = scaled
        factors = np.exp(spread * ndtri((np.arange(_FACTORS) + 0.5) / _FACTORS))
        sizes = (cause.sizes[:, None] / factors).ravel()
        logs = np.repeat(_by_size(states, replace(cause, draws=draws), kinds), _FACTORS)
        logs[np.abs(sizes) > np.abs(cause.sizes).max()] = -np.inf
    weights = np.exp(logs - logs.max())
    order = np.argsort(sizes)
    share = np.cumsum(weights[order]) / weights.sum()
    low, mid, high = (sizes[order][np.searchsorted(share, p).clip(0, share.size - 1)] for p in QUANTILES)
    return float(low), float(mid), float(high)


def _scaled(change: Change, cause: Cause) -> tuple[float, FloatArray] | None:
    """Return the spread of ln of the scale of a cause's draws and these without it, if it is most of them."""
    mean, info = cause.draws.mean(axis=0), change.info[_best(change)]
    scale = cause.draws @ info @ mean / max(float(mean @ info @ mean), 1e-300)
    if len(scale) < 2 or scale.min() < _LEAST_SCALE:
        return None
    logs = np.log(scale)
    draws = cause.draws * (np.exp(logs.mean()) / scale)[:, None]
    left, all_ = (
        float(np.einsum("di,ij,dj->", x, info, x)) for x in (draws - draws.mean(axis=0), cause.draws - mean)
    )
    spread = float(logs.std(ddof=1))
    return (spread, draws) if spread > _SCALED and left < _SHAPED * all_ else None


def _begins(change: Change) -> FloatArray:
    """Return ln of the weights of the onsets."""
    return np.asarray(change.log_stake - np.logaddexp.reduce(change.log_stake))


def _in_noise(change: Change, sensor: Cause) -> list[tuple[float, Change]]:
    r"""Return ln of the weight and the change under increased noise, if there is evidence of it.

    The scatter of a damaged structure's records may increase as well, so that increased noise alone does not
    attribute a change of frequencies to a sensor. With X = A⁻¹b, the noise factors G and A' = G⁻¹AG⁻¹,

    .. math:: \frac{p(X|θ, G)}{p(X|0, 1)} = \frac{N(X; 0, GA^{-1}G)}{N(X; 0, A^{-1})}
              \exp(θ J^T A'X - \tfrac12 θ^2 J^T A'J)

    The first factor and the likelihood ratio of the scatter are the weights of the onsets.
    """
    total, louder = _loudness(change, sensor)
    if total.max() < _NO_SIGN:
        return []
    own = total + _moved(change, louder, np.zeros(louder.shape[1]))
    info = change.info / louder[:, :, None] / louder[:, None, :]
    seen = np.einsum("tij,tj->ti", _inverse(change.info), change.score)
    begins = _begins(change) + own
    weight = float(np.logaddexp.reduce(begins))
    known = replace(change, info=info, score=np.einsum("tij,tj->ti", info, seen), log_stake=begins)
    return [(weight + np.log(_LOUDER_TOO), known)]


def _likelihood(
    info: FloatArray, score: FloatArray, cause: Cause, kinds: Sequence[str], times: float = 1.0
) -> FloatArray:
    r"""Return ln Λ by onset and size, (n_begins, n_sizes), with the uncertainty of the direction.

    With δ = θ(J(θ) + Rε), ε ~ N(0, I) and RᵀAR = QΛQᵀ, c = QᵀRᵀ(b − θAJ):

    .. math:: \ln Λ = θ J^T b - \tfrac12 θ^2 J^T A J + \tfrac12 Σ \frac{θ^2 c_i^2}{1 + θ^2 Λ_i}
              - \tfrac12 Σ \ln (1 + θ^2 Λ_i)
    """
    size, root, steps = cause.sizes, _misfit(cause, kinds, times), cause.steps(cause.sizes)
    moved = steps @ info  # (n_begins, n_sizes, m)
    plain = score @ steps.T - 0.5 * np.einsum("tsi,si->ts", moved, steps)
    values, vectors = np.linalg.eigh(root.T @ info @ root)
    turned = root @ vectors
    square = (size[:, None] * ((score[:, None, :] - moved) @ turned)) ** 2
    wide = 1.0 + size[:, None] ** 2 * np.maximum(values, 0.0)[:, None, :]
    return np.asarray(plain + 0.5 * np.sum(square / wide - np.log(wide), axis=-1))


def _misfit(cause: Cause, kinds: Sequence[str], times: float = 1.0) -> FloatArray:
    """Return R, (m, r), with RRᵀ the covariance of a cause's direction per unit of size.

    The draws of the structural model give errors that are correlated between quantities. What the model
    misses is ``times`` the usual: of each quantity by itself, and of two modes that it mixes otherwise.
    """
    draws = cause.draws
    kind, J = np.array(kinds), draws.mean(axis=0)
    alone = np.zeros(len(kind))
    for one in np.unique(kind):
        alone[kind == one] = times * cause.misfit * np.sqrt(np.mean(draws[:, kind == one] ** 2))
    drawn = (draws - J).T / np.sqrt(max(len(draws) - 1, 1))
    if cause.mixing is None:
        return np.concatenate([np.diag(alone), drawn], axis=1)
    mixed = times**2 * cause.mixing.T @ cause.mixing
    values, vectors = np.linalg.eigh(np.diag(alone**2) + drawn @ drawn.T + mixed)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def _noisy(change: Change, cause: Cause, begins: FloatArray) -> float:
    """Return ln of the evidence of increased noise of at least one mode, by any factor.

    The accompanying shift is evaluated with the noise that is likely for each onset.
    """
    total, louder = _loudness(change, cause)
    shift = np.logaddexp.reduce([_moved(change, louder, g * np.diag(cause.draws)) for g in SHIFTS], axis=0)
    return float(np.logaddexp.reduce(begins + total + shift - np.log(len(SHIFTS))))


def _loudness(change: Change, cause: Cause) -> tuple[FloatArray, FloatArray]:
    """Return ln of the evidence of increased noise of at least one mode (n_begins,), and its factors."""
    total = np.zeros(len(change.info))
    louder = np.ones((len(change.info), change.info.shape[-1]))
    ln_g = np.log(np.concatenate([[1.0], STRONGER]))
    for mode in np.unique(cause.louder):
        of_mode = cause.louder == mode
        by_factor = change.log_scatter[:, of_mode].sum(axis=1)  # all quantities of a mode by one factor
        none = np.zeros((len(by_factor), 1))
        logs = np.concatenate([none, by_factor - np.log(by_factor.shape[1])], axis=1)
        mass = np.logaddexp.reduce(logs, axis=1)
        total += mass - np.log(2.0)
        louder[:, of_mode] = np.exp(np.exp(logs - mass[:, None]) @ ln_g)[:, None]
    # increased noise of no mode is not a failing sensor
    quiet = -np.log(2.0) * len(np.unique(cause.louder))
    total += np.log(np.maximum(-np.expm1(np.minimum(quiet - total, 0.0)), 1e-12)) - np.log(-np.expm1(quiet))
    return total, louder


def _moved(change: Change, louder: FloatArray, std: FloatArray) -> FloatArray:
    """Return ln of the evidence of δ ~ N(0, std²) in increased noise, relative to normal noise, (n_begins,).

    The estimate of a step, A⁻¹b, has the covariance A⁻¹ without a change and GA⁻¹G + std² here; under
    increased noise the mean deviates more, which is evidence for it.
    """
    unsure = _inverse(change.info)
    seen = np.einsum("tij,tj->ti", unsure, change.score)
    wide = louder[:, :, None] * unsure * louder[:, None, :] + np.diag(std**2)
    fits = np.einsum("ti,ti->t", seen, np.linalg.solve(wide, seen[..., None])[..., 0])
    ratio = np.linalg.slogdet(wide)[1] - np.linalg.slogdet(unsure)[1]
    return np.asarray(0.5 * (np.einsum("ti,ti->t", seen, change.score) - fits - ratio))


def _inverse(info: FloatArray) -> FloatArray:
    """Return A⁻¹ by onset, with a ridge for quantities of which there is little information."""
    ridge = 1e-9 * np.trace(info, axis1=1, axis2=2)[:, None, None] * np.eye(info.shape[-1])
    return np.asarray(np.linalg.inv(info + ridge))


def _free(info: FloatArray, score: FloatArray, std: FloatArray) -> FloatArray:
    """Return ln of the evidence of δ ~ N(0, std²) by onset, (n_begins,)."""
    wide = np.eye(len(std)) + std[:, None] * info * std
    turned = std * score
    solved = np.linalg.solve(wide, turned[..., None])[..., 0]
    return np.asarray(0.5 * np.einsum("ti,ti->t", turned, solved) - 0.5 * np.linalg.slogdet(wide)[1])


def _something(change: Change, kinds: Sequence[str]) -> float:
    """Return ln of the evidence of a step of any size and direction, of one kind of quantity or all."""
    begins = _begins(change)
    spans = []
    alone = tuple((kind,) for kind in SIZES if kind in kinds)
    for chosen in alone if len(alone) == 1 else (*alone, tuple(SIZES)):
        for k in range(max(len(s) for s in SIZES.values())):
            std = np.array([SIZES[q][min(k, len(SIZES[q]) - 1)] if q in chosen else 0.0 for q in kinds])
            spans.append(float(np.logaddexp.reduce(begins + _free(change.info, change.score, std))))
    return float(np.logaddexp.reduce(spans) - np.log(len(spans)))


def _groups(
    change: Change, causes: Sequence[Cause], verdicts: dict[str, CauseVerdict], kinds: Sequence[str]
) -> tuple[tuple[str, ...], ...]:
    """Return groups of causes that data and model cannot distinguish, each at its likely size.

    The covariance of their difference is that of the data plus that of the directions: A⁻¹ + D².
    """
    with_size = [c for c in causes if not c.louder.size]
    best = change.info[_best(change)]
    steps = {c.name: c.steps(np.array([verdicts[c.name].size]))[0] for c in with_size}
    roots = {c.name: verdicts[c.name].size * _misfit(c, kinds) for c in with_size}
    groups: list[set[str]] = []
    for i, one in enumerate(with_size):
        for other in with_size[:i]:
            difference = steps[one.name] - steps[other.name]
            miss = sum((r @ r.T for r in (roots[one.name], roots[other.name])), np.zeros_like(best))
            known = best @ np.linalg.inv(np.eye(len(best)) + miss @ best)
            if np.sqrt(difference @ known @ difference) < INSEPARABLE:
                joined = {one.name, other.name}
                for group in [g for g in groups if g & joined]:
                    joined |= group
                    groups.remove(group)
                groups.append(joined)
    return tuple(tuple(sorted(g, key=lambda n: -verdicts[n].probability)) for g in groups)


def _best(change: Change) -> int:
    """Return the index of the onset that is likeliest of an arbitrary step, by its fit and its weight."""
    m = change.info.shape[-1]
    scale = 1e-6 * np.trace(change.info, axis1=1, axis2=2).max() * np.eye(m)
    solved = np.linalg.solve(change.info + scale, change.score[..., None])[..., 0]
    return int(np.argmax(0.5 * np.einsum("ti,ti->t", change.score, solved) + change.log_stake))


_POINTS = 401
"""Number of points of the grid over which a predicted value is integrated."""
_REACH = 6.0
"""Extent of that grid beyond the outermost prediction, in standard deviations."""


def expected_information(probability: FloatArray, mean: FloatArray, std: FloatArray) -> float:
    r"""Return the expected information of one value on the cause [nats].

    .. math:: I = Σ_c p_c \int p(y|c) \ln \frac{p(y|c)}{p(y)} dy

    Parameters
    ----------
    probability : (n_causes,) probabilities that sum to one
    mean, std : (n_causes,) value predicted by each cause, and its standard deviation including the
        measurement's

    Examples
    --------
    >>> two = np.array([0.5, 0.5])
    >>> round(expected_information(two, np.array([0.0, 100.0]), np.ones(2)), 3)  # ln 2: the value decides
    0.693
    >>> round(expected_information(two, np.zeros(2), np.ones(2)), 3)
    0.0
    """
    low, high = np.min(mean - _REACH * std), np.max(mean + _REACH * std)
    # the grid combines the quantiles of the mixture's components, so that it is fine where predictions are
    # sharp
    z = np.linspace(-_REACH, _REACH, _POINTS)
    y = np.unique(np.concatenate([(mean[:, None] + std[:, None] * z).ravel(), [low, high]]))
    log_each = -0.5 * ((y - mean[:, None]) / std[:, None]) ** 2 - np.log(np.sqrt(2.0 * np.pi) * std[:, None])
    log_all = np.logaddexp.reduce(log_each + np.log(probability)[:, None], axis=0)
    integrand = probability[:, None] * np.exp(log_each) * (log_each - log_all)
    return max(0.0, float(np.trapezoid(integrand.sum(axis=0), y)))
