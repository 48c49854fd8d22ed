r"""Remaining life of a weld: a lognormal life, given that no failure occurred until its age.

With the median damage r of a year by the mean of the tests and the variance s² of its logarithm, a life T is
lognormal about 1/r. Given that it is longer than the age a,

.. math:: P(T > a + t \mid T > a) = \frac{Φ(-\ln(r(a + t))/s)}{Φ(-\ln(ra)/s)}, \qquad
          β_{year} = -Φ^{-1}\left(P(T \le a + 1 \mid T > a)\right)

(DNVGL-RP-C210, section 3: lognormal Miner's sum, S-N scatter and loads).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, inf, log

from scipy.special import log_ndtr, ndtri, ndtri_exp

from jackettwin.errors import require

_FEWEST_YEARS = 1e-9


@dataclass(frozen=True)
class RemainingLife:
    """Remaining life of a weld.

    Attributes
    ----------
    rate : float
        Median damage of a year, by the mean of the tests.
    log_std : float
        Standard deviation of its logarithm, scatter of tests and Miner's sum included.
    age_years : float
        That passed without failure.
    """

    rate: float
    log_std: float
    age_years: float = 0.0

    def __post_init__(self) -> None:
        require(self.log_std > 0.0, "must be positive", field="log_std", value=self.log_std, allowed="> 0")

    def quantile(self, probability: float) -> float:
        """Return the years t with P(T ≤ age + t | T > age) = probability; infinite without damage."""
        if self.rate <= 0.0:
            return inf
        survives = self._log_survival(self.age_years)
        total = exp(-self.log_std * float(ndtri_exp(survives + log(1.0 - probability)))) / self.rate
        return max(total - self.age_years, 0.0)

    def failure_in(self, years: float) -> float:
        """Return the probability that it fails within so many years from now."""
        if self.rate <= 0.0:
            return 0.0
        later, now = self._log_survival(self.age_years + years), self._log_survival(self.age_years)
        return 1.0 - exp(later - now)

    @property
    def reliability_index(self) -> float:
        """β of the coming year."""
        return float(-ndtri(max(self.failure_in(1.0), 1e-300)))

    def later(self, years: float) -> RemainingLife:
        """Return what is left so many years from now, if it has not failed until then."""
        return replace(self, age_years=self.age_years + years)

    def year_of_index(self, target: float, *, at_most: float = 1000.0) -> float | None:
        """Return how many years from now β of a year falls below a target; None if not within ``at_most``."""
        if self.reliability_index < target:
            return 0.0
        for years in range(1, int(at_most) + 1):
            if self.later(years).reliability_index < target:
                return float(years)
        return None

    def _log_survival(self, years: float) -> float:
        return float(log_ndtr(-log(self.rate * max(years, _FEWEST_YEARS)) / self.log_std))
