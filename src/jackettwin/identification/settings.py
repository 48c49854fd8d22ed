"""What the user may choose about an identification; what is not chosen follows from the data."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from jackettwin.errors import InputError, did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

Method = Literal["ssi-cov", "ssi-dat", "plscf", "efdd"]
METHODS: tuple[str, ...] = get_args(Method)
_CHOICES: dict[str, tuple[str, ...]] = {
    "method": METHODS,
    "weighting": ("br", "cva"),
    "state_matrix": ("shift", "one-lag"),
}
_RANGES: dict[str, tuple[float, float]] = {
    "lowest_frequency_hz": (0.0, np.inf),
    "highest_frequency_hz": (0.0, np.inf),
    "sample_rate_hz": (0.0, np.inf),
    "block_rows": (2, 2000),
    "max_order": (2, 400),
    "order_step": (1, 20),
    "frequency_tolerance": (0.0, 1.0),
    "damping_tolerance": (0.0, 10.0),
    "mac_tolerance": (0.0, 1.0),
    "max_damping_ratio": (0.0, 1.0),
    "min_mpc": (0.0, 1.0),
    "max_mpd_rad": (0.0, np.pi),
    "max_damping_cov": (0.0, np.inf),
    "max_damping_excess": (1.0, np.inf),
    "cluster_distance": (0.0, 2.0),
    "min_order_share": (0.0, 1.0),
    "blocks": (0, 1000),
}
_MAY_BE_ZERO = {"min_mpc", "min_order_share"}
_WHOLE = {"block_rows", "max_order", "order_step", "blocks"}
_SWITCHES = {"refine", "real_poles"}


@dataclass(frozen=True)
class IdentificationSettings:
    """Choices of an identification; None means chosen from the data.

    Attributes
    ----------
    method : "ssi-cov", "ssi-dat", "plscf" or "efdd"
        How poles are found. Only SSI-cov states the uncertainty of every pole; the others are there to
        compare with.
    reference_channels : tuple of str or None
        Channels whose past the covariances are taken with (a few good ones: less work, less noise);
        default all.
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
        The same in units of what a record can tell at best, 1/√(2πζfT). Above it a mode is doubtful: it
        counts if the spectrum cannot be explained without it (``refine``), else it is dropped.
    cluster_distance : float
        Poles nearer than this, |Δλ|/|λ| + 1 − MAC on average, belong to one mode.
    min_order_share : float
        A mode must appear in this share of the model orders, from the first that holds it on (0 to 1).
    refine : bool
        Whether the modes are refined by maximum likelihood.
    blocks : int
        Blocks of the record whose scatter gives the uncertainty (0 to 1000); 0 leaves it out.
    real_poles : bool
        Whether relaxations (poles that do not oscillate) are looked for as well. Method ssi-cov with
        its uncertainty only.
    """

    method: Method = "ssi-cov"
    reference_channels: tuple[str, ...] | None = None
    lowest_frequency_hz: float | None = None
    highest_frequency_hz: float | None = None
    sample_rate_hz: float | None = None
    block_rows: int | None = None
    max_order: int | None = None
    order_step: int = 2
    weighting: Literal["br", "cva"] = "br"
    state_matrix: Literal["shift", "one-lag"] = "shift"
    frequency_tolerance: float = 0.01
    damping_tolerance: float = 0.05
    mac_tolerance: float = 0.02
    max_damping_ratio: float = 0.15
    min_mpc: float = 0.0
    max_mpd_rad: float = float(np.pi)
    max_damping_cov: float = 1.0
    max_damping_excess: float = 6.0
    cluster_distance: float = 0.1
    min_order_share: float = 0.5
    blocks: int = 30
    refine: bool = True
    real_poles: bool = False

    def __post_init__(self) -> None:
        for item in fields(self):
            _check(item.name, getattr(self, item.name), optional=item.default is None)
        if self.weighting == "cva" and self.reference_channels is not None:
            raise InputError(
                "canonical variate analysis takes all channels as references",
                field="reference_channels",
                value=self.reference_channels,
                remedy="leave reference_channels out, or set weighting to br",
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

    def with_method(self, method: str) -> IdentificationSettings:
        """Return the settings with another method, checked like one from a file."""
        return self.from_mapping({**vars(self), "method": method})

    @classmethod
    def from_mapping(cls, values: Mapping[str, Any]) -> IdentificationSettings:
        """Build settings from the keys of a YAML mapping.

        Raises
        ------
        InputError
            If a key is unknown or a value is of the wrong type or outside its range.
        """
        known = [item.name for item in fields(cls)]
        for key in values:
            if key not in known:
                raise InputError(
                    "unknown key",
                    field=str(key),
                    allowed=", ".join(known),
                    remedy=did_you_mean(str(key), known),
                )
        listed = values.get("reference_channels")
        names = {"reference_channels": tuple(listed)} if isinstance(listed, list) else {}
        return cls(**{**values, **names})


def _check_names(field: str, value: object) -> None:
    if not isinstance(value, tuple) or not value or not all(isinstance(name, str) for name in value):
        raise InputError("must be a list of names", field=field, value=value, allowed="channel names")


def _check(name: str, value: object, *, optional: bool) -> None:
    if value is None and optional:
        return
    if name in _SWITCHES:
        if not isinstance(value, bool):
            raise InputError("must be a switch", field=name, value=value, allowed="true or false")
        return
    if name == "reference_channels":
        _check_names(name, value)
        return
    if name in _CHOICES:
        if value not in _CHOICES[name]:
            raise InputError("unknown choice", field=name, value=value, allowed=" or ".join(_CHOICES[name]))
        return
    low, high = _RANGES[name]
    kind: tuple[type, ...] = (int, np.integer) if name in _WHOLE else (int, float, np.integer, np.floating)
    right_type = isinstance(value, kind) and not isinstance(value, bool)
    open_below = name not in _WHOLE | _MAY_BE_ZERO
    inside = right_type and low <= value <= high and np.isfinite(value)  # type: ignore[operator,call-overload]
    if not inside or (open_below and value == low):
        what = "a whole number" if name in _WHOLE else "a number"
        raise InputError(
            f"must be {what} in its range",
            field=name,
            value=value,
            allowed=f"{low:g} to {high:g}" if np.isfinite(high) else f"> {low:g}",
        )
