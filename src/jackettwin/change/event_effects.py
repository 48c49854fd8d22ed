"""What an event does to frequencies, damping and directions: from the modes before and after it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.change.changed_structures import Happening, Standing
from jackettwin.change.standing_modes import MODES, Modes

_DAMPED = 0.9
"""Largest share of a damping ratio that an event takes: the ground has no more of one, but for its model."""
_MIXES = 0.5
"""Errors of a model's directions over its error of frequencies, by other rotations of two modes than an equal
error beside the diagonal makes: docs/verification/directions.md."""


def effect(event: Happening, base: Modes, after: Modes, eta: float, zeta: FloatArray) -> FloatArray:
    """Return the change of ln f, ln ζ and directions [rad] by one unit of an event, (3·MODES,).

    The ground's part of ζ is ½η times its share of the strain energy. No event takes more than
    ``_DAMPED`` of a ζ.
    """
    ln_f = np.log(after.modes.omega / base.modes.omega)
    more = 0.5 * eta * (after.soil_share - base.soil_share) + event.damps * np.maximum(-ln_f, 0.0)
    ln_zeta = np.log1p(np.maximum(more / zeta, -_DAMPED))
    return np.concatenate([ln_f, ln_zeta, turned(base, after)]) / event.per


def mixing(event: Happening, base: Modes, after: Modes, error: float) -> FloatArray:
    r"""Return what another rotation of two modes than the model's does to an event's effect, (k, 3·MODES).

    With G = Φᵀ(δK − λδM)Φ of the event, a rotation φ of modes i and j changes its effect by

    .. math:: φ G_{ij}/λ_i \text{ and } -φ G_{ij}/λ_j, \quad
              \tan 2φ = \frac{4 ε_{ij} \sqrt{λ_iλ_j}}{|λ_i - λ_j|}

    ε_ij is half of what the model misses beside the diagonal, as its error of frequencies is half of what it
    misses on it. Members that differ from the drawing divide an effect otherwise between neighbouring modes;
    only the sum is as certain as their energies.
    """
    left, _, right = np.linalg.svd(base.modes.shapes.T @ (base.mass @ after.modes.shapes))
    turn, before = left @ right, base.modes.omega**2
    G = (turn * after.modes.omega**2) @ turn.T - np.diag(before)
    rows = []
    for i in range(MODES):
        for j in range(i):
            apart = abs(before[i] - before[j]) / np.sqrt(before[i] * before[j])
            phi = 0.5 * np.arctan2(4.0 * _MIXES * error, apart)
            row = np.zeros(3 * MODES)
            row[i], row[j] = phi * G[i, j] / before[i], -phi * G[i, j] / before[j]
            rows.append(row / event.per)
    return np.array(rows)


def pairs_of(labels: Sequence[str]) -> list[tuple[int, int]]:
    """Return the bending pairs among some modes: places of the fore-aft and of the side-side one."""
    pairs = ((f"fore_aft_{n}", f"side_side_{n}") for n in range(1, MODES))
    return [(labels.index(a), labels.index(b)) for a, b in pairs if a in labels and b in labels]


def turned(base: Modes, after: Modes) -> FloatArray:
    """Return the rotation of the lower mode of each bending pair [rad], from x towards y.

    It is given at both modes of the pair, (MODES,); opposite directions are equivalent.
    """
    out = np.zeros(MODES)
    for i, j in pairs_of(base.labels):
        before, now = (m.direction[i if m.modes.omega[i] < m.modes.omega[j] else j] for m in (base, after))
        out[[i, j]] = 0.5 * np.angle(np.exp(2j * (now - before)))
    return out


def repeated(event: Happening, times: float) -> Happening:
    """Return an event so many times over, a whole number unless it has ``often``, and its effect per unit."""

    def apply(standing: Standing) -> Standing:
        for _ in range(int(times)):
            standing = event.apply(standing)
        return standing

    often = apply if event.often is None else event.often(times)
    return replace(event, apply=often, per=times * event.per)


def happened(event: Happening, stands: Sequence[Standing]) -> list[Standing]:
    """Return the stands of one structure after an event, which changes that whatever its feet."""
    first = event.apply(stands[0])
    if first.horizontal is stands[0].horizontal and first.vertical is stands[0].vertical:
        return [replace(standing, structure=first.structure) for standing in stands]
    return [first, *(replace(event.apply(s), structure=first.structure) for s in stands[1:])]


def bend(per_unit: dict[float, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return sizes, and the deviation of the change per unit from that of a single event.

    Towards zero it goes on as between the two smallest.

    Parameters
    ----------
    per_unit : by size, change by it per unit; first that of a single event, alone if it has one size
    """
    once = next(iter(per_unit.values()))
    if len(per_unit) == 1:
        return np.zeros(0), np.zeros((0, once.size))
    sizes = sorted(per_unit)
    bends = [per_unit[size] - once for size in sizes]
    none = bends[0] - (bends[1] - bends[0]) * sizes[0] / (sizes[1] - sizes[0])
    return np.array([0.0, *sizes]), np.array([none, *bends])
