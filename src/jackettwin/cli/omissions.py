"""Omissions of commands, some by their options and all others always, and how to include them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jackettwin.caveats import OUT_OF_SCOPE, Omission, omission_documents

if TYPE_CHECKING:
    from jackettwin.simulate import Scenario

Left = list[dict[str, str | None]]
_P_DELTA = Omission("geometric (P-Δ) stiffness of the weight: --gravity")
_WATER = Omission(
    "water and marine growth beyond what the structure's densities hold: `simulate` and twins add them"
)
_WIND = Omission("the rotor in wind: `operation`, `simulate`")


_UPDATED = (
    Omission("ground that softens with amplitude: one linear law; scenarios with `hysteresis` have loops"),
    Omission("rotations of feet, and what couples their directions, unless `support.stiffness` gives them"),
    Omission("errors of the structure beyond its `tolerances` and the suspects that are named"),
    Omission("resistance and life: `check`, `fatigue`; life of a twin by `life`", "ISO 19902 13 to 16"),
)
ALWAYS: dict[str, tuple[Omission, ...]] = {
    "identify": (
        Omission("changes within a record: it is taken as stationary, and its excitation as broad in band"),
        Omission("damping that grows with amplitude: its mean over the record"),
    ),
    "run": _UPDATED,
    "update": _UPDATED,
    "explore": _UPDATED,
    "follow": (*_UPDATED, Omission("jumps: the ground's stiffness drifts; `watch` finds when it jumped")),
    "watch": (
        Omission("gain, sign, position of sensors: no pole shows them; `identify` and `run` look for them"),
        Omission("how modes change with conditions that the table lacks: part of what is unexplained"),
        Omission("causes that are not listed: `something else`"),
    ),
    "refine": (
        Omission("damping and shapes: frequencies alone are fitted"),
        Omission("the ground: feet are pinned, or stand on the springs of the structure's file"),
    ),
    "stages": (Omission("the ground: each stage stands on pinned feet"), Omission("damping"), _WATER),
    "view": (_P_DELTA, _WATER, Omission("checks of what is drawn: colours are stresses, `check` has codes")),
    "law": (Omission("amplitude: a law is linear; scenarios with `hysteresis` have loops of the soil"),),
    "simulate-set": (
        Omission("what `simulate` leaves out of each case: run one of them"), *OUT_OF_SCOPE,
    ),
    "scf": (
        Omission("ring-stiffened and grouted joints", "DNV-RP-C203 appendix B"),
        Omission("braces of other planes of the joint, and their loads"),
    ),
}  # fmt: skip
"""Of commands that say nothing else under ``left_out``."""


def omitted_by(command: str) -> Left:
    """Return what a command always leaves out."""
    return omission_documents(ALWAYS[command])


def of_modes(*, gravity: bool, steel: bool) -> Left:
    """Return what ``modes`` leaves out."""
    own = Omission("damping of the steel: --rayleigh or --mode-damping")
    return omission_documents([*([] if gravity else [_P_DELTA]), *([] if steel else [own]), _WATER, _WIND])


def of_superelement(*, gravity: bool, steel: bool) -> Left:
    """Return what ``superelement`` leaves out."""
    own = Omission("damping of the steel: --rayleigh, or --deck-damping")
    loads = Omission("loads of water on the foundation, and its added mass and buoyancy")
    return omission_documents([*([] if gravity else [_P_DELTA]), *([] if steel else [own]), loads])


def of_export(*, damping: bool) -> Left:
    """Return what no deck holds of a structure; ``damping``: whether that of a deck is not at hand."""
    own = Omission("the structure's own damping: the deck has 1 % for each of its modes")
    return omission_documents(
        [
            Omission("tower and turbine: what is above the interface"),
            Omission("damping of the ground, and stiffness that varies with frequency: `superelement`"),
            Omission("geometric (P-Δ) stiffness: `superelement --gravity`"),
            *([own] if damping else []),
        ]
    )


def of_simulation(scenario: Scenario) -> Left:
    """Return what a simulation of this scenario leaves out."""
    found, turbine, sea = [], scenario.turbine, scenario.sea
    if turbine is not None and turbine.state == "operating":
        works = "the working rotor's controller, bending blades, wake and lift that lag: `operation` has them"
        found.append(Omission(works))
    elif turbine is not None:
        found.append(Omission("unsteady lift of the standing blades, and their bending but by `blades:`"))
    if sea is None:
        found.append(Omission("water: its waves, added mass and buoyancy; give `water`"))
    elif sea.waves is not None:
        found.append(Omission("slam and breaking waves: `loads` screens them", "IEC 61400-3-1"))
        found.append(Omission("second-order and ringing forces; relative motion but by its drag"))
    return omission_documents(
        [
            *found,
            Omission("displacements in the equilibrium: loads act on the structure at rest"),
            *OUT_OF_SCOPE,
        ]
    )
