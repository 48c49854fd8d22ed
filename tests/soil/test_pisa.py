"""PISA's curves of stocky piles: conics, published parameters by hand, and rigid piles in closed form."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.soil import read_foundation
from jackettwin.soil.ground.pisa import Conic, StockyGround
from jackettwin.soil.ground.profile import Clay, Layer, Point, Sand, SoilProfile
from jackettwin.soil.piles.capacity import pushover
from jackettwin.soil.piles.impedance import lumped_head
from jackettwin.soil.piles.piles import Pile
from jackettwin.soil.piles.reaction_curves import linearised, pile_curves
from jackettwin.soil.piles.soil_curves import CurveOptions
from jackettwin.structure.model import STEEL

S_U, G_0 = 100e3, 60e6
TILL = Clay((S_U, S_U), shear_modulus_pa=(G_0, G_0))
DUNKIRK = Sand(40.0, relative_density=0.75, shear_modulus_pa=(80e6, 80e6))
STOCKY = CurveOptions(clay_py="pisa", sand_py="pisa")


@pytest.mark.parametrize("n", [0.0, 0.3, 0.5, 0.94, 1.0])
def test_a_conic_starts_with_k_and_ends_at_its_ultimate(n: float) -> None:
    """Byrne et al. 2020: bilinear for n = 0, straight to the ultimate for n = 1."""
    curve = Conic(k=8.0, n=n, x_u=50.0, y_u=6.0, x_scale=1e-3, y_scale=2e5)
    assert curve.capacity == 1.2e6
    assert float(curve.force(0.06)) == pytest.approx(1.2e6)
    assert float(curve.force(0.05)) == pytest.approx(1.2e6, rel=1e-6)
    assert float(curve.force(-0.02)) == -float(curve.force(0.02))
    y = np.linspace(0.0, 0.06, 200)
    assert (np.diff(curve.force(y)) >= -1e-6).all()
    if n < 1.0:
        assert float(curve.force(1e-9)) == pytest.approx(1e-9 * curve.initial_stiffness, rel=1e-3)
    if n == 0.0:
        np.testing.assert_allclose(curve.force(y), np.minimum(curve.initial_stiffness * y, 1.2e6), rtol=1e-9)
    if n == 1.0:
        assert float(curve.force(0.025)) == pytest.approx(0.6e6)


def test_a_point_of_the_conic_satisfies_its_equation() -> None:
    curve = Conic(k=10.6, n=0.9, x_u=241.4, y_u=7.0, x_scale=1.0, y_scale=1.0)
    for x in (0.1, 5.0, 100.0, 240.0):
        y = float(curve.force(x))
        a = y / 7.0 - x / 241.4
        residual = -0.9 * a**2 + 0.1 * (y / 7.0 - 10.6 * x / 7.0) * (y / 7.0 - 1.0)
        assert abs(residual) < 1e-12


def test_cowden_and_dunkirk_by_hand() -> None:
    """Parameters of the published tables at z = D, L = 3 D."""
    D = 2.0
    till = StockyGround(Point(D, 20e3, S_U, S_U, TILL, G_0), D, 3 * D)
    assert till.lateral.k == pytest.approx(8.95)
    assert till.lateral.capacity == pytest.approx((10.7 - 7.101 * np.exp(-0.3085)) * S_U * D)
    assert till.moment.capacity == pytest.approx(0.24215 * S_U * D**2)
    assert till.base_shear.initial_stiffness == pytest.approx(1.6445 * G_0 * D)
    assert till.base_moment.initial_stiffness == pytest.approx(0.208204 * G_0 * D**3)
    sand = StockyGround(Point(D, 20e3, 0.0, 0.0, DUNKIRK, 80e6), D, 3 * D)
    assert sand.lateral.k == pytest.approx(8.731 - 0.6982 * 0.75 - 0.9178)
    assert sand.lateral.capacity == pytest.approx((0.3667 + 25.89 * 0.75 + (0.3375 - 6.675) / 3) * 20e3 * D)
    assert sand.base_moment.capacity == pytest.approx((0.37806 + 3 * -0.0478275) * 20e3 * D**3)
    assert sand.moment_grows_with_force and not till.moment_grows_with_force


def test_the_head_of_a_rigid_pile_is_the_sum_of_its_springs() -> None:
    """K_HH = ∫G₀k_p dz + k_H G₀D, K_RR = ∫G₀(k_p z² + k_m D²) dz + k_H G₀DL² + k_M G₀D³."""
    D, L = 4.0, 12.0
    pile = Pile(L, D, 0.1, 1e4 * STEEL.youngs_modulus_pa)
    curves = pile_curves(pile, SoilProfile((Layer(30.0, 10e3, clay=TILL),)), STOCKY)
    lumped = lumped_head(pile, linearised(curves))
    head = lumped.steel + lumped.soil
    z = np.linspace(0.0, L, 4001)
    k_p, k_m = 10.6 - 1.65 * z / D, 1.42 - 0.09643 * z / D
    k_H, k_M = 2.717 - 0.3575 * 3, 0.2146 - 0.002132 * 3
    sway = np.trapezoid(G_0 * k_p, z) + k_H * G_0 * D
    rock = np.trapezoid(G_0 * (k_p * z**2 + k_m * D**2), z) + k_H * G_0 * D * L**2 + k_M * G_0 * D**3
    assert head[0, 0] == pytest.approx(sway, rel=2e-3)
    assert head[4, 4] == pytest.approx(rock, rel=5e-3)


@pytest.mark.parametrize("soil", [TILL, DUNKIRK])
def test_sides_and_base_carry_their_part_of_a_stocky_pile(soil) -> None:
    """Reported of the PISA piles: without base and sides a pile of L/D near 3 is visibly weaker."""
    pile = Pile(15.0, 5.0, 0.1, element_m=1.0)
    layer = Layer(40.0, 10e3, clay=soil) if isinstance(soil, Clay) else Layer(40.0, 10e3, soil)
    curves = pile_curves(pile, SoilProfile((layer,)), STOCKY)
    whole = pushover(pile, curves, arm_m=40.0, steps=4)
    alone = pushover(
        pile, type(curves)(curves.at, curves.py, curves.tz, curves.qz, curves.diameter_m), arm_m=40.0, steps=4
    )
    assert 1.05 < whole.ultimate_n / alone.ultimate_n < 2.5
    assert (np.diff(whole.load_n) > 0.0).all()


def test_a_foundation_file_takes_them(tmp_path: Path) -> None:
    path = tmp_path / "monopile.yaml"
    text = (
        "pile: {length_m: 24, outer_diameter_m: 8, thickness_m: 0.08}\nsoil:\n  layers:\n"
        "    - {thickness_m: 40, effective_weight_n_m3: 10.0e3, sand: {friction_angle_deg: 40, "
        "relative_density: 0.75, shear_modulus_pa: [6.0e7, 1.2e8]}}\ncurves: {sand_py: pisa}\n"
    )
    path.write_text(text)
    ground = read_foundation(path)
    assert ground.notes == ()
    assert ground.curves is not None and len(ground.curves.sides) == ground.curves.at.depth.size
    for gone, message in (("relative_density: 0.75, ", "relative_density"), ("pisa", "sand_py")):
        path.write_text(text.replace(gone, "" if "density" in gone else "piza"))
        with pytest.raises(InputError, match=message):
            read_foundation(path)
    path.write_text(text.replace("sand_py: pisa", "sand_py: pisa, cyclic: true"))
    with pytest.raises(InputError, match="static"):
        read_foundation(path)
