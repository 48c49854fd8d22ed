"""Table of tolerances: name, size, source and effect of each.

Another package adds one by an entry point in ``jackettwin.tolerances`` that is a :class:`KnownTolerance`;
twin files change the size of a tolerance or close it by its name under ``tolerances:``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from jackettwin.plugins import plugins_of_type
from jackettwin.response import Matrix
from jackettwin.structure import Assembly, PointMass, Structure, without_rotor
from jackettwin.twin.config import TwinConfig, assembled
from jackettwin.twin.rotor_at_work import AT_WORK_STD, USUAL_WIND_M_S, rotor_at_work, stiffness_at_work
from jackettwin.twin.tolerances.parts import (
    JACKET,
    PIECE,
    TOWER,
    heavier,
    legs_by_foot,
    stiffer,
    thicker,
    with_braces,
    with_lower_feet,
    with_part,
    with_top_bodies,
)
from jackettwin.twin.tolerances.sea import (
    Change,
    changed_mass,
    denser_growth,
    flooded,
    level_mass,
    more_added_mass,
    thicker_growth,
    unstated_growth,
)
from jackettwin.updating import Direction, Tolerance, numbered_modes

_BLADES_HZ, _BENDING_MASS, _BENDING_INERTIA = 0.6, 0.05, 0.45
"""Frequency [Hz] of a rotor's blades, and effective shares of mass and inertia of the rotor–nacelle assembly
in their first bending modes. Those of the IEA 15 MW turbine, clamped at the hub, are at 0.52 Hz flapwise and
0.75 Hz edgewise, with 5 % of the mass along the wind and 44 to 55 % of the inertias."""

AT_WORK = "rotor_at_work"
"""Name of the tolerance on a rotor that produces power."""
Effect = Callable[[TwinConfig, Assembly, Tolerance], tuple[Direction, ...]]
PLUGINS = "jackettwin.tolerances"
"""Entry points of packages that add tolerances: each is a :class:`KnownTolerance`."""


@dataclass(frozen=True)
class KnownTolerance:
    """A tolerance and the effect of one standard deviation on a twin.

    Attributes
    ----------
    suspected : bool
        Whether it is used only to explain data that a twin does not fit, not as a tolerance of every twin.
    tolerance : Tolerance
    effect : function of the twin, its assembly and the tolerance with the twin's size
        Returns one direction, several for equal unknowns (one for each foot), or none if the twin has no
        such part.
    """

    tolerance: Tolerance
    effect: Effect
    suspected: bool = False


def _drawn(change: Callable[[TwinConfig, float], TwinConfig | None]) -> Effect:
    """Return the effect of a change of the drawings, by assembling the changed twin."""

    def effect(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
        changed = change(config, tolerance.std)
        if changed is None:
            return ()
        other = assembled(changed)
        mass, stiffness = other.mass - assembly.mass, other.stiffness - assembly.stiffness
        return (Direction(tolerance, _or_none(mass), _or_none(stiffness)),)

    return effect


def _or_none(matrix: Matrix) -> Matrix | None:
    return matrix if matrix.nnz and abs(matrix).max() > 0.0 else None


def _steel(change: Callable[[Structure, float], Structure | None]) -> Effect:
    """Return the effect of a change of the structure."""

    def changed(config: TwinConfig, size: float) -> TwinConfig | None:
        structure = change(config.structure, size)
        return None if structure is None else replace(config, structure=structure)

    return _drawn(changed)


def _heavier_body(body: PointMass, factor: float) -> PointMass:
    return replace(_turning_body(body, factor), mass_kg=factor * body.mass_kg)


def _raised_body(body: PointMass, by_m: float) -> PointMass:
    x, y, z = body.cg_offset_m
    return replace(body, cg_offset_m=(x, y, z + by_m))


def _overhanging_body(body: PointMass, by_m: float) -> PointMass:
    x, y, z = body.cg_offset_m
    return replace(body, cg_offset_m=(x - by_m, y, z))


def _turning_body(body: PointMass, factor: float) -> PointMass:
    xx, yy, zz, xy, xz, yz = (factor * value for value in body.inertia_kg_m2)
    return replace(body, inertia_kg_m2=(xx, yy, zz, xy, xz, yz))


def _wet(change: Change) -> Effect:
    """Return the effect of a change of the water, whether the structure's or the twin's mass includes it."""

    def effect(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
        mass = changed_mass(config.water, assembly, tolerance.std, change)
        return () if mass is None else (Direction(tolerance, mass=mass),)

    return effect


def _flooding(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
    """Return the effect of the water's mass in each leg, each of which may be flooded or dry."""
    found = []
    for names in legs_by_foot(config.structure):
        mass = changed_mass(config.water, assembly, 1.0, flooded(names)) if names else None
        if mass is not None:
            found.append(Direction(tolerance, mass=_or_none(tolerance.std * mass)))
    return tuple(found)


def _level(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
    mass = level_mass(config.water, assembly, tolerance.std)
    return () if mass is None else (Direction(tolerance, mass=mass),)


def _feet(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
    """Return the deviation of each foot from the mean, unless each has its own parameters."""
    n = len(config.structure.reaction_nodes)
    if n < 2 or config.tie.startswith("per-leg"):
        return ()
    shares = tolerance.std * (np.eye(n) - 1.0 / n)
    return tuple(Direction(tolerance, feet=np.tile(row[:, None], 6)) for row in shares)


def _loss_growth(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
    """Return the effect of a loss that grows with another power of frequency than the law's."""
    return (Direction(tolerance, loss_growth=tolerance.std),)


def _softer_sideways(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
    """Return the effect of laterally softer feet, unless the twin separates lateral and axial stiffness."""
    if config.tie not in ("all", "per-leg"):
        return ()
    share = np.array([-tolerance.std] * 2 + [0.0] + [-tolerance.std] * 3)
    return (Direction(tolerance, feet=np.tile(share, (len(config.structure.reaction_nodes), 1))),)


def _softer_foot(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
    """Return the effect of one foot softer than the others with the mean as stated, for each foot."""
    n = len(config.structure.reaction_nodes)
    shares = -tolerance.std * (np.eye(n) - 1.0 / n)
    return tuple(Direction(tolerance, feet=np.tile(row[:, None], 6)) for row in shares)


def _bending_blades(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
    """Return the effect of flexible blades of a lumped rotor, unless the twin models its blades."""
    if len(without_rotor(config.structure).elements) < len(config.structure.elements):
        return ()

    def lighter(body: PointMass) -> PointMass:
        share = tolerance.std * _BENDING_INERTIA
        return replace(
            _turning_body(body, 1.0 - share), mass_kg=(1.0 - tolerance.std * _BENDING_MASS) * body.mass_kg
        )

    other = with_top_bodies(config.structure, lighter)
    if other is None:
        return ()
    mass = assembly.mass - assembled(replace(config, structure=other)).mass
    return (Direction(tolerance, mass=_or_none(mass), resonance_hz=_BLADES_HZ),)


def stiffer_at_work(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
    """Return the effect of more stiffness by the rotor at work; none of a twin without its rotor's files."""
    if config.update.rotor is None:
        return ()
    wind = config.update.wind_speed_m_s or USUAL_WIND_M_S
    sides = rotor_at_work(config, assembly, numbered_modes(assembly, 2), wind)
    return (Direction(tolerance, stiffness=tolerance.std * stiffness_at_work(sides, assembly)),)


def _updated_at_work(config: TwinConfig, assembly: Assembly, tolerance: Tolerance) -> tuple[Direction, ...]:
    works = config.update.rotor_state == "operating"
    return stiffer_at_work(config, assembly, tolerance) if works else ()


def _table() -> tuple[KnownTolerance, ...]:
    """Return the tolerances of this package."""
    return (
        KnownTolerance(
            Tolerance("rna_mass", "mass of the rotor–nacelle assembly", 0.015, "-",
                      "assumed: sums of items before weighing differ by 1 to 3 %; ISO 19901-5 (2016) asks "
                      "to weigh",
                      "weigh nacelle, hub and blades"),
            _steel(lambda s, x: with_top_bodies(s, lambda b: _heavier_body(b, 1.0 + x))),
        ),
        KnownTolerance(
            Tolerance("rna_height", "height of the nacelle's mass", 0.2, "m",
                      "assumed: fittings of some 5 % of the mass, 4 m from where they are drawn",
                      "take it from the weighing report"),
            _steel(lambda s, x: with_top_bodies(s, lambda b: _raised_body(b, x))),
        ),
        KnownTolerance(
            Tolerance("rna_overhang", "overhang of the nacelle's mass", 0.2, "m",
                      "assumed: fittings of some 5 % of the mass, 4 m from where they are drawn",
                      "take it from the weighing report"),
            _steel(lambda s, x: with_top_bodies(s, lambda b: _overhanging_body(b, x))),
        ),
        KnownTolerance(
            Tolerance("rna_inertia", "inertia of the rotor–nacelle assembly", 0.03, "-",
                      "assumed: twice the mass's, because distances from the axis count squared",
                      "ask the maker for the inertia of blades and nacelle"),
            _steel(lambda s, x: with_top_bodies(s, lambda b: _turning_body(b, 1.0 + x))),
        ),
        KnownTolerance(
            Tolerance(AT_WORK, "stiffness that a rotor at work adds at the tower top", AT_WORK_STD, "-",
                      "computed: frequencies agree with OpenFAST 5 within a fifth of the 6 to 8 % that it "
                      "adds (docs/verification/operation.md); a controller and gusts are assumed",
                      "take frequencies from records of the parked or idling rotor"),
            _updated_at_work,
        ),
        KnownTolerance(
            Tolerance("tower_stiffness", "bending stiffness of the tower", 0.015, "-",
                      "JCSS Probabilistic Model Code 3.02 (2001): E by 3 % a plate, less in the mean of many",
                      "measure walls and diameters of the cans; take E from the mill's certificates"),
            _steel(lambda s, x: with_part(s, TOWER, stiffer(1.0 + x))),
        ),
        KnownTolerance(
            Tolerance("tower_mass", "mass of the tower", 0.01, "-",
                      "JCSS Probabilistic Model Code 2.1 (2001): steel by 1 %; flanges and internals",
                      "weigh the sections when they are lifted"),
            _steel(lambda s, x: with_part(s, TOWER, heavier(1.0 + x))),
        ),
        KnownTolerance(
            Tolerance("jacket_stiffness", "stiffness of the jacket's steel", 0.01, "-",
                      "JCSS Probabilistic Model Code 3.02 (2001): E by 3 % a plate, less in the mean of many",
                      "take E from the mill's certificates"),
            _steel(lambda s, x: with_part(s, JACKET, stiffer(1.0 + x))),
        ),
        KnownTolerance(
            Tolerance("jacket_mass", "mass of the jacket", 0.02, "-",
                      "assumed: anodes, appurtenances and weld by half of their usual 4 %; ISO 19901-5 "
                      "(2016) asks to weigh",
                      "take it from the weighing at load-out"),
            _steel(lambda s, x: with_part(s, JACKET, heavier(1.0 + x))),
        ),
        KnownTolerance(
            Tolerance("jacket_wall", "walls of the jacket's tubes", 0.01, "-",
                      "EN 10029 (2010): plates of 20 to 50 mm by 1 to 2 %, less in the mean of many",
                      "measure walls by ultrasound"),
            _steel(lambda s, x: with_part(s, JACKET, thicker(1.0 + x))),
        ),
        KnownTolerance(
            Tolerance("transition_stiffness", "stiffness of transition piece and grout", 0.1, "-",
                      "JCSS Probabilistic Model Code 3.01 (2001): E of concrete by 15 %; a shell as beams",
                      "compute it by shell elements"),
            _steel(lambda s, x: with_part(s, PIECE, stiffer(1.0 + x))),
        ),
        KnownTolerance(
            Tolerance("foot_level", "level of the feet", 0.5, "m",
                      "assumed: beds are surveyed to some decimetres, and piles are stabbed and grouted to "
                      "as much",
                      "survey the bed and the feet after installation"),
            _steel(with_lower_feet),
        ),
        KnownTolerance(
            Tolerance("growth", "marine growth, unstated", 0.04, "m",
                      "DNV-RP-C205 (2021) 6.7.4: 50 to 100 mm after some years",
                      "inspect the growth by diver or ROV, and state it (water.marine_growth)"),
            _wet(unstated_growth),
        ),
        KnownTolerance(
            Tolerance("growth_thickness", "thickness of the stated growth", 0.47, "-",
                      "assumed: ×/÷ 1.6 about a design profile (DNV-RP-C205 (2021) 6.7.4)",
                      "inspect the growth by diver or ROV"),
            _wet(thicker_growth),
        ),
        KnownTolerance(
            Tolerance("growth_density", "density of the stated growth", 115.0, "kg/m³",
                      "DNV-RP-C205 (2021) 6.7.4: 1,325 kg/m³; soft growth little more than water",
                      "weigh samples of it"),
            _wet(denser_growth),
        ),
        KnownTolerance(
            Tolerance("added_mass", "added mass of the water", 0.1, "-",
                      "DNV-RP-C205 (2021) 6.9: C_A of cylinders by roughness and motion",
                      "only a test in water determines it"),
            _wet(more_added_mass),
        ),
        KnownTolerance(
            Tolerance("flooding", "water in each leg as drawn or not", 0.22, "-",
                      "assumed without statistics: one leg in twenty is not as drawn, √(0.05 · 0.95)",
                      "look for water in the legs by ultrasound"),
            _flooding,
        ),
        KnownTolerance(
            Tolerance("water_level", "mean level of the sea", 0.3, "m",
                      "assumed: surges of the North Sea of weeks, and the datum of charts, beside the tide",
                      "take the daily levels from a tide gauge"),
            _level,
        ),
        KnownTolerance(
            Tolerance("feet_unlike", "feet unlike each other", 0.15, "-",
                      "Phoon & Kulhawy 1999: ground by 10 to 30 %, less in the mean along a pile",
                      "fit each leg (support.tie: per-leg) with sensors at the feet"),
            _feet,
        ),
        KnownTolerance(
            Tolerance("loss_growth", "growth of the ground's loss with frequency", 0.5, "power",
                      "assumed: between hysteretic ground (0) and a dashpot (1)",
                      "fit the other laws (update.laws), and damping of more modes"),
            _loss_growth,
        ),
        KnownTolerance(
            Tolerance("soft_sideways", "feet softer sideways than lengthwise", 0.3, "-",
                      "assumed: heads of jacket piles are two to ten times softer sideways; those of the "
                      "shipped records are by 4.8",
                      "support.tie: horizontal-vertical", one_sided=True),
            _softer_sideways, suspected=True,
        ),
        KnownTolerance(
            Tolerance("weak_leg", "one foot softer than the others", 0.3, "-",
                      "assumed: scour at one leg or a pile that was not driven home",
                      "compare the directions of bending pairs, put a sensor on each leg", one_sided=True),
            _softer_foot, suspected=True,
        ),
        KnownTolerance(
            Tolerance("joints", "softness of the brace joints", 0.1, "-",
                      "assumed, from the flexibility of joint cans (Buitrago et al. 1993)",
                      "model the joints' local flexibility", one_sided=True),
            _steel(lambda s, x: with_braces(s, stiffer(1.0 - x))), suspected=True,
        ),
        KnownTolerance(
            Tolerance("law", "loss of the ground that grows otherwise with frequency", 1.0, "power",
                      "from hysteretic ground (0) to a dashpot (1)",
                      "fit the other laws (update.laws), and damping of more modes", beyond="loss_growth"),
            _loss_growth, suspected=True,
        ),
        KnownTolerance(
            Tolerance("bending_blades", "bending of the blades, lumped in the model", 1.0, "rotors",
                      "the IEA 15 MW rotor's first modes (5 % of the mass, 45 % of the inertia, 0.6 Hz)",
                      "model the blades (blades:)", one_sided=True),
            _bending_blades, suspected=True,
        ),
    )  # fmt: skip


REMAINDERS = {"remainder_frequency": 0.003, "remainder_damping": 0.04}
"""Relative errors of each mode on its own. A finer mesh or a shell model changes a frequency by 0.2 to 0.5 %.
Of other laws a dashpot is the farthest from the twin's: beyond ``loss_growth`` it changes damping ratios by
1.9 %, without it by 31 % (``qualify/wrong_models.py laws``); the steel's own damping is assumed to differ
from the stated form by a tenth in each mode, which is 3 to 4 % of the whole."""
SCALES = (1.0, 1.4)
"""Equally likely factors on all tolerances and remainders of a twin together, up to twice the variance, as
the table's sizes have not been measured on many assets."""
TOLERANCES = {known.tolerance.name: known for known in _table()}


def tolerances() -> dict[str, KnownTolerance]:
    """Return every tolerance by its name, those of installed packages included."""
    added = plugins_of_type(PLUGINS, KnownTolerance).values()
    return {**TOLERANCES, **{known.tolerance.name: known for known in added}}


def directions(config: TwinConfig, assembly: Assembly) -> tuple[Direction, ...]:
    """Return the effect of each open tolerance of a twin on its structure.

    Parameters
    ----------
    assembly : Assembly
        Of this twin, including water.
    """
    found: list[Direction] = []
    for name, known in tolerances().items():
        std = config.tolerances.std(name, known.tolerance.std)
        if std > 0.0 and (not known.suspected or name in config.tolerances.given):
            found += known.effect(config, assembly, replace(known.tolerance, std=std))
    return tuple(found)


def suspects(config: TwinConfig, assembly: Assembly) -> tuple[Direction, ...]:
    """Return the effects of suspected errors of a twin that does not fit its data, each at a typical size."""
    found: list[Direction] = []
    for name, known in tolerances().items():
        if known.suspected and name not in config.tolerances.given:
            found += known.effect(config, assembly, known.tolerance)
    return tuple(found)
