"""The document of an identification says of each mode what its poles and its covariance say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, identification_document, identify
from jackettwin.identification.document import poles_document
from jackettwin.identification.estimate import Identification
from jackettwin.identification.synthetic import ModalSystem, simulate

SYSTEM = ModalSystem(
    np.array([0.5, 0.9]),
    np.array([0.01, 0.012]),
    np.array([[1.0, 0.5, -0.3], [-0.4, 1.0, 0.2]]),
    np.array([[1.0, 0.2], [0.2, 0.8]]),
    noise_ratio=0.05,
)


@pytest.fixture(scope="module")
def found() -> Identification:
    record = simulate(SYSTEM, np.random.default_rng(1), duration_s=600.0, sample_rate_hz=8.0)
    return identify(record, IdentificationSettings(refine=False))


def test_the_poles_of_a_mode_are_counted_and_averaged(found: Identification) -> None:
    poles, modes = found.stabilisation, identification_document(found, {}, {})["modes"]
    assert len(modes) == 2
    for k, (mode, f) in enumerate(zip(modes, SYSTEM.frequency_hz, strict=True)):
        own = [i for i in range(len(poles.order)) if poles.cluster[i] == k]
        said = mode["poles"]
        assert said["count"] == len(own) > 10
        assert said["frequency_mean_hz"] == pytest.approx(sum(poles.frequency_hz[i] for i in own) / len(own))
        # poles of one record scatter by less than the record leaves unknown
        assert abs(said["frequency_mean_hz"] - f) < 4.0 * mode["frequency_std_hz"]
        assert 0.0 < said["frequency_scatter_hz"] < 3.0 * mode["frequency_std_hz"]
        spread = np.sqrt(np.mean([(poles.damping_ratio[i] - said["damping_ratio_mean"]) ** 2 for i in own]))
        assert said["damping_ratio_scatter"] == pytest.approx(spread)


def test_the_ellipse_has_the_stated_deviations_as_its_shadow(found: Identification) -> None:
    for mode in identification_document(found, {}, {})["modes"]:
        covariance = np.array(mode["log_covariance"])
        assert covariance == pytest.approx(covariance.T)
        assert np.linalg.eigvalsh(covariance).min() > 0.0
        assert np.sqrt(covariance[0, 0]) == pytest.approx(mode["frequency_std_hz"] / mode["frequency_hz"])
        assert np.sqrt(covariance[1, 1]) == pytest.approx(
            mode["damping_ratio_std"] / mode["damping_ratio"], rel=0.05
        )


def test_a_mode_without_poles_says_none(found: Identification) -> None:
    alone = replace(found.stabilisation, cluster=np.full_like(found.stabilisation.cluster, -1))
    assert poles_document(alone, 0) is None
