"""Omissions of ``modes``, ``superelement``, ``export`` and ``simulate``, and how to include them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jackettwin.caveats import Omission, omission_documents

if TYPE_CHECKING:
    from jackettwin.simulate import Scenario

Left = list[dict[str, str | None]]
_P_DELTA = Omission("geometric (P-Δ) stiffness of the weight: --gravity")
_WATER = Omission(
    "water and marine growth beyond what the structure's densities hold: `simulate` and twins add them"
)
_WIND = Omission("the rotor in wind: `operation`, `simulate`")


def of_modes(*, gravity: bool, steel: bool) -> Left:
    """Return what ``modes`` leaves out."""
    own = Omission("damping of the steel: --rayleigh or --mode-damping")
    return omission_documents([*([] if gravity else [_P_DELTA]), *([] if steel else [own]), _WATER, _WIND])


def of_superelement(*, gravity: bool, steel: bool) -> Left:
    """Return what ``superelement`` leaves out."""
    own = Omission("damping of the steel: --rayleigh, or --deck-damping")
    loads = Omission("loads of water on the foundation, and its added mass and buoyancy")
    return omission_documents([*([] if gravity else [_P_DELTA]), *([] if steel else [own]), loads])


def of_export() -> Left:
    """Return what no deck holds of a structure."""
    return omission_documents(
        [
            Omission("tower and turbine: what is above the interface"),
            Omission("damping of the ground, and stiffness that varies with frequency: `superelement`"),
            Omission("geometric (P-Δ) stiffness: `superelement --gravity`"),
            Omission("the structure's own damping: the deck has 1 % for each of its modes"),
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
            Omission("ice: out of scope", "ISO 19906"),
            Omission("earthquakes: out of scope", "ISO 19901-2"),
        ]
    )
