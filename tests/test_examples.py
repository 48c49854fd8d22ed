"""Every example runs and says what it promises."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_gravity_softens_the_first_mode() -> None:
    """The records' README: P-Δ lowers the first modes by about 3 %."""
    assert load("01_modes_of_a_jacket").main() == pytest.approx(0.03, abs=0.01)


def test_undamped_frequencies_tell_a_locked_damper() -> None:
    """Tables 8.1 and 8.3: 0.1812 Hz with soil; the locked damper hides 0.1506 Hz."""
    soil, locked = load("02_locked_damper").main()
    assert soil == pytest.approx(0.1812, rel=6e-3)
    assert locked == pytest.approx(0.1506, rel=6e-3)


def test_a_record_gives_both_bending_pairs() -> None:
    frequencies = load("03_identify_a_record").main()
    assert sum(0.17 < f < 0.185 for f in frequencies) == 2
    assert sum(0.72 < f < 0.79 for f in frequencies) == 2


def test_the_update_is_as_near_as_the_thesis() -> None:
    assert load("04_update_supports").main() <= 0.0040


def test_a_three_leg_jacket_has_a_first_pair_by_symmetry() -> None:
    f = load("05_your_own_jacket").main()
    # three legs make both directions alike but for the nacelle's inertia
    assert f[1] / f[0] == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda p: p.stem)
def test_examples_are_short_and_tested(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= 60
    assert path.stem in Path(__file__).read_text()


def test_the_superelement_keeps_the_damping() -> None:
    """1 % where plain Craig–Bampton is twice off."""
    ours, plain = load("06_superelement").main()
    assert abs(ours) < 0.01
    assert plain > 0.9


def test_a_bridge_needs_no_jacket() -> None:
    """Ten minutes know f to 1/√(…) ≈ 0.1 %; three standard deviations."""
    ratios, least_mac = load("07_modes_of_a_bridge").main()
    assert ratios == pytest.approx([1.0, 1.0, 1.0], abs=0.004)
    assert least_mac > 0.999
