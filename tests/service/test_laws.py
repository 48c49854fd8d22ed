"""A support law over HTTP: its curves are those of the closed form, wrong ones are refused."""

from __future__ import annotations

import numpy as np
import pytest
from fastapi.testclient import TestClient

from jackettwin.soil import DEFAULT_LAWS, families

URL = "/api/v1/law"


def test_a_kelvin_voigt_support_stores_k_and_loses_omega_c(client: TestClient) -> None:
    found = client.get(URL, params={"of": "kelvin-voigt:k=2.5e9,c=7.6e8"}).json()
    omega = 2.0 * np.pi * np.array(found["frequency_hz"])
    np.testing.assert_allclose(found["storage_n_m"], 2.5e9)
    np.testing.assert_allclose(found["loss_n_m"], 7.6e8 * omega)
    # creep under a unit step of force: (1 − exp(−kt/c))/k
    t = np.array(found["time_s"])
    np.testing.assert_allclose(found["creep_m_n"], (1.0 - np.exp(-2.5e9 * t / 7.6e8)) / 2.5e9, rtol=1e-6)


@pytest.mark.parametrize("of", ["kelvin-voigt:k=-1,c=1", "glue:k=1", "zener:k0=1e9", "zener:" + "9" * 250])
def test_a_law_that_is_none_is_refused(client: TestClient, of: str) -> None:
    answer = client.get(URL, params={"of": of})
    assert answer.status_code == 422 and answer.json()["detail"]


def test_every_law_is_listed_with_the_parameters_it_takes(client: TestClient) -> None:
    """In the middle between its bounds each is drawn; the usual laws come first."""
    items = client.get("/api/v1/laws").json()["items"]
    assert [law["name"] for law in items][: len(DEFAULT_LAWS)] == list(DEFAULT_LAWS)
    assert {law["name"] for law in items} == set(families())
    for law in items:
        given = (f"{p['name']}={(p['low'] * p['high']) ** 0.5}" for p in law["parameters"])
        answer = client.get(URL, params={"of": f"{law['name']}:{','.join(given)}"})
        assert answer.status_code == 200, answer.text
        assert all(p["words"] for p in law["parameters"])
