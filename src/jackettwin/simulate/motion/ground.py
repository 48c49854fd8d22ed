"""Ground that unloads and reloads under the feet, as its difference from linear pile heads."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.simulate.motion.model import Model
from jackettwin.soil import Foundation
from jackettwin.soil.piles.cyclic import advance

EVALUATIONS = 4
"""Iterations of a step: each reduces the error by the share of the initial stiffness that is lost."""


class CyclicFeet:
    """All feet in time, with the state of the sliders at the last step.

    Steps must be asked for in order; one step may be asked for repeatedly, while it is iterated.
    """

    def __init__(self, model: Model, foundation: Foundation) -> None:
        structure = model.assembly.structure
        head = foundation.head()
        self._pile = foundation.cyclic()
        self._linear = head.steel + head.soil
        rows = [
            model.assembly.expand[model.assembly.mesh.node_dofs(foot)] for foot in structure.reaction_nodes
        ]
        self.motion: FloatArray = np.vstack([np.asarray(row @ model.reduced.basis) for row in rows])
        self._settled = [self._pile.at_rest() for _ in rows]
        self._asked = list(self._settled)
        self._step = 0

    def force(self, step: int, heads: FloatArray) -> FloatArray:
        """Return K q − F(q) (6·n_feet,): by how much the ground carries less than if it were linear."""
        if step != self._step:
            self._settled, self._step = list(self._asked), step
        out = np.empty_like(heads)
        for i, held in enumerate(self._settled):
            here = slice(6 * i, 6 * i + 6)
            force, self._asked[i] = advance(self._pile, held, heads[here])
            out[here] = self._linear @ heads[here] - force
        return out
