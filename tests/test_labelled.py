"""Results in the libraries of others: the same numbers under their names; a library that lacks is named."""

import sys
from datetime import UTC, datetime

import numpy as np
import pytest
from observations import estimate, observation

from jackettwin import Channel, Record, TwinState, advance, to_arviz, to_dataframe, to_xarray
from jackettwin.errors import MissingExtra
from jackettwin.updating import Posterior
from jackettwin.updating.posterior.convergence import Convergence

NOON = datetime(2025, 1, 1, 12, tzinfo=UTC)


@pytest.fixture
def posterior() -> Posterior:
    z = np.log(np.arange(1.0, 13.0).reshape(6, 2))
    ones = np.ones(2)
    return Posterior(
        z, np.ones((6, 1), complex), np.arange(6.0), 0.0, 0.1, Convergence(ones, ones, ones),
        names=("k", "c"), runs=2,
    )  # fmt: skip


def test_a_posterior_is_chains_of_parameters(posterior: Posterior) -> None:
    assert repr(posterior).startswith("Posterior(") and "90 %: " in repr(posterior)
    tree = to_arviz(posterior)
    # two runs of three draws, one after the other
    np.testing.assert_allclose(tree["posterior"]["k"].values, [[1.0, 3.0, 5.0], [7.0, 9.0, 11.0]])
    np.testing.assert_allclose(to_dataframe(posterior)["c"], [2.0, 4.0, 6.0, 8.0, 10.0, 12.0])


def test_observations_and_states_are_tables() -> None:
    seen = observation({2: estimate(0.18, 0.01)}, NOON)
    assert to_dataframe(seen).loc[0, ["label", "frequency_hz"]].tolist() == ["mode_2", 0.18]
    state, _ = advance(TwinState("model"), seen)
    assert "days to " in repr(state) and len(repr(state)) + len(repr(seen)) < 400
    table = to_dataframe(state)
    assert table["mode"].tolist() == [2] and table["records"].tolist() == [1]
    # whole numbers of 2^-24 keep nine digits
    assert table["frequency_hz"][0] == pytest.approx(0.18, rel=1e-8)


def test_a_record_is_an_array_by_channel_and_time() -> None:
    record = Record(np.arange(6.0).reshape(2, 3), 2.0, (Channel("a"), Channel("b")), NOON)
    array = to_xarray(record)
    assert array.sel(channel="b").values.tolist() == [3.0, 4.0, 5.0]
    assert array["time"].values[2] == np.datetime64("2025-01-01T12:00:01")


def test_a_missing_library_is_named(posterior: Posterior, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "arviz_base", None)
    with pytest.raises(MissingExtra, match=r"arviz_base is not installed; pip install .*labels"):
        to_arviz(posterior)
