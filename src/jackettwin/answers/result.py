"""A run's answers to the five questions of its first page, in numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import exp, log
from typing import Literal

from jackettwin.intervals import NORMAL_90
from jackettwin.study import Scrutiny

LEAST_MODEL_ERROR = 0.01
"""Standard deviation by which a model of beams misses frequencies, where the twin states less."""

_TRACE = 0.01
"""Share of a measured damping ratio below which what is beyond all sources is none: medians do not add up."""


@dataclass(frozen=True)
class Span:
    """A number and its central 90 % interval; None where the interval is not known.

    The number is the posterior's median where there is a posterior, else the best fit or the measured value.
    """

    value: float
    low: float | None = None
    high: float | None = None

    @classmethod
    def of(cls, value: float | None, std: float | None) -> Span | None:
        """Return the span of a positive number known with a standard deviation, normal in its logarithm.

        >>> Span.of(2.0, 0.1)  # doctest: +ELLIPSIS
        Span(value=2.0, low=1.842..., high=2.171...)
        """
        if value is None:
            return None
        if std is None or value <= 0.0:
            return cls(value)
        factor = exp(NORMAL_90 * std / value)
        return cls(value, value / factor, value * factor)

    @property
    def log_std(self) -> float | None:
        """Standard deviation of the logarithm that a normal with this interval has."""
        if self.low is None or self.high is None or not 0.0 < self.low <= self.high:
            return None
        return log(self.high / self.low) / (2.0 * NORMAL_90)

    def meets(self, other: Span) -> bool:
        """Return whether two intervals overlap."""
        low, high = self.low or self.value, self.high or self.value
        return low <= (other.high or other.value) and (other.low or other.value) <= high


@dataclass(frozen=True)
class ModeAnswer:
    """A measured mode beside the design and the updated model.

    Attributes
    ----------
    design_hz : Span or None
        On the foundation the twin's priors state; None where they state no stiffness.
    rigid_hz : float
        With feet that cannot move.
    model_hz, model_damping : Span or None
        Of the recommended law; None for a mode it has not.
    sources : {source: Span}
        Damping ratio that steel, ground, rotor and water give the mode, as far as they are modelled.
    model_error : float
        Relative standard deviation by which the twin says that the model misses the frequency.
    number : int
        On pinned supports, from 1.
    open_dashpot : str
        Dashpot that gives the rotor's part, if no datum and no prior constrains it.
    """

    label: str
    measured_hz: Span | None
    measured_damping: Span | None
    fits_frequency: bool
    fits_damping: bool
    design_hz: Span | None
    rigid_hz: float
    model_hz: Span | None
    model_damping: Span | None
    sources: Mapping[str, Span]
    model_error: float = 0.0
    number: int = 0
    open_dashpot: str = ""

    @property
    def given_sources(self) -> Mapping[str, Span]:
        """The sources that data or stated values determine: not an open dashpot's."""
        return {name: span for name, span in self.sources.items() if name != "rotor" or not self.open_dashpot}

    @property
    def unexplained(self) -> float | None:
        """Measured damping ratio beyond that of all sources; None if nothing is, or it is not known."""
        if self.measured_damping is None or not self.sources or self.open_dashpot:
            return None
        measured = self.measured_damping.value
        beyond = measured - sum(span.value for span in self.sources.values())
        return beyond if beyond > _TRACE * measured else None

    @property
    def damped_as_measured(self) -> bool | None:
        """Whether measured and modelled damping overlap, each with its interval; None without intervals."""
        measured, model = self.measured_damping, self.model_damping
        if measured is None or model is None or measured.low is None:
            return None
        return measured.meets(model)

    @property
    def excessive(self) -> tuple[str, ...]:
        """Sources that alone damp the mode more than was measured, with its interval."""
        if self.measured_damping is None or self.measured_damping.high is None:
            return ()
        most = self.measured_damping.high
        return tuple(name for name, span in self.given_sources.items() if (span.low or span.value) > most)

    @property
    def as_designed(self) -> bool | None:
        """Whether measured frequency and design overlap, each with its interval; None without either."""
        if self.measured_hz is None or self.design_hz is None:
            return None
        return self.measured_hz.meets(self.design_hz)

    @property
    def near_design(self) -> bool | None:
        """Whether the model's own error may part the measured frequency from the design."""
        design = self.design_hz
        if self.measured_hz is None or design is None:
            return None
        slack = exp(NORMAL_90 * max(self.model_error, LEAST_MODEL_ERROR))
        low, high = design.low or design.value, design.high or design.value
        return self.measured_hz.meets(Span(design.value, low / slack, high * slack))


@dataclass(frozen=True)
class Clearance:
    """Distance of a mode's frequency from a band that the rotor excites.

    ``margin`` is the distance of the nearer end of the mode's 90 % interval to the band's nearer edge, as a
    share of that edge; negative inside the band.
    """

    label: str
    order: str
    low_hz: float
    high_hz: float
    margin: float


@dataclass(frozen=True)
class GroundAnswer:
    """Estimate of one parameter of the ground.

    Attributes
    ----------
    kind : {"stiffness", "damping"}
    before : Span or None
        What the twin's priors said; None where any value between the bounds was as likely.
    verdict : str
        ``identified``, ``weak``, ``unidentified``, or ``""`` without intervals.
    factor : float or None
        Upper over lower end of the 90 % interval.
    """

    name: str
    unit: str
    kind: Literal["stiffness", "damping"]
    value: Span
    before: Span | None
    verdict: str
    factor: float | None
    reason: str


@dataclass(frozen=True)
class LawAnswer:
    """One law among those fitted.

    ``misfit`` is χ² (or the relative cost) at the best fit; ``probability`` is None for a law that locks its
    damper or whose data carry no standard deviations.
    """

    law: str
    probability: float | None
    misfit: float
    locked: bool
    sampled: bool


@dataclass(frozen=True)
class AveragedGround:
    """Stiffness or loss of the ground over all laws that the data do not distinguish, by their probability.

    Attributes
    ----------
    name : str
        ``k``, storage stiffness, or ``loss_factor``, with the suffix of its group of feet.
    frequency_hz : float
        At which it is compared, for the laws' own parameters differ.
    laws : names of the laws
    """

    name: str
    unit: str
    frequency_hz: float
    value: Span
    laws: tuple[str, ...]


@dataclass(frozen=True)
class FitAnswer:
    """Agreement of the best fit with its data.

    Attributes
    ----------
    chi2, freedom, probability : of the fit, and how probable a larger χ² is if the model is true
    fits : bool
        Whether chance explains what is missed.
    off : {mode: relative deviation of the model's frequency}
        Of the fitted ones, the one that is most standard deviations off first.
    cover : float or None
        Relative error of the model that would cover what its frequencies miss, where it does not fit.
    moved : {parameter: change of its logarithm}
        By which it comes out wrong if all frequencies of the model are 1 % too high.
    """

    chi2: float
    freedom: int
    probability: float
    fits: bool
    off: Mapping[str, float]
    cover: float | None
    moved: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class NextStep:
    """Something one could measure, and how far it would narrow what is not known of the ground.

    ``factors`` maps parameters to the factor between the ends of their 90 % interval, expected afterwards.
    """

    what: str
    factors: Mapping[str, float]
    days: float | None = None
    """Length of the records it takes, if it is a matter of length."""
    modes: tuple[int, ...] = ()
    """Of ``what="modes"``, numbers of measured modes that are not fitted."""


@dataclass(frozen=True)
class Answers:
    """The first page in numbers.

    Attributes
    ----------
    law : str
        Recommended; ``""`` where nothing was fitted.
    probability_from : {"evidence", "approximation", ""}
        Sampled evidence of every law, or Laplace's approximation at the best fits.
    rotor_speed_hz : (lowest, highest) or None
    rotor_state : {"parked", "operating"} or None
    wind_m_s : float or None
        Mean wind speed of the records.
    usable : float
        Longest interval, as a factor, of a parameter that counts as identified.
    records, minutes : of measurements
    scrutiny : Scrutiny or None
        What the recommended law's fit does not explain, and what its answers hang on.
    averaged : tuple of AveragedGround
        Empty unless two laws are comparably probable.
    records_for : {mode: number}
        Records like these after which the mode's damping ratio is known to ± ``precision`` (90 %).
    """

    law: str
    laws: tuple[LawAnswer, ...]
    probability_from: str
    modes: tuple[ModeAnswer, ...]
    clearances: tuple[Clearance, ...]
    rotor_speed_hz: tuple[float, float] | None
    blades: int
    ground: tuple[GroundAnswer, ...]
    next_steps: tuple[NextStep, ...]
    records: int
    minutes: float
    records_for: Mapping[str, int]
    precision: float
    usable: float
    fit: FitAnswer | None = None
    scrutiny: Scrutiny | None = None
    averaged: tuple[AveragedGround, ...] = ()
    rotor_state: str | None = None
    wind_m_s: float | None = None

    @property
    def fits(self) -> bool:
        """Whether nothing says that the model cannot meet the data."""
        return self.fit is None or self.fit.fits
