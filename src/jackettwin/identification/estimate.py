"""Results of an identification: modes, poles, spectra and settings."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, Int64Array
from jackettwin.findings import Finding
from jackettwin.identification.mode_shapes import mpc
from jackettwin.identification.picks import Pick
from jackettwin.identification.status import ModeStatus, sentence, worse
from jackettwin.intervals import log_interval_90
from jackettwin.records import Channel


@dataclass(frozen=True)
class ModalEstimate:
    """One identified mode; unknown values are None.

    Attributes
    ----------
    frequency_hz : float
        |λ|/2π.
    damping_ratio : float
        −Re λ/|λ|.
    mode_shape : (n_channels,) complex
        1 at the largest entry, in the units of the channels. If their kinds differ, e.g.
        velocities beside accelerations, the entries are the implied accelerations.
    frequency_std_hz, damping_ratio_std : float or None
    frequency_interval_90, damping_ratio_interval_90 : (low, high) or None
        Computed on the logarithms of frequency and damping.
    damping_ratio_cov_limit : float
        Smallest coefficient of variation of the damping on this record: 1/√(2πζfT) (Au 2014).
    log_covariance : (2, 2) or None
        Covariance of (ln f, ln ζ).
    mode_shape_std : (n_channels,) or None
        Standard deviation of each entry of the shape.
    mpc, mpd_rad : float
        Modal phase collinearity (1: real shape) and mean phase deviation of the SSI shape.
    order_share : float
        Share of the model orders in which the mode appears, from the first one on.
    method : str
        Method that gave the numbers.
    unrefined : ModalEstimate or None
        The subspace estimate of a mode refined by maximum likelihood.
    cramer_rao_log_std : (2,) or None
        Smallest standard deviations of ln f and ln ζ of any unbiased method, for the fitted spectral model.
    mode_shape_unaligned : (n_channels,) complex or None
        The shape as identified, if it was rotated within the plane of a close pair.
    damping_log_likelihood : (1 + NOISE_RANGES, n_nodes) or None
        Log-likelihood of a lightly damped mode at the nodes ``LOG_ZETA`` of ``line_likelihood.py``, by ranges
        of the noise; then the interval of ζ is the likelihood's, not symmetric on the logarithm. Earlier
        versions stored (n_nodes,), over all noise.
    status : ModeStatus
        ``"ok"``, ``"damping unknown"``, ``"unchecked"``, ``"doubtful"`` or ``"not a mode: …"``.
    reasons : tuple of Finding
        Why the status is not ``"ok"``.
    """

    frequency_hz: float
    damping_ratio: float
    mode_shape: ComplexArray
    mpc: float
    mpd_rad: float
    order_share: float
    method: str = "ssi-cov"
    status: ModeStatus = ModeStatus.OK
    reasons: tuple[Finding, ...] = ()
    frequency_std_hz: float | None = None
    damping_ratio_std: float | None = None
    frequency_interval_90: tuple[float, float] | None = None
    damping_ratio_interval_90: tuple[float, float] | None = None
    log_covariance: FloatArray | None = None
    mode_shape_std: FloatArray | None = None
    damping_ratio_cov_limit: float | None = None
    unrefined: ModalEstimate | None = None
    cramer_rao_log_std: FloatArray | None = None
    mode_shape_unaligned: ComplexArray | None = None
    damping_log_likelihood: FloatArray | None = None

    @property
    def status_reason(self) -> str | None:
        """Why the status is not ``"ok"``, as one text; None if it is."""
        return sentence(self.reasons)

    @property
    def lagging(self) -> ModalEstimate:
        """The estimate whose shape tells what moves in phase with the mode from what lags behind it.

        Beside a wave's peak slow parts of other modes move in quadrature with the mode; fitted by maximum
        likelihood its shape has no phase, and small entries of it took them up: the share of a tower's foot
        in the motion of its top was 5 % too large in twelve shapes of jackets of known shape, and 1 % as
        subspaces have it.
        """
        return self.unrefined or self

    def with_covariance(self, log_covariance: FloatArray) -> ModalEstimate:
        """Return the mode with a covariance (2, 2) of (ln f, ln ζ), its standard deviations and intervals."""
        std_f, std_zeta = np.sqrt(np.diag(log_covariance))
        return replace(
            self,
            log_covariance=log_covariance,
            frequency_std_hz=float(self.frequency_hz * std_f),
            damping_ratio_std=float(self.damping_ratio * std_zeta),
            frequency_interval_90=log_interval_90(self.frequency_hz, std_f),
            damping_ratio_interval_90=log_interval_90(self.damping_ratio, std_zeta),
        )

    def flagged(self, status: ModeStatus, reason: Finding) -> ModalEstimate:
        """Return the mode with one more reason; its status is the worse of the old and the given one."""
        return replace(self, status=worse(self.status, status), reasons=(*self.reasons, reason))


@dataclass(frozen=True)
class RealPole:
    """A relaxation exp(−a t).

    Attributes
    ----------
    rate_rad_s : float
        a = −λ [1/s]; a / 2π lies inside the band of the identification.
    rate_std_rad_s : float
    rate_interval_90 : (low, high)
        Computed on the logarithm of the rate.
    mode_shape : (n_channels,) complex
        In the units of the channels, 1 at the largest entry.
    order_share : float
        Share of the model orders in which it appears, from the first one on.
    """

    rate_rad_s: float
    rate_std_rad_s: float
    rate_interval_90: tuple[float, float]
    mode_shape: ComplexArray
    order_share: float

    @property
    def time_constant_s(self) -> float:
        """1/a [s]."""
        return 1.0 / self.rate_rad_s


@dataclass(frozen=True)
class Rejected:
    """A candidate that was not accepted as a mode, and why."""

    frequency_hz: float
    damping_ratio: float | None
    reason: str
    status: ModeStatus = ModeStatus.NOISE


@dataclass(frozen=True)
class Stabilisation:
    """All poles inside the band, of all model orders: flat arrays of the same length.

    Attributes
    ----------
    order : (n_poles,) int
    frequency_hz, damping_ratio : (n_poles,)
    mode_shape : (n_poles, n_channels) complex
    stable_frequency, stable_damping, stable_shape : (n_poles,) bool
        Soft criteria towards the previous order, thesis eqs. (6.23)–(6.25).
    cluster : (n_poles,) int
        Position of the mode in ``Identification.modes``; −1 for none.
    log_covariance : (n_poles, 2, 2) or None
        Covariance of (ln f, ln ζ).
    mode_shape_std : (n_poles, n_channels) or None
    few_blocks : (n_poles, 2) or None
        Factors on the standard deviations of ln f and ln ζ of a mode where few blocks of the record carry its
        motion. ``log_covariance``, by which poles are judged, is without them.
    """

    order: Int64Array
    frequency_hz: FloatArray
    damping_ratio: FloatArray
    mode_shape: ComplexArray
    stable_frequency: BoolArray
    stable_damping: BoolArray
    stable_shape: BoolArray
    cluster: Int64Array
    log_covariance: FloatArray | None = None
    mode_shape_std: FloatArray | None = None
    few_blocks: FloatArray | None = None

    @classmethod
    def none(cls, n_channels: int) -> Stabilisation:
        """Return the diagram of a method without poles."""
        no, number, flags = np.empty(0), np.empty(0, dtype=np.int64), np.empty(0, dtype=np.bool_)
        shapes = np.empty((0, n_channels), dtype=np.complex128)
        return cls(number, no, no, shapes, flags, flags, flags, number)

    @property
    def frequency_std_hz(self) -> FloatArray | None:
        """Standard deviation of every frequency [Hz], (n_poles,)."""
        if self.log_covariance is None:
            return None
        return np.asarray(self.frequency_hz * np.sqrt(self.log_covariance[:, 0, 0]))

    @property
    def damping_ratio_std(self) -> FloatArray | None:
        """Standard deviation of every damping ratio, (n_poles,)."""
        if self.log_covariance is None:
            return None
        return np.asarray(self.damping_ratio * np.sqrt(self.log_covariance[:, 1, 1]))

    @property
    def stable(self) -> BoolArray:
        """Poles that meet all three soft criteria."""
        return self.stable_frequency & self.stable_damping & self.stable_shape

    @property
    def mpc(self) -> FloatArray:
        """Modal phase collinearity of every shape, (n_poles,)."""
        return mpc(self.mode_shape)


@dataclass(frozen=True)
class Spectrum:
    """One-sided power spectral densities by Welch's method, for plots.

    Attributes
    ----------
    frequencies_hz : (n_frequencies,)
    density : (n_channels, n_frequencies)
        In the channel's unit squared per Hz.
    singular_values : (n_channels, n_frequencies)
        Singular values of the spectral matrix of the channels scaled to unit variance [1/Hz], descending.
    """

    frequencies_hz: FloatArray
    density: FloatArray
    singular_values: FloatArray


@dataclass(frozen=True)
class ResolvedSettings:
    """Settings with which an identification was run."""

    lowest_frequency_hz: float
    highest_frequency_hz: float
    sample_rate_hz: float
    block_rows: int
    orders: tuple[int, ...]
    lag_window_s: float


_SHOWN = 8
"""Number of modes and records named when a result is printed."""


@dataclass(frozen=True)
class Identification:
    """Modes of a record, sorted by frequency, with all that is needed to judge them."""

    records: tuple[str, ...]
    channels: tuple[Channel, ...]
    modes: tuple[ModalEstimate, ...]
    rejected: tuple[Rejected, ...]
    stabilisation: Stabilisation
    spectrum: Spectrum
    settings: ResolvedSettings
    duration_s: float
    findings: tuple[Finding, ...] = ()
    """Findings on the record as it was identified, and on the modes sought in it."""
    notes: tuple[Finding, ...] = ()
    """Findings on what was done to the modes, for those who read these."""
    real_poles: tuple[RealPole, ...] = ()
    """Relaxations, if requested."""
    picks: tuple[Pick, ...] = ()
    """Candidates that were considered; ``identify(…, picks=…)`` considers the same ones again."""

    def __repr__(self) -> str:
        shown = (f"{m.frequency_hz:.4g} Hz {100 * m.damping_ratio:.2g} %" for m in self.modes[:_SHOWN])
        records = ", ".join(self.records[:_SHOWN])
        return f"Identification({records}; {len(self.modes)} modes: {', '.join(shown)})"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences of the findings that limit conclusions."""
        return tuple(str(finding) for finding in self.findings if finding.severity != "info")

    def unchecked(self, method: str) -> Identification:
        """Return the same with the modes flagged as those of a method that does not check them."""
        reason = Finding("unchecked", params={"method": method})
        return replace(self, modes=tuple(m.flagged(ModeStatus.UNCHECKED, reason) for m in self.modes))

    @property
    def without_figures(self) -> Identification:
        """The same without poles and spectrum, which only figures need: a few kilobytes."""
        n_channels = len(self.channels)
        spectrum = Spectrum(np.empty(0), np.empty((n_channels, 0)), np.empty((n_channels, 0)))
        return replace(self, stabilisation=Stabilisation.none(n_channels), spectrum=spectrum)
