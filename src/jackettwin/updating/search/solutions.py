"""Search for all solutions: from scattered starts, then with known solutions excluded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy  # scipy.stats is loaded where it is used: half a second

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import InputError, require
from jackettwin.progress import SILENT, Progress
from jackettwin.response import damping_ratio
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.clusters import SAME, extent, gather
from jackettwin.updating.search.descent import End, descend, descend_simplex, settle
from jackettwin.updating.search.shorter_law import ShorterLaws
from jackettwin.updating.search.start_points import given_points

SearchMethod = Literal["least-squares", "nelder-mead"]
METHODS = ("least-squares", "nelder-mead")

LOCKED_DAMPER = 0.05
"""Relative difference of undamped and damped frequency above which a damper counts as locked: it carries the
load instead of the spring."""
_MOST = 16
"""Largest factor on the number of starts, doubled while some good solution has been found only once."""
MOST_EVALUATIONS = 40_000
"""Number of evaluations of the model after which starts are no longer doubled: about half a minute."""
_HOPELESS = 4
"""The search stops if this many times the number of starts have led to no minimum."""
_DEFLATED = 6
"""Largest number of searches with known solutions excluded; a quarter of the starts if these are few."""
_CONFIDENCE = 0.95
"""With which a solution that was missed is said to have few ways that lead to it."""


@dataclass(frozen=True)
class Solution:
    """A minimum of the cost, or a cluster of equal ones.

    Attributes
    ----------
    theta : (n_parameters,)
        For a cluster, the point nearest the middle of the bounds.
    cost : float
        Sum of squared residuals.
    frequency_hz, undamped_hz, damping_ratio : (n_targets,) in the first operating state
    rates : (n_relaxations,) rates of the measured relaxations [rad/s]
    locked_damper : bool
        Whether an undamped frequency is more than 5 % from the damped one.
    locks_within : bool
        Whether a damper is locked here or at an end of the cluster.
    at_bound : tuple of str
        Parameters that ended on a bound.
    found : int
        Number of starts that ended here.
    extent : (n_parameters, 2)
        Range of each parameter, with the others refitted, in which the cost does not rise noticeably.
    """

    theta: FloatArray
    cost: float
    frequency_hz: FloatArray
    undamped_hz: FloatArray
    damping_ratio: FloatArray
    rates: FloatArray
    locked_damper: bool
    locks_within: bool
    at_bound: tuple[str, ...]
    found: int
    extent: FloatArray


@dataclass(frozen=True)
class GivenSearch:
    """A search from a given point.

    Attributes
    ----------
    start, end : (n_parameters,)
    cost : float
        Cost at the end.
    settled : bool
        Whether the end is a minimum; a simplex may stall in a valley.
    """

    start: FloatArray
    end: FloatArray
    cost: float
    settled: bool


@dataclass(frozen=True)
class Search:
    """All solutions found, lowest cost first, and the completeness of the list.

    Attributes
    ----------
    starts : int
        Number of searches from scattered points.
    deflated : int
        Number of further searches with known solutions excluded by deflation (Farrell et al. 2015).
    missed_share_95 : float or None
        Upper limit, with 95 % confidence, of the share of random starts that lead to a missed solution. None
        if the search started from given points.
    spent : int or None
        Number of evaluations after which the search stopped although some solution had been found only once;
        None if it ended regularly.
    stalled : int
        Number of searches of both kinds that ended above every solution: stalled, on a shoulder, or on a
        plateau far from the data.
    begun : tuple of GivenSearch
        Ends of the searches from given points.
    """

    solutions: tuple[Solution, ...]
    starts: int
    deflated: int
    missed_share_95: float | None
    spent: int | None = None
    stalled: int = 0
    begun: tuple[GivenSearch, ...] = ()

    @property
    def statement(self) -> str:
        """A sentence on the completeness of the list."""
        n = len(self.solutions)
        once = sum(s.found == 1 for s in self.solutions)
        unsettled = "" if self.spent is None else f"Not complete after {self.spent:,} evaluations: "
        # end points that were not compared for lack of time may be one solution
        if self.spent is not None and not once:
            often = ", some of which may be the same"
        else:
            often = f", {once} of them found only once" if once else ", each found more than once"
        many = f"{n} distinct solution{'s' if n > 1 else ''}{often}"
        stalled = (
            f"; {self.stalled} of these searches stalled at a higher cost, in a valley or on a plateau"
            if self.stalled
            else ""
        )
        if self.missed_share_95 is None:
            points = f"{self.starts} given point{'s' if self.starts > 1 else ''}"
            return (
                f"{unsettled}Searches from {points} ended in {many}{stalled}. "
                "Other starts may lead to other solutions."
            )
        share = 100 * self.missed_share_95
        return (
            f"{unsettled}{self.starts} starts and {self.deflated} searches with known solutions excluded "
            f"ended in {many}{stalled}. If a solution was missed, fewer than {share:.2g} % of random starts "
            "lead to it (95 % confidence)."
        )


def search(
    problem: Problem,
    *,
    method: SearchMethod = "least-squares",
    starts: int | Sequence[Mapping[str, float]] = 32,
    seed: int = 0,
    most_evaluations: int = MOST_EVALUATIONS,
    progress: Progress = SILENT,
) -> Search:
    """Return the distinct solutions, best first.

    Starts are scrambled Sobol points in the logarithms between the bounds, doubled in number while some
    solution without redundant branches has been found only once. Known solutions are then excluded from
    further searches. Minima that fit far worse than the best (:meth:`Problem.poor`) are no solutions. From
    given points there is one search each and no others, as in the thesis.

    Parameters
    ----------
    method : {"least-squares", "nelder-mead"}
        Gradient-based least squares, or the thesis's simplex (section 8.2) with ``starts`` searches only.
    starts : int or sequence of {parameter: value}
        Number of scattered starts, or the starting points
        (:func:`jackettwin.updating.search.start_points.given_points`).
    most_evaluations : int
        Number of evaluations of the model after which no starts are added.
    progress : Progress
        Receives a message after each start.

    Raises
    ------
    InputError
        If the method is unknown, there is no start, a point does not belong to the problem, or no search ends
        in a minimum.
    """
    if method not in METHODS:
        raise InputError("unknown method", field="update.method", value=method, allowed=", ".join(METHODS))
    run = descend if method == "least-squares" else descend_simplex
    if not isinstance(starts, int):
        return _from_points(problem, run, given_points(problem, starts), progress)
    require(
        starts >= 1, "there must be at least one start", field="update.starts", value=starts, allowed="≥ 1"
    )
    deflated = min(_DEFLATED, max(2, starts // 4)) if method == "least-squares" else 0
    points = _scatter(problem, starts * (_MOST if method == "least-squares" else 1), seed)
    clusters: list[tuple[End, int]] = []
    ends: list[End] = []
    n, tried, spent = starts, 0, 0
    while True:
        new: list[tuple[End, int]] = []
        for point in points[tried:n]:
            if tried >= starts and spent >= most_evaluations:
                break
            end = run(problem, point)
            ends.append(end)
            tried, spent = tried + 1, spent + end.evaluations
            new += [(end, 1)] if end.settled else []
            progress.within(f"{tried} of {n} starts, {len(clusters)} distinct solutions from earlier ones")
        best = min((end.cost for end, _ in [*clusters, *new]), default=0.0)
        clusters, compared = gather(problem, _near(problem, new, best), known=_near(problem, clusters, best))
        enough = _often(problem, clusters) if clusters else n >= _HOPELESS * starts
        if enough or not compared or 2 * n > len(points) or spent >= most_evaluations:
            break
        n *= 2
    if deflated:
        clusters = _deflate(problem, clusters, points[:deflated], ends, progress)
    kept = _kept(problem, clusters)
    return Search(
        _solutions(problem, kept),
        tried,
        deflated,
        1.0 - (1.0 - _CONFIDENCE) ** (1.0 / tried),
        spent if not compared or (spent >= most_evaluations and not enough) else None,
        _stalled(problem, ends, kept),
    )


def _often(problem: Problem, clusters: list[tuple[End, int]]) -> bool:
    """Return whether every solution was found more than once, or has branches that the data do not need.

    The valley of redundant branches has as many arms as there are starts.
    """
    shorter = ShorterLaws(problem)
    return all(count > 1 or shorter(end) is not None for end, count in clusters)


def _near(problem: Problem, ends: list[tuple[End, int]], best: float) -> list[tuple[End, int]]:
    """Return the ends that do not fit far worse than the best."""
    return [v for v in ends if v[0].cost <= problem.poor(best)]


def _kept(problem: Problem, clusters: list[tuple[End, int]]) -> list[tuple[End, int]]:
    """Return the clusters that explain the data; raise an error if there is none."""
    if not clusters:
        raise _out_of_reach(problem)
    return _near(problem, clusters, clusters[0][0].cost)


def _solutions(problem: Problem, kept: list[tuple[End, int]]) -> tuple[Solution, ...]:
    """Return the solutions that clusters of end points are."""
    stay: list[tuple[End, int]] = []
    moved: list[tuple[End, int]] = []
    for end, count in kept:
        middle = settle(problem, end)
        (stay if np.abs(middle.z - end.z).max() < SAME else moved).append((middle, count))
    # two ends of one cluster may only be seen to be one from its middle
    clusters, _ = gather(problem, moved, known=stay)
    return tuple(_solution(problem, end, count) for end, count in clusters)


def _stalled(problem: Problem, ends: list[End], kept: list[tuple[End, int]]) -> int:
    return sum(not _ended_in(problem, end, kept) for end in ends)


def _ended_in(problem: Problem, end: End, clusters: list[tuple[End, int]]) -> bool:
    """Return whether the cost of an end is as low as that of some solution."""
    low = (cluster.cost for cluster, _ in clusters)
    return end.settled and any(abs(end.cost - cost) <= problem.allowance(cost) for cost in low)


def _from_points(
    problem: Problem, run: Callable[[Problem, FloatArray], End], points: FloatArray, progress: Progress
) -> Search:
    """Return the ends of searches from given points (n, d)."""
    ends: list[End] = []
    for i, point in enumerate(points, start=1):
        ends.append(run(problem, point))
        progress.within(f"given point {i} of {len(points)}")
    clusters, compared = gather(problem, [(end, 1) for end in ends if end.settled])
    begun = tuple(
        GivenSearch(np.exp(z), np.exp(end.z), end.cost, end.settled)
        for z, end in zip(points, ends, strict=True)
    )
    spent, kept = None if compared else sum(end.evaluations for end in ends), _kept(problem, clusters)
    stalled = _stalled(problem, ends, kept)
    return Search(_solutions(problem, kept), len(points), 0, None, spent, stalled, begun)


def _out_of_reach(problem: Problem) -> InputError:
    """Return an error that compares the data with the frequencies possible with these supports."""
    first = problem.states[0]
    targets = first.residuals.used
    ends = problem.vectors(np.stack([problem.prior.low, problem.prior.high]), first)
    low, high = (problem.model.undamped_hz(theta, first.residuals.modes) for theta in ends)
    bounds = [
        (t, float(t.frequency_hz), a, b)
        for t, a, b in zip(targets, low, high, strict=True)
        if t.frequency_hz is not None and not np.isnan(b)
    ]
    each = all((np.isnan(a) or a <= f) and f <= b for _, f, a, b in bounds)
    reach = [f"mode {t.mode} {'' if np.isnan(a) else f'from {a:.3g} '}to {b:.3g} Hz" for t, _, a, b in bounds]
    why = (
        "supports reach each frequency but not all data together"
        if each
        else "no support can reproduce the data"
    )
    return InputError(
        f"no start of the search ended in a minimum: {why}",
        value={t.mode: t.frequency_hz and round(float(t.frequency_hz), 5) for t in targets},
        allowed="undamped " + ", ".join(reach) if reach else None,
        remedy="check mode numbers (close modes change places as supports change: jackettwin explore draws "
        "it), frequencies, damping ratios, their standard deviations and update.bounds",
    )


def starting_points(problem: Problem, n: int, seed: int) -> FloatArray:
    """Return the first points θ (n, d) that a search of this seed starts from."""
    return np.asarray(np.exp(_scatter(problem, n, seed)))


def _scatter(problem: Problem, n: int, seed: int) -> FloatArray:
    low, high = problem.prior.low, problem.prior.high
    sampler = scipy.stats.qmc.Sobol(low.size, scramble=True, rng=np.random.default_rng(seed))
    power = int(np.ceil(np.log2(max(n, 2))))
    return np.asarray(low + (high - low) * sampler.random_base2(power)[:n])


def _deflate(
    problem: Problem,
    clusters: list[tuple[End, int]],
    points: FloatArray,
    ends: list[End],
    progress: Progress,
) -> list[tuple[End, int]]:
    """Return the clusters, extended by further searches with these excluded; their ends are appended."""
    for i, point in enumerate(points, start=1):
        progress.within(f"search {i} of {len(points)} with {len(clusters)} known solutions excluded")
        end = descend(problem, point, known=tuple(cluster.z for cluster, _ in clusters))
        ends.append(end)
        if end.settled and end.cost <= problem.poor(clusters[0][0].cost if clusters else end.cost):
            clusters, _ = gather(problem, [(end, 1)], known=clusters)
    return clusters


def _solution(problem: Problem, end: End, found: int) -> Solution:
    poles, undamped = _damped_and_undamped(problem, end.z)
    damped = np.abs(poles) / (2.0 * np.pi)
    sides, points = extent(problem, end)
    on_bound = (end.z - problem.prior.low < 1e-3) | (problem.prior.high - end.z < 1e-3)
    return Solution(
        theta=np.exp(end.z),
        cost=end.cost,
        frequency_hz=damped,
        undamped_hz=undamped,
        damping_ratio=damping_ratio(poles),
        rates=np.array([found.rate[0] for found in problem.relaxed(end.z[None], problem.states[0])]),
        locked_damper=_locked(poles, undamped),
        locks_within=any(_locked(*_damped_and_undamped(problem, z)) for z in points),
        at_bound=tuple(p.name for p, flag in zip(problem.parameters, on_bound, strict=True) if flag),
        found=found,
        extent=np.exp(sides),
    )


def _damped_and_undamped(problem: Problem, z: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Return the poles and undamped frequencies of the first state's modes."""
    first = problem.states[0]
    theta, modes = problem.vectors(z[None], first)[0], first.residuals.modes
    return problem.model.predict(theta, modes).poles, problem.model.undamped_hz(theta, modes)


def _locked(poles: ComplexArray, undamped_hz: FloatArray) -> bool:
    apart = np.abs(undamped_hz * 2.0 * np.pi / np.abs(poles) - 1.0)
    return bool(np.isnan(apart).any() or (apart > LOCKED_DAMPER).any())
