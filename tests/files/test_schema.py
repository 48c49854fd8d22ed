"""Errors of a schema, in one sentence each."""

from typing import Annotated, Literal

import pytest
from pydantic import Field

from jackettwin.errors import InputError, did_you_mean
from jackettwin.files import Schema, validate


class Cat(Schema):
    type: Literal["cat"]
    lives: int = 9


class Dog(Schema):
    type: Literal["dog"]
    barks: bool = True


class Cellar(Schema):
    depth_m: Annotated[float, Field(gt=0.0)]


class Home(Schema):
    area_m2: Annotated[float, Field(gt=0.0)]
    pets: list[Annotated[Cat | Dog, Field(discriminator="type")]] = []
    rooms: dict[str, Cat] = {}
    glass_ratio: Annotated[float, Field(lt=1.0)] = 0.2
    duration_s: Annotated[float, Field(lt=10.0)] = 1.0
    colour: Literal["red", "none"] | Annotated[float, Field(ge=0.0, le=1.0)] = "red"
    cellar: str | Cellar = "none"
    name: str = "home"
    floors: int = 1
    windows_m: list[tuple[float, float]] = []
    heated: bool = True
    slope_deg: Annotated[float, Field(gt=0.0, le=80.0)] = 30.0


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({}, "area_m2: required key is missing; add 'area_m2'"),
        ({"area_m2": -1}, "area_m2: .*got -1.; allowed: > 0"),
        ({"area_m2": -1}, "area_m2: .*; check the number and its unit"),
        ({"area_m2": 1, "glass_ratio": 1.2}, "glass_ratio: .*; a ratio: 1.2 % is 0.012"),
        ({"area_m2": "big"}, "area_m2: .*got 'big'"),
        ({"area_m2": float("nan")}, "area_m2: .*finite"),
        ({"area": 1}, "area: unknown key .got 'area'.*did you mean 'area_m2'"),
        ({"area_m2": 1, "pets": [{"type": "cow"}]}, "pets.0.type: unknown type .got 'cow'.; allowed: 'cat'"),
        ({"area_m2": 1, "pets": [{"lives": 3}]}, "pets.0.type: required key is missing; add 'type'"),
        ({"area_m2": 1, "pets": [{"type": "cat", "live": 3}]}, "pets.0.cat.live: .*did you mean 'lives'"),
        ({"area_m2": 1, "pets": [{"type": "dog", "lives": 3}]}, "pets.0.dog.lives: .*allowed: type, barks"),
        ({"area_m2": 1, "rooms": {"attic": {"type": "cat", "lifes": 1}}}, "rooms.attic.lifes: .*'lives'"),
        ({"area_m2": 1, "duration_s": 20}, "duration_s: .*; check the number and its unit"),
        ({"area_m2": 1, "name": 5}, "name: not a text .got 5.; write a name"),
        # unions: the field alone, what is wrong with the kind it is, or what every kind allows
        ({"area_m2": 1, "colour": 16}, r"colour: .*less than or equal to 1 .got 16.; allowed: 0 to 1"),
        ({"area_m2": 1, "colour": "blue"}, "colour: .*allowed: 'red' or 'none'; take one of them, or write"),
        ({"area_m2": 1, "colour": "rde"}, "colour: not one of the choices .got 'rde'.*did you mean 'red'"),
        # the whole range, not the broken bound alone
        ({"area_m2": 1, "slope_deg": 90}, "slope_deg: .*got 90.; allowed: > 0, ≤ 80; check the number"),
        ({"area_m2": 1, "slope_deg": -1}, "slope_deg: .*; allowed: > 0, ≤ 80"),
        ({"area_m2": 1, "windows_m": [[1, 2, 3]]}, "windows_m.0: too many.*leave out"),
        ({"area_m2": 1, "floors": "9" * 5000}, "floors: a number too large"),
        # yes is no number
        ({"area_m2": True}, "area_m2: not a number .got True.; write it"),
        ({"area_m2": 1, "floors": False}, "floors: not a number .got False."),
        ({"area_m2": 1, "windows_m": [[1, 2], [1, True]]}, "windows_m.1.1: not a number"),
        ({"area_m2": 1, "rooms": {"attic": {"type": "cat", "lives": True}}}, "rooms.attic.lives: not a num"),
        ({"area_m2": 1, "cellar": {"depth_m": -1}}, "cellar.depth_m: .*got -1.; allowed: > 0"),
        ({"area_m2": 1, "cellar": {"depth": 1}}, "cellar.depth: unknown key .*did you mean 'depth_m'"),
        ({"area_m2": 1, "cellar": 5}, "cellar: not a text .got 5.; write a name.*, or write keys"),
    ],
)  # fmt: skip
def test_one_sentence_names_place_value_and_remedy(data: dict, message: str) -> None:
    with pytest.raises(InputError, match="home.yaml: " + message):
        validate(Home, data, file="home.yaml")


def test_a_short_word_is_no_misspelt_one_that_begins_with_another_letter() -> None:
    """Three of the four letters of `name` are in `frame`."""
    with pytest.raises(InputError, match="allowed: .*; take it out, or use one of these"):
        validate(Home, {"area_m2": 1, "hooms": {}}, file="home.yaml")
    assert did_you_mean("name", ["frame", "node"]) is None
    assert did_you_mean("tau", ["tau_s"]) == "did you mean 'tau_s'?"


def test_good_data_pass() -> None:
    home = validate(Home, {"area_m2": 3, "pets": [{"type": "dog"}], "heated": False})
    assert not home.heated
    assert home.pets == [Dog(type="dog")]
