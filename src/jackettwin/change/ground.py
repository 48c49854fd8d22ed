"""Ground under a structure's feet: its stiffness, and the loss of stiffness by scour."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import log, pi
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.files import read_yaml
from jackettwin.soil import Foundation, feet_in_line, read_foundation
from jackettwin.soil.foundation import build_foundation, shipped_foundations
from jackettwin.twin import TwinConfig
from jackettwin.updating import Update

REFERENCE = "jacket15"
"""Shipped foundation that represents undescribed piles: 60 m long, 3.5 m wide, in ten metres of stiff
clay over dense sand. A metre of scour takes 21 % of their lateral stiffness and 1 % of the axial one,
which acts deeper."""


class Loss(NamedTuple):
    """ln of the stiffness that a pile's head loses by a metre of scour.

    Attributes
    ----------
    sideways, axially : of a head that a jacket keeps upright
    free_sideways, free_turning : of one that turns freely, as under a monopile: of 1/F_hh and 1/F_rr, F the
        flexibility. Scour acts most on the coupling of both motions, which K_rr leaves out.
    """

    sideways: float
    axially: float
    free_sideways: float
    free_turning: float


OF_CURVES, OF_OTHER_PILES = 0.2, 0.4
"""Standard deviations of ln of what scour takes by a pile's own soil curves, and by those of other piles. In
uniform ground a free head loses ln(1 + 2λ + 2λ² + ⅔λ³) sideways (Hetényi 1946), 0.22 for λ = 0.113 /m, where
the reference has 0.33."""
ARM_M = 14.0
"""Arm at which a foot's vertical stiffness resists its rotation where feet stand in a line, as a monopile
does: 5e11 Nm/rad for 2.5e9 N/m."""


@dataclass(frozen=True)
class Ground:
    """Stiffness of the ground and its dependence on scour.

    Attributes
    ----------
    piles : Foundation or None
        Layered ground with a pile; if None, scour acts as on the piles of ``REFERENCE``.
    stiffness : (n_draws, 2, n_feet) or None
        Horizontal and vertical stiffness of the feet [N/m], drawn from the posterior of an update; without,
        it is fitted to the frequencies of the baseline. Of feet in a line the second is the rotational
        stiffness over ``ARM_M`` squared.
    """

    piles: Foundation | None = None
    stiffness: FloatArray | None = None

    @classmethod
    def of(cls, config: TwinConfig, update: Update | None = None) -> Ground:
        """Return the ground from a twin file and the update of its supports."""
        sampled = None if update is None or update.uncertainty is None else _feet_stiffness(update)
        return cls(_piles(config), sampled)

    @property
    def scour_loss(self) -> Loss:
        """Loss of ln stiffness per metre of scour, by the soil's own curves."""
        return _reference_loss() if self.piles is None else scour_loss(self.piles)

    @property
    def loss_std(self) -> float:
        """Standard deviation of ln of each of these."""
        return OF_OTHER_PILES if self.piles is None else OF_CURVES


UNDESCRIBED = Ground()
"""Undescribed ground."""


def scour_loss(piles: Foundation) -> Loss:
    """Return the loss of ln stiffness of a pile head per metre of scour.

    Raises
    ------
    InputError
        If the ground has no layers.
    """
    before, after = (one.head() for one in (piles, piles.scoured(1.0)))
    K, L = before.steel + before.soil, after.steel + after.soil
    F, G = np.linalg.inv(K), np.linalg.inv(L)
    upright, free = np.diag(K) / np.diag(L), np.diag(G) / np.diag(F)
    return Loss(log(upright[0]), log(upright[2]), log(free[0]), log(free[3]))


@cache
def _reference_loss() -> Loss:
    return scour_loss(read_foundation(REFERENCE))


def _piles(config: TwinConfig) -> Foundation | None:
    """Return the pile foundation that a twin names under ``support.stiffness``, if its ground has layers."""
    if config.heads is None or config.heads in ("own", "pinned", "clamped"):
        return None
    path = config.path.parent / config.heads
    if config.heads in shipped_foundations():
        piles = read_foundation(config.heads)
    elif path.suffix.lower() in (".yaml", ".yml") and "pile" in (content := read_yaml(path)):
        piles = build_foundation(content, path)
    else:
        return None
    return None if piles.profile is None else piles


def _feet_stiffness(update: Update) -> FloatArray:
    """Return the storage stiffness of every foot at the first pinned frequency, draw by draw."""
    model, known = update.model, update.uncertainty
    assert known is not None
    feet, s = model.assembly.structure.reaction_nodes, 2j * pi * model.reference_hz
    out, turns = np.zeros((len(known.log_theta), 2, len(feet))), feet_in_line(model.assembly.structure)
    for draw, theta in zip(out, np.exp(known.log_theta), strict=True):
        for spring in model.tie_groups.support(model.laws(theta)).springs:
            k = np.asarray(spring.law.stiffness(s)).real * spring.matrix
            upright = 0.5 * (k[3, 3] + k[4, 4]) / ARM_M**2 if turns else k[2, 2]
            draw[:, feet.index(spring.node)] += 0.5 * (k[0, 0] + k[1, 1]), upright
    return out
