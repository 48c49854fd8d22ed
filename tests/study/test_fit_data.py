"""Targets against the model's modes on rigid feet, before anything is fitted."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.study.fit_data import target_modes
from jackettwin.twin import read_twin

LABELS = ("side_side_1", "fore_aft_1", "torsion_1", "side_side_2", "fore_aft_2")
PINNED_HZ = np.array([0.1832, 0.1859, 0.572, 0.749, 0.794])
TWIN = "structure: jacket15\ntargets:\n  - {{mode: {}, frequency_hz: {}}}\n"


def given(folder: Path, mode: int, frequency_hz: float) -> tuple[str, ...]:
    path = folder / "twin.yaml"
    path.write_text(TWIN.format(mode, frequency_hz))
    return tuple(m.label for m in target_modes(read_twin(path), LABELS, pinned_hz=PINNED_HZ))


@pytest.mark.parametrize(
    ("mode", "frequency_hz", "right"),
    [(3, 0.18, "mode 1 .side_side_1"), (1, 0.55, "mode 3 .torsion_1"), (2, 0.74, "mode 4 .side_side_2")],
)
def test_a_number_far_from_its_mode_is_refused_with_the_one_that_fits(
    tmp_path: Path, mode: int, frequency_hz: float, right: str
) -> None:
    with pytest.raises(InputError, match=rf"another mode's fits.*{right}"):
        given(tmp_path, mode, frequency_hz)


@pytest.mark.parametrize(("mode", "frequency_hz"), [(1, 0.15), (4, 0.5), (5, 0.8), (1, 0.19)])
def test_soft_soil_and_errors_of_a_model_are_allowed(tmp_path: Path, mode: int, frequency_hz: float) -> None:
    assert given(tmp_path, mode, frequency_hz) == (LABELS[mode - 1],)
