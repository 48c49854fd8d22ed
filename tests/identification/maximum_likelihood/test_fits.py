"""A fit that breaks down costs the refinement, never the record."""

from __future__ import annotations

import json
import warnings

import numpy as np
import pytest

from jackettwin.errors import NumericalError
from jackettwin.files.codec import decode, encode
from jackettwin.identification import Identification, identify
from jackettwin.identification.maximum_likelihood import fits, likelihood, refinement
from jackettwin.identification.synthetic import simulate


@pytest.mark.parametrize(
    "error",
    [
        np.linalg.LinAlgError("singular"),
        ValueError("non-broadcastable"),
        FloatingPointError("underflow"),
        NumericalError("no digits left"),
        RuntimeWarning("ill-conditioned"),
    ],
)
def test_what_breaks_down_leaves_the_modes_as_the_subspace_method_found_them(error, tower, rng, monkeypatch):
    def broken(*args, **more):
        raise error

    record = simulate(tower, rng, sample_rate_hz=5.0)
    monkeypatch.setattr(fits, "refine", broken)
    monkeypatch.setattr(fits, "refine_group", broken)
    found = identify(record)
    assert len(found.modes) == 4
    assert {mode.method for mode in found.modes} == {"ssi-cov"}
    left = [finding.text for finding in found.findings if finding.code == "not_refined"]
    assert left
    assert all(f"broke down ({type(error).__name__})" in text for text in left)
    assert set(found.warnings) == {str(finding) for finding in found.findings if finding.severity != "info"}
    stored = json.dumps(encode(found.without_figures))
    assert decode(Identification, json.loads(stored)).findings == found.findings


def test_a_result_that_is_no_number_is_not_believed(tower, rng, monkeypatch):
    def with_a_hole(fit):
        def wrapped(*args, **more):
            refined = fit(*args, **more)
            refined.frequency_hz[0] = np.nan
            return refined

        return wrapped

    record = simulate(tower, rng, sample_rate_hz=5.0)
    monkeypatch.setattr(fits, "refine", with_a_hole(fits.refine))
    monkeypatch.setattr(fits, "refine_group", with_a_hole(fits.refine_group))
    found = identify(record)
    assert {mode.method for mode in found.modes} == {"ssi-cov"}
    assert any("broke down (not a number)" in text for text in found.warnings)


def test_a_fit_whose_steps_cost_too_much_takes_none(tower, rng, monkeypatch):
    record, steps, scoring = simulate(tower, rng, sample_rate_hz=5.0), [], likelihood.scoring
    monkeypatch.setattr(likelihood, "scoring", lambda *given: steps.append(0) or scoring(*given))
    assert {mode.method for mode in identify(record).modes} == {"maximum likelihood"} and steps
    steps.clear()
    monkeypatch.setattr(refinement, "MAX_STEP_WORK", 1e3)
    found = identify(record)
    assert {mode.method for mode in found.modes} == {"ssi-cov"} and not steps
    assert any("too many modes" in text for text in found.warnings)


def test_overflow_inside_a_fit_is_no_warning(tower, rng, monkeypatch):
    whole = fits.refine

    def overflowing(*args, **more):
        np.exp(np.array([1e3]))
        return whole(*args, **more)

    monkeypatch.setattr(fits, "refine", overflowing)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = identify(simulate(tower, rng, sample_rate_hz=5.0))
    assert {mode.method for mode in found.modes} == {"maximum likelihood"}
