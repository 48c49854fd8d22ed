"""The types of arrays that signatures name; their shapes stand in the docstrings."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
AnyFloatArray = npt.NDArray[np.floating[Any]]
"""In single precision where seven digits are enough."""
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.intp]
"""Indices into arrays."""
Int64Array = npt.NDArray[np.int64]
"""Whole numbers of a stated width: counts and times in nanoseconds."""
