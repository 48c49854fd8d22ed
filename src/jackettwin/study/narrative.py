"""What to beware of, in sentences."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot
from typing import Any

from jackettwin.study.measure import Measured
from jackettwin.study.measurements import MeasuredMode
from jackettwin.study.result import unpaired_finding
from jackettwin.twin import TwinConfig, stated_model
from jackettwin.updating import Update


def without_relaxation(laws: tuple[str, ...]) -> tuple[str, ...]:
    """Return why laws were left out of an update to real poles."""
    return tuple(f"{law}: left out, a structure on it has no real poles." for law in laws)


def cautions(
    config: TwinConfig,
    found: Measured | None,
    measured: tuple[MeasuredMode, ...],
    updates: tuple[Update, ...],
    labels: tuple[str, ...] = (),
) -> tuple[str, ...]:
    """Return what the reader should beware of; ``labels`` are those of the model's numbered modes."""
    lines = []
    if config.assigned:
        ours = [m for m in measured if m.mode in config.assigned]
        pairs = ", ".join(f"{m.frequency_hz:.4g} Hz is {m.label} (mode {m.mode})" for m in ours)
        lines.append(f"Frequencies without a name were taken for the nearest modes: {pairs}.")
    if found is not None:
        lines += [f"left out: {one.problem}" for one in found.failed]
        lines += [str(finding) for finding in found.findings]
        lines += [
            *_of_another_model(config, found),
            *_of_records(found),
            *_strangers(found, labels, every=not updates),
        ]
        lines += _wind_without_rotor(config, found, measured)
    lines += [*_unweighted(config, measured, updates), *_rotor_without_wind(config, updates)]
    for u in updates:
        if u.best.locked_damper:
            lines.append(
                f"{u.law}: every solution locks a damper; its undamped structure is more than 5 % off."
            )
        if u.best.at_bound:
            lines.append(f"{u.law}: {', '.join(u.best.at_bound)} ended on a bound.")
        lines += [
            f"{u.law}: {m.label} misses its frequency by {100 * (f / m.frequency_hz - 1.0):+.1f} %"
            f"{'.' if m.fits_frequency else '; it was not fitted: the measured one may be another.'}"
            for m, f in zip(measured, u.modes.frequency_hz, strict=True)
            if m.frequency_hz is not None and _misses(config, m, float(f))
        ]
    return tuple(lines)


def _of_another_model(config: TwinConfig, found: Measured) -> list[str]:
    """Return where records state that they come from a structure modelled otherwise than the twin's."""
    ours = config.modelling()
    differences: dict[str, list[str]] = {}
    for seen in found.observations:
        for key, value in stated_model(seen.truth).items():
            if value != ours[key]:
                text = f"{key} {_word(value)}; the twin has {_word(ours[key])}, which moves its frequencies"
                differences.setdefault(f"{text}: write {key}: {_word(value)}, or leave it out", []).append(
                    seen.name
                )
    return [f"{', '.join(names)}: simulated with {text}." for text, names in differences.items()]


def _word(value: object) -> str:
    """Return a value as YAML has it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _of_records(found: Measured) -> list[str]:
    """Return what was found of the records, each sentence once with all that it holds of."""
    places: dict[str, list[str]] = {}
    for seen in found.observations:
        said = [(_place(seen.name, f), f["text"]) for f in seen.quality.get("findings", ())]
        said += [(seen.name, text) for text in seen.identification.warnings]
        said += [(seen.name, str(f)) for f in seen.findings if f.code == "sensor_against_model"]
        for place, text in said:
            places.setdefault(text, []).append(place)
    return [f"{', '.join(dict.fromkeys(where))}: {text}" for text, where in places.items()]


def _place(record: str, finding: Mapping[str, Any]) -> str:
    """Return where a finding was made: a record, or a channel of it."""
    return f"{record}, {finding['subject']}" if finding["subject"] else record


def _wind_without_rotor(config: TwinConfig, found: Measured, measured: tuple[MeasuredMode, ...]) -> list[str]:
    winds = [one.wind_m_s for one in found.observations if one.wind_m_s]
    fitted = [m.label for m in measured if m.fits_damping]
    if config.update.dashpots or not winds or not fitted:
        return []
    return [
        f"The records were taken in wind, up to {max(winds):.3g} m/s, and the twin has no rotor: its "
        f"damping of {', '.join(fitted)} is attributed to the supports, whose own is then an upper limit. "
        "Give update.rotor or update.dashpots."
    ]


def _unweighted(
    config: TwinConfig, measured: tuple[MeasuredMode, ...], updates: tuple[Update, ...]
) -> list[str]:
    """Say that a few missing standard deviations took the weight, and all intervals, from the other data."""
    if config.update.weighting != "auto" or all(u.problem.weighted for u in updates):
        return []
    stds = [(f"f{m.mode}", m.frequency_std_hz) for m in measured if m.fits_frequency]
    stds += [(f"ζ{m.mode}", m.damping_ratio_std) for m in measured if m.fits_damping]
    stds += [(f"real pole {r.rate_rad_s:.3g} 1/s", r.rate_std_rad_s) for r in config.relaxations]
    without = [name for name, std in stds if std is None]
    if not without or len(without) == len(stds):
        return []
    return [
        f"{', '.join(without)} without a standard deviation: all data count by their relative error alone, "
        "damping as much as frequency, and there are no intervals. State it, or update.model_error."
    ]


def _rotor_without_wind(config: TwinConfig, updates: tuple[Update, ...]) -> list[str]:
    known = all(u.problem.parameters[i].median is not None for u in updates for i in _dashpots(config, u))
    if config.update.rotor is None or known:
        return []
    return [
        "The wind is not known, so that the rotor's geometry gives the dashpots' pattern and no prior. "
        "Give update.wind_speed_m_s."
    ]


def _dashpots(config: TwinConfig, u: Update) -> list[int]:
    return [i for i, p in enumerate(u.problem.parameters) if p.name in config.update.dashpots]


def _strangers(found: Measured, labels: tuple[str, ...], *, every: bool) -> list[str]:
    """Return a line for each mode that is ``ok``, or for every one, without a counterpart in the model."""
    reasons = (
        (one.name, unpaired_finding(mode, against, labels))
        for one in found.observations
        for mode, against in zip(one.identification.modes, one.held, strict=False)
        if every or mode.status == "ok"
    )
    return [f"{name}: no counterpart in the model for {why}" for name, why in reasons if why is not None]


def _misses(config: TwinConfig, m: MeasuredMode, f: float) -> bool:
    """Return whether a fitted frequency is off by 1 % and three standard deviations, any by a tenth."""
    if m.frequency_hz is None:
        return False
    std = hypot(m.frequency_std_hz or 0.0, config.update.model_error(m.mode).frequency * m.frequency_hz)
    least = 0.01 if m.fits_frequency else 0.1
    return abs(f - m.frequency_hz) > max(3.0 * std, least * m.frequency_hz)
