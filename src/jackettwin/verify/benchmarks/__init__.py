"""Benchmarks that others published, computed with the product; ``benchmarks.csv`` holds their figures."""

from __future__ import annotations

from collections.abc import Callable

from jackettwin.verify.benchmarks.foundations import foundation_benchmarks
from jackettwin.verify.benchmarks.frames import frame_benchmarks
from jackettwin.verify.benchmarks.piles import pile_benchmarks
from jackettwin.verify.benchmarks.turbines import turbine_benchmarks
from jackettwin.verify.benchmarks.waves import wave_benchmarks
from jackettwin.verify.benchmarks.welds import weld_benchmarks
from jackettwin.verify.rows import Computed

__all__ = ["BENCHMARKS"]

BENCHMARKS: dict[str, Callable[[], Computed]] = {
    "frames and beams": frame_benchmarks,
    "foundations": foundation_benchmarks,
    "piles and beams on springs": pile_benchmarks,
    "rotors and towers": turbine_benchmarks,
    "waves": wave_benchmarks,
    "welds": weld_benchmarks,
}
"""Function that computes the rows of a field."""
