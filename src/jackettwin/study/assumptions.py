"""What a run takes for granted: choices of modelling, and tolerances that nobody has settled."""

from __future__ import annotations

from collections.abc import Iterable
from math import expm1

from jackettwin.caveats import TOLERANCES, Assumption
from jackettwin.soil import MUDLINE
from jackettwin.structure import Rayleigh
from jackettwin.study.measurements import MeasuredMode, MeasuredRelaxation
from jackettwin.study.scrutiny import Scrutiny
from jackettwin.twin import TwinConfig

_MODES = "Modes are numbered by their order on pinned feet and followed by mass-weighted MAC."


def tolerance_assumptions(
    config: TwinConfig, s: Scrutiny | None, parameters: Iterable[str]
) -> tuple[Assumption, ...]:
    """Return the tolerances of a twin: those still open, which moves the answer most first, then the settled.

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
    return f"±{100.0 * std:.3g} %" if unit == "-" else f"±{std:.3g} {unit}"


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
        + (f"; {', '.join(config.of_records)}: as the records state it." if config.of_records else ".")
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
        where = "" if wind is None else f", stated at a wind of {wind:.3g} m/s and proportional to it"
        parked = f"The rotor is parked: dashpots {', '.join(config.update.dashpots)} {shape}{where}."
        found.append(Assumption("rotor", parked))
    if config.update.water:
        water = (
            f"Factors on the water are updated: {', '.join(config.update.water)}. Drag is linear, in one "
            "mean sea for all records; radiation damping is left out."
        )
        found.append(Assumption("water", water))
    if config.update.parameters:
        further = f"Updated beside the law: {', '.join(config.update.parameters)}."
        found.append(Assumption("parameters", further))
    if len(config.records) > 1:
        fused = (
            f"{len(config.records)} records are fused on the logarithms, weighted by precision, with their "
            "scatter."
        )
        found.append(Assumption("records", fused))
    return found


def _steel(config: TwinConfig) -> str:
    """Say how the steel is damped."""
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
        tied = f"{nodes[0]}, which all feet follow rigidly" if nodes == (MUDLINE,) else f"foot {nodes[0]}"
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
