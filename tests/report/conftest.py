from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import plotly.graph_objects as go
import pytest
from figure_units import assert_units_of

from jackettwin.caveats import Assumption
from jackettwin.decks import read_structure
from jackettwin.identification import (
    Examination,
    Identification,
    IdentificationSettings,
    ModalEstimate,
    identify,
)
from jackettwin.identification.comparison import compare_methods
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record, assess
from jackettwin.response.modes.labels import mode_kinds, mode_labels
from jackettwin.response.sensors import Sensor
from jackettwin.soil import family
from jackettwin.structure import Rayleigh, assemble
from jackettwin.study import TwinResult
from jackettwin.study.measurements import MeasuredMode
from jackettwin.study.result import DampingExcess
from jackettwin.twin.observation import Observation, Recognised
from jackettwin.updating import Residuals, Target, numbered_modes, single, support_model, update

PLACES = (("top", 144.0), ("mid", 77.0))


@pytest.fixture(scope="session")
def targets_only() -> TwinResult:
    """Table 6.1 on the reference jacket: no record, nothing identified."""
    assembly = assemble(read_structure("jacket15"))
    numbered = numbered_modes(assembly, 8)
    labels = mode_labels(mode_kinds(assembly, numbered.shapes, numbered.frequency_hz))
    targets = (Target(1, 0.1819, damping_ratio=0.0127), Target(2, 0.1838), Target(4, 0.7362))
    steel = Rayleigh.minimum(0.01, 0.1832)
    model = support_model(assembly, family=family("kelvin-voigt"), rayleigh=steel)
    fitted = update(single(model, Residuals(targets, relative=True)), starts=4)
    measured = tuple(
        MeasuredMode(
            t.mode, labels[t.mode - 1], t.frequency_hz, None, t.damping_ratio, None, None, None, True,
            t.damping_ratio is not None,
        )
        for t in targets
    )  # fmt: skip
    return TwinResult(
        name="from_targets",
        assembly=assembly,
        sensors=(),
        numbered=numbered,
        labels=labels,
        observations=(),
        shown=None,
        measured=measured,
        updates=(fitted,),
        excess=((),),
        assumptions=(Assumption("steel_damping", "The steel has 1 %."),),
        warnings=(),
    )


@pytest.fixture(scope="session")
def record() -> Record:
    """Four channels of noise through two lightly damped modes."""
    rng = np.random.default_rng(1)
    rate, n = 10.0, 6000
    data = 0.02 * rng.standard_normal((4, n))
    for row, f in ((0, 0.18), (1, 0.21)):
        pole = np.exp((-0.01 + 1j) * 2 * np.pi * f / rate)
        q = np.zeros(n, dtype=complex)
        drive = rng.standard_normal(n)
        for k in range(1, n):
            q[k] = pole * q[k - 1] + drive[k]
        data[row::2] += np.outer([1.0, 0.5], q.real)
    directions = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0)}
    channels = tuple(
        Channel(f"acc_{name}_{axis}", height_m=height, direction=direction)
        for name, height in PLACES
        for axis, direction in directions.items()
    )
    return Record(data, rate, channels, name="noise <&> modes")


@pytest.fixture(scope="session")
def observation(record: Record) -> Examination:
    found = identify(record)
    return Examination(record, assess(record), found, compare_methods(record, found))


def _certain(mode: ModalEstimate) -> ModalEstimate:
    return replace(mode, frequency_std_hz=0.0012, damping_ratio_std=0.0033)


@pytest.fixture(scope="session")
def complete(targets_only: TwinResult, record: Record, observation: Examination) -> TwinResult:
    """A record with uncertainty on every mode, an unpaired mode, unexplained damping."""
    modes = tuple(map(_certain, observation.identification.modes))
    found = replace(observation.identification, modes=modes)
    measured = tuple(
        replace(
            m,
            frequency_std_hz=0.0012,
            damping_ratio=0.0234,
            damping_ratio_std=0.0033,
            mac=0.97,
            estimate=mode,
        )
        for m, mode in zip(targets_only.measured, found.modes[:2], strict=False)
    )
    known = [Recognised(m.mode, m.label, 0.97) for m in measured]
    sensors = tuple(Sensor(c.name, c.direction, height_m=c.height_m) for c in record.channels)
    seen = Observation(
        "id", "model", "settings", "0", record.name, None, {}, observation.quality.summary(),
        found.without_figures, (*known, *[None] * (len(found.modes) - len(known))), sensors,
    )  # fmt: skip
    excess = (DampingExcess("side_side_1", 0.0456, 0.004, 0.0123),)
    return replace(
        targets_only,
        name="from_record",
        sensors=sensors,
        observations=(seen,),
        shown=replace(observation, identification=found),
        measured=(*measured, *targets_only.measured[len(measured) :]),
        excess=(excess,),
        warnings=("Beware <script>alert(1)</script>.",),
    )


@pytest.fixture(scope="session")
def assert_units() -> Callable[[go.Figure], None]:
    """Fail on an axis that shows numbers without quantity and unit."""
    return assert_units_of


@pytest.fixture(scope="session")
def identifications() -> list[Identification]:
    """Three records of one system of two modes."""
    rng = np.random.default_rng(3)
    system = ModalSystem(
        frequency_hz=np.array([0.5, 1.3]),
        damping_ratio=np.array([0.02, 0.015]),
        mode_shapes=np.array([[1.0, 0.6, 0.3], [-0.4, 0.5, 1.0]]),
        force=np.eye(2),
    )
    settings = IdentificationSettings(lowest_frequency_hz=0.3, max_order=24, refine=False)
    return [
        identify(simulate(system, rng, duration_s=300.0, sample_rate_hz=10.0), settings) for _ in range(3)
    ]
