"""From a record to its modes without a hand on it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.identification.decays.free_decay import transient
from jackettwin.identification.estimate import Identification, ModalEstimate, Stabilisation
from jackettwin.identification.frequency_domain.fdd import fdd
from jackettwin.identification.methods import EFDD, method_names
from jackettwin.identification.picks import Pick, of_record
from jackettwin.identification.pole_methods import relaxations, uncertain
from jackettwin.identification.preparation.components import at_all_channels, components
from jackettwin.identification.preparation.prepared import prepare
from jackettwin.identification.preparation.spectra import welch
from jackettwin.identification.preparation.whitening import as_measured
from jackettwin.identification.quiet_bands import candidates_of, searched, with_quiet_bands
from jackettwin.identification.selection.choice import chosen_modes, cleared, screened_choice
from jackettwin.identification.selection.picked import left_out, picked_clusters, with_verdicts
from jackettwin.identification.selection.screening import evidence
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.status import ModeStatus
from jackettwin.processes import on_one_blas_thread

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jackettwin.identification.decays.free_decay import Transient
    from jackettwin.identification.selection.candidates import Candidate
    from jackettwin.records import Record


STEADFAST = 0.8
"""Share of the orders in which a mode must appear where no uncertainty speaks for it."""


@on_one_blas_thread
def identify(
    record: Record,
    settings: IdentificationSettings | None = None,
    *,
    picks: Sequence[Pick] = (),
    progress: Callable[[str], None] | None = None,
) -> Identification:
    """Identify the modes of a record.

    Vibration channels only; others are left aside. Detrended, decimated and scaled to unit variance,
    then SSI-cov over a sweep of model orders, clustering of the poles, hard criteria, refinement of the
    modes by maximum likelihood. A record of a structure that was let go is recognised, and its modes are
    those of the decay (``decays/free_decay.py``; their ``method`` is "decay").

    Parameters
    ----------
    record : Record
        NaN marks a missing sample.
    settings : IdentificationSettings, optional
        What is not set follows from the data.
    picks : sequence of Pick, optional
        Poles to take instead of the automatic selection, e.g. ``Identification.picks`` of an earlier run;
        picks of other records are passed over.
    progress : callable, optional
        Called with a few words at the start of every step.

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
    if settings.method == EFDD:
        _refuse_picks(wanted)
        return fdd(record, settings)
    fallen = _fallen(record, settings, progress) if settings.method == "ssi-cov" and not wanted else None
    if fallen is not None and fallen.identified is not None:
        return fallen.identified
    if settings.method != "ssi-cov":
        # what is compared is the method; without uncertainties, persistence alone tells modes from noise
        share = max(settings.min_order_share, STEADFAST)
        settings = settings.model_copy(update={"refine": False, "min_order_share": share})
    say = progress or (lambda text: None)
    say("preparing")
    whole = prepare(record, settings)
    ready, basis = components(whole, settings)
    y, scale, resolved = ready.y, ready.scale, ready.settings
    say("poles")
    search = searched(ready, settings)
    if uncertain(settings):
        search = with_quiet_bands(search, ready, settings)
    poles, judged, tones = search.poles, search.judged, search.tones
    say("selection")
    missing: tuple[str, ...] = ()
    if wanted:
        picked = picked_clusters(poles, [c.cluster for c in judged], wanted)
        missing = left_out(judged, picked)
        judged = with_verdicts(wanted, candidates_of(poles, picked, tones, ready, settings))
    say("refinement")
    known = None
    if uncertain(settings):
        known = evidence(tones.clean, ready, record.conditions, bands=search.bands, sensors=basis is None)
    if known is not None and not wanted:
        judged = cleared(judged, known)
    chosen = chosen_modes(judged, tones, ready, settings)
    if known is not None:
        chosen = screened_choice(chosen, judged, known, rescue=not wanted, drifting=tones.drifting)
    label = poles.cluster.copy()
    for number, index in enumerate(chosen.candidate):
        label[judged[index].cluster.poles] = number
    modes = tuple(_named(mode, settings) for mode in chosen.modes)
    identified = Identification(
        records=(record.name,),
        channels=ready.channels,
        modes=modes if fallen is None else fallen.as_doubtful(modes),
        rejected=chosen.rejected,
        stabilisation=replace(poles, cluster=label),
        spectrum=as_measured(welch(y * scale[:, None], resolved.sample_rate_hz), ready.differentiated),
        settings=resolved,
        duration_s=record.duration_s,
        warnings=(*ready.warnings, *missing, *map(str, chosen.findings)),
        findings=chosen.findings,
        real_poles=relaxations(ready, settings) if settings.real_poles else (),
        picks=tuple(_pick(poles, c, record.name) for c in judged if c.objection is None),
    )
    return identified if basis is None else at_all_channels(identified, whole, basis)


def _fallen(
    record: Record, settings: IdentificationSettings, progress: Callable[[str], None] | None
) -> Transient | None:
    """Return what falls in a record, with its modes if it is a free decay, or those beside it if a knock."""
    fallen = transient(record, settings)
    if fallen is None or fallen.beside is None:
        return fallen
    try:
        found = identify(fallen.beside, settings, progress=progress)
    except InputError:
        return transient(record, settings, impacts=True)
    if not any(mode.status is ModeStatus.OK for mode in found.modes):
        return transient(record, settings, impacts=True)
    said = Finding("beside_knock", params={"fall": fallen.fall, "used_s": fallen.beside.duration_s})
    found = replace(found, findings=(said, *found.findings), warnings=(str(said), *found.warnings))
    return replace(fallen, identified=found)


def _pick(poles: Stabilisation, chosen: Candidate, record: str) -> Pick:
    """Return the pick that stands for a candidate."""
    k = chosen.cluster.representative
    return Pick(float(poles.frequency_hz[k]), int(poles.order[k]), record, chosen.doubt is not None)


def _refuse_picks(picks: Sequence[Pick]) -> None:
    if picks:
        raise InputError(
            "has no poles to pick from",
            field="method",
            value=EFDD,
            allowed=", ".join(name for name in method_names() if name != EFDD),
            remedy="leave the picks out, or choose another method",
        )


def _named(mode: ModalEstimate, settings: IdentificationSettings) -> ModalEstimate:
    return mode if settings.method == "ssi-cov" else replace(mode, method=settings.method)
