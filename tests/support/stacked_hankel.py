"""Another estimator of the Hankel matrix and of its scatter, to compare with."""

from collections.abc import Callable, Iterable

import numpy as np

from jackettwin.arrays import FloatArray


def stacked_hankel(
    y: FloatArray, block_rows: int, n_blocks: int
) -> tuple[FloatArray, Callable[[], Iterable[FloatArray]]]:
    """Return the Hankel matrix by stacked data and a source of its block deviations.

    The estimator of pyOMA2's ``cov`` (Döhler & Mevel 2013, §3.2): every block of a segment averages
    over the same instants. For comparison; gaps are not allowed.

    Parameters
    ----------
    y : (n_channels, n_samples)
    """
    n_channels, n_samples = y.shape
    length = n_samples - 2 * block_rows + 1

    def products(start: int, stop: int) -> FloatArray:
        future = [y[:, block_rows + i + start : block_rows + i + stop] for i in range(block_rows)]
        past = [y[:, block_rows - 1 - j + start : block_rows - 1 - j + stop] for j in range(block_rows)]
        return np.asarray(np.vstack(future) @ np.vstack(past).T / (stop - start))

    whole = products(0, length)

    def deviations() -> Iterable[FloatArray]:
        size = length // n_blocks
        for b in range(n_blocks):
            yield (products(b * size, (b + 1) * size) - whole) / np.sqrt(n_blocks * (n_blocks - 1.0))

    return whole, deviations
