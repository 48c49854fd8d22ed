"""Findings: what is worth saying of a record, a mode, a model or a state, as data.

A finding has a code, a severity, a subject and parameters; the catalogue makes its sentence from them,
so that the same finding reads the same on the terminal, in the report, in the store and behind the API.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Severity = Literal["info", "warning", "alarm"]
Value = float | int | str | bool | None


@dataclass(frozen=True)
class Kind:
    """What all findings of one code have in common.

    Attributes
    ----------
    severity : {"info", "warning", "alarm"}
        ``info`` needs nobody, ``warning`` limits what may be concluded, ``alarm`` asks for a person.
    sentence : str
        A format string over the parameters, without subject: ``"{share:.2%} of the samples are missing"``.
    """

    severity: Severity
    sentence: str


CATALOGUE: dict[str, Kind] = {
    # records
    "gaps": Kind("info", "{share:.2%} of the samples are missing, at most {longest_s:.3g} s in a row"),
    "gain_jump": Kind(
        "warning",
        "{channels}: {factor:.3g} times as sensitive {at} {time_s:.0f} s as in the rest of the record, "
        "judged by the other channels; scaled, {from_s:.0f} to {to_s:.0f} s declared missing",
    ),
    "gain_grows": Kind(
        "warning",
        "{channels}: {factor:.3g} times as sensitive at the end as at the beginning, judged by the other "
        "channels; scaled",
    ),
    "sign_turns": Kind(
        "warning",
        "{channels}: the sign turns between {from_s:.0f} and {to_s:.0f} s; turned back, declared missing "
        "between",
    ),
    "time_lost": Kind(
        "warning",
        "{channels}: {lost} {lost_s:.4g} s against the other channels between {from_s:.0f} and {to_s:.0f} s; "
        "brought into step, declared missing there",
    ),
    "samples_repeated": Kind(
        "alarm",
        "every sample of every channel is written {times} times: only one of them is used. If the repeats "
        "are copies of one instant, all frequencies are {times} times what is said here",
    ),
    "another_time": Kind(
        "alarm",
        "{channels}: the spectrum has the peaks of the other channels, but the samples match theirs at no "
        "delay: not of the same minutes{unless}; left out if they are fewer than the others",
    ),
    "direction_unknown": Kind(
        "warning",
        "{channels}: the spectrum has the peaks of the other channels, but the samples do not move with "
        'theirs, and directions are not stated: do they point across? State "direction" of each channel in '
        "the JSON beside the file; parallel channels would not be of the same minutes",
    ),
    "stored_backwards": Kind(
        "alarm", "{channels}: matches the other channels only if read from the end to the beginning; turned"
    ),
    "coarse_quantiser": Kind(
        "warning",
        "read in steps of {steps:.2g} times its rms: the rounding error is neither small nor white; "
        "distrust modes and damping",
    ),
    "clock_late": Kind(
        "warning",
        "{channels}: read {delay_s:.3g} ± {std_s:.2g} s {late} than the others, the same at all "
        "frequencies: another clock; shifted",
    ),
    "clock_drift": Kind(
        "warning",
        "{channels}: the clock runs {drift_ppm:.0f} ± {std_ppm:.2g} ppm too {slow} against the others', off"
        " by {delay_s:.3g} s in the middle of the record; resampled",
    ),
    "clock_curve": Kind(
        "warning",
        "{channels}: the clock's rate changes: later than the others' by {begin_s:.3g} s at the beginning, "
        "{middle_s:.3g} s in the middle and {end_s:.3g} s at the end; resampled",
    ),
    "clock_late_or_complex": Kind(
        "info",
        "{channels}: read {delay_s:.3g} s {late} than the others, or the modes are complex: the record "
        "cannot tell which; kept",
    ),
    "clock_jump": Kind(
        "warning",
        "{channels}: the clock jumps by {by_s:.3g} s against the others' between {from_s:.0f} and "
        "{to_s:.0f} s",
    ),
    "clock_cut": Kind(
        "warning", "only {from_s:.0f} to {to_s:.0f} s are used, the longest stretch in which no clock jumps"
    ),
    "clocks_wander": Kind(
        "alarm",
        "the clocks of the loggers wander against each other: no stretch is long enough to bring them into "
        "step",
    ),
    "file": Kind("info", "{text}"),
    "dead": Kind("warning", "does not vary at all; left out"),
    "empty": Kind("warning", "{share:.0%} of the samples are missing; left out"),
    "outliers": Kind("warning", "{share:.1%} of the samples stand out, too many to be spikes; kept"),
    "spikes": Kind("info", "{share:.3%} of the samples are spikes; declared missing"),
    "clipped": Kind(
        "warning", "{share:.2%} of the samples are at the range's end; kept, amplitudes are too small"
    ),
    "stuck": Kind("info", "reading is frozen for {share:.2%} of the time; declared missing"),
    "held": Kind(
        "info",
        "every value is repeated {times} times: the sensor is read at a lower rate, and its signal is late",
    ),
    "drift": Kind("info", "drifts over {ratio:.1f} times the rms of its vibration; slow part removed"),
    "unsteady": Kind(
        "warning",
        "is {ratio:.3g} times stronger in one tenth of the record than usual: the record is not stationary",
    ),
    "sign_turned": Kind("warning", "moves against all parallel channels; sign turned"),
    "sign_unclear": Kind(
        "warning", "moves against a parallel channel, and nothing says which of them is wrong; kept"
    ),
    "unit": Kind(
        "warning", "{which} is {size} compared with similar channels: {units}? kept, correct the unit"
    ),
    "weak": Kind(
        "warning", "its rms is {ratio:.2g} times that of similar channels: is the sensor or its unit wrong?"
    ),
    "strong": Kind(
        "warning", "its rms is {ratio:.2g} times that of similar channels: is the sensor or its unit wrong?"
    ),
    "not_filtered": Kind(
        "warning",
        "{channels}: the spectrum does not fall towards half the sample rate, has a peak and {share:.1%} of "
        "its power near it: sampled or decimated without a filter? Peaks may be folded from above",
    ),
    "axes_crossed": Kind(
        "warning", "{channels}: each moves with the other axis of all other places: exchanged; put right"
    ),
    "axes_crossed_unclear": Kind(
        "warning",
        "{channels}: at some of these places x and y are exchanged, and nothing says at which; kept, state "
        '"direction" in the JSON beside the file',
    ),
    "unreadable": Kind("warning", "{samples} samples are infinite or beyond {limit:g}; declared missing"),
    "changed": Kind("warning", "{what}; declared missing there"),
    "changed_unclear": Kind("warning", "{what}, or a similar channel changes; kept"),
    "stamps_jitter": Kind(
        "warning", "time stamps jitter by {share:.0%} of a step (rms); interpolated to a regular grid"
    ),
    "stamps_missing": Kind("warning", "{samples} samples have no time stamp; declared missing"),
    "stamps_disordered": Kind("warning", "{samples} time stamps repeat or run backwards; left out"),
    # identification
    "peaks_above_band": Kind(
        "info",
        "{count} clear peaks above the band, which ends at {edge:.3g} Hz: {peaks} Hz; modes there are not "
        "sought, --band {widen} widens it",
    ),
    "not_refined": Kind("warning", "modes at {frequencies_hz} Hz not refined: {obstacle}"),
    "hidden_mode": Kind(
        "warning",
        "a second mode may hide beside {frequency_hz:.4g} Hz: poles of another shape at {other_hz:.4g} Hz, "
        "within its bandwidth, were left out",
    ),
    "steady_tone_near": Kind(
        "warning", "a steady tone at {frequency_hz:.4g} Hz is too near to trust the damping"
    ),
    "tone_passes": Kind(
        "warning", "a tone passes here, between {low_hz:.4g} and {high_hz:.4g} Hz: distrust the damping"
    ),
    "free_decay": Kind(
        "info",
        "a free decay from {from_s:.4g} to {to_s:.4g} s, over {fall:.1f} e-folds; its modes explain "
        "{explained:.1%} of it, and the rest of the record is not used",
    ),
    "beside_knock": Kind(
        "info",
        "one impact rings out over {fall:.1f} e-folds; the modes are those of the {used_s:.4g} s beside it",
    ),
    "transient": Kind(
        "warning",
        "the record falls by {fall:.1f} e-folds from one maximum while forces go on: neither a free decay "
        "nor stationary",
    ),
    "decay_forced": Kind("warning", "forces that go on leave {left:.0%} of the decay unexplained"),
    "decay_weak": Kind("warning", "only {ratio:.0f} times as strong as the noise near its frequency"),
    "decay_short": Kind("warning", "observed over {folds:.1f} e-folds only"),
    "decay_damping_unknown": Kind("warning", "the damping is uncertain by {spread:.0%}"),
    "decay_damping_changes": Kind(
        "warning",
        "the damping changes with the amplitude: {early:.2%} of critical at first, {late:.2%} at the end",
    ),
    "damping_unknown": Kind(
        "warning",
        "the record does not tell the damping: its logarithm has a standard deviation of {log_std:.2g}",
    ),
    "narrow_as_a_line": Kind(
        "warning", "its peak is hardly broader than a line of the spectrum: the record is too short for it"
    ),
    "follows_the_sea": Kind(
        "warning",
        "a peak of waves: with {damping_percent:.2g} % it is as broad as that of the sea of {period_s:.3g} "
        "s, and at its frequency",
    ),
    "broad_as_waves": Kind(
        "warning",
        "with {damping_percent:.2g} % it is as broad as the forces of waves; state their period (tp_s)",
    ),
    "broad": Kind(
        "warning",
        "with {damping_percent:.2g} % it is so broad that it may be a slope of the forces' spectrum",
    ),
    "complex_shape": Kind(
        "warning",
        "the sensors do not move in phase (modal phase collinearity {mpc:.2f}) and no close mode explains it",
    ),
    "one_part": Kind(
        "warning",
        "{share:.0%} of its power lie in one fifth of the record, unlike that of the other modes: a tone "
        "that ended, or an impact",
    ),
    "one_sensor": Kind("warning", "{share:.0%} of its motion is that of one sensor"),
    "sensor_beside": Kind(
        "warning",
        "together with the mode beside it, its shape holds one sensor that moves alone, {share:.0%} of its "
        "own motion: a mount or a cable",
    ),
    "shape_of_neighbours": Kind(
        "warning",
        "its shape is a combination of those of the modes below and above: a peak of the forces, or of "
        "something that is not measured, which these modes show",
    ),
    "unlike_model": Kind(
        "warning",
        "no mode of the model has such a shape ({mac:.2f} at most), and the refinement could not confirm it",
    ),
    "below_model": Kind(
        "warning",
        "it lies below the lowest mode of the model and has its shape (MAC {mac:.2f}): the structure "
        "follows slow forces, as those of waves",
    ),
    "sea_forced": Kind(
        "warning",
        "it is no further mode of the model, and {share:.0%} of its shape is how the sea moves the structure "
        "at that frequency: a peak of the waves",
    ),
    "shape_twice": Kind(
        "warning",
        "another mode at nearly the same frequency has the same shape: one peak is identified twice, or one"
        " of them is no mode",
    ),
    "too_short": Kind(
        "alarm",
        "{share:.0%} of the motion is slower than {cycles} cycles in {duration_s:.3g} s: the record is too "
        "short for any statement",
    ),
    "few_cycles": Kind("warning", "the record holds only {cycles:.0f} of its cycles"),
    "zero_steps": Kind(
        "warning", "its zero steps by {size:.3g} times the rms of the vibration at {time_s:.1f} s; taken back"
    ),
    "zero_steps_together": Kind(
        "alarm",
        "the zeros of most channels step at {time_s:.1f} s: something happened to the logger or the "
        "structure",
    ),
    "one_method": Kind("warning", "with a shorter lag window only {share:.0%} of the model orders find it"),
    "no_peak": Kind(
        "warning",
        "in the direction of its shape the spectrum has no clear peak: {ratio:.2g} times the level beside "
        "it, where a single mode has 17 times",
    ),
    "second_peak": Kind(
        "warning",
        "a clear peak beside it, at {frequency_hz:.4g} Hz, belongs to no mode: two modes may be identified "
        "as one",
    ),
    "steady_envelope": Kind(
        "warning",
        "its amplitude varies less than that of a mode of so little damping should: it may be a tone",
    ),
    "rotor_order_passes": Kind("warning", "{order}P of the rotor passes here: distrust the damping"),
    "rotor_order_across_records": Kind(
        "warning",
        "moves with another peak at {ratio:g} times the frequency of the lower, {low_hz:.3g} to "
        "{high_hz:.3g} Hz in {number} records, while modes stay: orders of a rotor whose speed is not told",
    ),
    "jumps_between_records": Kind(
        "warning",
        "jumps {times} times from one record to the next, typically by {size:.1%}, while {stays_hz:.4g} Hz "
        "stays: an order of a rotor whose speed is not told, or two modes taken for one",
    ),
    # updating
    "unpaired_shape": Kind(
        "info",
        "nearest in the model is {label} at {model_frequency_hz:.4g} Hz ({difference:+.1%}), of another "
        "shape: MAC {mac:.2f}, {least_mac:g} needed",
    ),
    "unpaired_frequency": Kind(
        "info",
        "of the model's modes {label} at {model_frequency_hz:.4g} Hz has the shape (MAC {mac:.2f}), "
        "but the frequency is {difference:+.0%} away",
    ),
    "unpaired_taken": Kind(
        "info",
        "resembles {label} of the model at {model_frequency_hz:.4g} Hz ({difference:+.1%}, MAC {mac:.2f}), "
        "but another measured mode resembles that more",
    ),
    # twin: a record on its way to an observation
    "yaw_unknown": Kind(
        "warning", "the yaw is not known: sensors on the nacelle are taken to be aligned with the fixed ones"
    ),
    "not_in_rotor_axes": Kind(
        "warning", "not turned to the rotor's axes: no two horizontal channels sit at one place"
    ),
    "channels_without_partner": Kind("warning", "left out: no second horizontal channel at the same place"),
    "rotor_order_removed": Kind(
        "warning",
        "{low_hz:.3g} to {high_hz:.3g} Hz by the measured rotor speed: taken out, {share:.1%} of a "
        "channel's power at most",
    ),
    "rotor_order_weak": Kind(
        "info", "{low_hz:.3g} to {high_hz:.3g} Hz by the measured rotor speed: taken out"
    ),
    "rotor_order_seen": Kind("info", "{low_hz:.3g} to {high_hz:.3g} Hz: seen along the measured rotor speed"),
    "rotor_order_stated": Kind("info", "{low_hz:.3g} to {high_hz:.3g} Hz by the stated rotor speed"),
    "places_unknown": Kind(
        "info",
        "the place is not known (height_m or node in the JSON beside the record): swapped signs and wrong "
        "units are not looked for",
    ),
    "sensors_absent": Kind("warning", "the record has no such channels; identified without them"),
    "channels_unclear": Kind("info", "left out: neither name and unit nor the JSON say what they measure"),
    "deformation_set_aside": Kind(
        "info", "left out beside accelerations; identify them from a file of their own"
    ),
    "sensor_against_model": Kind(
        "warning",
        "points the other way than the twin says: if it were turned, the shapes it moves in would agree "
        "with the model's by {after:.0%} instead of {before:.0%}. Kept; turn its direction.",
    ),
    "sensor_uncalibrated": Kind(
        "warning", "has a history of calibrations, but none that holds at that time: taken as it was logged"
    ),
    "operation_unknown": Kind(
        "warning",
        "the state of operation is unknown, since {missing} is missing: send these conditions, and the "
        "record is observed again",
    ),
    "identification": Kind("warning", "{text}"),
    "no_mode_of_the_model": Kind("warning", "none of its {modes} identified modes is one of the model"),
    "record_mismatched": Kind(
        "warning",
        "none of its {modes} modes is one of the twin's: is it of another turbine, or are its sensors "
        "elsewhere than the twin says? It does not count.",
    ),
    # twin: an observation on its way into the state
    "record_doubled": Kind("warning", "these samples are known already and count once"),
    "record_overlaps": Kind(
        "warning",
        "other samples of the same minutes are known; if they are of the same sensors, they count twice",
    ),
    # twin: the days of a state watched
    "watch_learning": Kind(
        "info", "learning what is normal: {days:.0f} of {needed:.0f} days; nothing is watched yet"
    ),
    "watch_begins": Kind(
        "info", "watched from {from} on: a false alarm once in {arl_years:g} years or more rarely"
    ),
    "watch_sees": Kind("info", "{said}"),
    "structure_changed": Kind(
        "alarm",
        "changed: {by_mode}; began {began} ({began_low} to {began_high}); "
        "most likely {cause} ({probability:.0%})",
    ),
    "structure_turned": Kind(
        "alarm",
        "turned: {by_mode}; began {began} ({began_low} to {began_high}); "
        "most likely {cause} ({probability:.0%})",
    ),
    "sensor_changed": Kind(
        "warning",
        "behaves otherwise since {began} ({began_low} to {began_high}); most likely {cause} "
        "({probability:.0%})",
    ),
    "cause_corrected": Kind(
        "warning",
        "the change of {alarm} was: {was} ({was_probability:.0%}); now: {now} ({probability:.0%})",
    ),
    # service
    "study_set_aside": Kind(
        "alarm",
        "what the days say could not be found in {tries} tries ({reason}): no change would be seen; "
        "mend the cause, then POST /jobs/{job}/retry",
    ),
    "life_unknown": Kind("warning", "no damage at the welds: {reason}"),
    "life_share": Kind(
        "alarm",
        "takes {ratio:.2g} times its former share of the damage of all welds, against the {days} days before",
    ),
    "life_budget": Kind(
        "alarm",
        "its damage of a year is {ratio:.2g} times what {years:g} years allow, at least {low:.2g} times "
        "(90 %)",
    ),
    "asset_silent": Kind(
        "alarm",
        "nothing came since for more than {hours:g} hours: is the logger, or the way from it, broken?",
    ),
    "record_late": Kind("info", "older than {days} days that are known; these days are computed again"),
}
"""Every code there is, by the package that finds it."""


@dataclass(frozen=True)
class Finding:
    """One thing worth saying.

    Attributes
    ----------
    code : str
        A key of :data:`CATALOGUE`.
    subject : str or None
        The channel, mode, record or parameter it concerns; None if it concerns the whole.
    params : mapping
        Numbers and names the sentence is made from, SI units.
    repaired : bool
        Whether what was found is taken out of the record.
    """

    code: str
    subject: str | None = None
    params: Mapping[str, Value] = field(default_factory=dict)
    repaired: bool = False

    def __post_init__(self) -> None:
        if self.code not in CATALOGUE:
            raise KeyError(f"no finding has the code {self.code!r}")

    @property
    def severity(self) -> Severity:
        """How much it matters."""
        return CATALOGUE[self.code].severity

    @property
    def text(self) -> str:
        """The sentence, without its subject."""
        return CATALOGUE[self.code].sentence.format(**self.params)

    @property
    def document(self) -> dict[str, Any]:
        """It as plain JSON data, with its severity and its sentence."""
        return {
            "code": self.code,
            "severity": self.severity,
            "subject": self.subject,
            "params": dict(self.params),
            "text": self.text,
            "repaired": self.repaired,
        }

    def __str__(self) -> str:
        """The sentence, with its subject."""
        return self.text if self.subject is None else f"{self.subject}: {self.text}"
