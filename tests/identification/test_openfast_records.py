"""The shipped OpenFAST records: what an independent program says the modes are."""

from __future__ import annotations

import json
from importlib.resources import files

import numpy as np
import pytest
from calibration import are_standard

from jackettwin.identification import fuse, identify
from jackettwin.identification.many_records.pairs import along_axes
from jackettwin.records import read_record

RECORDS = files("jackettwin") / "data" / "records"
RIGID = sorted(
    path.name.removesuffix(".json")
    for path in RECORDS.iterdir()
    if path.name.endswith(".json") and "flexible" not in path.name
)
PAIRS = (("side_side_1", "fore_aft_1"), ("side_side_2", "fore_aft_2"))
IN_TURBULENCE = 0.855
"""Mean aerodynamic damping of side-side modes in turbulence over that of a steady wind: 0.82 to 0.89."""
STILL = {
    "pile": {"side_side_1": 0.0057, "side_side_2": 0.0130},
    "kv": {"side_side_1": 0.0083, "side_side_2": 0.0321},
}
"""Damping without wind: stated for the pile asset, extrapolated for the other; the rest is aerodynamic."""


@pytest.fixture(scope="module")
def results():
    """As of records whose yaw is known: one of them does not tell the first pair apart by its shapes."""
    return {name: along_axes(identify(read_record(str(RECORDS / f"{name}.parquet")))) for name in RIGID}


def truth(name):
    """Return frequency and mean damping in turbulence of each mode."""
    text = (RECORDS / f"{name}.json").read_text(encoding="utf-8")
    steady = {m["label"]: (m["frequency_hz"], m["damping_ratio"]) for m in json.loads(text)["true_modes"]}
    still = STILL[name.split("_")[0]]
    return {
        label: (f, still[label] + IN_TURBULENCE * (zeta - still[label]) if label in still else zeta)
        for label, (f, zeta) in steady.items()
    }


def fore_aft_share(mode):
    size = np.abs(mode.mode_shape) ** 2
    return size[::2].sum() / size.sum()


def pair(modes, true, labels):
    """Return the modes near a pair, the one that moves least along the wind first."""
    centre = np.mean([true[label][0] for label in labels])
    near = [m for m in modes if abs(m.frequency_hz / centre - 1.0) < 0.07]
    return sorted(near, key=fore_aft_share)


@pytest.mark.parametrize("name", RIGID)
def test_both_bending_pairs_are_found_apart_and_refined(results, name):
    for labels in PAIRS:
        found = pair(results[name].modes, truth(name), labels)
        assert len(found) == 2
        assert {mode.method for mode in found} == {"maximum likelihood"}
        assert fore_aft_share(found[0]) < 0.2


def test_damping_lies_inside_its_interval_in_nine_of_ten(results):
    """Seven records, four modes: errors in units of their deviations, judged from both sides."""
    inside, scores = 0, []
    for name, result in results.items():
        true = truth(name)
        for labels in PAIRS:
            for mode, label in zip(pair(result.modes, true, labels), labels, strict=True):
                low, high = mode.damping_ratio_interval_90
                inside += low < true[label][1] < high
                scores.append(
                    np.log(mode.damping_ratio / true[label][1]) / np.sqrt(mode.log_covariance[1, 1])
                )
    assert inside >= 22  # fewer have a probability of 2 % at 90 % coverage (binomial)
    assert are_standard(np.array(scores))


def test_refined_damping_is_as_sharp_as_the_record_allows_and_no_sharper(results):
    """One force moves all channels: their ratios must not be taken for knowledge of the damping."""
    second = [m for r in results.values() for m in r.modes if 0.7 < m.frequency_hz < 0.82]
    ratio = [np.sqrt(m.log_covariance[1, 1]) / m.damping_ratio_cov_limit for m in second]
    assert 0.8 < np.median(ratio) < 1.5


@pytest.mark.parametrize("asset", ["pile", "kv"])
def test_fused_frequencies_are_within_one_per_cent(results, asset):
    names = [name for name in RIGID if name.startswith(asset)]
    fused = fuse([results[name] for name in names])
    true = truth(names[0])
    for labels in PAIRS:
        for mode, label in zip(pair(fused.modes, true, labels), labels, strict=True):
            low, high = mode.frequency_interval_90
            assert abs(mode.frequency_hz / true[label][0] - 1.0) < 0.01 or low < true[label][0] < high


@pytest.mark.parametrize("name", np.random.default_rng(13).choice(RIGID, 3, replace=False))
def test_one_channel_at_a_time(name):
    """A single sensor is a record, too: it shows the first mode of its direction at least."""
    record = read_record(str(RECORDS / f"{name}.parquet")).of_quantity("acceleration")
    lowest = min(f for f, _ in truth(name).values())
    for channel in np.random.default_rng(13).choice(record.channel_names, 2, replace=False):
        found = identify(record.select([channel]))
        # ten minutes leave 1 % of the wide first peak's frequency, three times that is far
        assert min(abs(m.frequency_hz / lowest - 1.0) for m in found.modes) < 0.03
