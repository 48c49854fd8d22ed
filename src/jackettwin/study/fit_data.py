"""What the update fits: modes of the records or of the twin file, and their residuals."""

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
"""A target this many times above the model's highest numbered mode is in another unit."""
_FITS = 0.2
"""A mode fits that lies less than this below its frequency on rigid feet, or half of it above."""
_STIFFEST = 1.5
"""One this many times above its own mode on pinned feet is another mode's: supports only soften."""


def target_modes(
    config: TwinConfig, labels: tuple[str, ...], *, pinned_hz: FloatArray
) -> tuple[MeasuredMode, ...]:
    """Return the modes that the twin file gives.

    Parameters
    ----------
    labels : of the model's numbered modes
    pinned_hz : of the model's numbered modes

    Raises
    ------
    InputError
        If a target is none of them, or far above.
    """
    _check_labels(config, labels)
    most = _FAR_ABOVE * float(pinned_hz.max())
    for place, target in enumerate(config.targets):
        if target.mode > len(labels):
            raise InputError(
                "the structure has fewer modes",
                file=config.path,
                field=f"targets.{place}.mode",
                value=target.mode,
                allowed=f"1 to {len(labels)}",
                remedy="leave the higher ones out, or divide its members (subdivide)",
            )
        if (target.frequency_hz or 0.0) > most:
            raise InputError(
                "is far above the modes of the model",
                file=config.path,
                field=f"targets.{place}.frequency_hz",
                value=target.frequency_hz,
                allowed=f"up to {most:.3g} Hz here",
                remedy="give Hz, not mHz, rad/s or cycles a minute",
            )
        _refuse_misnumbered(config, place, labels, pinned_hz)
        own = float(pinned_hz[target.mode - 1])
        if (target.frequency_hz or 0.0) > _STIFFEST * own:
            raise InputError(
                "no support lifts this mode so high",
                file=config.path,
                field=f"targets.{place}.frequency_hz",
                value=target.frequency_hz,
                allowed=f"up to {own:.4g} Hz, mode {target.mode} ({labels[target.mode - 1]}) on rigid feet",
                remedy="check the mode's number (jackettwin modes lists them), the unit, and the structure",
            )
    for given in config.relaxations:
        if given.rate_rad_s > 2.0 * pi * most:
            raise InputError(
                "relaxes far faster than the modes of the model oscillate",
                file=config.path,
                field="targets.rate_rad_s",
                value=given.rate_rad_s,
                allowed=f"up to {2.0 * pi * most:.3g} rad/s here",
                remedy="give rad/s: one over the relaxation time in seconds",
            )
    return tuple(
        MeasuredMode(
            mode=t.mode,
            label=labels[t.mode - 1],
            frequency_hz=t.frequency_hz,
            frequency_std_hz=t.frequency_std_hz,
            damping_ratio=t.damping_ratio,
            damping_ratio_std=t.damping_ratio_std,
            correlation=t.correlation,
            estimate=None,
            mac=None,
            fits_frequency=t.frequency_hz is not None and t.mode in config.update.modes,
            fits_damping=t.damping_ratio is not None
            and t.mode in config.update.modes
            and config.update.fits_damping(labels[t.mode - 1]),
        )
        for t in sorted(config.targets, key=lambda t: t.mode)
    )


def _refuse_misnumbered(
    config: TwinConfig, place: int, labels: tuple[str, ...], pinned_hz: FloatArray
) -> None:
    """Refuse a target far from its own mode where another mode, not among the targets, would fit.

    Raises
    ------
    InputError
        Names the mode that fits.
    """
    target = config.targets[place]
    if target.frequency_hz is None:
        return
    share = target.frequency_hz / pinned_hz
    own = float(share[target.mode - 1])
    if LEAST_SHARE <= own <= MOST_SHARE:
        return
    taken = {t.mode for t in config.targets}
    fitting = [i for i, s in enumerate(share) if i + 1 not in taken and 1.0 - _FITS <= s <= 1.0 + 0.5 * _FITS]
    if fitting:
        best = min(fitting, key=lambda i: abs(share[i] - 1.0))
        raise InputError(
            "the frequency is far from its mode's, and another mode's fits",
            file=config.path,
            field=f"targets.{place}.frequency_hz",
            value=target.frequency_hz,
            allowed=f"about {pinned_hz[target.mode - 1]:.4g} Hz or less for mode {target.mode} "
            f"({labels[target.mode - 1]}), on rigid feet",
            remedy=f"mode {best + 1} ({labels[best]}) has {pinned_hz[best]:.4g} Hz on rigid feet: "
            f"write mode: {best + 1}",
        )


def updating(config: TwinConfig, state: TwinState) -> TwinState:
    """Return what is known from the records that may update the supports; the others are tracked only.

    Raises
    ------
    InputError
        If there is none.
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
        Gives a mode as the record shows it that is most like the model, and the MAC.

    Raises
    ------
    InputError
        If none of the records' modes is one of the model.
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
        fits_frequency=chosen,
        fits_damping=chosen and config.update.fits_damping(label),
    )


def residuals(
    config: TwinConfig, measured: tuple[MeasuredMode, ...], relaxations: tuple[MeasuredRelaxation, ...] = ()
) -> Residuals:
    """Return the residuals of all measured modes; what takes no part in the fit is None.

    They are relative if any of the data, relaxations among them, has no standard deviation.
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
        "weights are of the relative cost (8.4); standard deviations weigh these data",
        file=config.path,
        field="update.weights",
        remedy="leave weights out, or set weighting: relative",
    )
    with located(file=config.path):
        targets = [_target(m, error, relative) for m, error in zip(measured, errors, strict=True)]
        return Residuals(tuple(_weighed(t, config.update.weights) for t in targets), relative)


def _weighed(target: Target, weights: Weights | None) -> Target:
    """Return a target with the weights of its mode; a value of weight zero takes no part."""
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
    """Return what is fitted of a mode; a stated error of the model stands in for an unknown deviation."""
    f = m.frequency_hz if m.fits_frequency else None
    zeta = m.damping_ratio if m.fits_damping else None
    if relative:
        return Target(m.mode, f, None, zeta, None)
    f_std = None if f is None else m.frequency_std_hz or error.frequency * f
    zeta_std = None if zeta is None else m.damping_ratio_std or error.damping * zeta
    both = m.frequency_std_hz and m.damping_ratio_std and f_std and zeta_std
    return Target(m.mode, f, f_std, zeta, zeta_std, m.correlation if both else 0.0)
