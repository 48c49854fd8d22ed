"""Fits of the spectral model: over the whole band if one is acceptable, otherwise group by group.

A fit is acceptable if it has converged, is close to the spectrum (``lack_of_fit``) and still describes the
modes it started from (``mode_drift.py``). First the modes alone are fitted over the whole band. Then a
background is added for the quasi-static response to waves, which would otherwise pull a mode off its peak.
Groups of modes that still drift, or all groups, are then fitted in narrow bands. Modes that no fit describes
keep their subspace estimates.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.errors import NumericalError
from jackettwin.findings import Finding
from jackettwin.identification.maximum_likelihood.band_fit import BandFit
from jackettwin.identification.maximum_likelihood.local_refinement import DITHER_SHARES, groups, refine_group
from jackettwin.identification.maximum_likelihood.mode_drift import drifted
from jackettwin.identification.maximum_likelihood.refinement import refine

if TYPE_CHECKING:
    from collections.abc import Callable


NUMERICAL_FAILURES = (ArithmeticError, ValueError, NumericalError, RuntimeWarning)
"""Exceptions of a fit that fails numerically (``LinAlgError`` is a ``ValueError``).
The subspace estimates are then kept; the record is never lost."""
MAX_LACK_OF_FIT = 1.4
"""Largest accepted lack of fit over the whole band (mean square of the misfit over its expectation).
Records that the model describes have 0.8 to 1.1."""
MAX_LOCAL_LACK_OF_FIT = 2.0
"""Largest accepted lack of fit in a narrow band, where the covariance is multiplied by a lack of fit above
1."""
CROWDED_GROUP = 4
"""Number of modes in a narrow band from which only one fit is tried: further fits take seconds and rarely
converge."""
SHARED_ARGUMENTS = ("frequency_hz", "damping_ratio", "shapes", "sure", "derivatives", "avoid_hz")
FIELDS_PER_MODE = (
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
    """Candidates that a fit starts from; the arrays are those of ``refine``.

    Attributes
    ----------
    frequency_hz, damping_ratio, log_damping_std : (n_candidates,)
    shapes : (n_candidates, n_channels)
    sure : (n_candidates,) bool
    derivatives : list of int
    avoid_hz : tuple of (low, high)
    max_damping_ratio : float
        Largest damping ratio of a mode.
    """

    frequency_hz: FloatArray
    damping_ratio: FloatArray
    log_damping_std: FloatArray
    shapes: FloatArray
    sure: BoolArray
    derivatives: list[int]
    avoid_hz: tuple[tuple[float, float], ...]
    max_damping_ratio: float


@dataclass(frozen=True)
class AcceptedFit:
    """A fit and the candidates whose estimates it replaces.

    Attributes
    ----------
    candidates : (n_candidates,) bool
    modes : BandFit
        Without those that drifted away from the mode they started from.
    """

    candidates: BoolArray
    modes: BandFit


@dataclass(frozen=True)
class _Attempt:
    """A fit, or the reason why it was rejected, and which candidates drifted, (n_candidates,) bool."""

    fit: BandFit | None
    drifted: BoolArray
    obstacle: str = ""
    converged: bool = False


def accepted_fits(
    y: FloatArray, sample_rate_hz: float, band_hz: tuple[float, float], start: FitStart
) -> tuple[list[AcceptedFit], tuple[Finding, ...]]:
    """Return the accepted fits, and a finding on each group of modes that none of them describes.

    Parameters
    ----------
    y : (n_channels, n_samples)
        As in ``refine``.
    """
    duration_s = y.shape[1] / sample_rate_hz
    whole = _whole_band(y, sample_rate_hz, band_hz, start)
    left = np.ones(len(start.sure), dtype=bool)
    fits, findings = [], []
    for group in groups(start.frequency_hz, start.sure, band_hz):
        if whole.fit is not None and not np.any(group.members & start.sure & whole.drifted):
            continue
        left &= ~group.members
        work = partial(refine_group, y, sample_rate_hz, group, **_shared_arguments(start))
        work = partial(work, max_lack_of_fit=MAX_LOCAL_LACK_OF_FIT)
        many = np.sum(group.members & start.sure) >= CROWDED_GROUP
        for share in DITHER_SHARES[:1] if many else DITHER_SHARES:
            local = _attempt(partial(work, dither_share=share), MAX_LOCAL_LACK_OF_FIT, start, duration_s)
            lost = local.drifted & start.sure
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
    """Return the finding that modes retain their subspace estimates, with the reason."""
    return Finding("not_refined", params={"frequencies_hz": _listed(frequency_hz), "obstacle": obstacle})


def _whole_band(
    y: FloatArray, sample_rate_hz: float, band_hz: tuple[float, float], start: FitStart
) -> _Attempt:
    """Return the fit of the whole band in which the fewest modes drift.

    A background is tried if the fit without it converged but is poor or let a mode drift. After a fit that
    did not converge it would double the cost, and it helped in none of the records examined.
    """
    best: _Attempt | None = None
    for background in (False, True):
        work = partial(refine, y, sample_rate_hz, band_hz, background=background, **_shared_arguments(start))
        work = partial(work, max_lack_of_fit=MAX_LACK_OF_FIT)
        attempt = _attempt(work, MAX_LACK_OF_FIT, start, y.shape[1] / sample_rate_hz)
        if best is None or _rank(attempt, start) < _rank(best, start):
            best = attempt
        if not attempt.converged or (best.fit is not None and not np.any(best.drifted & start.sure)):
            break
    assert best is not None
    return best


def _rank(attempt: _Attempt, start: FitStart) -> tuple[bool, int, int]:
    return attempt.fit is None, int(np.sum(attempt.drifted & start.sure)), int(attempt.drifted.sum())


def _shared_arguments(start: FitStart) -> dict[str, Any]:
    """Return the arguments that ``refine`` and ``refine_group`` share."""
    return {key: getattr(start, key) for key in SHARED_ARGUMENTS}


def _attempt(fit: Callable[[], BandFit], most: float, start: FitStart, duration_s: float) -> _Attempt:
    none = np.zeros(len(start.sure), dtype=bool)
    try:
        # an overflow shows in the result, which is checked below
        with np.errstate(all="ignore"):
            refined = fit()
    except NUMERICAL_FAILURES as error:
        return _Attempt(None, none, f"the arithmetic of the fit broke down ({type(error).__name__})")
    if not _finite(refined):
        return _Attempt(None, none, "the arithmetic of the fit broke down (not a number)")
    if np.isinf(refined.lack_of_fit):
        return _Attempt(None, none, "too many modes lie close to one another to be fitted together")
    if not refined.converged:
        return _Attempt(None, none, "the fit of the spectral model did not converge")
    if refined.lack_of_fit > most:
        return _Attempt(
            None,
            none,
            f"the spectrum is not that of these modes under smooth random forces "
            f"(lack of fit {refined.lack_of_fit:.1f}, at most {most:g})",
            converged=True,
        )
    lost = drifted(
        refined,
        frequency_hz=start.frequency_hz,
        damping_ratio=start.damping_ratio,
        log_damping_std=start.log_damping_std,
        duration_s=duration_s,
        max_damping_ratio=start.max_damping_ratio,
    )
    none[refined.candidate[lost]] = True
    return _Attempt(refined, none, converged=True)


def _finite(refined: BandFit) -> bool:
    """Tell whether all numbers of a fit are finite and its variances positive."""
    numbers = (getattr(refined, name) for name in FIELDS_PER_MODE)
    variances = np.diagonal(refined.covariance, axis1=1, axis2=2)
    return all(np.isfinite(x).all() for x in numbers) and bool(np.all(variances > 0.0))


def _accepted(attempt: _Attempt, candidates: BoolArray) -> AcceptedFit:
    """Return a fit restricted to some candidates, without those that drifted."""
    assert attempt.fit is not None
    kept = (candidates & ~attempt.drifted)[attempt.fit.candidate]
    arrays = {name: getattr(attempt.fit, name)[kept] for name in FIELDS_PER_MODE}
    return AcceptedFit(candidates, replace(attempt.fit, **arrays))


def _listed(frequency_hz: FloatArray) -> str:
    return ", ".join(f"{f:.3g}" for f in frequency_hz)
