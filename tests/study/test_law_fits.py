"""Fits kept between runs: a second run is the same to the last digit and neither searches nor samples."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import Any

import pytest

from jackettwin.files.codec import encode
from jackettwin.files.json import null_for_nan
from jackettwin.study import TwinResult, run_document, run_twin
from jackettwin.twin import read_twin
from jackettwin.twin.config import TwinConfig
from jackettwin.updating import Update

kept_fits = import_module("jackettwin.study.law_fits")


@dataclass
class Shelf:
    """Keeps documents as a file would: plain data in, plain data out."""

    documents: dict[str, Any] = field(default_factory=dict)

    def get(self, schema: Any, key: str) -> Any:
        return schema.load(self.documents[key]) if key in self.documents else None

    def put(self, schema: Any, key: str, value: Any) -> None:
        self.documents[key] = schema.dump(value)


@pytest.fixture(scope="module")
def config() -> TwinConfig:
    config = read_twin("thesis_table_6_1")
    given = tuple(
        replace(t, frequency_std_hz=0.005 * (t.frequency_hz or 1.0), damping_ratio_std=0.003)
        for t in config.targets
    )
    quick = {"laws": ("kelvin-voigt", "zener"), "particles": 20, "weighting": "auto"}
    return replace(config, targets=given, update=config.update.model_copy(update=quick))


def run(config: TwinConfig, keep: Shelf, **how: Any) -> TwinResult:
    return run_twin(config, posteriors="likely", keep=keep, **how)


@pytest.fixture(scope="module")
def shelf() -> Shelf:
    return Shelf()


@pytest.fixture(scope="module")
def first(config: TwinConfig, shelf: Shelf) -> TwinResult:
    return run(config, shelf)


def document(result: TwinResult) -> Any:
    return null_for_nan(run_document(result, report=""))


def refuse(*_: object, **__: object) -> Update:
    raise AssertionError("fitted again")


def test_a_second_run_is_the_same_to_the_last_digit_and_fits_nothing(
    config: TwinConfig, shelf: Shelf, first: TwinResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept_fits, "update", refuse)
    monkeypatch.setattr(kept_fits, "with_posterior", refuse)
    second = run(config, shelf)
    assert any(u.uncertainty is not None for u in second.updates)
    assert [encode(u.fit) for u in second.updates] == [encode(u.fit) for u in first.updates]
    assert document(second) == document(first)


@pytest.mark.parametrize(
    "other",
    [
        lambda c: replace(c, gravity=not c.gravity),
        lambda c: replace(c, rayleigh=replace(c.rayleigh, alpha=1.01 * c.rayleigh.alpha)),
        lambda c: replace(
            c, targets=(replace(c.targets[0], frequency_std_hz=0.0011), *c.targets[1:])
        ),
        lambda c: replace(c, update=c.update.model_copy(update={"seed": 1})),
        lambda c: replace(c, update=c.update.model_copy(update={"bounds": {"k": (2e8, 1e10)}})),
        lambda c: replace(c, tie="horizontal-vertical"),
    ],
    ids=["gravity", "steel", "data", "seed", "bounds", "tie"],
)  # fmt: skip
def test_what_changes_the_question_is_fitted_again(
    config: TwinConfig, shelf: Shelf, first: TwinResult, other: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept_fits, "update", refuse)
    with pytest.raises(AssertionError, match="fitted again"):
        run(other(config), shelf, laws=("kelvin-voigt",))


def test_another_name_or_place_of_the_twin_is_the_same_question(
    config: TwinConfig, shelf: Shelf, first: TwinResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept_fits, "update", refuse)
    assert run(replace(config, name="elsewhere"), shelf, laws=("kelvin-voigt",)).updates


def test_a_posterior_takes_its_own_settings_and_a_search_does_not(first: TwinResult) -> None:
    u = first.updates[0]
    how = read_twin("thesis_table_6_1").update
    more = how.model_copy(update={"particles": how.particles + 1})
    keys = {
        (h is more, sampled): kept_fits.fit_key(u.problem, u.shown, h, sampled=sampled)
        for h in (how, more)
        for sampled in (False, True)
    }
    assert keys[False, False] == keys[True, False]
    assert keys[False, True] != keys[True, True] != keys[True, False]
