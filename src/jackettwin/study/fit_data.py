"""Data of the update: modes of the records or of the twin file, and their residuals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, did_you_mean, located, require
from jackettwin.identification import ModalEstimate
from jackettwin.study.measure import mean_target
from jackettwin.study.measurements import MeasuredMode, MeasuredRelaxation
from jackettwin.twin import ALL, TwinConfig, TwinState
from jackettwin.twin.config import ModelError, Weights
from jackettwin.twin.targets_table import LEAST_SHARE, MOST_SHARE
from jackettwin.updating import Residuals, Target

_FAR_ABOVE = 3.0
"""Ratio to the model's highest numbered mode above which a target must be in another unit."""
_FITS = 0.2
"""Relative distance of a plausible mode below its frequency on rigid feet; above it, half of this."""
_STIFFEST = 1.5
"""Ratio to its mode on pinned feet above which a target belongs to another mode: supports only soften."""


def target_modes(
    config: TwinConfig, labels: tuple[str, ...], *, pinned_hz: FloatArray
) -> tuple[MeasuredMode, ...]:
    """Return the target modes of the twin file.

    Parameters
    ----------
    labels : of the model's numbered modes
    pinned_hz : of the model's numbered modes

    Raises
    ------
    InputError
        If the model has no such mode, or the target is far above it.
    """
    _check_labels(config, labels)
    most = _FAR_ABOVE * float(pinned_hz.max())
    for place in range(len(config.targets)):
        _check_target(config, place, labels, pinned_hz, most)
    for given in config.relaxations:
        if given.rate_rad_s > 2.0 * pi * most:
            raise InputError(
                "the relaxation rate is far above the frequencies of the model's modes",
                file=config.path,
                field="targets.rate_rad_s",
                value=given.rate_rad_s,
                allowed=f"up to {2.0 * pi * most:.3g} rad/s here",
                remedy="give rad/s: one over the relaxation time in seconds",
            )
    return tuple(
        _measured_mode(config, t, labels[t.mode - 1], None)
        for t in sorted(config.targets, key=lambda t: t.mode)
    )


def _check_target(
    config: TwinConfig, place: int, labels: tuple[str, ...], pinned_hz: FloatArray, most_hz: float
) -> None:
    """Refuse a target that no mode of the model, on any supports, can have.

    Raises
    ------
    InputError
        Names the target, and the mode that it fits if there is one.
    """
    target = config.targets[place]
    if target.mode > len(labels):
        raise InputError(
            "the structure has fewer modes",
            file=config.path,
            field=f"targets.{place}.mode",
            value=target.mode,
            allowed=f"1 to {len(labels)}",
            remedy="leave the higher ones out, or divide its members (subdivide)",
        )
    if target.frequency_hz is None:
        return
    if target.frequency_hz > most_hz:
        raise InputError(
            "is far above the modes of the model",
            file=config.path,
            field=f"targets.{place}.frequency_hz",
            value=target.frequency_hz,
            allowed=f"up to {most_hz:.3g} Hz here",
            remedy="give Hz, not mHz, rad/s or cycles a minute",
        )
    _refuse_misnumbered(config, place, target.frequency_hz / pinned_hz, labels, pinned_hz)
    own = float(pinned_hz[target.mode - 1])
    if target.frequency_hz > _STIFFEST * own:
        raise InputError(
            "no support stiffness gives this mode so high a frequency",
            file=config.path,
            field=f"targets.{place}.frequency_hz",
            value=target.frequency_hz,
            allowed=f"up to {own:.4g} Hz, mode {target.mode} ({labels[target.mode - 1]}) on rigid feet",
            remedy="check the mode's number (jackettwin modes lists them), the unit, and the structure",
        )


def _refuse_misnumbered(
    config: TwinConfig, place: int, share: FloatArray, labels: tuple[str, ...], pinned_hz: FloatArray
) -> None:
    """Refuse a target far from its own mode where the value fits another mode that is not a target.

    Parameters
    ----------
    share : of the target's frequency in that of each mode on rigid feet

    Raises
    ------
    InputError
        Names the mode that the value fits.
    """
    target = config.targets[place]
    own = float(share[target.mode - 1])
    if LEAST_SHARE <= own <= MOST_SHARE:
        return
    taken = {t.mode for t in config.targets}
    fitting = [i for i, s in enumerate(share) if i + 1 not in taken and 1.0 - _FITS <= s <= 1.0 + 0.5 * _FITS]
    if fitting:
        best = min(fitting, key=lambda i: abs(share[i] - 1.0))
        raise InputError(
            "the frequency is far from that of its mode and fits another mode",
            file=config.path,
            field=f"targets.{place}.frequency_hz",
            value=target.frequency_hz,
            allowed=f"about {pinned_hz[target.mode - 1]:.4g} Hz or less for mode {target.mode} "
            f"({labels[target.mode - 1]}), on rigid feet",
            remedy=f"mode {best + 1} ({labels[best]}) has {pinned_hz[best]:.4g} Hz on rigid feet: "
            f"write mode: {best + 1}",
        )


def updating(config: TwinConfig, state: TwinState) -> TwinState:
    """Return the state of the records that may update the supports; the other records are tracked only.

    Raises
    ------
    InputError
        If no record may.
    """
    rule = config.operation
    if rule.updates is None:
        return state
    seen = sorted({name.partition(", ")[0] for day in state.days.values() for name in day.operations})
    used = state.of_operations(rule.may_update)
    if seen and ALL not in used.totals:
        raise InputError(
            "no record is in a state of operation that may update the supports",
            file=config.path,
            field="operation.updates",
            value=list(rule.updates),
            allowed=", ".join(seen),
            remedy="add a state, send the conditions, or bring records of such a state",
        )
    return used


def recorded_modes(
    config: TwinConfig,
    state: TwinState,
    labels: tuple[str, ...],
    clearest: Callable[[int], tuple[ModalEstimate, float] | None] = lambda _: None,
) -> tuple[MeasuredMode, ...]:
    """Return the modes of the records, fused.

    Parameters
    ----------
    clearest : callable, optional
        Gives a mode as identified from the record that is most similar to the model, and the MAC.

    Raises
    ------
    InputError
        If none of the records' modes is paired with a mode of the model.
    """
    _check_labels(config, labels)
    totals = state.totals.get(ALL)
    if totals is None or not totals.modes:
        raise InputError(
            "no identified mode resembles a mode of the model",
            file=config.path,
            field="records",
            value=[path.name for path in config.records],
            remedy="check the sensors' places and directions, and the structure",
        )
    return tuple(
        _measured_mode(config, mean_target(mode, total), labels[mode - 1], clearest(mode))
        for mode, total in totals.modes.items()
    )


def _check_labels(config: TwinConfig, labels: tuple[str, ...]) -> None:
    """Refuse labels in ``update.damping_of`` that no mode of the model has."""
    wanted = config.update.damping_of
    for label in wanted if isinstance(wanted, tuple) else ():
        if label not in labels:
            raise InputError(
                "no mode of the structure has this label",
                file=config.path,
                field="update.damping_of",
                value=label,
                allowed=", ".join(labels),
                remedy=did_you_mean(label, labels),
            )


def _measured_mode(
    config: TwinConfig, mean: Target, label: str, clearest: tuple[ModalEstimate, float] | None
) -> MeasuredMode:
    """Return a measured mode, and which of its values the update fits."""
    estimate, mac = clearest or (None, None)
    chosen = mean.mode in config.update.modes
    return MeasuredMode(
        mode=mean.mode,
        label=label,
        frequency_hz=mean.frequency_hz,
        frequency_std_hz=mean.frequency_std_hz,
        damping_ratio=mean.damping_ratio,
        damping_ratio_std=mean.damping_ratio_std,
        correlation=mean.correlation,
        estimate=estimate,
        mac=mac,
        fits_frequency=chosen and mean.frequency_hz is not None,
        fits_damping=chosen and mean.damping_ratio is not None and config.update.fits_damping(label),
    )


def residuals(
    config: TwinConfig, measured: tuple[MeasuredMode, ...], relaxations: tuple[MeasuredRelaxation, ...] = ()
) -> Residuals:
    """Return the residuals of all measured modes; None for values that are not fitted.

    They are relative if any datum, including relaxations, has no standard deviation.
    """
    errors = [config.update.model_error(m.mode) for m in measured]
    complete = all(
        (m.frequency_std_hz is not None or e.frequency > 0.0 or not m.fits_frequency)
        and (m.damping_ratio_std is not None or e.damping > 0.0 or not m.fits_damping)
        for m, e in zip(measured, errors, strict=True)
    )
    complete &= all(r.rate_std_rad_s is not None or config.update.rate_error > 0.0 for r in relaxations)
    weighting = config.update.weighting
    if weighting == "covariance" and not complete:
        raise InputError(
            "covariance weighting needs a standard deviation of every target",
            file=config.path,
            field="update.weighting",
            value=weighting,
            remedy="give frequency_std_hz, damping_ratio_std and rate_std_rad_s, or weighting: relative",
        )
    relative = weighting == "relative" or not complete
    require(
        relative or config.update.weights is None,
        "weights apply to the relative cost (8.4) only; these data are weighted by standard deviations",
        file=config.path,
        field="update.weights",
        remedy="leave weights out, or set weighting: relative",
    )
    with located(file=config.path):
        targets = [_target(m, error, relative) for m, error in zip(measured, errors, strict=True)]
        return Residuals(tuple(_weighed(t, config.update.weights) for t in targets), relative)


def _weighed(target: Target, weights: Weights | None) -> Target:
    """Return a target with the weights of its mode; a value of weight zero is not fitted."""
    if weights is None:
        return target
    f, zeta = weights.of_mode(target.mode)
    return replace(
        target,
        frequency_hz=target.frequency_hz if f > 0.0 else None,
        damping_ratio=target.damping_ratio if zeta > 0.0 else None,
        frequency_weight=f or 1.0,
        damping_weight=zeta or 1.0,
    )


def _target(m: MeasuredMode, error: ModelError, relative: bool) -> Target:
    """Return the fitted data of a mode; a stated model error replaces an unknown standard deviation."""
    f = m.frequency_hz if m.fits_frequency else None
    zeta = m.damping_ratio if m.fits_damping else None
    if relative:
        return Target(m.mode, f, None, zeta, None)
    f_std = None if f is None else m.frequency_std_hz or error.frequency * f
    zeta_std = None if zeta is None else m.damping_ratio_std or error.damping * zeta
    both = m.frequency_std_hz and m.damping_ratio_std and f_std and zeta_std
    return Target(m.mode, f, f_std, zeta, zeta_std, m.correlation if both else 0.0)
