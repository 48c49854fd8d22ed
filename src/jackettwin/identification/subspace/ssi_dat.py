r"""Data-driven stochastic subspace identification: the projection of future on past outputs.

.. math:: P = Y_f Y_p^T (Y_p Y_p^T)^{-1} Y_p, \quad
   \begin{bmatrix} Y_p \\ Y_f \end{bmatrix} = \begin{bmatrix} L_{11} & 0 \\ L_{21} & L_{22} \end{bmatrix}
   \begin{bmatrix} Q_1^T \\ Q_2^T \end{bmatrix}, \quad P = L_{21} Q_1^T

(Van Overschee & De Moor 1996, ch. 3; Peeters & De Roeck 1999, reference channels). The column space of P
is that of its factor :math:`L_{21}`; from there SSI-dat proceeds as SSI-cov with another weighting.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.identification.subspace.ssi_cov import Subspace, balanced_subspace

if TYPE_CHECKING:
    from collections.abc import Sequence


CHUNK = 4096
"""Columns of the data matrices factorised at a time: memory does not grow with the record."""


def ssi_dat(
    y: FloatArray, *, block_rows: int, max_order: int, references: Sequence[int] | None = None
) -> Subspace:
    """Factorise the projection once for all model orders.

    Parameters
    ----------
    y : (n_channels, n_samples)
        NaN marks a missing sample; instants whose past or future contains one are left out.
    references : sequence of int, optional
        Rows that make up the past; default all.

    Raises
    ------
    InputError
        If there are fewer complete instants than the data matrices have rows.
    """
    n_channels = len(y)
    past = y if references is None else y[list(references)]
    n_past, n_future = block_rows * len(past), block_rows * n_channels
    instants = _whole_instants(y, block_rows)
    if len(instants) < n_past + n_future:
        raise InputError(
            "gaps or a short record leave too little for SSI-dat",
            field="method",
            value=f"{len(instants)} complete instants",
            allowed=f"≥ {n_past + n_future} for {block_rows} block rows",
            remedy="use ssi-cov, which copes with gaps, or fewer block rows",
        )
    triangle: FloatArray = np.empty((0, n_past + n_future))
    for first in range(0, len(instants), CHUNK):
        at = instants[first : first + CHUNK]
        before = past[:, at[:, None] - np.arange(1, block_rows + 1)]
        after = y[:, at[:, None] + np.arange(block_rows)]
        triangle = _triangle(np.vstack([triangle, np.hstack([_stacked(before), _stacked(after)])]))
    projection = triangle[:n_past, n_past:].T / np.sqrt(len(instants))
    return balanced_subspace(np.asarray(projection), n_channels, max_order, factors=False)


def _whole_instants(y: FloatArray, block_rows: int) -> IntArray:
    """Return the instants whose past and future contain no missing sample."""
    whole = np.isfinite(y).all(axis=0)
    run = np.convolve(whole, np.ones(2 * block_rows), mode="valid")
    return np.flatnonzero(run > 2 * block_rows - 0.5) + block_rows


def _triangle(rows: FloatArray) -> FloatArray:
    """Return the square upper factor R of rows = QR."""
    (r,) = linalg.qr(rows, mode="r", check_finite=False)
    return np.asarray(r[: rows.shape[1]], dtype=np.float64)


def _stacked(windows: FloatArray) -> FloatArray:
    """Reshape (n_channels, n_instants, block_rows) to (n_instants, block_rows · n_channels)."""
    return np.asarray(windows.transpose(1, 2, 0).reshape(windows.shape[1], -1))
