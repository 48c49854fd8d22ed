r"""One Hankel matrix of all channels from setups in which some sensors were moved.

Setup j sees some channels of one system, under its own excitation. With common references its Hankel
matrix factorises as :math:`H^{(j)} = O^{(j)} Z^{(j)}`, with those rows of the one observability matrix that
belong to its channels, and a factor that holds its excitation. The rows of the channels that every setup has,
side by side, give all these factors in one state basis,

.. math:: [H^{(1,\mathrm{ref})} \dots H^{(J,\mathrm{ref})}] = U \Sigma V^T, \quad
          [Z^{(1)} \dots Z^{(J)}] = V_n^T,

and re-scale the rows of a channel that was moved, from setup j that has it to any setup k,

.. math:: H^{(k,\mathrm{mov})} = H^{(j,\mathrm{mov})}\, (Z^{(j)})^+ Z^{(k)},

before the identification: "pre global estimation re-scaling" (PreGER; Döhler, Andersen & Mevel 2012, after
Mevel, Basseville, Benveniste & Goursat 2002). There k is one setup; here it is all of them, so that each
setup's own data remain as measured.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg

from jackettwin.arrays import FloatArray, Int64Array
from jackettwin.identification.subspace.ssi_cov import RANK, hankel

if TYPE_CHECKING:
    from collections.abc import Sequence


def joined_hankel(
    covariances: Sequence[FloatArray], rows: Sequence[Int64Array], block_rows: int, max_order: int
) -> FloatArray:
    """Return the Hankel matrix of all channels, with the block columns of all setups side by side.

    What a setup measured enters unchanged; what it could not see is re-scaled from the setups that did.
    A single setup gives its own Hankel matrix.

    Parameters
    ----------
    covariances : for each setup (2·block_rows + 1, n_channels of the setup, n_references)
        Lags 0 … 2·block_rows; the references are the same channels in the same order in all setups.
    rows : for each setup (n_channels of the setup,)
        Position of each of its channels among all, numbered from 0 without gaps. At least one channel must be
        in every setup.
    block_rows : int
    max_order : int
        Largest number n of states whose factors re-scale; at most half the rows of the common channels
        are taken, since the last factors are those of noise.

    Returns
    -------
    (block_rows·n_channels, n_setups·block_rows·n_references)
    """
    n_channels = 1 + max(int(own.max()) for own in rows)
    n_columns = block_rows * covariances[0].shape[2]
    h = np.full((block_rows, n_channels, len(rows), n_columns), np.nan)
    seen = np.zeros((n_channels, len(rows)), dtype=bool)
    for j, (lags, own) in enumerate(zip(covariances, rows, strict=True)):
        h[:, own, j] = hankel(lags, block_rows).reshape(block_rows, len(own), n_columns)
        seen[own, j] = True
    common = seen.all(axis=1)
    factors = _factors(h[:, common].reshape(-1, len(rows) * n_columns), max_order)
    factors = factors.reshape(-1, len(rows), n_columns)
    for c in np.flatnonzero(~common):
        here, n_states = seen[c], len(factors)
        own_factors = factors[:, here].reshape(n_states, -1)
        observability = linalg.lstsq(own_factors.T, h[:, c, here].reshape(block_rows, -1).T)[0].T
        h[:, c, ~here] = np.tensordot(observability, factors[:, ~here], axes=1)
    return h.reshape(block_rows * n_channels, -1)


def _factors(common: FloatArray, max_order: int) -> FloatArray:
    """Return the leading right singular vectors of the rows of common channels, (n_states, n_columns)."""
    _, s, vt = linalg.svd(common, full_matrices=False, check_finite=False)
    return np.asarray(vt[: min(max_order, len(common) // 2, int(np.sum(s > RANK * s[0])))])
