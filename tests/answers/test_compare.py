"""Two runs compared: closed forms of the difference of two logarithms."""

from __future__ import annotations

import json
from math import log
from pathlib import Path

import pytest
from click.testing import CliRunner

from jackettwin.answers.compare import change, changed_inputs, compare, shared_records
from jackettwin.cli import main
from jackettwin.twin import inputs_document, read_twin


def document(f: float, k: float) -> dict:
    k_known = {"value": 9.9, "median": k, "interval_90": [k / 1.2, k * 1.2], "unit": "N/m"}
    return {
        "modes": [
            {"label": "fore_aft_1", "frequency_hz": f, "frequency_std_hz": 0.001 * f, "damping_ratio": 0.01,
             "damping_ratio_std": None},
        ],
        "updates": [
            {"law": "zener", "parameters": {}},
            {"law": "maxwell-3", "parameters": {"k": k_known}},
        ],
        "answers": {"law": "maxwell-3"},
        "headline": ["…"],
    }  # fmt: skip


def test_a_change_is_measured_in_its_own_uncertainty() -> None:
    """Ln 1.01 over √2 · 0.001."""
    found = change("f", "Hz", (0.2, 0.001), (0.202, 0.001))
    assert found.sigmas == pytest.approx(log(1.01) / (2**0.5 * 0.001))
    assert found.verdict == "changed"
    assert change("f", "Hz", (0.2, 0.01), (0.202, 0.01)).verdict == "within its uncertainty"
    # turned round, the sign turns
    assert change("f", "Hz", (0.202, 0.001), (0.2, 0.001)).sigmas == pytest.approx(-(found.sigmas or 0.0))


def test_the_deviations_of_two_runs_add_as_squares() -> None:
    """Of 3 % and 4 % each, the difference has 5 %."""
    found = change("f", "Hz", (1.0, 0.03), (1.05, 0.04))
    assert found.sigmas == pytest.approx(log(1.05) / 0.05)


def test_what_only_one_run_has_is_new_or_gone() -> None:
    assert change("f", "Hz", None, (0.2, 0.001)).verdict == "new"
    assert change("f", "Hz", (0.2, 0.001), None).verdict == "gone"
    assert change("f", "Hz", (0.2, None), (0.3, 0.1)).verdict == "not known: no uncertainty"


def test_the_median_of_the_recommended_law_is_compared() -> None:
    by = {c.what: c for c in compare(document(0.2, 1e9), document(0.2, 2e9))}
    assert set(by) == {"frequency of fore_aft_1", "damping ratio of fore_aft_1", "k (maxwell-3)"}
    assert by["frequency of fore_aft_1"].verdict == "the same"
    k = by["k (maxwell-3)"]
    assert (k.before, k.after, k.verdict) == (1e9, 2e9, "changed")
    # an interval of 90 % of a factor 1.2 either way is 1.645 deviations of the logarithm wide on each side
    assert k.sigmas == pytest.approx(log(2.0) / (2**0.5 * log(1.2) / 1.6449), rel=1e-4)


def test_the_command_names_what_changed_and_refuses_what_is_no_run(tmp_path: Path) -> None:
    for name, (f, k) in {"a": (0.2, 1e9), "b": (0.21, 1e9)}.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "result.json").write_text(json.dumps(document(f, k)))
    a, b = str(tmp_path / "a"), str(tmp_path / "b")
    said = CliRunner().invoke(main, ["compare", a, b]).stdout
    assert "Changed: frequency of fore-aft 1 by +5 %" in said
    changes = json.loads(CliRunner().invoke(main, ["compare", a, b, "--json"]).stdout)["changes"]
    assert changes[0]["relative_change"] == pytest.approx(0.05)
    refused = CliRunner().invoke(main, ["compare", a, str(tmp_path / "c")])
    assert refused.exit_code == 2 and "no such run" in refused.stderr


def made(records: str, twin: str = "t", said: str = "parked") -> dict:
    hashes = {f"SHA-256 of {name}.parquet": name for name in records}
    return {"provenance": {"SHA-256 of twin.yaml": twin, "made": "today", **hashes}, "assumptions": [said]}


def test_errors_of_records_that_both_runs_have_cancel() -> None:
    """A mean of n records and one of these and m − n more: var of the difference is σ²(1/n − 1/m)."""
    a, b = made("ab"), made("abcdefgh")
    assert shared_records(a, b) == pytest.approx(0.5)
    std = 0.01
    found = change("f", "Hz", (0.2, std / 2**0.5), (0.202, std / 8**0.5), shared_records(a, b))
    assert found.sigmas == pytest.approx(log(1.01) / (std * (1 / 2 - 1 / 8) ** 0.5))
    assert shared_records(a, made("xy")) == 0.0 and shared_records({}, a) == 0.0
    # the same records on other ground: no chance parts them
    same = change("k", "N/m", (1e9, 0.1), (1.01e9, 0.1), shared_records(a, a))
    assert same.verdict == "by other inputs: the records are the same"


def test_every_input_that_differs_is_named() -> None:
    a, b = made("ab"), made("bc", twin="u", said="model error 1 %")
    found = {(i.what, i.before, i.after) for i in changed_inputs(a, b)}
    assert found == {
        ("twin.yaml", "t", "u"), ("a.parquet", "a", None), ("c.parquet", None, "c"),
        ("assumption", "parked", None), ("assumption", None, "model error 1 %"),
    }  # fmt: skip
    assert changed_inputs(a, a) == ()


def asked(text: str, folder: Path, *, records: str = "ab") -> dict:
    """Return the part of a run's result that says what it was asked with."""
    (folder / "twin.yaml").write_text(text)
    return made(records) | {"inputs": inputs_document(read_twin(folder / "twin.yaml", records_follow=True))}


TWIN = """structure: jacket15
damping: {{rayleigh: {{ratio: 0.0055, frequency_hz: 0.183}}}}
water: {{depth_m: {depth}, marine_growth: [{{top_z_m: 0, bottom_z_m: -40, thickness_m: {growth}}}]}}
update: {{modes: [1, 2], model_error: [{{modes: [1, 2], frequency: {error}, damping: 0.0}}]}}
tolerances: {{rna_mass: {{std: {rna}}}}}
"""
USUAL = {"depth": 70.0, "growth": 0.05, "error": 0.005, "rna": 0.01}


@pytest.mark.parametrize(
    ("key", "value", "place"),
    [
        ("depth", 71.5, "water.depth_m"),
        ("growth", 0.1, "thickness_m"),
        ("error", 0.01, "update.model_errors.1.frequency"),
        ("rna", 0.02, "tolerances.given.rna_mass"),
    ],
)
def test_a_value_that_differs_is_named_with_both(tmp_path: Path, key: str, value: float, place: str) -> None:
    a, b = (asked(TWIN.format(**known), tmp_path) for known in (USUAL, {**USUAL, key: value}))
    found = [i for i in changed_inputs(a, b) if i.what.endswith(place)]
    assert [(i.before, i.after) for i in found] == [(USUAL[key], value)]
    assert changed_inputs(a, a) == ()


def test_a_mass_and_a_record_that_differ_are_named(tmp_path: Path) -> None:
    a = asked("structure: jacket15\n", tmp_path)
    heavier = asked("structure: jacket15\n", tmp_path, records="bc")
    place = next(name for name in heavier["inputs"] if name.endswith("mass_kg"))
    heavier["inputs"][place] *= 1.02
    found = {i.what: (i.before, i.after) for i in changed_inputs(a, heavier)}
    assert place.startswith("structure.masses.")
    assert set(found) == {place, "a.parquet", "c.parquet"}
    assert found[place][1] == pytest.approx(1.02 * found[place][0])


def test_walls_that_differ_alike_are_one_line(tmp_path: Path) -> None:
    a, b = asked("structure: jacket15\n", tmp_path), asked("structure: jacket15\n", tmp_path)
    steel = [name for name in b["inputs"] if name.endswith("youngs_modulus_pa")]
    steel = [name for name in steel if b["inputs"][name] == 2.1e11]
    b["inputs"] |= dict.fromkeys(steel, 2.0e11)
    for name, one in {"a": a, "b": b}.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "result.json").write_text(json.dumps({**document(0.2, 1e9), **one}))
    said = CliRunner().invoke(main, ["compare", str(tmp_path / "a"), str(tmp_path / "b")]).stdout
    lines = [line for line in said.splitlines() if line.startswith("Other input")]
    assert len(lines) == 1 and "210000000000.0 → 200000000000.0 (and" in lines[0]
