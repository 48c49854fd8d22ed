import pytest

from jackettwin.errors import InputError, did_you_mean
from jackettwin.quantities import QUANTITIES, guess_quantity, to_si


def test_every_si_unit_has_factor_one() -> None:
    assert all(to_si(name, q.unit) == 1.0 for name, q in QUANTITIES.items())
    assert to_si("acceleration", "Gal") == to_si("acceleration", "gal") == 0.01  # Galileo: cm/s²


def test_wrong_unit_names_value_allowed_and_remedy() -> None:
    message = r"wrong unit for acceleration \(got 'm/s\^3'\); allowed: m/s\^2.*did you mean"
    with pytest.raises(InputError, match=message):
        to_si("acceleration", "m/s^3")


def test_unknown_quantity_suggests_the_closest() -> None:
    with pytest.raises(InputError, match="did you mean 'acceleration'"):
        to_si("accelaration", "m/s^2")


def test_error_collects_its_place_from_inside_out() -> None:
    inner = InputError("is negative", field="thickness_m", value=-0.1, allowed="> 0")
    outer = inner.at(field="sections.leg").at(file="a.yaml")
    assert str(outer) == "a.yaml: sections.leg.thickness_m: is negative (got -0.1); allowed: > 0"


def test_no_suggestion_for_a_distant_word() -> None:
    assert did_you_mean("xyz", ["frequency"]) is None


@pytest.mark.parametrize(
    ("name", "unit", "expected"),
    [
        ("YawBrTAxp", "m/s^2", "acceleration"),
        ("acc_top_x", "", "acceleration"),
        ("acc_top_x", "m/s^3", "acceleration"),  # to_si then says what is wrong
        ("NacYaw", "deg", "yaw"),
        ("BldPitch1", "deg", "pitch"),
        ("RotSpeed", "rpm", "rotor speed"),
        ("GenPwr", "kW", "power"),
        ("Wind1VelX", "m/s", "wind speed"),
        ("laser_1", "m/s", "velocity"),
        ("ch1", "mm/s", "velocity"),
        ("ref_x", "m/s", "velocity"),
        ("anemometer top", "m/s", "wind speed"),
        ("wave_u", "m/s", "other"),
        ("Wave1Elev", "m", "wave elevation"),
        ("RootMxb1", "kN-m", "moment"),
        ("Azimuth", "deg", "azimuth"),
        ("WindDir", "deg", "wind direction"),
        ("Status", "mode", "other"),
        ("ch1", "deg", "other"),  # yaw, pitch or inclination: nothing says which
        ("ch1", "", "other"),
    ],
)
def test_quantities_are_guessed_only_where_name_and_unit_agree(name: str, unit: str, expected: str) -> None:
    assert guess_quantity(name, unit) == expected
