"""Shares of the variance of a mode over the baseline explained by each condition."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.watching.block import Block
from jackettwin.watching.design import Design


def shares(
    block: Block, design: Design, rows: FloatArray, values: FloatArray
) -> tuple[dict[str, float], ...]:
    """Return for each quantity the share of its variance over the baseline by condition.

    The share of a condition is the covariance of its contribution with the quantity, so that the shares add
    up to the part explained by all conditions. "slow" is the share of unexplained slow processes, "noise"
    that of identification.

    Parameters
    ----------
    rows : (n, p) regressors of the baseline
    values : (n, m) logarithms of the quantities, NaN where missing
    """
    names = np.array(design.names)
    out = []
    for q in range(len(block.kept)):
        seen = np.isfinite(values[:, q]) & np.isfinite(rows).all(axis=1)
        y = values[seen, q] - values[seen, q].mean()
        total = float(np.mean(y**2))
        parts = rows[seen] * block.reference[q]
        share = {
            str(name): float(np.mean((parts[:, names == name].sum(axis=1)) * y) / total)
            for name in dict.fromkeys(names)
            if name != "level"
        }
        memory = block.memories[0]
        slow = float(memory.std[q] ** 2) / total
        share["slow, unexplained"] = min(slow, max(0.0, 1.0 - sum(share.values())))
        share["noise"] = max(0.0, 1.0 - sum(share.values()))
        out.append(share)
    return tuple(out)


def slopes(block: Block, design: Design) -> tuple[dict[str, float], ...]:
    """Return the steady-state effect of a unit of each condition on each quantity, about the baseline's mean.

    The effects are on logarithms, or directions [rad], in the most frequent operating state, after all lags.
    """
    first = len(design.states)
    out: tuple[dict[str, float], ...] = tuple({} for _ in block.kept)
    for place, column in enumerate(design.columns, start=first):
        if column.shape == "line":
            for found, per_scale in zip(out, block.reference[:, place], strict=True):
                found[column.name] = found.get(column.name, 0.0) + float(per_scale) / column.scale
    return out


def unexplained_std(block: Block) -> FloatArray:
    """Return the standard deviation of the slow processes, averaged over models, (m,)."""
    weight = np.exp(block.log_weights)
    each = np.array([memory.std**2 for memory in block.memories])
    return np.asarray(np.sqrt(weight @ each))
