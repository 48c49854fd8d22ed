"""What makes every mode of a record doubtful."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from observations import estimate, observation
from scipy.signal import decimate

from jackettwin.identification import IdentificationSettings, examine
from jackettwin.identification.estimate import ModalEstimate
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record
from jackettwin.twin.mode_doubts import unlike_model
from jackettwin.updating.data.pairing import Counterpart

PLAIN = IdentificationSettings(refine=False)
SYSTEM = ModalSystem(
    np.array([0.3, 1.1, 2.3]),
    np.array([0.01, 0.015, 0.01]),
    np.array([[1.0, 0.6, 0.3, 0.1], [-0.4, 0.7, 1.0, 0.4], [0.6, -1.0, 0.5, 0.9]]),
    np.diag([1.0, 3.0, 5.0]),
)


@pytest.fixture
def sound(rng: np.random.Generator) -> Record:
    """Return ten minutes at 10 Hz, filtered before they are sampled so."""
    quick = simulate(SYSTEM, rng, duration_s=600.0, sample_rate_hz=40.0)
    return replace(quick, data=decimate(quick.data, 4), sample_rate_hz=10.0)


def codes(record: Record) -> list[set[str]]:
    return [{reason.code for reason in mode.reasons} for mode in examine(record, PLAIN).identification.modes]


def test_a_sound_record_is_not_doubted(sound: Record) -> None:
    modes = examine(sound, PLAIN).identification.modes
    assert [mode.status for mode in modes] == ["ok"] * 3


def test_samples_that_stand_twice(sound: Record) -> None:
    """Each is used once, so that no image of a mode is a mode; what they mean is not known."""
    repeated = replace(sound, data=np.repeat(sound.data[:, ::2], 2, axis=1))
    modes = examine(repeated, PLAIN).identification.modes
    assert modes
    for mode in modes:
        assert mode.status == "doubtful"
        assert np.min(np.abs(np.log(mode.frequency_hz / SYSTEM.frequency_hz))) < 0.02


def test_thirty_seconds_are_too_short(sound: Record) -> None:
    for start in (0, 1_500):
        found = codes(replace(sound, data=sound.data[:, start : start + 300]))
        assert all("too_short" in of or "few_cycles" in of for of in found)


def test_zeros_that_step_together(sound: Record) -> None:
    sense = np.array([1.0, -1.0, -1.0, 1.0])[:, None]
    after = np.arange(sound.data.shape[1]) > 2_500
    stepped = replace(sound, data=sound.data + 3.0 * sense * sound.data.std(axis=1, keepdims=True) * after)
    modes = examine(stepped, PLAIN).identification.modes
    assert modes
    assert all(mode.reasons[-1].code == "zero_steps_together" for mode in modes)


def test_of_channels_of_two_days_every_mode_is_doubted(sound: Record) -> None:
    """Their directions must be known: halves of a record that share nothing may point across one another."""
    along = tuple(replace(channel, direction=(1.0, 0.0, 0.0)) for channel in sound.channels)
    sound = replace(sound, channels=along)
    other = simulate(SYSTEM, np.random.default_rng(8), duration_s=600.0, sample_rate_hz=10.0)
    mixed = replace(sound, data=np.vstack([sound.data[:2], other.data[2:]]))
    found = codes(mixed)
    assert found
    assert all("another_time" in of for of in found)


def test_a_step_of_one_rms_gives_nothing_that_is_ok(sound: Record) -> None:
    step = sound.data.std(axis=1, keepdims=True)
    modes = examine(replace(sound, data=step * np.round(sound.data / step)), PLAIN).identification.modes
    assert all(mode.status != "ok" for mode in modes)


def mode_of(method: str, unrefined: ModalEstimate | None = None) -> ModalEstimate:
    found = estimate(0.5, 0.01)
    return replace(found, method=method, unrefined=unrefined, status=ModeStatus.OK)


def test_what_the_model_has_not_and_the_refinement_left_is_doubted() -> None:
    """A peak of the waves between the pairs was ``ok`` on symmetric jackets; a refined blade mode stays."""
    paired = Counterpart(0, 0.25, 0.0, 0.99, "paired")
    unlike, far = Counterpart(0, 0.25, 1.0, 0.46, "shape"), Counterpart(0, 0.25, 1.0, 0.95, "frequency")
    plain = mode_of("ssi-cov")
    refined = mode_of("maximum-likelihood", plain)
    seen = observation({1: plain}, None).identification
    found = replace(seen, modes=(plain, plain, refined, plain))
    held = (paired, unlike, unlike, far)
    now = unlike_model(found, held, (0.0,) * 4).modes
    assert [mode.status for mode in now] == ["ok", "doubtful", "ok", "ok"]
    assert [reason.code for reason in now[1].reasons] == ["unlike_model"]
    # a record that shows nothing of the model tells nothing against it
    assert unlike_model(found, (unlike,) * 4, (1.0,) * 4) is found


def test_what_moves_as_the_lowest_mode_far_below_it_follows_forces() -> None:
    """Swell of 12 s is narrower than seas are: neither its breadth nor its shape tells it."""
    first, swell, second = (replace(mode_of("ssi-cov"), frequency_hz=f) for f in (0.2, 0.085, 0.5))
    seen = observation({1: first}, None).identification
    found = replace(seen, modes=(swell, first, second))
    paired, alike = Counterpart(0, 0.2, 0.0, 0.99, "paired"), Counterpart(0, 0.2, -0.6, 0.97, "frequency")
    now = unlike_model(found, (alike, paired, alike), (0.0,) * 3).modes
    assert [mode.status for mode in now] == ["doubtful", "ok", "ok"]
    assert [reason.code for reason in now[0].reasons] == ["below_model"]


def test_what_moves_as_under_waves_is_doubted_even_if_it_was_refined() -> None:
    """The sea's shape tells: a paired mode and a blade's keep their status."""
    refined = mode_of("maximum-likelihood", mode_of("ssi-cov"))
    found = replace(observation({1: refined}, None).identification, modes=(refined,) * 4)
    paired, taken, unlike = (
        Counterpart(0, 0.25, 0.0, 0.9, verdict) for verdict in ("paired", "taken", "shape")
    )
    now = unlike_model(found, (paired, taken, unlike, unlike), (1.0, 0.98, 0.97, 0.91)).modes
    assert [mode.status for mode in now] == ["ok", "doubtful", "doubtful", "ok"]
    assert [reason.code for reason in now[1].reasons] == ["sea_forced"]
