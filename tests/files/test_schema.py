"""Errors of a schema, in one sentence each."""

from typing import Annotated, Literal

import pytest
from pydantic import Field

from jackettwin.errors import InputError
from jackettwin.files import Schema, validate


class Cat(Schema):
    type: Literal["cat"]
    lives: int = 9


class Dog(Schema):
    type: Literal["dog"]
    barks: bool = True


class Home(Schema):
    area_m2: Annotated[float, Field(gt=0.0)]
    pets: list[Annotated[Cat | Dog, Field(discriminator="type")]] = []
    rooms: dict[str, Cat] = {}
    glass_ratio: Annotated[float, Field(lt=1.0)] = 0.2


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
        ({"area_m2": 1, "pets": [{"type": "cow"}]}, "pets.0: .*'cat', 'dog'"),
        ({"area_m2": 1, "pets": [{"type": "cat", "live": 3}]}, "pets.0.cat.live: .*did you mean 'lives'"),
        ({"area_m2": 1, "pets": [{"type": "dog", "lives": 3}]}, "pets.0.dog.lives: .*allowed: type, barks"),
        ({"area_m2": 1, "rooms": {"attic": {"type": "cat", "lifes": 1}}}, "rooms.attic.lifes: .*'lives'"),
    ],
)  # fmt: skip
def test_one_sentence_names_place_value_and_remedy(data: dict, message: str) -> None:
    with pytest.raises(InputError, match="home.yaml: " + message):
        validate(Home, data, file="home.yaml")


def test_good_data_pass() -> None:
    home = validate(Home, {"area_m2": 3, "pets": [{"type": "dog"}]})
    assert home.pets == [Dog(type="dog")]
