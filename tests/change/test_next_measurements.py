"""What would settle a doubt between two causes: entropies by hand, states, sensors and places."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.change.causes import MODES, ModelCauses, SeenCauses, seen_causes
from jackettwin.change.next_measurements import Circumstances, _looks, next_measurements
from jackettwin.watching import Cause, CauseVerdict, Diagnosis

LABELS = ("side_side_1", "fore_aft_1", "torsion_1", *(f"local_{i}" for i in range(1, 6)))
AROUND = Circumstances(
    ("operating", "parked"), np.outer([0.05, 0.01], np.ones(MODES)), np.array([5e-4, 0.05])
)


def cause(name: str, torsion: float) -> Cause:
    direction = np.zeros((1, 2 * MODES))
    direction[0, :3] = -1e-3, -1e-3, torsion
    return Cause(name, direction, np.ones(1), np.zeros(1), misfit=0.0)


def seen(torsion: float) -> SeenCauses:
    """Return two causes that differ in torsion alone, of which the bending modes are watched."""
    causes = cause("soil softening", 0.0), cause("marine growth", torsion)
    best = ("at the top", "at the top", "on the leg", *[""] * 5)
    model = ModelCauses(LABELS, np.linspace(0.2, 3.0, MODES), causes, (), seen_best=best)
    return seen_causes(model, (("frequency", 0), ("frequency", 1)), LABELS)


def judged(shares: dict[str, float]) -> Diagnosis:
    verdicts = [CauseVerdict(name, p, 1.0, (0.99, 1.01), "-") for name, p in shares.items()]
    return Diagnosis(tuple(verdicts), ())


EVEN = judged({"soil softening": 0.5, "marine growth": 0.5})


def test_the_mode_that_differs_is_named_with_state_and_sensor() -> None:
    first, second = next_measurements(seen(-0.02), EVEN, AROUND)
    assert (first.mode, first.quantity, first.state, first.sensor) == (
        "torsion_1", "frequency", "parked", "on the leg",
    )  # fmt: skip
    assert first.gain_nats == pytest.approx(np.log(2.0), rel=1e-3)  # 2 % against 0.03 %: it settles it
    assert second.what == "the thickness of the growth under water" and second.mode == ""
    assert second.gain_nats < first.gain_nats


def test_a_watched_mode_needs_no_sensor() -> None:
    every = replace(seen(-0.02), columns=(0, 1, 2))
    (first, *_) = next_measurements(every, EVEN, AROUND)
    assert first.sensor == "" and "once more" in first.what


def test_what_records_cannot_resolve_is_not_advised() -> None:
    """Causes that differ by a tenth of what a month's records tell leave the look alone."""
    (only,) = next_measurements(seen(-3e-5), EVEN, AROUND)
    assert only.mode == ""


def test_a_month_is_known_by_records_and_by_what_is_unexplained() -> None:
    """Au's √(ζ/2πfT) of 86,400 s, before and after, and 7.5 independent values of 0.05 %."""
    noise = AROUND.noise(np.array([0.2]))
    au = 0.01 / (2.0 * np.pi * 0.2 * 86_400.0)
    np.testing.assert_allclose(noise[1, 0, 0], np.sqrt(2.0 * (au + 5e-4**2 / 7.5)))
    assert noise[0, 0, 0] > noise[1, 0, 0] and noise[0, 1, 0] < noise[1, 1, 0]  # damped: f worse, ζ better


def test_a_look_tells_what_it_can_show() -> None:
    """Two equally likely causes: the survey settles them, ln 2 but for what a look may miss."""
    (survey,) = _looks(list(judged({"scour at all feet": 0.5, "soil softening": 0.5}).verdicts))
    assert survey.what == "a survey of the seabed at the feet"
    assert 0.5 * np.log(2.0) < survey.gain_nats < np.log(2.0)


def test_what_is_certain_needs_nothing() -> None:
    sure = judged({"soil softening": 1.0, "marine growth": 0.0})
    assert next_measurements(seen(-0.02), sure, AROUND) == ()
