"""Findings: messages about a record, a mode, a model or a state, as data.

A finding has a code, a severity, a subject and parameters; the catalogue forms its sentence from them, so
that it reads the same on the terminal, in the report, in the store and in the API.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Severity = Literal["info", "warning", "alarm"]
Value = float | int | str | bool | None


@dataclass(frozen=True)
class Kind:
    """Properties common to all findings of one code.

    Attributes
    ----------
    severity : {"info", "warning", "alarm"}
        ``info`` needs no action, ``warning`` limits the conclusions, ``alarm`` needs a person.
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
        "{channels}: the sensitivity {at} {time_s:.0f} s is {factor:.3g} times that in the rest of the "
        "record, compared with the other channels; corrected, {from_s:.0f} to {to_s:.0f} s declared missing",
    ),
    "gain_grows": Kind(
        "warning",
        "{channels}: the sensitivity at the end is {factor:.3g} times that at the beginning, compared with "
        "the other channels; corrected",
    ),
    "sign_turns": Kind(
        "warning",
        "{channels}: the sign changes between {from_s:.0f} and {to_s:.0f} s; corrected, declared missing in "
        "between",
    ),
    "time_lost": Kind(
        "warning",
        "{channels}: {lost} {lost_s:.4g} s relative to the other channels between {from_s:.0f} and "
        "{to_s:.0f} s; realigned, declared missing there",
    ),
    "samples_repeated": Kind(
        "alarm",
        "every sample of every channel is repeated {times} times; only one of them is used. If the repeats "
        "are copies of one instant, all frequencies are {times} times those stated here",
    ),
    "resampled_by_holding": Kind(
        "info",
        "all channels change together and hold their values in between: a record of {rate_hz:.4g} Hz that "
        "was brought to a higher rate; its own samples are used",
    ),
    "blanks_filled": Kind(
        "info",
        "every {times}th sample is there, and blanks between: sampled at {rate_hz:.4g} Hz beside faster "
        "channels; interpolated",
    ),
    "another_time": Kind(
        "alarm",
        "{channels}: the spectrum has the peaks of the other channels, but the samples match theirs at no "
        "delay: they are not from the same time{unless}; left out if they are fewer than the others",
    ),
    "direction_unknown": Kind(
        "warning",
        "{channels}: the spectrum has the peaks of the other channels, but the samples do not move with "
        'theirs, and directions are not stated: are they perpendicular? State "direction" of each channel in '
        "the JSON beside the file; if the channels are parallel, they are not from the same time",
    ),
    "stored_backwards": Kind(
        "alarm", "{channels}: matches the other channels only if the time is reversed; reversed"
    ),
    "coarse_quantiser": Kind(
        "warning",
        "the resolution is {steps:.2g} times its rms: the rounding error is neither small nor white; "
        "distrust modes and damping",
    ),
    "clock_late": Kind(
        "warning",
        "{channels}: sampled {delay_s:.3g} s {late} than the others (standard deviation {std_s:.2g} s), "
        "equally at all frequencies: the clocks differ; shifted",
    ),
    "clock_drift": Kind(
        "warning",
        "{channels}: the clock is {drift_ppm:.0f} ppm too {slow} compared with the others' "
        "(standard deviation {std_ppm:.2g} ppm), and in error by {delay_s:.3g} s in the middle of the "
        "record; resampled",
    ),
    "clock_curve": Kind(
        "warning",
        "{channels}: the clock's rate changes: it is later than the others' by {begin_s:.3g} s at the "
        "beginning, {middle_s:.3g} s in the middle and {end_s:.3g} s at the end; resampled",
    ),
    "clock_late_or_complex": Kind(
        "info",
        "{channels}: sampled {delay_s:.3g} s {late} than the others, or the modes are complex: the record "
        "does not distinguish the two; not corrected",
    ),
    "clock_jump": Kind(
        "warning",
        "{channels}: the clock jumps by {by_s:.3g} s relative to the others' between {from_s:.0f} and "
        "{to_s:.0f} s",
    ),
    "clock_cut": Kind(
        "warning", "only {from_s:.0f} to {to_s:.0f} s are used, the longest stretch in which no clock jumps"
    ),
    "clocks_wander": Kind(
        "alarm",
        "the clocks of the loggers drift irregularly against each other: no stretch is long enough to "
        "synchronise them",
    ),
    "file": Kind("info", "{text}"),
    "dead": Kind("warning", "is constant; left out"),
    "empty": Kind("warning", "{share:.0%} of the samples are missing; left out"),
    "outliers": Kind(
        "warning", "{share:.1%} of the samples are outliers, too many to be spikes; not removed"
    ),
    "spikes": Kind("info", "{share:.3%} of the samples are spikes; declared missing"),
    "clipped": Kind(
        "warning",
        "{share:.2%} of the samples are at the limit of the range; not corrected, amplitudes are too small",
    ),
    "stuck": Kind("info", "the reading is frozen for {share:.2%} of the time; declared missing"),
    "held": Kind(
        "info",
        "every value is repeated {times} times: the sensor is sampled at a lower rate, and its signal is "
        "delayed",
    ),
    "drift": Kind("info", "drifts by {ratio:.1f} times the rms of its vibration; the slow part is removed"),
    "unsteady": Kind(
        "warning",
        "is {ratio:.3g} times stronger in one tenth of the record than usual: the record is not stationary",
    ),
    "sign_turned": Kind("warning", "has the opposite sign of all parallel channels; sign changed"),
    "sign_unclear": Kind(
        "warning",
        "has the opposite sign of a parallel channel; which of them is wrong is not known; not changed",
    ),
    "unit": Kind(
        "warning", "{which} is {size} compared with similar channels: {units}? not changed, correct the unit"
    ),
    "weak": Kind(
        "warning", "its rms is {ratio:.2g} times that of similar channels: is the sensor or its unit wrong?"
    ),
    "strong": Kind(
        "warning", "its rms is {ratio:.2g} times that of similar channels: is the sensor or its unit wrong?"
    ),
    "not_filtered": Kind(
        "warning",
        "{channels}: the spectrum does not fall towards half the sample rate, {half_hz:.3g} Hz, has a peak "
        "at {peak_hz:.3g} Hz and {share:.1%} of its power in the upper third of the band: was it sampled or "
        "decimated without an anti-aliasing filter? Peaks may be aliases",
    ),
    "axes_crossed": Kind(
        "warning",
        "{channels}: each moves with the other axis at all other places: the two are exchanged; corrected",
    ),
    "axes_crossed_unclear": Kind(
        "warning",
        "{channels}: at some of these places x and y are exchanged, but not known at which; not changed, "
        "state "
        '"direction" in the JSON beside the file',
    ),
    "unreadable": Kind("warning", "{samples} samples are infinite or beyond {limit:g}; declared missing"),
    "changed": Kind("warning", "{what}; declared missing there"),
    "changed_unclear": Kind("warning", "{what}, or a similar channel changes; not corrected"),
    "stamps_jitter": Kind(
        "warning", "time stamps jitter by {share:.0%} of a step (rms); interpolated to a regular grid"
    ),
    "stamps_missing": Kind("warning", "{samples} samples have no time stamp; declared missing"),
    "stamps_disordered": Kind("warning", "{samples} time stamps are repeated or decrease; left out"),
    # identification
    "copied": Kind("warning", "is a copy of {other}; left out"),
    "predicted": Kind("warning", "{share:.1%} of the samples are missing, predicted from the other channels"),
    "short_for_lowest": Kind(
        "warning",
        "the record is short: {duration_s:.3g} s contain {cycles:.0f} cycles of {frequency_hz:.3g} Hz; "
        "distrust modes of such low frequency, which need hundreds of cycles",
    ),
    "strong_below_band": Kind(
        "warning",
        "the band starts at {low_hz:.3g} Hz, but the record moves strongly near {strongest_hz:.2g} Hz; it "
        "has too few cycles there to show a peak; use a longer record, or state lowest_frequency_hz",
    ),
    "components": Kind(
        "info",
        "identified from {components} components of {channels} channels, {share:.1%} of their power",
    ),
    "picks_leave_out": Kind(
        "warning",
        "the picks leave out modes at {frequencies_hz} Hz: what is fitted to the spectrum lacks them; pick "
        "them too, or narrow the band",
    ),
    "pair_rotated": Kind(
        "info",
        "shapes of the pair at {low_hz:.4g} and {high_hz:.4g} Hz rotated within their plane to fore-aft and "
        "side-side, as one record does not separate them (fore-aft share before: {low_share:.0%} and "
        "{high_share:.0%})",
    ),
    "setups_joined": Kind(
        "info",
        "setups were joined before the identification by {references}; without uncertainty, of the checks on "
        "modes only those on stable poles and a clear peak are made",
    ),
    "references_still": Kind(
        "warning",
        "{frequency_hz:.4g} Hz: the references hardly move; parts of the shape may not be consistent",
    ),
    "peaks_above_band": Kind(
        "info",
        "above the band, which ends at {edge:.3g} Hz, the spectrum has {count}: {peaks} Hz; modes are not "
        "sought there, --band {widen} widens the band",
    ),
    "not_refined": Kind("warning", "modes at {frequencies_hz} Hz are not refined: {obstacle}"),
    "one_channel": Kind(
        "info",
        "one channel cannot tell two modes closer than their bandwidths from one broader mode: bending modes "
        "often come in such pairs, and a channel across tells them apart",
    ),
    "hidden_mode": Kind(
        "warning",
        "there may be a second mode near {frequency_hz:.4g} Hz: poles of another shape at {other_hz:.4g} Hz, "
        "within its bandwidth, were left out",
    ),
    "perhaps_two": Kind(
        "warning",
        "there may be two modes at {frequency_hz:.4g} Hz, closer than the record separates: the sensors move "
        "in a second shape there, with {share:.0%} of the power; a longer record tells",
    ),
    "steady_tone_near": Kind(
        "warning", "a steady tone at {frequency_hz:.4g} Hz is near: distrust the damping"
    ),
    "tone_passes": Kind(
        "warning",
        "a drifting tone, as of a rotor's order, between {low_hz:.4g} and {high_hz:.4g} Hz, crosses this "
        "frequency: distrust the damping",
    ),
    "free_decay": Kind(
        "info",
        "a free decay from {from_s:.4g} to {to_s:.4g} s, over {fall:.1f} e-folds; its modes explain "
        "{explained:.1%} of it, and the rest of the record is not used",
    ),
    "beside_knock": Kind(
        "info",
        "a response that decays by {fall:.1f} e-folds, as to an impact or a simulation's start, is left out; "
        "the modes are those of the other {used_s:.4g} s",
    ),
    "transient": Kind(
        "warning",
        "the amplitude falls by {fall:.1f} e-folds from one maximum while forces act: the record is "
        "neither a free decay nor stationary",
    ),
    "decay_forced": Kind("warning", "{left:.0%} of the decay is not explained, since forces still act"),
    "decay_weak": Kind("warning", "it is only {ratio:.0f} times as strong as the noise near its frequency"),
    "decay_short": Kind("warning", "it is observed over {folds:.1f} e-folds only"),
    "decay_damping_unknown": Kind("warning", "the damping is uncertain by {spread:.0%}"),
    "decay_damping_changes": Kind(
        "warning",
        "the damping changes with the amplitude: {early:.2%} of critical at first, {late:.2%} at the end",
    ),
    "unchecked": Kind(
        "info",
        "found by {method}, whose modes are not checked for tones, waves, noise and one peak found twice, as "
        "those of ssi-cov with its uncertainty are",
    ),
    "damping_unknown": Kind(
        "warning",
        "the record does not determine the damping: its logarithm has a standard deviation of {log_std:.2g}",
    ),
    "narrow_as_a_line": Kind(
        "warning",
        "its peak is hardly broader than a line of the spectrum: the record is too short for its damping",
    ),
    "follows_the_sea": Kind(
        "warning",
        "it is a peak of the waves: with a damping of {damping_percent:.2g} % it is as broad as the peak "
        "of a sea of {period_s:.3g} s, and at its frequency",
    ),
    "broad_as_waves": Kind(
        "warning",
        "with a damping of {damping_percent:.2g} % it is as broad as a peak of wave forces; state the waves' "
        "peak period (tp_s)",
    ),
    "broad": Kind(
        "warning",
        "its damping of {damping_percent:.2g} %, or the upper end of its interval, is so high that the "
        "forces' spectrum may explain it",
    ),
    "complex_shape": Kind(
        "warning",
        "the sensors do not move in phase (modal phase collinearity {mpc:.2f}) and no close mode explains it",
    ),
    "one_part": Kind(
        "warning",
        "{share:.0%} of its power is in one fifth of the record, unlike that of the other modes: it is a "
        "tone that ended, or an impact",
    ),
    "one_sensor": Kind("warning", "{share:.0%} of its motion is that of one sensor"),
    "sensor_beside": Kind(
        "warning",
        "its shape and that of the neighbouring mode contain the motion of one sensor alone, {share:.0%} "
        "of its motion: a mount or a cable vibrates",
    ),
    "shape_of_neighbours": Kind(
        "warning",
        "its shape is a combination of those of the modes below and above: it is a peak of the forces or "
        "of an unmeasured motion, to which these modes respond",
    ),
    "unlike_model": Kind(
        "warning",
        "no mode of the model has such a shape (MAC at most {mac:.2f}), and refinement did not confirm it",
    ),
    "below_model": Kind(
        "warning",
        "it is below the lowest mode of the model and has its shape (MAC {mac:.2f}): it is the quasi-static "
        "response to slow forces such as waves",
    ),
    "sea_forced": Kind(
        "warning",
        "it is no mode of the model, and {share:.0%} of its shape is the response to the sea at that "
        "frequency: it is a peak of the waves",
    ),
    "shape_twice": Kind(
        "warning",
        "another mode at nearly the same frequency has the same shape: one peak is identified twice, or one"
        " of them is no mode",
    ),
    "too_short": Kind(
        "alarm",
        "{share:.0%} of the motion has fewer than {cycles} cycles in {duration_s:.3g} s: the record is too "
        "short for any statement",
    ),
    "few_cycles": Kind("warning", "the record contains only {cycles:.0f} of its cycles"),
    "zero_steps": Kind(
        "warning", "its zero jumps by {size:.3g} times the rms of the vibration at {time_s:.1f} s; corrected"
    ),
    "zero_steps_together": Kind(
        "alarm",
        "the zeros of most channels jump at {time_s:.1f} s: the logger or the structure was disturbed",
    ),
    "one_method": Kind(
        "warning", "with a shorter lag window it appears in only {share:.0%} of the model orders"
    ),
    "no_peak_in_setup": Kind(
        "warning",
        "{setup} has no clear peak there, {ratio:.2g} times the neighbouring level: its part of the shape is "
        "not known, or a sensor moved without a new name, or it is of another structure",
    ),
    "no_peak": Kind(
        "warning",
        "in the direction of its shape the spectrum has no clear peak: it is {ratio:.2g} times the "
        "neighbouring level, whereas a single mode has 17 times; noise, or an order of a rotor whose speed "
        "wanders, looks so",
    ),
    "second_peak": Kind(
        "warning",
        "a clear peak near it, at {frequency_hz:.4g} Hz, belongs to no mode: two modes may be identified as "
        "one",
    ),
    "no_skirts": Kind(
        "warning",
        "its peak falls off faster than that of a mode: it may be an order of a rotor whose speed wanders; "
        "add the rotor's speed as a channel [rpm]",
    ),
    "may_be_folded": Kind(
        "warning",
        "the record seems not to have been filtered before it was sampled at {rate_hz:.3g} Hz: a motion "
        "above half of that would look so",
    ),
    "multiple_of_order": Kind(
        "warning",
        "lies at half or twice the frequency of another peak, and neither falls off as slowly as that of a "
        "mode: both may be orders of a rotor; add the rotor's speed as a channel [rpm] or condition",
    ),
    "turns": Kind(
        "warning",
        "the directions of this pair turn within the record, as with a yawing nacelle: shapes and damping "
        "are of neither; add the yaw as a channel [deg], or cut the record where it turns",
    ),
    "steady_envelope": Kind(
        "warning",
        "its amplitude varies less than that of a mode of such low damping: it may be a tone, or an order of "
        "a rotor whose speed wanders; add the rotor's speed as a channel [rpm]",
    ),
    "rotor_order_passes": Kind(
        "warning", "{order}P of the rotor crosses this frequency: distrust the damping"
    ),
    "rotor_order_across_records": Kind(
        "warning",
        "varies with another peak at {ratio:g} times the frequency of the lower, {low_hz:.3g} to "
        "{high_hz:.3g} Hz in {number} records, while modes are constant: orders of a rotor of unknown speed",
    ),
    "jumps_between_records": Kind(
        "warning",
        "jumps {times} times from one record to the next, typically by {size:.1%}, while {stays_hz:.4g} Hz "
        "is constant: an order of a rotor of unknown speed, or two modes taken for one",
    ),
    # updating
    "unpaired_shape": Kind(
        "info",
        "the nearest mode of the model is {label} at {model_frequency_hz:.4g} Hz ({difference:+.1%}), but "
        "its shape differs: MAC {mac:.2f}, {least_mac:g} needed",
    ),
    "unpaired_frequency": Kind(
        "info",
        "the model's mode {label} at {model_frequency_hz:.4g} Hz has this shape (MAC {mac:.2f}), but its "
        "frequency differs by {difference:+.0%}",
    ),
    "unpaired_taken": Kind(
        "info",
        "resembles {label} of the model at {model_frequency_hz:.4g} Hz ({difference:+.1%}, MAC {mac:.2f}), "
        "but another measured mode resembles it more",
    ),
    # twin: a record on its way to an observation
    "yaw_unknown": Kind(
        "warning",
        "the yaw is not known: sensors on the nacelle are assumed to be aligned with the fixed ones",
    ),
    "not_in_rotor_axes": Kind(
        "warning", "not rotated to the rotor's axes: no place has two horizontal channels"
    ),
    "channels_without_partner": Kind("warning", "left out: no second horizontal channel at the same place"),
    "rotor_order_removed": Kind(
        "warning",
        "{low_hz:.3g} to {high_hz:.3g} Hz by the measured rotor speed: removed, at most {share:.1%} of a "
        "channel's power",
    ),
    "rotor_order_weak": Kind("info", "{low_hz:.3g} to {high_hz:.3g} Hz by the measured rotor speed: removed"),
    "rotor_order_seen": Kind(
        "info", "{low_hz:.3g} to {high_hz:.3g} Hz: detected at the measured rotor speed"
    ),
    "rotor_order_stated": Kind("info", "{low_hz:.3g} to {high_hz:.3g} Hz by the stated rotor speed"),
    "places_unknown": Kind(
        "info",
        "the position is not known (height_m or node in the JSON beside the record): wrong signs and units "
        "are not checked",
    ),
    "sensors_absent": Kind("warning", "the record has no such channels; identified without them"),
    "channels_unclear": Kind("info", "left out: neither name and unit nor the JSON show what they measure"),
    "deformation_set_aside": Kind(
        "info", "left out beside accelerations; identify them from a file of their own"
    ),
    "sensor_against_model": Kind(
        "warning",
        "points opposite to its direction in the twin: with the other sign, the shapes in which it moves "
        "would agree with the model's by {after:.0%} instead of {before:.0%}. Not changed; reverse its "
        "direction.",
    ),
    "sensor_uncalibrated": Kind(
        "warning", "has a history of calibrations, but none that is valid at that time: used as logged"
    ),
    "operation_unknown": Kind(
        "warning",
        "the state of operation is unknown, since {missing} is missing: send these conditions, and the "
        "record is observed again",
    ),
    "identification": Kind("warning", "{text}"),
    "identification_note": Kind("info", "{text}"),
    "no_mode_of_the_model": Kind("warning", "none of its {modes} identified modes is a mode of the model"),
    "record_mismatched": Kind(
        "warning",
        "none of its {modes} modes is a mode of the twin: is it from another turbine, or are its sensors not "
        "where the twin states? It is not used.",
    ),
    # twin: an observation on its way into the state
    "record_doubled": Kind("warning", "these samples are known already and are used once"),
    "record_overlaps": Kind(
        "warning",
        "other samples of the same time are known; if they are from the same sensors, they are counted twice",
    ),
    # twin: the days of a state watched
    "watch_learning": Kind(
        "info", "the baseline is being learnt: {days:.0f} of {needed:.0f} days; nothing is monitored yet"
    ),
    "watch_begins": Kind(
        "info", "monitored from {from} on: at most one false alarm in {arl_years:g} years on average"
    ),
    "watch_sees": Kind("info", "{said}"),
    "structure_changed": Kind(
        "alarm",
        "changed (90 % in brackets): {by_mode}; began {began} ({began_low} to {began_high}); {said}",
    ),
    "structure_turned": Kind(
        "alarm",
        "turned (90 % in brackets): {by_mode}; began {began} ({began_low} to {began_high}); {said}",
    ),
    "sensor_changed": Kind(
        "warning",
        "behaves differently since {began} (90 %: {began_low} to {began_high}); {said}",
    ),
    "cause_corrected": Kind(
        "warning",
        "the change of {alarm} was: {was}; now: {now}",
    ),
    "change_taken_back": Kind(
        "warning",
        "changed back (90 % in brackets): {by_mode}; began {began} ({began_low} to {began_high}); {said}: a "
        "repair, or a mass that comes and goes",
    ),
    "change_again": Kind(
        "warning",
        "changed once more (90 % in brackets): {by_mode}; began {began} ({began_low} to {began_high}); "
        "{said}: it comes and goes, like ice or a state of operation without a column",
    ),
    # service
    "study_set_aside": Kind(
        "alarm",
        "the days could not be evaluated in {tries} attempts ({reason}): no change would be detected; remove "
        "the cause, then try job {job} again",
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
        "no data arrived for more than {hours:g} hours: is the logger or its connection broken?",
    ),
    "record_late": Kind("info", "older than {days} days that are known; these days are evaluated again"),
}
"""All codes, by the package that reports them."""


@dataclass(frozen=True)
class Finding:
    """One message.

    Attributes
    ----------
    code : str
        A key of :data:`CATALOGUE`.
    subject : str or None
        The channel, mode, record or parameter it concerns; None if it concerns the whole.
    params : mapping
        Numbers and names in the sentence, in SI units.
    repaired : bool
        Whether the fault is corrected in the record.
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
        """Severity of the code."""
        return CATALOGUE[self.code].severity

    @property
    def text(self) -> str:
        """The sentence, without its subject."""
        return CATALOGUE[self.code].sentence.format(**self.params)

    @property
    def document(self) -> dict[str, Any]:
        """The finding as plain JSON data, with its severity and its sentence."""
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
