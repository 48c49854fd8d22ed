"""Automatic identification of the modes of a record."""

from __future__ import annotations

from dataclasses import replace
from pkgutil import resolve_name
from typing import TYPE_CHECKING, cast

import numpy as np

from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.identification.decays.free_decay import transient
from jackettwin.identification.decays.relaxations import release_relaxations
from jackettwin.identification.estimate import Identification, ModalEstimate, Spectrum, Stabilisation
from jackettwin.identification.methods import POLELESS, method_names
from jackettwin.identification.peaks_above import peaks_above
from jackettwin.identification.picks import Pick, of_record
from jackettwin.identification.pole_methods import relaxations, uncertain
from jackettwin.identification.preparation.components import components, expand_to_all_channels
from jackettwin.identification.preparation.prepared_record import prepare
from jackettwin.identification.preparation.resolve import with_orders
from jackettwin.identification.preparation.spectra import welch
from jackettwin.identification.preparation.whitening import as_measured, left_to_differentiate
from jackettwin.identification.quiet_bands import candidates_of, searched, with_quiet_bands
from jackettwin.identification.selection.choice import chosen_modes, clear_damping_doubts, screened_choice
from jackettwin.identification.selection.light_damping import with_damping_likelihoods
from jackettwin.identification.selection.picks import left_out, picked_clusters, with_verdicts
from jackettwin.identification.selection.screening import evidence
from jackettwin.identification.selection.turning import turning_doubted
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.status import ModeStatus
from jackettwin.processes import on_one_blas_thread

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jackettwin.arrays import FloatArray
    from jackettwin.identification.decays.free_decay import Transient
    from jackettwin.identification.preparation.prepared_record import PreparedRecord
    from jackettwin.identification.quiet_bands import PoleSearch
    from jackettwin.identification.selection.candidates import Candidate, Tones
    from jackettwin.identification.selection.choice import Choice
    from jackettwin.identification.selection.screening import Evidence
    from jackettwin.records import Record

    PolelessMethod = Callable[[Record, IdentificationSettings], Identification]

MIN_PERSISTENCE = 0.8
"""Share of the model orders in which a mode must appear if the method gives no uncertainty."""


@on_one_blas_thread
def identify(
    record: Record,
    settings: IdentificationSettings | None = None,
    *,
    picks: Sequence[Pick] = (),
    progress: Callable[[str], None] | None = None,
) -> Identification:
    """Identify the modes of a record.

    Only vibration channels are used. They are detrended, decimated and scaled to unit variance.
    SSI-cov over a sweep of model orders, clustering of the poles,
    hard criteria and refinement by maximum likelihood follow. A free decay is recognised;
    then its modes are those of the decay (``decays/free_decay.py``; their ``method`` is "decay").

    Parameters
    ----------
    record : Record
        NaN marks a missing sample.
    settings : IdentificationSettings, optional
        Settings left open follow from the data.
    picks : sequence of Pick, optional
        Poles to use instead of the automatic selection, e.g. ``Identification.picks`` of an earlier run;
        picks of other records are ignored.
    progress : callable, optional
        Called with the name of every step at its start.

    Raises
    ------
    InputError
        If no usable channel is left, the band lies outside the record's, the record is shorter than its
        lag window needs, or there is no pole where one is picked.

    Examples
    --------
    >>> import numpy as np
    >>> from jackettwin.records import Channel, Record
    >>> t = np.arange(6000) / 20.0
    >>> rng = np.random.default_rng(1)
    >>> h = np.exp(-0.02 * 2 * np.pi * t) * np.sin(2 * np.pi * t)
    >>> y = np.convolve(rng.standard_normal(6000), h)[:6000]
    >>> result = identify(Record(np.array([y, -0.5 * y]), 20.0, (Channel("a"), Channel("b"))))
    >>> [round(mode.frequency_hz, 1) for mode in result.modes]
    [1.0]
    """
    settings = settings or IdentificationSettings()
    wanted = of_record(picks, record.name)
    if settings.method in POLELESS:
        _refuse_picks(wanted, settings.method)
        return cast("PolelessMethod", resolve_name(POLELESS[settings.method]))(record, settings)
    decay = _decay(record, settings, progress) if settings.method == "ssi-cov" and not wanted else None
    if decay is not None and decay.identified is not None:
        return _with_release(decay.identified, record, settings)
    if settings.method != "ssi-cov":
        # the methods are compared as such; without uncertainties, only persistence separates modes from noise
        share = max(settings.min_order_share, MIN_PERSISTENCE)
        settings = settings.model_copy(update={"refine": False, "min_order_share": share})
    say = progress or (lambda text: None)
    say("preparing")
    whole = _with_picked_orders(prepare(record, settings), wanted)
    ready, basis = components(whole, settings)
    above = peaks_above(record, settings, ready.settings)  # here, where the least memory is held beside it
    say("poles")
    search = searched(ready, settings)
    if uncertain(settings):
        search = with_quiet_bands(search, ready, settings)
    say("selection")
    judged, missing = _judged(search, ready, settings, wanted)
    say("refinement")
    known = _evidence(search, ready, record, settings, sensors=basis is None)
    chosen, judged = _chosen(judged, search.tones, ready, settings, known, rescue=not wanted)
    modes = tuple(_named(mode, settings) for mode in chosen.modes)
    identified = Identification(
        records=(record.name,),
        channels=ready.channels,
        modes=modes if decay is None else decay.as_doubtful(modes),
        rejected=chosen.rejected,
        stabilisation=_labelled(search.poles, chosen, judged),
        spectrum=_spectrum(ready),
        settings=ready.settings,
        duration_s=record.duration_s,
        findings=(*ready.findings, *missing, *chosen.findings),
        notes=(*above, *((Finding("one_channel"),) if len(ready.channels) == 1 else ())),
        real_poles=relaxations(ready, settings) if settings.real_poles else (),
        picks=tuple(_pick(search.poles, c, record.name) for c in judged if c.objection is None),
    )
    identified = identified if basis is None else expand_to_all_channels(identified, whole, basis)
    return _with_release(_as_checked(identified, settings), record, settings)


def _judged(
    search: PoleSearch, ready: PreparedRecord, settings: IdentificationSettings, wanted: Sequence[Pick]
) -> tuple[list[Candidate], tuple[Finding, ...]]:
    """Return the candidates, those of the picks if there are any, and findings on what these leave out."""
    if not wanted:
        return search.judged, ()
    picked = picked_clusters(search.poles, [c.cluster for c in search.judged], wanted)
    judged = with_verdicts(wanted, candidates_of(search.poles, picked, search.tones, ready, settings))
    return judged, left_out(search.judged, picked)


def _evidence(
    search: PoleSearch,
    ready: PreparedRecord,
    record: Record,
    settings: IdentificationSettings,
    *,
    sensors: bool,
) -> Evidence | None:
    """Return the data by which modes are judged; None for a method without uncertainty."""
    if not uncertain(settings):
        return None
    return evidence(search.tones.clean, ready, record.conditions, looks=search.looks, sensors=sensors)


def _chosen(
    judged: list[Candidate],
    tones: Tones,
    ready: PreparedRecord,
    settings: IdentificationSettings,
    known: Evidence | None,
    *,
    rescue: bool,
) -> tuple[Choice, list[Candidate]]:
    """Return the refined and screened modes, and the candidates whose doubts were cleared."""
    if known is not None and rescue:
        judged = clear_damping_doubts(judged, known)
    chosen = chosen_modes(judged, tones, ready, settings, None if known is None else known.lines)
    if known is not None:
        chosen = screened_choice(chosen, judged, known, tones=tones, rescue=rescue)
        y, rate = tones.clean, ready.settings.sample_rate_hz
        chosen = replace(chosen, modes=turning_doubted(chosen.modes, y, rate))
    return _with_likelihoods(chosen, tones.clean, ready, settings), judged


def _labelled(poles: Stabilisation, chosen: Choice, judged: Sequence[Candidate]) -> Stabilisation:
    """Return the poles with the number of the mode that each belongs to."""
    label = poles.cluster.copy()
    for number, index in enumerate(chosen.candidate):
        label[judged[index].cluster.poles] = number
    return replace(poles, cluster=label)


def _spectrum(ready: PreparedRecord) -> Spectrum:
    """Return the spectrum of the prepared samples in the channels' units."""
    spectrum = welch(ready.y, ready.settings.sample_rate_hz)
    spectrum = replace(spectrum, density=spectrum.density * ready.scale[:, None] ** 2)
    return as_measured(spectrum, ready.differentiated)


def _as_checked(found: Identification, settings: IdentificationSettings) -> Identification:
    """Return the identification; modes without an uncertainty were not screened."""
    if uncertain(settings):
        return found
    return found.unchecked("a quick look" if settings.quick else settings.method)


def _with_release(found: Identification, record: Record, settings: IdentificationSettings) -> Identification:
    """Return the identification with the relaxation after a release, if one is requested."""
    release = release_relaxations(record) if settings.real_poles else None
    if release is None or release.pole is None:
        return found
    shape = dict(zip([c.name for c in release.channels], release.pole.mode_shape, strict=True))
    pole = replace(release.pole, mode_shape=np.array([shape.get(c.name, 0j) for c in found.channels]))
    return replace(found, real_poles=(pole,))


def _decay(
    record: Record, settings: IdentificationSettings, progress: Callable[[str], None] | None
) -> Transient | None:
    """Return a decay with its modes if it is free, or with the ambient modes if it is an impact."""
    decay = transient(record, settings)
    if decay is None or decay.beside is None:
        return decay
    try:
        found = identify(decay.beside, settings, progress=progress)
    except InputError:
        return transient(record, settings, impacts=True)
    if not any(mode.status in (ModeStatus.OK, ModeStatus.UNCHECKED) for mode in found.modes):
        return transient(record, settings, impacts=True)
    finding = Finding("beside_knock", params={"fall": decay.fall, "used_s": decay.beside.duration_s})
    return replace(decay, identified=replace(found, findings=(finding, *found.findings)))


def _with_likelihoods(
    chosen: Choice, y: FloatArray, ready: PreparedRecord, settings: IdentificationSettings
) -> Choice:
    """Return the modes, the lightly damped ones with the likelihood of their damping."""
    if not (settings.refine and uncertain(settings)):
        return chosen
    kinds = left_to_differentiate(ready.channels, ready.differentiated)
    rate = ready.settings.sample_rate_hz
    return replace(chosen, modes=with_damping_likelihoods(chosen.modes, y, rate, ready.scale, kinds))


def _with_picked_orders(ready: PreparedRecord, picks: Sequence[Pick]) -> PreparedRecord:
    """Return a prepared record whose model orders include those of the picks."""
    orders = [pick.order for pick in picks if pick.order is not None]
    return replace(ready, settings=with_orders(ready.settings, orders)) if orders else ready


def _pick(poles: Stabilisation, chosen: Candidate, record: str) -> Pick:
    """Return the pick of a candidate."""
    k = chosen.cluster.representative
    return Pick(float(poles.frequency_hz[k]), int(poles.order[k]), record, chosen.doubt is not None)


def _refuse_picks(picks: Sequence[Pick], method: str) -> None:
    if picks:
        raise InputError(
            "the method has no poles to pick from",
            field="method",
            value=method,
            allowed=", ".join(name for name in method_names() if name not in POLELESS),
            remedy="omit the picks, or choose another method",
        )


def _named(mode: ModalEstimate, settings: IdentificationSettings) -> ModalEstimate:
    return mode if settings.method == "ssi-cov" else replace(mode, method=settings.method)
