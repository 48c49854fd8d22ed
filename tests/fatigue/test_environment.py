"""Corrosion by elevation."""

import pytest

from jackettwin.fatigue import models_at_height, read_curve


@pytest.mark.parametrize(
    ("z_m", "environment"),
    [(30.0, "air"), (5.1, "air"), (0.0, "free-corrosion"), (-4.9, "free-corrosion"), (-40.0, "cathodic")],
)
def test_each_elevation_has_its_curve(z_m: float, environment: str) -> None:
    """Air above the splash zone, nothing that protects in it, anodes below (DNV-RP-C203, 2.4)."""
    name, model = models_at_height("T", design_factor=3.0)(z_m)
    assert name == environment
    assert model.curve == read_curve("T", name)
    assert model.design_factor == 3.0
