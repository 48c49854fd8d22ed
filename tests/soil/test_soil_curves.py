"""Kinds of soil curves: chosen by name in a file, listed in the documentation."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil import Clay, CurveOptions, Pile, Point, Sand, SoilCurve, read_foundation
from jackettwin.soil.piles import soil_curves

ROOT = Path(__file__).parents[2]
GROUND = """
pile: {length_m: 40, outer_diameter_m: 2.0, thickness_m: 0.05}
soil: {layers: [{thickness_m: 40, effective_weight_n_m3: 1e4, sand: {friction_angle_deg: 35}}]}
"""


def test_every_kind_stands_in_the_documentation() -> None:
    page = (ROOT / "docs/reference/foundation.md").read_text("utf-8")
    for kind in soil_curves.SOIL_CURVES:
        row = next(line for line in page.splitlines() if line.startswith(f"| `{kind.reaction}` "))
        assert f"`{kind.name}`: {kind.words}" in row


@pytest.mark.parametrize("kind", soil_curves.SOIL_CURVES, ids=lambda kind: f"{kind.reaction}-{kind.name}")
def test_every_kind_is_built_by_its_name(kind: SoilCurve) -> None:
    """Curves pass through zero, push back, and start with their initial stiffness or below it."""
    G = 8e7
    sand = Sand(35.0, relative_density=0.7, shear_modulus_pa=(G, G))
    soil = sand if kind.reaction.startswith("sand") else Clay((80e3, 80e3), shear_modulus_pa=(G, G))
    point = Point(10.0, 100e3, 80e3, 80e3, soil, G)
    options = CurveOptions(**{kind.reaction: kind.name})
    curve = options.curve(kind.reaction[-2:], point, Pile(40.0, 2.0, 0.05))
    assert curve.force(0.0) == 0.0
    assert 0.0 < float(curve.force(1e-3)) <= curve.capacity
    assert float(curve.force(-1e-3)) == -float(curve.force(1e-3))


@pytest.mark.parametrize(
    ("curves", "message"),
    [
        ("sand_tz: iso", "curves.sand_tz: no such soil curve .got 'iso'.; allowed: rp2geo, rp2a"),
        ("clay_py: cube_root", "curves.clay_py: no such soil curve .*did you mean 'cube-root'"),
        ("cyclic: true, clay_py: cube-root", "curves.clay_py: .*static.*allowed: table, if cyclic"),
        ("layering: api", "curves.layering: .*overburden.*georgiadis"),
        ("cycles: 0.5", "curves.cycles: out of range .got 0.5.; allowed: 1 to 1e.09"),
        ("sand_tx: rp2a", "unknown key .got 'sand_tx'.*allowed: cyclic, sand_tz.*did you mean 'sand_tz'"),
        ("cyclic: maybe", "curves.cyclic: not a yes or no"),
    ],
)
def test_a_kind_that_is_not_there_is_refused(tmp_path: Path, curves: str, message: str) -> None:
    path = tmp_path / "ground.yaml"
    path.write_text(f"{GROUND}curves: {{{curves}}}\n")
    with pytest.raises(InputError, match=message) as caught:
        read_foundation(path)
    assert str(path) in str(caught.value)


def test_a_kind_of_another_package_is_chosen_by_its_name(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A shaft that holds twice as well doubles what the pile is held by along its axis."""
    ours = soil_curves.soil_curves("sand_tz")["rp2a"]

    def twice(point: Point, pile: Pile, options: CurveOptions):
        one = ours.build(point, pile, CurveOptions(sand_tz="rp2a"))
        return type(one)(one.y, tuple(2.0 * p for p in one.p))

    row = SoilCurve("sand_tz", "rough", "a rough shaft", twice)
    monkeypatch.setattr(soil_curves, "plugins_of_type", lambda group, kind: {"rough": row})
    soil_curves.soil_curves.cache_clear()
    axial = []
    for name in ("rp2a", "rough"):
        path = tmp_path / f"{name}.yaml"
        path.write_text(f"{GROUND}curves: {{sand_tz: {name}}}\n")
        axial.append(read_foundation(path).springs.axial[:-1])
    soil_curves.soil_curves.cache_clear()
    np.testing.assert_allclose(axial[1], 2.0 * axial[0], rtol=1e-12)
