"""S-N curves: where their slopes meet, hand values, thickness, editions."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from jackettwin.errors import InputError
from jackettwin.fatigue import ENVIRONMENTS, read_curve, shipped_editions
from jackettwin.files import find_file, read_yaml

NAMES = tuple(read_yaml(find_file("dnv_rp_c203_2016", "sn_curves"))["curves"])


@pytest.mark.parametrize("edition", shipped_editions())
@pytest.mark.parametrize("name", NAMES)
def test_slopes_meet_at_the_knee(edition: str, name: str) -> None:
    """The tables print log a to three decimals, of which T's do not quite close: 0.0033 in log N."""
    for environment in ("air", "cathodic"):
        curve = read_curve(name, environment, edition)
        S = 1e-6 * curve.knee_pa
        assert curve.log_a[1] - curve.m[1] * np.log10(S) == pytest.approx(
            np.log10(curve.knee_cycles), abs=4e-3
        )


def test_hand_values() -> None:
    """T in air of 2016: 10^12.480/100³ above the knee (67.1 MPa), 10^16.130/50⁵ below."""
    curve = read_curve("T", "air")
    N = curve.cycles_to_failure(np.array([100e6, 50e6, 0.0]))
    assert N[0] == pytest.approx(10.0**12.480 / 1e6, rel=1e-12)
    assert N[1] == pytest.approx(10.0**16.130 / 50.0**5, rel=1e-12)
    assert N[2] == np.inf
    # one slope where steel corrodes freely
    free = read_curve("D", "free-corrosion").cycles_to_failure(np.array([10e6]))
    assert free[0] == pytest.approx(10.0**11.687 / 1e3, rel=1e-12)


def test_thick_plates_are_weaker_and_thin_ones_are_not_stronger() -> None:
    curve = read_curve("F", "air")
    assert curve.thickness_factor(0.050) == pytest.approx(2.0**0.25, rel=1e-12)
    assert curve.thickness_factor(0.010) == 1.0
    S = np.array([100e6])
    assert curve.damage(S, np.ones(1), thickness_m=0.050) == pytest.approx(
        2.0**0.75 * curve.damage(S, np.ones(1)), rel=1e-12
    )


def test_the_older_curve_of_tubular_joints_is_the_lower_one() -> None:
    S = np.array([80e6])
    old, new = (
        read_curve("T", "air", edition).cycles_to_failure(S) for edition in sorted(shipped_editions())
    )
    assert new[0] / old[0] == pytest.approx(10.0 ** (12.480 - 12.164), rel=1e-12)


def test_unknown_names_are_refused_with_what_there_is() -> None:
    with pytest.raises(InputError, match="S-N curve"):
        read_curve("Q", "air")
    with pytest.raises(InputError, match="environment"):
        read_curve("T", "water")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="sn_curve"):
        read_curve("T", "air", "dnv_1999")
    with pytest.raises(InputError, match="thickness_m"):
        read_curve("T", "air").thickness_factor(-0.02)


@pytest.mark.parametrize("name", NAMES)
def test_sea_water_is_never_better_than_air(name: str) -> None:
    S = np.geomspace(5e6, 250e6, 40)  # steeper B lines cross that of free corrosion at 265 MPa
    lives = [read_curve(name, environment).cycles_to_failure(S) for environment in ENVIRONMENTS]
    assert (lives[0] >= lives[1] * (1.0 - 5e-3)).all()
    assert (lives[1] >= lives[2] * (1.0 - 5e-3)).all()


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"air": {"m": [-3, 5], "log_a": [12, 15.333], "knee_cycles": 1e7}}, "m: out of range"),
        ({"air": {"m": [3, 5], "log_a": [12, 25], "knee_cycles": 1e7}}, "do not meet"),
        ({"air": {"m": [3, 5], "log_a": [12, 15.333]}}, "knee_cycles"),
        ({"reference_thickness_m": 25}, "reference_thickness_m"),
        ({"thickness_exponent": -0.2}, "thickness_exponent"),
    ],
)
def test_curves_of_a_users_file_must_fit_themselves(
    tmp_path: Path, changed: dict[str, object], said: str
) -> None:
    two = {"m": [3, 5], "log_a": [12.0, 15.0 + 1.0 / 3.0], "knee_cycles": 1e7}
    curve = {"thickness_exponent": 0.2, "reference_thickness_m": 0.025, "air": two, "cathodic": two}
    curve |= {"free_corrosion": {"m": [3], "log_a": [11.7]}}
    path = tmp_path / "own.yaml"
    edition = {"edition": "own", "source": "us", "log_std": 0.2}
    path.write_text(yaml.safe_dump(edition | {"curves": {"X": curve}}))
    assert read_curve("X", "air", str(path)).knee_pa == pytest.approx(1e6 * 10.0 ** (5.0 / 3.0))
    path.write_text(yaml.safe_dump(edition | {"curves": {"X": curve | changed}}))
    with pytest.raises(InputError, match=said):
        read_curve("X", "air", str(path))
