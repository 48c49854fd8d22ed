"""Memory and CPU seconds of ``identify --whole`` on a record of hours.

``python benchmarks/bench_long_record.py 24``: six modes under white forces in nine channels at 100 Hz with
sensor noise, written to Parquet ten minutes at a time. Bars: 400 MB and 150 CPU-s for a day, on a machine
whose dense 800 × 800 eigenvalues take 0.47 s.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from time import process_time

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from scipy.signal import lfilter

F = np.array([0.172, 0.176, 1.02, 1.15, 1.9, 2.4])
ZETA = np.array([0.006, 0.012, 0.008, 0.009, 0.012, 0.010])
RMS = np.array([0.05, 0.05, 0.02, 0.02, 0.01, 0.01])
NOISE = 2e-3
RATE, CHANNELS, PIECE_S = 100.0, 9, 600.0


def write(path: Path, hours: float) -> None:
    """Write the record; modes keep their state from one piece to the next."""
    rng = np.random.default_rng(7)
    poles = np.exp((-ZETA + 1j * np.sqrt(1.0 - ZETA**2)) * 2.0 * np.pi * F / RATE)
    filters = [np.array([1.0, -2.0 * p.real, abs(p) ** 2]) for p in poles]
    # variance of white noise behind the filter: that of an AR(2) process
    gain = [
        RMS[k] * np.sqrt((1 - a[2]) * ((1 + a[2]) ** 2 - a[1] ** 2) / (1 + a[2]))
        for k, a in enumerate(filters)
    ]
    level = np.linspace(1.0, 0.3, (CHANNELS + 1) // 2)[np.arange(CHANNELS) // 2]
    crosswise = np.arange(CHANNELS)[:, None] % 2 != np.arange(len(F)) % 2
    shapes = np.cos((np.arange(len(F)) // 2) * 0.8 * np.pi * (1.0 - level[:, None])) * level[:, None]
    shapes = np.where(crosswise, 0.02 * level[:, None], shapes)
    names = [f"acc_{'abcde'[i // 2]}_{'xy'[i % 2]}" for i in range(CHANNELS)]
    n, state = int(PIECE_S * RATE), [np.zeros(2) for _ in F]
    with pq.ParquetWriter(path, pa.schema([(name, pa.float32()) for name in names])) as file:
        for _ in range(round(hours * 3600.0 / PIECE_S)):
            q = np.empty((len(F), n))
            for k, a in enumerate(filters):
                q[k], state[k] = lfilter([gain[k]], a, rng.standard_normal(n), zi=state[k])
            y = shapes @ q + NOISE * rng.standard_normal((CHANNELS, n))
            file.write_table(pa.table(dict(zip(names, y.astype(np.float32), strict=True))))
    said = {"sample_rate_hz": RATE, "channels": {name: {"unit": "m/s^2"} for name in names}}
    path.with_suffix(".json").write_text(json.dumps(said))


def main(hours: float) -> None:
    """Print memory and CPU seconds of the command, start-up included, and its modes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.parquet"
        write(path, hours)
        command = [sys.executable, "-m", "jackettwin", "identify", str(path), "--whole", "--fresh", "--json"]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = used.ru_utime + used.ru_stime
    matrix = np.random.default_rng(0).standard_normal((800, 800))
    start = process_time()
    np.linalg.eig(matrix)
    scaled = 0.47 / (process_time() - start) * spent
    print(f"{hours:g} h: {used.ru_maxrss / 1e3:.0f} MB, {spent:.0f} CPU-s, {scaled:.0f} scaled")
    modes = json.loads(done.stdout)["modes"]
    for f, zeta in zip(F, ZETA, strict=True):
        mode = min(modes, key=lambda m: abs(m["frequency_hz"] / f - 1.0))
        found = f"{mode['frequency_hz']:.4f} Hz, {100.0 * mode['damping_ratio']:.3f} %, {mode['status']}"
        print(f"{f:.3f} Hz, {100.0 * zeta:.1f} %: {found}")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 24.0)
