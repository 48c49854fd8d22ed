"""The judges of coverage judge from both sides."""

import numpy as np
from calibration import are_standard, is_calibrated


def test_too_wide_fails_as_too_narrow_does() -> None:
    assert is_calibrated(950, 1000) and not is_calibrated(990, 1000) and not is_calibrated(900, 1000)
    z = np.random.default_rng(1).standard_normal(2000)
    assert are_standard(z) and not are_standard(z / 1.12) and not are_standard(z * 1.12)
