"""Waves and their loads: another program's stream function, closed forms of linear waves on a cylinder."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from jackettwin.constants import GRAVITY_M_S2
from jackettwin.loads import highest_wave, regular_wave, wave_number
from jackettwin.verify.rows import Computed


def wave_benchmarks() -> Computed:
    """Return lengths, crests and speeds of waves, by their ids."""
    return {**_stream_function(), **_linear(), **_highest()}


def _stream_function() -> Computed:
    """H = 0.2 m, d = 0.5 m, L = 2 m with g = 9.81 m/s², given by the period of the other program."""
    speed, length, depth = 1.799024665755609, 2.0, 0.5
    # waves of one shape are as fast as √g
    scale = sqrt(9.81 / GRAVITY_M_S2)
    wave = regular_wave("stream-function", height=0.2, period=length / speed * scale, depth=depth, order=20)
    at = np.array([[0.0, 0.0, 0.0], [0.25 * length, 0.0, 0.0], [0.5 * length, 0.0, 0.0]])
    crest, quarter, trough = (depth + wave.elevation(at, np.zeros(1))[0]).tolist()
    return {
        "fenton-length": 2.0 * pi / wave.k,
        "fenton-crest": crest,
        "fenton-quarter": quarter,
        "fenton-trough": trough,
    }


def _linear() -> Computed:
    """Return d/L of linear waves where d/L₀ is given."""
    found: Computed = {}
    for text in ("0.1", "0.2", "0.5"):
        depth = 10.0
        deep = depth / float(text)
        omega = sqrt(2.0 * pi * GRAVITY_M_S2 / deep)
        found[f"linear-{text}"] = depth * float(wave_number(omega, depth)) / (2.0 * pi)
    return found


def _highest() -> Computed:
    """Return the steepest deep-water wave H/λ, and the highest solitary one H/d."""
    return {"highest-deep": highest_wave(1.0, 1e3), "highest-shallow": highest_wave(1e5, 1.0)}
