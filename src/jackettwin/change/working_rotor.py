"""The operating rotor in monitoring: part of the monitored structure, and itself a cause of change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads import OPERATING_LOG_STD
from jackettwin.response import UndampedModes
from jackettwin.structure import Assembly
from jackettwin.twin import (
    AT_WORK_STD,
    USUAL_WIND_M_S,
    RotorSide,
    TwinConfig,
    assembled,
    rotor_at_work,
    stiffness_at_work,
)
from jackettwin.updating import numbered_modes
from jackettwin.watching import Cause, sizes_about

NAME = "rotor at work"
_USUAL_CHANGE, _SPREAD = 0.1, 0.8
"""Median size of a change of what the rotor adds, and its spread in ln: assumed, as for soil. Another
schedule of pitch and speed, worn or iced blades or another controller change it by a tenth to a third."""


@dataclass(frozen=True)
class WorkingRotor:
    """Damping and stiffness that an operating rotor adds at the tower top in the mean wind of a twin.

    Attributes
    ----------
    sides : {dashpot: its damping and stiffness in one direction}
    """

    sides: Mapping[str, RotorSide]

    @classmethod
    def of(cls, config: TwinConfig) -> WorkingRotor | None:
        """Return the rotor of a twin whose records are of operation; None for a parked or unknown one.

        Raises
        ------
        InputError
            If the rotor's files are wrong, or its schedule does not reach the wind.
        """
        given = config.update
        if given.rotor is None or given.rotor_state != "operating":
            return None
        assembly = assembled(config)
        wind = given.wind_speed_m_s or USUAL_WIND_M_S
        return cls(rotor_at_work(config, assembly, numbered_modes(assembly, 2), wind))

    def on(self, assembly: Assembly) -> Assembly:
        """Return an assembled structure with the rotor's stiffness in the mean wind."""
        return replace(assembly, stiffness=assembly.stiffness + stiffness_at_work(self.sides, assembly))

    def cause(
        self, assembly: Assembly, modes: UndampedModes, zeta: FloatArray, draws: int, rng: np.random.Generator
    ) -> Cause:
        """Return the cause that the rotor adds another share of stiffness and damping.

        The direction is as uncertain as the rotor is in updating: its stiffness by the tolerance
        ``rotor_at_work``, its damping by the standard deviations of ln c of the two sides.

        Parameters
        ----------
        modes : (n,) of the structure with the rotor, mass normalised
        zeta : (n,) damping ratios
        """
        Phi, omega = modes.shapes, modes.omega
        top = Phi[assembly.dofs(assembly.structure.top_node)]
        ln_f = 0.5 * np.einsum("in,in->n", Phi, stiffness_at_work(self.sides, assembly) @ Phi) / omega**2
        stiffer = 1.0 + AT_WORK_STD * rng.standard_normal(draws)
        more = np.zeros((draws, omega.size))
        for name, side in self.sides.items():
            ratio = side.dashpot * np.einsum("in,ij,jn->n", top, side.pattern, top) / (2.0 * omega)
            std = OPERATING_LOG_STD[name.removeprefix("c_")]
            more += np.outer(np.exp(std * rng.standard_normal(draws)), ratio)
        direction = np.hstack([np.outer(stiffer, ln_f), more / zeta, np.zeros((draws, omega.size))])
        sizes, weights = sizes_about(_USUAL_CHANGE, _SPREAD, both_ways=True)
        return Cause(NAME, direction, sizes, weights, "-")
