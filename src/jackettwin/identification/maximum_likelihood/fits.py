"""The fits of the spectral model that are accepted: of the whole band if one will do, else of close modes.

What a fit must be: converged, near the spectrum (``lack_of_fit``), and of the modes it started from
(``mode_drift.py``). First the modes alone are tried over the whole band; then with a background, which the
quasi-static response to waves is, else a mode leaves its peak to stand for it; then the groups that still
stray, or all of them, in their narrow bands. What no fit describes is left as the subspace method found it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.errors import NumericalError
from jackettwin.findings import Finding
from jackettwin.identification.maximum_likelihood.local_refinement import DITHER_SHARES, groups, refine_group
from jackettwin.identification.maximum_likelihood.mode_drift import strayed
from jackettwin.identification.maximum_likelihood.refined import Refined
from jackettwin.identification.maximum_likelihood.refinement import refine

if TYPE_CHECKING:
    from collections.abc import Callable


BREAKDOWNS = (ArithmeticError, ValueError, NumericalError, RuntimeWarning)
"""What a fit that breaks down raises, ``LinAlgError`` among the value errors: a reason to keep what the
subspace method found, never to lose the record."""
MOST_LACK_OF_FIT = 1.4
"""Mean square of the misfit over its expectation up to which a fit of the whole band is accepted;
records that are what the model says have 0.8 to 1.1."""
MOST_LOCAL_LACK_OF_FIT = 2.0
"""The same in a narrow band, where the covariance is multiplied by what exceeds 1."""

MANY_MODES = 4
"""So many modes within one narrow band: what does not end at the first try costs seconds and ends seldom."""

GIVEN = ("frequency_hz", "damping_ratio", "shapes", "sure", "derivatives", "avoid_hz")
OF_EACH_MODE = (
    "candidate",
    "frequency_hz",
    "damping_ratio",
    "shapes",
    "covariance",
    "shape_covariance",
    "cramer_rao",
)


@dataclass(frozen=True)
class FitStart:
    """The candidates a fit starts from; arrays as of ``refine``.

    Attributes
    ----------
    frequency_hz, damping_ratio, log_damping_std : (n_candidates,)
    shapes : (n_candidates, n_channels)
    sure : (n_candidates,) bool
    derivatives : list of int
    avoid_hz : tuple of (low, high)
    most_damping : float
        A damping ratio above it is of no mode.
    """

    frequency_hz: FloatArray
    damping_ratio: FloatArray
    log_damping_std: FloatArray
    shapes: FloatArray
    sure: BoolArray
    derivatives: list[int]
    avoid_hz: tuple[tuple[float, float], ...]
    most_damping: float


@dataclass(frozen=True)
class AcceptedFit:
    """A fit and the candidates it speaks for.

    Attributes
    ----------
    candidates : (n_candidates,) bool
    modes : Refined
        Only those that are still the modes they started from.
    """

    candidates: BoolArray
    modes: Refined


@dataclass(frozen=True)
class _Tried:
    """A fit, None if it is not to be used and why; which candidates strayed in it, (n_candidates,)."""

    fit: Refined | None
    strayed: BoolArray
    obstacle: str = ""
    converged: bool = False


def accepted_fits(
    y: FloatArray, sample_rate_hz: float, band_hz: tuple[float, float], start: FitStart
) -> tuple[list[AcceptedFit], tuple[Finding, ...]]:
    """Return the fits that are accepted, and a finding on each group of modes that none describes.

    Parameters
    ----------
    y : (n_channels, n_samples)
        As of ``refine``.
    """
    duration_s = y.shape[1] / sample_rate_hz
    whole = _whole_band(y, sample_rate_hz, band_hz, start)
    left = np.ones(len(start.sure), dtype=bool)
    fits, findings = [], []
    for group in groups(start.frequency_hz, start.sure, band_hz):
        if whole.fit is not None and not np.any(group.members & start.sure & whole.strayed):
            continue
        left &= ~group.members
        work = partial(refine_group, y, sample_rate_hz, group, **_given(start))
        work = partial(work, most_lack_of_fit=MOST_LOCAL_LACK_OF_FIT)
        many = np.sum(group.members & start.sure) >= MANY_MODES
        for share in DITHER_SHARES[:1] if many else DITHER_SHARES:
            local = _tried(partial(work, dither_share=share), MOST_LOCAL_LACK_OF_FIT, start, duration_s)
            lost = local.strayed & start.sure
            if local.fit is not None and not lost.any():
                fits.append(_accepted(local, group.members))
                break
        else:
            obstacle = local.obstacle or f"the fit left the peak at {_listed(start.frequency_hz[lost])} Hz"
            findings.append(not_refined(start.frequency_hz[group.members & start.sure], obstacle))
    if whole.fit is not None and left.any():
        fits.append(_accepted(whole, left))
    return fits, tuple(findings)


def not_refined(frequency_hz: FloatArray, obstacle: str) -> Finding:
    """Return what is said of modes that are left as the subspace method found them, and why."""
    return Finding("not_refined", params={"frequencies_hz": _listed(frequency_hz), "obstacle": obstacle})


def _whole_band(
    y: FloatArray, sample_rate_hz: float, band_hz: tuple[float, float], start: FitStart
) -> _Tried:
    """Return the fit of the whole band in which fewest modes stray, that of the modes alone if none does.

    A background is tried beside modes that were fitted but strayed, or nearly: where they cannot be fitted
    at all, it costs as much again and helps in no record that was seen.
    """
    best: _Tried | None = None
    for background in (False, True):
        work = partial(refine, y, sample_rate_hz, band_hz, background=background, **_given(start))
        work = partial(work, most_lack_of_fit=MOST_LACK_OF_FIT)
        tried = _tried(work, MOST_LACK_OF_FIT, start, y.shape[1] / sample_rate_hz)
        if best is None or _rank(tried, start) < _rank(best, start):
            best = tried
        if not tried.converged or (best.fit is not None and not np.any(best.strayed & start.sure)):
            break
    assert best is not None
    return best


def _rank(tried: _Tried, start: FitStart) -> tuple[bool, int, int]:
    return tried.fit is None, int(np.sum(tried.strayed & start.sure)), int(tried.strayed.sum())


def _given(start: FitStart) -> dict[str, Any]:
    """Return the arguments that ``refine`` and ``refine_group`` share."""
    return {key: getattr(start, key) for key in GIVEN}


def _tried(fit: Callable[[], Refined], most: float, start: FitStart, duration_s: float) -> _Tried:
    none = np.zeros(len(start.sure), dtype=bool)
    try:
        # what overflows is found by its result
        with np.errstate(all="ignore"):
            refined = fit()
    except BREAKDOWNS as error:
        return _Tried(None, none, f"the arithmetic of the fit broke down ({type(error).__name__})")
    if not _finite(refined):
        return _Tried(None, none, "the arithmetic of the fit broke down (not a number)")
    if np.isinf(refined.lack_of_fit):
        return _Tried(None, none, "too many modes lie close to one another to be fitted together")
    if not refined.converged:
        return _Tried(None, none, "the fit of the spectral model did not converge")
    if refined.lack_of_fit > most:
        return _Tried(
            None,
            none,
            f"the spectrum is not that of these modes under smooth random forces "
            f"(lack of fit {refined.lack_of_fit:.1f}, at most {most:g})",
            converged=True,
        )
    lost = strayed(
        refined,
        frequency_hz=start.frequency_hz,
        damping_ratio=start.damping_ratio,
        log_damping_std=start.log_damping_std,
        duration_s=duration_s,
        most_damping=start.most_damping,
    )
    none[refined.candidate[lost]] = True
    return _Tried(refined, none, converged=True)


def _finite(refined: Refined) -> bool:
    """Tell whether a fit is of numbers, variances above zero among them."""
    numbers = (getattr(refined, name) for name in OF_EACH_MODE)
    variances = np.diagonal(refined.covariance, axis1=1, axis2=2)
    return all(np.isfinite(x).all() for x in numbers) and bool(np.all(variances > 0.0))


def _accepted(tried: _Tried, candidates: BoolArray) -> AcceptedFit:
    """Return what a fit says of some candidates; one that strayed stood for the forces."""
    assert tried.fit is not None
    kept = (candidates & ~tried.strayed)[tried.fit.candidate]
    arrays = {name: getattr(tried.fit, name)[kept] for name in OF_EACH_MODE}
    return AcceptedFit(candidates, replace(tried.fit, **arrays))


def _listed(frequency_hz: FloatArray) -> str:
    return ", ".join(f"{f:.3g}" for f in frequency_hz)
