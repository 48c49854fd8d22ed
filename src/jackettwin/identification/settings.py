"""Settings of an identification; unset ones follow from the data."""

from __future__ import annotations

from math import pi
from typing import Annotated, Literal

from pydantic import Field, model_validator

from jackettwin.errors import InputError
from jackettwin.files import Schema, one_of, validate
from jackettwin.identification.methods import method_names

Frequency = Annotated[float, Field(gt=0.0)]


class IdentificationSettings(Schema):
    """Settings of an identification; None means chosen from the data.

    Attributes
    ----------
    method : str
        Method: "ssi-cov", "ssi-dat", "plscf", "efdd", "bayoma", or that of an installed package.
        Only SSI-cov gives the uncertainty of every pole; the others serve for comparison.
    reference_channels : tuple of str or None
        Reference channels of the covariances (a few good ones reduce work and noise); default all.
    lowest_frequency_hz : float or None
        Lower edge of the band of interest (> 0); default 0.65 of the lowest clear spectral peak. Sample
        rate and lag window follow from it.
    highest_frequency_hz : float or None
        Upper edge of the band (above the lower edge); default 25 times the lower edge.
    sample_rate_hz : float or None
        Rate the record is decimated to; default 2.5 times the upper edge or the next possible above.
    block_rows : int or None
        Block rows of the Hankel matrix (2 to 2000): the lag window is twice as many samples. Default
        1.5 cycles of the lower edge.
    max_order : int or None
        Largest model order (2 to 400); default 60 or what the Hankel matrix supports.
    order_step : int
        Step between model orders up to 20, twice that beyond (1 to 20).
    weighting : "br" or "cva"
        Balanced realisation or canonical variate analysis.
    state_matrix : "shift" or "one-lag"
        From the shift structure of the observability matrix or from the Hankel matrix one lag later.
    frequency_tolerance, damping_tolerance, mac_tolerance : float
        Soft criteria: largest relative change of frequency and damping and largest 1 − MAC towards the
        previous order, thesis eqs. (6.23)–(6.25).
    max_damping_ratio : float
        Hard criterion: poles above it, and unstable ones, are dropped (0 to 1).
    min_mpc, max_mpd_rad : float
        Hard criteria on the complexity of a mode's shape. Off by default (0, π): SSI returns complex
        shapes for close pairs of perfectly real modes.
    max_damping_cov : float
        Hard criterion: largest standard deviation of ln ζ. A pole that fits noise has far more.
    max_damping_excess : float
        The same relative to the long-data limit 1/√(2πζfT). Above it a mode is doubtful:
        it is accepted only if the spectrum cannot be explained without it (``refine``).
    cluster_distance : float
        Poles nearer than this, |Δλ|/|λ| + 1 − MAC on average, belong to one mode.
    min_order_share : float
        Share of the model orders, from the first that contains it, in which a mode must appear (0 to 1).
    refine : bool
        Whether the modes are refined by maximum likelihood.
    blocks : int
        Number of blocks of the record whose scatter gives the uncertainty (0 to 1000); 0 disables it.
    real_poles : bool
        Whether relaxations (poles that do not oscillate) are sought too.
        Only for method ssi-cov with its uncertainty.
    """

    method: Annotated[str, one_of(method_names)] = "ssi-cov"
    reference_channels: Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    lowest_frequency_hz: Frequency | None = None
    highest_frequency_hz: Frequency | None = None
    sample_rate_hz: Frequency | None = None
    block_rows: Annotated[int, Field(ge=2, le=2000)] | None = None
    max_order: Annotated[int, Field(ge=2, le=400)] | None = None
    order_step: Annotated[int, Field(ge=1, le=20)] = 2
    weighting: Literal["br", "cva"] = "br"
    state_matrix: Literal["shift", "one-lag"] = "shift"
    frequency_tolerance: Annotated[float, Field(gt=0.0, le=1.0)] = 0.01
    damping_tolerance: Annotated[float, Field(gt=0.0, le=10.0)] = 0.05
    mac_tolerance: Annotated[float, Field(gt=0.0, le=1.0)] = 0.02
    max_damping_ratio: Annotated[float, Field(gt=0.0, le=1.0)] = 0.15
    min_mpc: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    max_mpd_rad: Annotated[float, Field(gt=0.0, le=pi)] = pi
    max_damping_cov: Annotated[float, Field(gt=0.0)] = 1.0
    max_damping_excess: Annotated[float, Field(gt=1.0)] = 6.0
    cluster_distance: Annotated[float, Field(gt=0.0, le=2.0)] = 0.1
    min_order_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.5
    blocks: Annotated[int, Field(ge=0, le=1000)] = 30
    refine: bool = True
    real_poles: bool = False

    @model_validator(mode="after")
    def _agrees_with_itself(self) -> IdentificationSettings:
        if self.weighting == "cva" and self.reference_channels is not None:
            raise InputError(
                "canonical variate analysis takes all channels as references",
                field="reference_channels",
                value=self.reference_channels,
                remedy="omit reference_channels, or set weighting to br",
            )
        low, high = self.lowest_frequency_hz, self.highest_frequency_hz
        if low is not None and high is not None and low >= high:
            raise InputError(
                "bounds reversed",
                field="highest_frequency_hz",
                value=high,
                allowed=f"> lowest_frequency_hz = {low:g}",
                remedy="swap the two frequencies",
            )
        return self

    @property
    def quick(self) -> bool:
        """Whether only poles and shapes are requested, without checks that distinguish modes from tones."""
        return self.blocks == 0 and not self.refine

    def with_method(self, method: str) -> IdentificationSettings:
        """Return the settings with another method, checked like one from a file."""
        return validate(IdentificationSettings, {**dict(self), "method": method})
