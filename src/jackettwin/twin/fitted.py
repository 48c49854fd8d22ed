"""What the update fits: modes of the records or of the twin file, and their residuals."""

from __future__ import annotations

from math import hypot

from jackettwin.errors import InputError, located
from jackettwin.twin.config import TwinConfig
from jackettwin.twin.measure import Measured, Sighting, fuse
from jackettwin.twin.result import MeasuredMode
from jackettwin.updating import Residuals, Target


def fitted_modes(
    config: TwinConfig, found: Measured | None, labels: tuple[str, ...]
) -> tuple[MeasuredMode, ...]:
    """Return the modes of the records; without records, the twin file's targets.

    Raises
    ------
    InputError
        If no mode of the records is one of the model.
    """
    return _from_targets(config, labels) if found is None else _from_records(config, found, labels)


def _from_targets(config: TwinConfig, labels: tuple[str, ...]) -> tuple[MeasuredMode, ...]:
    return tuple(
        MeasuredMode(
            mode=t.mode,
            label=labels[t.mode - 1],
            frequency_hz=t.frequency_hz,
            frequency_std_hz=t.frequency_std_hz,
            damping_ratio=t.damping_ratio,
            damping_ratio_std=t.damping_ratio_std,
            estimate=None,
            mac=None,
            fits_frequency=t.frequency_hz is not None,
            fits_damping=t.damping_ratio is not None,
        )
        for t in sorted(config.targets, key=lambda t: t.mode)
    )


def _from_records(config: TwinConfig, found: Measured, labels: tuple[str, ...]) -> tuple[MeasuredMode, ...]:
    if not found.sightings:
        raise InputError(
            "no identified mode resembles a mode of the model",
            file=config.path,
            field="records",
            value=[path.name for path in config.records],
            remedy="check the sensors' places and directions, and the structure",
        )
    return tuple(
        _measured_mode(config, mode, labels[mode - 1], seen) for mode, seen in found.sightings.items()
    )


def _measured_mode(config: TwinConfig, mode: int, label: str, seen: tuple[Sighting, ...]) -> MeasuredMode:
    f, f_std, zeta, zeta_std = fuse(seen)
    best = max(seen, key=lambda s: s.mac)
    chosen = mode in config.update.modes
    wanted = config.update.damping_of
    damped = wanted == "all" or (
        wanted != "none" and (label.startswith(wanted) if isinstance(wanted, str) else label in wanted)
    )
    return MeasuredMode(
        mode, label, f, f_std, zeta, zeta_std, best.estimate, best.mac, chosen, chosen and damped
    )


def residuals(config: TwinConfig, measured: tuple[MeasuredMode, ...]) -> Residuals:
    """Return the residuals of all measured modes; what takes no part in the fit is None."""
    errors = [config.update.model_error(m.mode) for m in measured]
    complete = all(
        (m.frequency_std_hz is not None or e.frequency > 0.0 or not m.fits_frequency)
        and (m.damping_ratio_std is not None or e.damping > 0.0 or not m.fits_damping)
        for m, e in zip(measured, errors, strict=True)
    )
    weighting = config.update.weighting
    if weighting == "covariance" and not complete:
        raise InputError(
            "covariance weighting needs a standard deviation of every target",
            file=config.path,
            field="update.weighting",
            value=weighting,
            remedy="give frequency_std_hz and damping_ratio_std, or weighting: relative",
        )
    relative = weighting == "relative" or not complete
    targets = []
    for m, error in zip(measured, errors, strict=True):
        f = m.frequency_hz if m.fits_frequency else None
        zeta = m.damping_ratio if m.fits_damping else None
        targets.append(
            Target(
                m.mode,
                f,
                None if relative or f is None else hypot(m.frequency_std_hz or 0.0, error.frequency * f),
                zeta,
                None if relative or zeta is None else hypot(m.damping_ratio_std or 0.0, error.damping * zeta),
            )
        )
    with located(file=config.path):
        return Residuals(tuple(targets), relative)
