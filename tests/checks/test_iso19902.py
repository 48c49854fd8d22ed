"""ISO 19902 clause 13 against hand calculations (slide-rule digits: 1e-4)."""

import numpy as np
import pytest

from jackettwin.checks.iso19902 import CHECKS, Strength, Stress, Tube, Utilisation, strength, utilisation
from jackettwin.errors import InputError

MPA = 1e6


def tube(D: float, t: float, KL: float, f_y: float = 355.0) -> Tube:
    return Tube(*(np.array(v) for v in (D, t, 210e9, f_y * MPA, KL)))


@pytest.mark.parametrize(
    ("one", "f_yc", "f_c", "f_b", "f_e"),
    [
        # D/t 50, r 0.34655 m: f_xe 2520, f_y/f_xe 0.141 → f_yc = f_y; λ 0.7553 → 1 − 0.278λ² = 0.8414;
        # Z_p/Z_e 1.29886, x 0.0845 → 1.13 − 2.58x = 0.9119
        (tube(1.0, 0.02, 20.0), 355.0, 298.70, 420.49, 622.30),
        # D/t 100: f_y/f_xe 0.2817 → 0.9698; λ 2.2092 → 0.9/λ² = 0.18441; x 0.1690 → 0.94 − 0.76x = 0.8115
        (tube(1.0, 0.01, 60.0), 344.28, 63.487, 370.49, 70.541),
        # D/t 20: stocky; x 0.0329 → the full plastic moment, Z_p/Z_e 1.33778
        (tube(2.0, 0.1, 10.0, 345.0), 345.0, 341.47, 461.54, 9378.6),
    ],
)
def test_strengths_by_hand(one: Tube, f_yc: float, f_c: float, f_b: float, f_e: float) -> None:
    s = strength(one)
    found = [float(v) / MPA for v in (s.f_yc, s.f_c, s.f_b, s.f_e)]
    assert found == pytest.approx([f_yc, f_c, f_b, f_e], rel=1e-4)
    assert float(s.f_v) == pytest.approx(float(one.f_y) / np.sqrt(3.0))


def use(
    axial: float, by: float, bz: float, shear: float = 0.0, torsion: float = 0.0, **options
) -> Utilisation:
    s = Strength(*(np.array(v * MPA) for v in (355.0, 344.28, 63.487, 70.541, 370.49, 204.96)))
    stress = Stress(*(np.array(v * MPA) for v in (axial, by, bz, shear, torsion)))
    return Utilisation(*(np.array(v) for v in utilisation(s, stress, **options)))


def test_tension_and_bending_by_hand() -> None:
    """1.05·100/355 = 0.29577; 1.05·√(60² + 80²)/370.49 = 0.28341; 13.3.2: their sum."""
    u = use(100.0, 60.0, 80.0, 20.0, -10.0)
    assert [float(u.tension), float(u.bending), float(u.section)] == pytest.approx(
        [0.29577, 0.28341, 0.57918], abs=1e-5
    )
    assert float(u.compression) == float(u.stability) == 0.0
    # 13.2.5: 1.05·20/204.96, 1.05·10/204.96
    assert [float(u.shear), float(u.torsion)] == pytest.approx([0.10246, 0.05123], abs=1e-5)


def test_compression_and_bending_by_hand() -> None:
    """13.3.3: 1.18·30/63.487 + 0.85·1.05·50/(1 − 30/70.541)/370.49; 1.18·30/344.28 + 1.05·50/370.49."""
    u = use(-30.0, 30.0, 40.0, C_m=0.85)
    assert float(u.compression) == pytest.approx(0.55759, abs=1e-5)
    assert float(u.stability) == pytest.approx(0.55759 + 0.12045 / 0.57472, abs=1e-4)
    assert float(u.section) == pytest.approx(0.10282 + 0.14170, abs=1e-5)


def test_the_cosine_of_2020() -> None:
    """An axial part of 0.2 becomes 1 − cos(0.2·π/2) = 0.04894; bending and column are as before."""
    axial = -0.2 * 344.28 / 1.18
    old, new = use(axial, 50.0, 0.0), use(axial, 50.0, 0.0, edition="2020")
    assert float(old.section - old.bending) == pytest.approx(0.2)
    assert float(new.section - new.bending) == pytest.approx(0.04894, abs=1e-5)
    assert float(new.stability) == float(old.stability)
    # at and beyond full use both editions agree that it is too much
    assert float(use(-400.0, 0.0, 0.0, edition="2020").section) > 1.0
    with pytest.raises(InputError, match="unknown edition"):
        use(0.0, 0.0, 0.0, edition="1999")


def test_strengths_are_continuous_where_formulas_meet() -> None:
    """The standard's branches meet to 0.3 %."""
    D, E, f_y = 1.0, 210e9, 355e6
    walls = [f_y * D / E / x for x in (0.0517, 0.1034)] + [
        0.170 * f_y**-1 * 0.0 + f_y * D / (2 * 0.3 * E * s) for s in (0.170, 1.911)
    ]
    for t in walls:
        near = [strength(tube(D, t * k, 10.0)) for k in (1 - 1e-6, 1 + 1e-6)]
        for name in ("f_yc", "f_b"):
            low, high = (float(getattr(s, name)) for s in near)
            assert low == pytest.approx(high, rel=3.5e-3)


def test_every_check_is_named() -> None:
    assert tuple(CHECKS) == Utilisation._fields
    assert all("ISO 19902 13." in text for text in CHECKS.values())
