"""The Kaimal spectrum, written out from the standard apart from the program's own band means."""

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads.aerodynamics.wind import Wind


def kaimal(wind: Wind, frequency_hz: FloatArray, component: int = 0) -> FloatArray:
    """Return S_k(f) [m²/s] of u, v, w (0, 1, 2), IEC 61400-1 (2019) eq. (C.14) and table C.1.

    f S/σ² = 4 (fL/V) / (1 + 6 fL/V)^{5/3}
    """
    L = (8.1, 2.7, 0.66)[component] * wind.scale_m / wind.speed_m_s
    sigma = (1.0, 0.8, 0.5)[component] * wind.sigma
    return np.asarray(4.0 * sigma**2 * L / (1.0 + 6.0 * np.asarray(frequency_hz) * L) ** (5.0 / 3.0))
