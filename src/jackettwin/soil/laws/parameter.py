"""An unknown positive number: its bounds and its prior."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.errors import InputError


@dataclass(frozen=True)
class Parameter:
    """A positive number updated in log space between two bounds.

    Its prior is flat in ln θ, or lognormal with a median and a standard deviation of ln θ, cut at the bounds.
    """

    name: str
    low: float
    high: float
    unit: str
    median: float | None = None
    log_std: float | None = None
    words: str = ""
    """Its name in a sentence."""

    def __post_init__(self) -> None:
        self._check_prior()
        if not 0.0 < self.low < self.high:
            raise InputError(
                "bounds are reversed or not positive",
                field=f"bounds.{self.name}",
                value=[self.low, self.high],
                allowed="0 < low < high",
                remedy="give [low, high]",
            )

    def _check_prior(self) -> None:
        if self.median is None and self.log_std is None:
            return
        if self.median is None or self.log_std is None or self.log_std <= 0.0:
            raise InputError(
                "a lognormal prior needs a median and a positive log_std",
                field=f"priors.{self.name}",
                value={"median": self.median, "log_std": self.log_std},
            )
        if not self.low <= self.median <= self.high:
            raise InputError(
                "the prior's median lies outside the bounds",
                field=f"priors.{self.name}",
                value=self.median,
                allowed=f"{self.low:g} to {self.high:g}",
                remedy="change update.bounds or update.priors",
            )
