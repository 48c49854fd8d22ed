"""Central intervals against the distributions they are named after."""

import re
from pathlib import Path

import numpy as np
import pytest
import scipy.stats

from jackettwin.intervals import NORMAL_90, NORMAL_95, interval_90, log_interval_90


def test_the_two_quantiles_are_those_of_the_normal_distribution() -> None:
    assert scipy.stats.norm.ppf(0.95) == pytest.approx(NORMAL_90, rel=1e-14)
    assert scipy.stats.norm.ppf(0.975) == pytest.approx(NORMAL_95, rel=1e-14)


def test_a_90_percent_interval_of_a_logarithm_is_that_of_a_lognormal() -> None:
    expected = scipy.stats.lognorm(s=0.3, scale=0.02).interval(0.9)
    assert log_interval_90(0.02, 0.3) == pytest.approx(expected, rel=1e-12)


def test_draws_leave_one_in_twenty_on_either_side() -> None:
    low, middle, high = interval_90(np.append(np.arange(1.0, 1002.0), np.nan)) or (0.0, 0.0, 0.0)
    assert (low, middle, high) == (51.0, 501.0, 951.0)  # of 1001 draws, 50 lie below and 50 above
    assert interval_90(np.full(3, np.nan)) is None


def test_one_level_is_printed_everywhere_and_its_numbers_stand_in_one_place() -> None:
    """Report and `identify` printed 95 % where the window had 90 %, of a number that stood in six places."""
    root = Path(__file__).parents[1]
    number, ends = r"NORMAL_95|\b1\.64(?:5|48\d+)\b|\b1\.96\b", r"[\[(]0\.05, (?:0\.5, )?0\.95[\])]"
    other = re.compile(rf"95 ?% (?:of [fζ]\b|interval)|(?:interval|low|high)_95|{number}|{ends}")
    kinds = ("src/jackettwin/**/*.py", "app/src/**/*.ts*", "examples/*.py", "docs/[rt]*/*.md", "*.md")
    places = [path for kind in kinds for path in root.glob(kind) if path.name != "CHANGELOG.md"]
    places = [path for path in places if "migrations" not in path.parts]
    with_others = {path.name for path in places if other.search(path.read_text("utf-8"))}
    own = {"intervals.py", "numbers.ts"}
    tests_of_one_in_twenty = {"drift.py", "screening.py", "updating.md"}
    of_others = {"headings.py", "twin.md", "observation.py"}
    width_of_a_likelihood = {"line_likelihood.py"}
    assert with_others == own | tests_of_one_in_twenty | of_others | width_of_a_likelihood
    window = (root / "app" / "src" / "words" / "numbers.ts").read_text("utf-8")
    assert f"NORMAL_90 = {NORMAL_90};" in window
