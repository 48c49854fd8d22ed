"""A support law over HTTP: its curves are those of the closed form, wrong ones are refused."""

from __future__ import annotations

import numpy as np
import pytest
from fastapi.testclient import TestClient

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
