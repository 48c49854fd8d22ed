"""Targets against the model's modes on rigid feet, before anything is fitted."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.study.fit_data import residuals, target_modes
from jackettwin.study.problem import UpdateEvidence, law_problem
from jackettwin.study.rotor import RotorDamping
from jackettwin.twin import read_twin
from jackettwin.twin.config import assembled
from jackettwin.updating.model_error.marginal import covariance

ERROR = """update:
  damping_of: all
  model_error: [{modes: [1], frequency: 0.003, damping: 0.2}]
"""
LABELS = ("side_side_1", "fore_aft_1", "torsion_1", "side_side_2", "fore_aft_2")
PINNED_HZ = np.array([0.1832, 0.1859, 0.572, 0.749, 0.794])
TWIN = "structure: jacket15\ntargets:\n  - {{mode: {}, frequency_hz: {}}}\n"


def given(folder: Path, mode: int, frequency_hz: float) -> tuple[str, ...]:
    path = folder / "twin.yaml"
    path.write_text(TWIN.format(mode, frequency_hz))
    return tuple(m.label for m in target_modes(read_twin(path), LABELS, pinned_hz=PINNED_HZ))


def test_the_models_error_adds_to_that_of_the_data(tmp_path: Path) -> None:
    """Variances add; the covariance of frequency and damping stays.

    What is fitted carries the measurement's own deviations; the model's stand beside, for all records once.
    """
    own = "{mode: 1, frequency_hz: 0.18, frequency_std_hz: 0.00072, damping_ratio: 0.012, "
    own += "damping_ratio_std: 0.0018, correlation: 0.5}"
    path = tmp_path / "twin.yaml"
    path.write_text(f"structure: jacket15\ntolerances: none\ntargets:\n  - {own}\n{ERROR}")
    config = read_twin(path)
    data = residuals(config, target_modes(config, LABELS, pinned_hz=PINNED_HZ))
    (target,) = data.targets
    assert (target.frequency_std_hz, target.damping_ratio_std) == (0.00072, 0.0018)
    assembly = assembled(config)
    problem = law_problem(
        config, UpdateEvidence(assembly, None, {"": (data, {})}, RotorDamping({}, {})), "kelvin-voigt"
    )
    found = problem.anchor(np.log([2e9, 1e7]))
    assert found is not None
    own_root = np.linalg.inv(data.shift_jacobian(np.eye(2)))
    total = own_root @ covariance(problem.gains(found)[0]) @ own_root.T
    f_std, zeta_std = np.hypot(0.00072 / 0.18, 0.003), np.hypot(0.0018 / 0.012, 0.2)
    assert np.sqrt(np.diag(total)) == pytest.approx([f_std, zeta_std], rel=1e-9)
    assert total[0, 1] == pytest.approx(0.5 * 0.00072 / 0.18 * 0.0018 / 0.012, rel=1e-9)


@pytest.mark.parametrize(
    ("mode", "frequency_hz", "right"),
    [(3, 0.18, "mode 1 .side_side_1"), (1, 0.55, "mode 3 .torsion_1"), (2, 0.74, "mode 4 .side_side_2")],
)
def test_a_number_far_from_its_mode_is_refused_with_the_one_that_fits(
    tmp_path: Path, mode: int, frequency_hz: float, right: str
) -> None:
    with pytest.raises(InputError, match=rf"fits another mode.*{right}"):
        given(tmp_path, mode, frequency_hz)


@pytest.mark.parametrize(("mode", "frequency_hz"), [(1, 0.15), (4, 0.5), (5, 0.8), (1, 0.19)])
def test_soft_soil_and_errors_of_a_model_are_allowed(tmp_path: Path, mode: int, frequency_hz: float) -> None:
    assert given(tmp_path, mode, frequency_hz) == (LABELS[mode - 1],)
