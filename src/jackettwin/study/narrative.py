"""Assumptions and warnings of a run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import expm1, hypot
from typing import Any

from jackettwin.caveats import TOLERANCES, Assumption
from jackettwin.errors import InputError
from jackettwin.soil import MUDLINE
from jackettwin.structure import Rayleigh
from jackettwin.study.measure import Measured
from jackettwin.study.measurements import MeasuredMode, MeasuredRelaxation
from jackettwin.study.result import unpaired_finding
from jackettwin.study.scrutiny import Scrutiny
from jackettwin.twin import TwinConfig, stated_model
from jackettwin.updating import Update

_MODES = "Modes are numbered by their order on pinned feet and tracked by mass-weighted MAC."


def tolerance_assumptions(
    config: TwinConfig, s: Scrutiny | None, parameters: Iterable[str]
) -> tuple[Assumption, ...]:
    """Return the tolerances of a twin: the open ones by their effect on the result, then the closed ones.

    Parameters
    ----------
    s : of the law whose parameters are named; None without a posterior
    """
    names = tuple(parameters)
    found = () if s is None else s.influences
    moving = sorted(found, key=lambda one: -float(abs(one.effect).max(initial=0.0)))
    still_open = (
        Assumption(
            f"{TOLERANCES}{one.tolerance.name}",
            f"{one.tolerance.words}, known to {_size(one.tolerance.std, one.tolerance.unit)}",
            confirmed=False,
            moves={name: expm1(float(e)) for name, e in zip(names, one.effect, strict=True)},
            settled_by=one.tolerance.settled_by,
        )
        for one in moving
    )
    settled = (
        Assumption(f"{TOLERANCES}{name}", f"{name}: weighed, measured or inspected", confirmed=True)
        for name, std in config.tolerances.given.items()
        if std == 0.0
    )
    return (*still_open, *settled)


def _size(std: float, unit: str) -> str:
    """Return one standard deviation in words."""
    size = f"{100.0 * std:.3g} %" if unit == "-" else f"{std:.3g} {unit}"
    return f"{size} (σ)"


def modelling_assumptions(
    config: TwinConfig,
    measured: tuple[MeasuredMode, ...],
    relaxations: tuple[MeasuredRelaxation, ...],
    wind: float | None,
) -> tuple[Assumption, ...]:
    """Return the choices of modelling of a run; dashpots are stated at the wind [m/s]."""
    how = config.modelling()
    theory = {"euler-bernoulli": "Euler–Bernoulli", "timoshenko": "Timoshenko"}[str(how["beam"])]
    rotary = how["rotary_inertia"] or theory == "Timoshenko"
    beams = (
        f"{theory} beams, {'with' if rotary else 'without'} rotary inertia; "
        + ("gravity's P-Δ stiffness is on" if config.gravity else "no gravity stiffness")
        + (f"; {', '.join(config.of_records)}: as the records state." if config.of_records else ".")
    )
    fitted = ", ".join(filter(None, [*map(_fitted, measured), *map(_relaxed, relaxations)]))
    found = [
        Assumption("beams", beams),
        Assumption("steel_damping", _steel(config)),
        Assumption("support", f"The support law {_acts_on(config)} (tie: {config.tie})."),
        Assumption("modes", _MODES),
        Assumption("fitted", f"Fitted: {fitted}."),
    ]
    if relaxations and config.update.rate_error:
        of_rates = f"Model error of relaxations: {100 * config.update.rate_error:.3g} % on the rate."
        found.append(Assumption("model_error", of_rates))
    for e in (e for e in config.update.model_errors if e.modes):
        of_modes = (
            f"Model error of modes {', '.join(map(str, e.modes))}: {100 * e.frequency:.3g} % on frequency, "
            f"{100 * e.damping:.3g} % on damping."
        )
        found.append(Assumption("model_error", of_modes))
    return (*found, *_beside_law(config, wind))


def _beside_law(config: TwinConfig, wind: float | None) -> list[Assumption]:
    """Return what is assumed of rotor, water, further parameters and the fusion of records."""
    found = []
    if config.update.dashpots:
        shape = "with the pattern of its blades" if config.update.rotor else "on the tower top"
        works = config.update.rotor_state == "operating"
        grows = "changing with it as computed, pitch and speed held" if works else "proportional to it"
        where = "" if wind is None else f", stated at a wind of {wind:.3g} m/s and {grows}"
        state = "at work" if works else "parked"
        rotor = f"The rotor is {state}: dashpots {', '.join(config.update.dashpots)} {shape}{where}."
        if works and config.update.rotor:
            rotor += " Its stiffness at work is part of the structure (tolerance rotor_at_work)."
        found.append(Assumption("rotor", rotor))
    if config.update.water:
        water = (
            f"Factors of the water are updated: {', '.join(config.update.water)}. Drag is linear, in one "
            "mean sea for all records; radiation damping is neglected."
        )
        found.append(Assumption("water", water))
    if config.update.parameters:
        further = f"Also updated, besides the law: {', '.join(config.update.parameters)}."
        found.append(Assumption("parameters", further))
    if len(config.records) > 1:
        fused = (
            f"{len(config.records)} records are fused as precision-weighted means of logarithms; the "
            "scatter between records is included."
        )
        found.append(Assumption("records", fused))
    return found


def _steel(config: TwinConfig) -> str:
    """Return the sentence on the steel's damping."""
    said = []
    if config.rayleigh != Rayleigh():
        said.append(f"Rayleigh, {100 * config.rayleigh_ratio:.3g} % at its minimum")
    if config.mode_damping:
        ratios = sorted(config.mode_damping.items())
        said.append("by mode, " + ", ".join(f"ζ{mode} {100 * ratio:.3g} %" for mode, ratio in ratios))
    return f"Steel damping: {'; '.join(said)}; on the structure only." if said else "The steel is undamped."


def _acts_on(config: TwinConfig) -> str:
    nodes = config.structure.reaction_nodes
    of = f"of {len(nodes)} reaction nodes"
    if config.tie == MUDLINE:
        tied = (
            f"{nodes[0]}, to which all feet are rigidly tied" if nodes == (MUDLINE,) else f"foot {nodes[0]}"
        )
        what = "sway and rocking" if config.heads is None else "the 6×6 stiffness"
        return f"acts on {what} of {tied}"
    return (
        f"acts on the three translations {of}" if config.heads is None else f"scales the 6×6 pile heads {of}"
    )


def _fitted(m: MeasuredMode) -> str:
    what = [word for word, flag in (("f", m.fits_frequency), ("ζ", m.fits_damping)) if flag]
    return f"{m.label} ({' and '.join(what)})" if what else ""


def _relaxed(r: MeasuredRelaxation) -> str:
    return f"{r.name} (relaxation at {r.rate_rad_s:.3g} rad/s)"


def without_relaxation(laws: tuple[str, ...]) -> tuple[str, ...]:
    """Return why laws were omitted from an update to real poles."""
    return tuple(f"{law}: omitted, as a structure on it has no real poles." for law in laws)


def without_fit(unfit: Mapping[str, InputError]) -> tuple[str, ...]:
    """Return why laws were omitted that no start of their search could fit."""
    return tuple(f"{law}: omitted: {error.problem}." for law, error in unfit.items())


def cautions(
    config: TwinConfig,
    found: Measured | None,
    measured: tuple[MeasuredMode, ...],
    updates: tuple[Update, ...],
    labels: tuple[str, ...] = (),
) -> tuple[str, ...]:
    """Return the warnings to the reader; ``labels`` are those of the model's numbered modes."""
    lines = []
    if config.assigned:
        ours = [m for m in measured if m.mode in config.assigned]
        pairs = ", ".join(f"{m.frequency_hz:.4g} Hz is {m.label} (mode {m.mode})" for m in ours)
        lines.append(f"Frequencies without a mode's name were assigned to the nearest modes: {pairs}.")
    if found is not None:
        lines += [f"left out: {one.problem}" for one in found.failed]
        lines += [str(finding) for finding in found.findings]
        lines += [
            *_of_another_model(config, found),
            *_of_records(found),
            *_strangers(found, labels, every=not updates),
        ]
        lines += _wind_without_rotor(config, found, measured)
    lines += _open_dashpots(config, measured, updates)
    lines += [*_unweighted(config, measured, updates), *_rotor_without_wind(config, updates)]
    for u in updates:
        if u.best.locked_damper:
            lines.append(
                f"{u.law}: in every solution a damper locks, and frequencies of the undamped structure "
                "differ by more than 5 %."
            )
        if u.best.at_bound:
            lines.append(f"{u.law}: {', '.join(u.best.at_bound)} lies on a bound.")
        lines += [
            f"{u.law}: {m.label} misses its frequency by {100 * (f / m.frequency_hz - 1.0):+.1f} %"
            f"{'.' if m.fits_frequency else '; it was not fitted: the measured mode may be another.'}"
            for m, f in zip(measured, u.central_hz, strict=True)
            if m.frequency_hz is not None and _misses(config, m, float(f))
        ]
    return tuple(lines)


def _of_another_model(config: TwinConfig, found: Measured) -> list[str]:
    """Return the records that state another modelling of the structure than the twin's."""
    ours = config.modelling()
    differences: dict[str, list[str]] = {}
    for seen in found.observations:
        for key, value in stated_model(seen.truth).items():
            if value != ours[key]:
                text = f"{key} {_word(value)}; the twin has {_word(ours[key])}, which changes its frequencies"
                differences.setdefault(f"{text}: write {key}: {_word(value)}, or omit the key", []).append(
                    seen.name
                )
    return [f"{', '.join(names)}: simulated with {text}." for text, names in differences.items()]


def _word(value: object) -> str:
    """Return a value as YAML writes it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _of_records(found: Measured) -> list[str]:
    """Return the findings on the records, each sentence once with all records that it applies to."""
    places: dict[str, list[str]] = {}
    for seen in found.observations:
        said = [(_place(seen.name, f), f["text"]) for f in seen.quality.get("findings", ())]
        said += [(seen.name, text) for text in seen.identification.warnings]
        said += [(seen.name, str(f)) for f in seen.findings if f.code == "sensor_against_model"]
        for place, text in said:
            places.setdefault(text, []).append(place)
    return [f"{', '.join(dict.fromkeys(where))}: {text}" for text, where in places.items()]


def _place(record: str, finding: Mapping[str, Any]) -> str:
    """Return the subject of a finding: a record, or one of its channels."""
    return f"{record}, {finding['subject']}" if finding["subject"] else record


def _wind_without_rotor(config: TwinConfig, found: Measured, measured: tuple[MeasuredMode, ...]) -> list[str]:
    winds = [one.wind_m_s for one in found.observations if one.wind_m_s]
    fitted = [m.label for m in measured if m.fits_damping]
    if config.update.dashpots or not winds or not fitted:
        return []
    return [
        f"The records were taken in wind, up to {max(winds):.3g} m/s, and the twin has no rotor: its damping "
        f"of {', '.join(fitted)} is attributed to the supports, so that their damping is an upper limit. "
        "Give update.rotor, or update.dashpots with the damping that determines them: update.damping_of: all "
        "fits that of side-side modes, too."
    ]


def _kind(dashpot: str) -> str:
    return dashpot.removeprefix("c_").replace("_", "-")


def _open_dashpots(
    config: TwinConfig, measured: tuple[MeasuredMode, ...], updates: tuple[Update, ...]
) -> list[str]:
    """Return the dashpots without a prior of whose direction no damping is fitted."""
    fitted = [m.label for m in measured if m.fits_damping]
    flat = {u.problem.parameters[i].name for u in updates for i in _dashpots(config, u)
            if u.problem.parameters[i].median is None}  # fmt: skip
    return [
        f"No datum constrains {name}: no damping of {_kind(name)} modes is fitted "
        "(update.damping_of); its interval is that of its bounds. Fit it (update.damping_of: all), or give "
        "update.rotor."
        for name in config.update.dashpots
        if name in flat and not any(label.startswith(name.removeprefix("c_")) for label in fitted)
    ]


def _unweighted(
    config: TwinConfig, measured: tuple[MeasuredMode, ...], updates: tuple[Update, ...]
) -> list[str]:
    """Warn that missing standard deviations of some data prevent weights and intervals for all data."""
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
        "The wind speed is not known: the rotor's geometry gives the dashpots' pattern but no prior. "
        "Give update.wind_speed_m_s."
    ]


def _dashpots(config: TwinConfig, u: Update) -> list[int]:
    return [i for i, p in enumerate(u.problem.parameters) if p.name in config.update.dashpots]


def _strangers(found: Measured, labels: tuple[str, ...], *, every: bool) -> list[str]:
    """Return a line for each mode (``ok`` ones unless ``every``) without a counterpart in the model."""
    reasons = (
        (one.name, unpaired_finding(mode, against, labels))
        for one in found.observations
        for mode, against in zip(one.identification.modes, one.held, strict=False)
        if every or mode.status == "ok"
    )
    return [f"{name}: no counterpart in the model for {why}" for name, why in reasons if why is not None]


def _misses(config: TwinConfig, m: MeasuredMode, f: float) -> bool:
    """Return whether a frequency differs by over three standard deviations and 1 % (10 % if not fitted)."""
    if m.frequency_hz is None:
        return False
    std = hypot(m.frequency_std_hz or 0.0, config.update.model_error(m.mode).frequency * m.frequency_hz)
    least = 0.01 if m.fits_frequency else 0.1
    return abs(f - m.frequency_hz) > max(3.0 * std, least * m.frequency_hz)
