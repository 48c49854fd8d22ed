"""Construction of the updated model from a structure and a law, with bounds and priors of its parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi, sqrt

from jackettwin.errors import InputError
from jackettwin.response import strongest_beta
from jackettwin.soil import Family, Parameter, Support
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating.band import condensed_for, numbered_modes
from jackettwin.updating.model import SupportModel
from jackettwin.updating.nuisance_parameters import STEEL, NuisanceParameters
from jackettwin.updating.tie_groups import priors_of, tie_groups

Lognormal = tuple[float, float]
"""Median and standard deviation of ln θ."""


def support_model(
    assembly: Assembly,
    *,
    family: Family,
    rayleigh: Rayleigh,
    tie: str = "all",
    bounds: Mapping[str, tuple[float, float]] | None = None,
    priors: Mapping[str, Lognormal] | None = None,
    highest_mode: int = 8,
    fastest_rate: float = 0.0,
    nuisance: NuisanceParameters | None = None,
    heads: Support | None = None,
    informed: bool = False,
) -> SupportModel:
    """Return the model with one law on the feet's translations, or on the DOFs of pile heads.

    Parameters
    ----------
    tie : {"all", "horizontal-vertical", "per-leg", "per-leg-horizontal-vertical"}
        Translations that share parameters.
    bounds : dict, optional
        Bounds by parameter name, with the tie's suffix, that of its side, or none.
    priors : dict, optional
        Lognormal priors by parameter name, as for the bounds; other priors are uniform in ln θ.
    highest_mode : int
        Highest mode number that will be requested.
    fastest_rate : float
        Largest rate of the real poles that will be requested [rad/s].
    nuisance : NuisanceParameters, optional
        Nacelle dashpots and steel damping to update as well.
    heads : Support, optional
        Pile heads whose 6×6 stiffness the laws scale (:func:`jackettwin.updating.tie_groups.tie_groups`).
    informed : bool
        Whether the law and the heads provide priors for parameters without one.

    Raises
    ------
    InputError
        If the tie is unknown, the structure has no reaction nodes, or a bound is wrong.
    """
    pinned_hz = numbered_modes(assembly, highest_mode).frequency_hz
    first_hz = float(pinned_hz[0])
    groups = tie_groups(assembly.structure, tie, heads=heads, reference_hz=first_hz)
    nuisance, bounds, priors = nuisance or NuisanceParameters(), bounds or {}, priors or {}
    suffixes = ("", *groups.suffixes) if groups.one_loss else groups.suffixes
    own = family.priors(first_hz) if informed else {}
    derived = {name + suffix: prior for name, prior in own.items() for suffix in suffixes}
    derived |= priors_of(groups, first_hz) if informed else {}
    of_law = groups.parameters(family)
    parameters = tuple(
        _informed(p, (own_name + side, own_name), bounds, priors, derived)
        for p, (own_name, side) in of_law.items()
    ) + tuple(_informed(p, (), bounds, priors, {}) for p in nuisance.parameters)
    known = {p.name + side for p in family.parameters for side in ("", *groups.sides)}
    known |= {p.name for p in of_law}
    known |= {p.name for p in nuisance.parameters}
    for field, names in (("bounds", bounds), ("priors", priors)):
        _no_unknown(field, names, known, family)
    condensed = condensed_for(assembly, groups, rayleigh, nuisance, pinned_hz, highest_mode, fastest_rate)
    if nuisance.rayleigh:
        parameters = _inside_band(parameters, bounds, strongest_beta(condensed.radius))
    low = next((p.low for p in parameters if p.name == "water_mass"), 1.0)
    nuisance.check_mass(
        condensed.pencil.M, [g.S for g in condensed.pencil.groups[len(groups.suffixes) :]], low
    )
    return SupportModel(
        assembly,
        rayleigh,
        family,
        parameters,
        groups,
        condensed,
        first_hz,
        highest_mode,
        nuisance,
        fastest_rate,
    )


def _inside_band(
    parameters: tuple[Parameter, ...], given: Mapping[str, tuple[float, float]], beta: float
) -> tuple[Parameter, ...]:
    """Return the parameters with bounds of the steel's damping such that it overdamps no mode of the band.

    The condensed model limits β = ζ/ω. The default upper bound of the ratio and lower bound of the frequency
    are reduced equally; for bounds given by the user an error is raised.
    """
    ratio, frequency = (next(p for p in parameters if p.name == s.name) for s in STEEL)
    # slightly inside, because of rounding when a search is on both bounds
    excess = ratio.high / (2.0 * pi * frequency.low) / beta * (1.0 + 1e-9)
    if excess <= 1.0:
        return parameters
    if ratio.name in given or frequency.name in given:
        raise InputError(
            "the steel's damping increases with frequency and is too strong for the requested modes",
            field=f"bounds.{ratio.name if ratio.name in given else frequency.name}",
            value=[ratio.high, frequency.low],
            allowed=f"highest ratio over lowest frequency up to {2.0 * pi * beta:.3g} 1/Hz",
            remedy="narrow the bounds, or leave out the highest modes",
        )
    narrow = {
        ratio.name: replace(ratio, high=ratio.high / sqrt(excess)),
        frequency.name: replace(frequency, low=frequency.low * sqrt(excess)),
    }
    return tuple(narrow.get(p.name, p) for p in parameters)


def _informed(
    p: Parameter,
    also_known_as: tuple[str, ...],
    bounds: Mapping[str, tuple[float, float]],
    priors: Mapping[str, Lognormal],
    derived: Mapping[str, Lognormal],
) -> Parameter:
    names = (p.name, *also_known_as)
    low, high = next((bounds[name] for name in names if name in bounds), (p.low, p.high))
    median, log_std = next((priors[name] for name in names if name in priors), (p.median, p.log_std))
    if median is None and p.name in derived and low <= derived[p.name][0] <= high:
        median, log_std = derived[p.name]
    return Parameter(p.name, low, high, p.unit, median, log_std)


def _no_unknown(field: str, given: Mapping[str, object], known: set[str], family: Family) -> None:
    for name in given:
        if name not in known:
            raise InputError(
                f"no such parameter of {family.name}",
                field=f"{field}.{name}",
                value=name,
                allowed=", ".join(sorted(known)),
            )
