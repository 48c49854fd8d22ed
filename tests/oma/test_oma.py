"""Records, modes and alarms of any structure: nothing else of the package is loaded, nor needed."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from jackettwin import oma
from jackettwin.oma import (
    Channel,
    History,
    IdentificationSettings,
    Record,
    assess,
    fuse,
    identify,
    mac,
    read_record,
    repair,
    start_watch,
    watch_day,
    write_record,
)

EXAMPLE = Path(__file__).parents[2] / "examples" / "07_modes_of_a_bridge.py"
ROOMS = {"records", "identification", "watching"}
"""What the door leads to …"""
GROUND = {
    "arrays", "axes", "constants", "errors", "files", "findings", "intervals", "oma", "plugins", "processes",
    "quantities", "signals", "version",
}  # fmt: skip
"""… and what these stand on."""
SHAPE = np.array([0.7, 1.0, 0.7])


def span(seed: int) -> Record:
    """Return five minutes of a span with modes at 1.3 and 3.1 Hz."""
    rng, rate, n = np.random.default_rng(seed), 20.0, 6000
    omega = 2.0 * np.pi * np.fft.rfftfreq(n, 1.0 / rate)
    y = 0.01 * rng.standard_normal((3, n))
    for f, shape in ((1.3, SHAPE), (3.1, [1.0, 0.0, -1.0])):
        own = 2.0 * np.pi * f
        response = -(omega**2) / (own**2 - omega**2 + 0.02j * own * omega)
        y += np.outer(shape, np.fft.irfft(response * np.fft.rfft(rng.standard_normal(n)), n))
    return Record(y, rate, (Channel("west"), Channel("middle"), Channel("east")), name=f"span{seed}")


def test_the_names_of_the_door() -> None:
    assert len(oma.__all__) == len(set(oma.__all__)) <= 20
    assert all(getattr(oma, name).__doc__ for name in oma.__all__)


def test_the_door_leads_nowhere_else() -> None:
    """The example runs from reading to modes; whatever was loaded until then belongs to the three rooms."""
    code = (
        "import json, runpy, sys\n"
        "runpy.run_path(sys.argv[1])['main']()\n"
        "print(json.dumps(sorted(name for name in sys.modules if name.startswith('jackettwin.'))))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(EXAMPLE)], capture_output=True, text=True, check=True
    )
    loaded = {name.split(".")[1] for name in json.loads(done.stdout.splitlines()[-1])}
    assert loaded >= ROOMS
    assert loaded <= ROOMS | GROUND


def test_a_record_goes_through_a_file_to_its_modes(tmp_path: Path) -> None:
    write_record(span(1), tmp_path / "span.parquet")
    record = read_record(tmp_path / "span.parquet")
    quality = assess(record)
    found = identify(repair(record, quality), IdentificationSettings(highest_frequency_hz=5.0))
    first, second = found.modes
    # five minutes at 1.3 Hz and ζ 1 %: a standard deviation of 0.3 % (Au 2014), thrice that here
    np.testing.assert_allclose([first.frequency_hz, second.frequency_hz], [1.3, 3.1], rtol=0.01)
    assert mac(first.mode_shape[None], SHAPE[None])[0, 0] > 0.999


def test_records_are_fused() -> None:
    fused = fuse(identify(span(seed)) for seed in (1, 2, 3))
    assert [len(mode.sightings) for mode in fused.modes] == [3, 3]
    assert fused.duration_s == 900.0


def history(days: np.ndarray, changed: float, seed: int = 3) -> History:
    """Return a frequency seen four times a day that changes by a share on day 40."""
    rng = np.random.default_rng(seed)
    f = 1.3 * np.where(days < 40.0, 1.0, 1.0 + changed) * (1.0 + 2e-3 * rng.standard_normal(days.size))
    none = np.full((days.size, 1), np.nan)
    std, states = np.full((days.size, 1), 2.6e-3), np.zeros(days.size, dtype=int)
    return History(days, ("bending",), f[:, None], std, none, none, np.empty((days.size, 0)), (), states)


def test_a_change_is_told_and_its_absence_is_not() -> None:
    days = np.arange(0.0, 70.0, 0.25)
    for changed in (0.0, -0.01):
        whole = history(days, changed)
        watch, alarms = start_watch(whole.rows(days < 30.0)), []
        for day in range(30, 70):
            watch, look = watch_day(watch, whole.rows(np.floor(days) == day))
            alarms += [] if look.change is None else [(day, float(look.change.size[0]))]
        assert len(alarms) == (changed != 0.0)
        for day, size in alarms:
            assert 40 <= day <= 46
            assert abs(size - np.log1p(changed)) < 0.003
