"""Convergence of draws: rank-normalised split R-hat and effective sample sizes, by ArviZ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray

LARGEST_RHAT = 1.1
"""R̂ of every parameter up to which runs count as mixed (Gelman et al. 2013, section 11.4)."""
SMALLEST_ESS = 50.0
"""Number of effective draws below which a 90 % interval is unreliable."""


@dataclass(frozen=True)
class Convergence:
    """Agreement of independent runs (Vehtari et al. 2021).

    Attributes
    ----------
    rhat : (n_parameters,) 1 when the runs agree
    ess_bulk, ess_tail : (n_parameters,) effective draws for the mean and for the 5 and 95 % quantiles
    """

    rhat: FloatArray
    ess_bulk: FloatArray
    ess_tail: FloatArray

    @property
    def problem(self) -> str | None:
        """The problem in a few words; None if there is none."""
        if not float(self.rhat.max()) <= LARGEST_RHAT:
            return f"R-hat {self.rhat.max():.2f}"
        least = min(float(self.ess_bulk.min()), float(self.ess_tail.min()))
        return None if least >= SMALLEST_ESS else f"{least:.0f} effective draws"


def convergence(z: FloatArray) -> Convergence:
    """Return the diagnostics of draws (n_runs, n_draws, n_parameters)."""
    # imported when needed: half a second
    from arviz_stats.base.array import array_stats

    stats: Any = array_stats
    axes = {"chain_axis": 0, "draw_axis": 1}
    return Convergence(
        np.asarray(stats.rhat(z, **axes)),
        np.asarray(stats.ess(z, method="bulk", **axes)),
        np.asarray(stats.ess(z, method="tail", prob=0.9, **axes)),
    )
