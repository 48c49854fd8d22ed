"""Rows of numbers of several laws, padded to the longest, as the compiled kernels take them."""

from collections.abc import Sequence

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.soil.laws.viscoelastic import Law


def law_rows(laws: Sequence[Law]) -> FloatArray:
    """Return (n_laws, width) rows."""
    widest = max(law.row.size for law in laws)
    return np.array([np.pad(law.row, (0, widest - law.row.size)) for law in laws])
