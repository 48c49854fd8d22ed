"""Modes of a bridge: no jacket, no model, only its accelerations.

The record is made here: a simply supported span under white noise, whose nth mode is a sine of n half waves
at n² times the first frequency. ``jackettwin.oma`` needs nothing of the rest of the package.
Run: python examples/07_modes_of_a_bridge.py
"""

import numpy as np

from jackettwin.oma import Channel, Record, assess, identify, mac, repair

FIRST_HZ, DAMPING = 1.3, 0.01
PLACES = np.array([0.13, 0.25, 0.38, 0.5, 0.69, 0.81])
"""Of the accelerometers, as shares of the span."""
SHAPES = np.sin(np.pi * np.outer([1, 2, 3], PLACES))
RATE_HZ, SECONDS = 50.0, 600.0


def bridge() -> Record:
    """Return ten minutes of accelerations [m/s²], the second channel with a spike as a bad cable makes it."""
    rng, n = np.random.default_rng(7), int(RATE_HZ * SECONDS)
    omega = 2.0 * np.pi * np.fft.rfftfreq(n, 1.0 / RATE_HZ)
    y = 0.002 * rng.standard_normal((len(PLACES), n))
    for number, shape in enumerate(SHAPES, start=1):
        own = 2.0 * np.pi * FIRST_HZ * number**2
        response = -(omega**2) / (own**2 - omega**2 + 2j * DAMPING * own * omega)
        force = 0.01 * np.fft.rfft(rng.standard_normal(n))
        y += np.outer(shape, np.fft.irfft(response * force, n))
    y[1, 12_345] += 5.0
    channels = tuple(Channel(f"z{100 * place:.0f}", "acceleration", "m/s^2") for place in PLACES)
    return Record(y, RATE_HZ, channels, name="span")


def main() -> tuple[list[float], float]:
    """Print quality and modes; return frequencies over the true ones, and the lowest MAC with the truth."""
    record = bridge()
    quality = assess(record)
    for finding in quality.findings:
        print(f"{finding.subject}: {finding.text}")
    found = identify(repair(record, quality))
    for mode in found.modes:
        low, high = mode.frequency_interval_90 or (float("nan"),) * 2
        print(f"{low:.4f} to {high:.4f} Hz in 90 %, damping {100 * mode.damping_ratio:.2f} %")
    true = FIRST_HZ * np.array([1, 4, 9])
    ratios = [mode.frequency_hz / f for mode, f in zip(found.modes, true, strict=True)]
    alike = np.diag(mac(np.array([mode.mode_shape for mode in found.modes]), SHAPES))
    return ratios, float(alike.min())


if __name__ == "__main__":
    main()
