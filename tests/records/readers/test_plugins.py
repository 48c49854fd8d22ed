"""A reader that an installed package brings: a real distribution, found through its entry point."""

import json
import os
import subprocess
import sys
from pathlib import Path

READER = """
import numpy as np
from jackettwin.records.readers.registry import Format
from jackettwin.records.readers.table import ReadTable

def read(path):
    samples = np.array([[float(word) for word in path.read_text().split()]])
    return ReadTable(("acc_x",), samples, sample_rate_hz=10.0, unit="m/s^2")

FORMAT = Format("logger of another make", (".xyz",), read)
"""
METADATA = "Metadata-Version: 2.1\nName: other-logger\nVersion: 1.0\n"
ENTRY = "[jackettwin.readers]\nother = other_logger:FORMAT\n"


def test_a_command_reads_what_an_installed_package_can(tmp_path: Path) -> None:
    """As pip leaves it: the module and its ``dist-info`` beside each other."""
    site = tmp_path / "site"
    info = site / "other_logger-1.0.dist-info"
    info.mkdir(parents=True)
    (site / "other_logger.py").write_text(READER)
    (info / "METADATA").write_text(METADATA)
    (info / "entry_points.txt").write_text(ENTRY)
    (tmp_path / "r.xyz").write_text(" ".join(str(0.01 * (i * i % 17)) for i in range(600)))
    code = (
        "import json, sys; from jackettwin.records import read_record\n"
        "record = read_record(sys.argv[1])\n"
        "print(json.dumps([record.channels[0].name, record.data.shape, record.sample_rate_hz]))"
    )
    path = os.pathsep.join([str(site), *sys.path])
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "r.xyz")],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": path},
    )
    assert json.loads(done.stdout) == ["acc_x", [1, 600], 10.0]
