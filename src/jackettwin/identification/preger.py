"""Modes of all setups in one identification (PreGER): some sensors are moved between records."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located
from jackettwin.findings import Finding
from jackettwin.identification.automatic import MIN_PERSISTENCE
from jackettwin.identification.document import identification_document
from jackettwin.identification.estimate import Identification, Spectrum
from jackettwin.identification.examination import doubted, made_ready
from jackettwin.identification.many_records.setups import WEAK_CONNECTION, add_channels, tie
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.preparation.prepared_record import prepare
from jackettwin.identification.preparation.resolve import guarded_band_hz
from jackettwin.identification.selection.candidates import beside_tones, candidates
from jackettwin.identification.selection.clustering import clusters
from jackettwin.identification.selection.neighbours import apart
from jackettwin.identification.selection.peaks import contrast
from jackettwin.identification.selection.screening import (
    CLOSE_DISTANCE,
    MIN_CONTRAST,
    MIN_CONTRAST_ELSEWHERE,
    MIN_SENSORS,
    SAME_PEAK_MAC,
)
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.status import ModeStatus
from jackettwin.identification.subspace.covariances import covariances
from jackettwin.identification.subspace.joined_setups import joined_hankel
from jackettwin.identification.subspace.ssi_cov import balanced_subspace, order_poles
from jackettwin.identification.subspace.stabilisation import stabilisation
from jackettwin.identification.tones.sinusoid import transform
from jackettwin.processes import on_one_blas_thread
from jackettwin.progress import SILENT, Progress
from jackettwin.records import Channel, Record, with_conditions

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ModalEstimate, ResolvedSettings, Stabilisation
    from jackettwin.identification.preparation.prepared_record import PreparedRecord


MIN_CONTRAST_IN_EVERY = 2.0
"""Least ratio of the power at the peak to the neighbouring power in every setup: of 90 modes of three setups
the least has 2.3; where a setup is of another structure, most have 0.4 to 1.5."""
TWICE_HALF_BANDWIDTHS, TWICE_MAC = 1.5, 0.5
"""Distance in half bandwidths and MAC within which a broad pole is taken for a second one of a narrower
mode's peak: two directions of a tower, of which one is damped by the rotor, move in different shapes."""


@dataclass(frozen=True)
class _Setups:
    """Prepared setups in one unit of each channel.

    Attributes
    ----------
    names, ready : for each setup
        ``y`` in units of ``scale`` and of the setup's own level of excitation.
    channels : tuple of Channel
        All channels, in the order of their first appearance.
    scale : (n_channels,)
    references : tuple of str
        Channels of all setups that serve as references.
    """

    names: tuple[str, ...]
    ready: tuple[PreparedRecord, ...]
    channels: tuple[Channel, ...]
    scale: FloatArray
    references: tuple[str, ...]

    @property
    def settings(self) -> ResolvedSettings:
        """Settings of the setup with the most model orders; band, rate and lag window are those of all."""
        return max((one.settings for one in self.ready), key=lambda own: own.orders[-1])


def preger_document(
    sources: Iterable[Record], settings: IdentificationSettings, progress: Progress = SILENT
) -> dict[str, Any]:
    """Return the result document of setups that are identified together.

    Each is assessed and repaired as a single record is, before the next one is asked for.

    Raises
    ------
    InputError
        As ``identify_setups``.
    """
    records, told = [], []
    doubts: list[Finding] = []
    own: list[Finding] = []
    for source in sources:
        with located(file=source.name):
            known = with_conditions(source)
            ready, quality, findings, against = made_ready(known, thorough=not settings.quick)
        records.append(ready)
        doubts += against
        told += [{"record": ready.name, **finding.document} for finding in quality.findings]
        own += [replace(f, subject=", ".join(filter(None, (ready.name, f.subject)))) for f in findings]
    progress("identify all setups together")
    found = doubted(identify_setups(records, settings), tuple(doubts))
    found = replace(found, findings=(*own, *found.findings))
    return {**identification_document(found, {"findings": told}, {}), "merge": "preger"}


@on_one_blas_thread
def identify_setups(
    records: Sequence[Record], settings: IdentificationSettings | None = None
) -> Identification:
    """Identify the modes of all setups at once: one frequency, damping ratio and whole shape a mode.

    The moving sensors' parts of the Hankel matrix are re-scaled to a common excitation by the channels
    that all setups share (``subspace/joined_setups.py``); then follow SSI-cov, clustering and the hard
    criteria. There is no uncertainty and no refinement.

    Parameters
    ----------
    records : sequence of Record
        Of one sample rate. A sensor that was moved has another name in each record.
    settings : IdentificationSettings, optional
        ``reference_channels`` must be in all records; default all that are.

    Raises
    ------
    InputError
        If the setups share no reference channel, differ in sample rate, one name is used for different
        sensors, or the settings ask for another method.
    """
    settings = settings or IdentificationSettings()
    _refuse_method(settings)
    setups = _setups(records, settings)
    poles, resolved = _poles(setups, settings), setups.settings
    duration_s = sum(one.duration_s for one in setups.ready)
    share = max(settings.min_order_share, MIN_PERSISTENCE)
    judged = candidates(
        poles,
        clusters(
            poles,
            distance=settings.cluster_distance,
            orders=resolved.orders,
            scale=setups.scale,
            share=share,
        ),
        (),
        settings.model_copy(update={"min_order_share": share}),
        duration_s=duration_s,
        n_orders=len(resolved.orders),
    )
    low, high = resolved.lowest_frequency_hz, resolved.highest_frequency_hz
    inside = [c for c in judged if low < c.mode.frequency_hz < high]
    chosen = [c for c in inside if c.objection is None]
    tones = [(f, f) for one in setups.ready for f in one.tones_hz]
    tones += [tone.swept_hz for one in setups.ready for tone in one.drifting]
    modes = tuple(_checked(replace(beside_tones(c.mode, tones), method="preger"), setups) for c in chosen)
    modes = tuple(_once(mode, modes, setups) for mode in modes)
    label = poles.cluster.copy()
    for number, candidate in enumerate(chosen):
        label[candidate.cluster.poles] = number
    n_channels = len(setups.channels)
    return Identification(
        records=tuple(record.name for record in records),
        channels=setups.channels,
        modes=modes,
        rejected=tuple(c.rejected for c in inside if c.objection is not None),
        stabilisation=replace(poles, cluster=label),
        spectrum=Spectrum(np.empty(0), np.empty((n_channels, 0)), np.empty((n_channels, 0))),
        settings=resolved,
        duration_s=duration_s,
        findings=(*(f for one in setups.ready for f in one.findings), *_loose(setups, modes)),
        notes=(Finding("setups_joined", params={"references": ", ".join(setups.references)}),),
    ).unchecked("PreGER")


def _checked(mode: ModalEstimate, setups: _Setups) -> ModalEstimate:
    """Return a mode, doubtful unless every setup shows a clear peak through the filter of its shape.

    A setup without one does not know its part of the shape, or is of another structure.
    """
    seen = _contrasts(mode, setups)
    share, ratio = max(seen)
    if share < 1.0:
        return mode.flagged(ModeStatus.DOUBTFUL, Finding("no_peak", params={"ratio": ratio}))
    for (_, ratio), name in zip(seen, setups.names, strict=True):
        if ratio < MIN_CONTRAST_IN_EVERY:
            without = Finding("no_peak_in_setup", name, {"setup": name, "ratio": ratio})
            mode = mode.flagged(ModeStatus.DOUBTFUL, without)
    return mode


def _contrasts(mode: ModalEstimate, setups: _Setups) -> list[tuple[float, float]]:
    """Return the contrast of a mode in each setup: over the least of a clear peak, and itself."""
    seen = dict(zip([c.name for c in setups.channels], mode.mode_shape / setups.scale, strict=True))
    out = []
    for one in setups.ready:
        shape = np.array([seen[c.name] for c in one.channels])
        least = MIN_CONTRAST if len(shape) >= MIN_SENSORS else MIN_CONTRAST_ELSEWHERE
        ratio, _ = contrast(transform(one.y), one.duration_s, mode, shape)
        out.append((ratio / least, ratio))
    return out


def _once(mode: ModalEstimate, modes: Sequence[ModalEstimate], setups: _Setups) -> ModalEstimate:
    """Return a mode, doubtful if its peak is that of another mode.

    That is one of less than half its damping, or one of the same shape that has more of the peak: excitations
    that differ in the setups leave two poles at one mode.
    """

    def takes_the_peak(other: ModalEstimate) -> bool:
        alike = float(mac(mode.mode_shape / setups.scale, other.mode_shape / setups.scale))
        if 2.0 * other.damping_ratio < mode.damping_ratio:
            reach = TWICE_HALF_BANDWIDTHS * mode.damping_ratio * mode.frequency_hz
            return abs(other.frequency_hz - mode.frequency_hz) < reach and alike > TWICE_MAC
        broader = other.damping_ratio > 2.0 * mode.damping_ratio
        if broader or alike < SAME_PEAK_MAC or apart(mode, other) > CLOSE_DISTANCE:
            return False
        own, theirs = (sum(ratio for _, ratio in _contrasts(m, setups)) for m in (mode, other))
        return own <= theirs

    clear = (other for other in modes if other is not mode and other.status is ModeStatus.OK)
    if not any(map(takes_the_peak, clear)):
        return mode
    return mode.flagged(ModeStatus.DOUBTFUL, Finding("shape_twice"))


def _poles(setups: _Setups, settings: IdentificationSettings) -> Stabilisation:
    """Return the poles of the Hankel matrix of all setups."""
    resolved, order = setups.settings, [channel.name for channel in setups.channels]
    lags, rows = [], []
    for one in setups.ready:
        own = [channel.name for channel in one.channels]
        at = [own.index(name) for name in setups.references]
        lags.append(covariances(one.y, 2 * resolved.block_rows)[:, :, at])
        rows.append(np.array([order.index(name) for name in own], dtype=np.int64))
    h = joined_hankel(lags, rows, resolved.block_rows, resolved.orders[-1])
    subspace = balanced_subspace(h, len(order), resolved.orders[-1], factors=False)
    return stabilisation(
        order_poles(subspace, subspace.orders(resolved.orders)),
        settings,
        sample_rate_hz=resolved.sample_rate_hz,
        duration_s=min(one.duration_s for one in setups.ready),
        band_hz=guarded_band_hz(resolved),
        scale=setups.scale,
    )


def _setups(records: Sequence[Record], settings: IdentificationSettings) -> _Setups:
    """Prepare all setups with one band, rate and lag window, and relate them to their common level."""
    ready = _alike(records, settings)
    known: dict[str, Channel] = {}
    for record, one in zip(records, ready, strict=True):
        add_channels(known, one.channels, record.name)
    references = _references(ready, records, settings)
    scale: dict[str, float] = {}
    related = []
    for one in ready:
        own = [c.name for c in one.channels]
        level = np.exp(np.mean([np.log(one.scale[own.index(name)]) for name in references]))
        relative = one.scale / level
        for name, value in zip(own, relative, strict=True):
            scale.setdefault(name, float(value))
        in_units = relative / [scale[name] for name in own]
        related.append(replace(one, y=one.y * in_units[:, None]))
    return _Setups(
        tuple(record.name for record in records),
        tuple(related),
        tuple(known.values()),
        np.array([scale[name] for name in known]),
        references,
    )


def _alike(records: Sequence[Record], settings: IdentificationSettings) -> list[PreparedRecord]:
    """Prepare the setups with one band, in which the lowest mode of each lies, and one lag window."""
    ready = [prepare(record, settings) for record in records]
    bands = {(one.settings.lowest_frequency_hz, one.settings.highest_frequency_hz) for one in ready}
    if len(bands) > 1:
        low, high = (min(edge) for edge in zip(*bands, strict=True))
        settings = settings.model_copy(update={"lowest_frequency_hz": low, "highest_frequency_hz": high})
        ready = [prepare(record, settings) for record in records]
    if len({one.settings.block_rows for one in ready}) > 1:
        rows = max(one.settings.block_rows for one in ready)
        settings = settings.model_copy(update={"block_rows": rows})
        ready = [prepare(record, settings) for record in records]
    rates = [one.settings.sample_rate_hz for one in ready]
    if len(set(rates)) > 1:
        raise InputError(
            "setups differ in sample rate",
            field="sample_rate_hz",
            value=sorted(set(rates)),
            allowed="one rate after decimation",
            remedy="resample the records to one rate",
        )
    return ready


def _references(
    ready: Sequence[PreparedRecord], records: Sequence[Record], settings: IdentificationSettings
) -> tuple[str, ...]:
    """Return the references: those chosen, or all channels that every setup has."""
    common = [
        c.name for c in ready[0].channels if all(c.name in [o.name for o in one.channels] for one in ready)
    ]
    if not common:
        raise InputError(
            "the setups share no reference channel",
            field="RECORD",
            value=[record.name for record in records],
            allowed="at least one channel that every setup has",
            remedy="take --merge poser, for which neighbours in a chain of setups may share channels",
        )
    strange = [name for name in settings.reference_channels or () if name not in common]
    if strange:
        raise InputError(
            "a reference is not in every setup",
            field="reference_channels",
            value=strange,
            allowed=", ".join(common),
            remedy="choose among the channels that every setup has",
        )
    return tuple(settings.reference_channels or common)


def _loose(setups: _Setups, modes: Sequence[ModalEstimate]) -> tuple[Finding, ...]:
    """Return findings on the modes in which the references hardly move."""
    at = np.array(
        [[c.name for c in setups.channels].index(name) for name in setups.references], dtype=np.int64
    )
    return tuple(
        Finding("references_still", params={"frequency_hz": mode.frequency_hz})
        for mode in modes
        if tie(mode.mode_shape, at) < WEAK_CONNECTION
    )


def _refuse_method(settings: IdentificationSettings) -> None:
    variant = (settings.method, settings.weighting, settings.state_matrix)
    if variant != ("ssi-cov", "br", "shift") or settings.real_poles:
        raise InputError(
            "joining setups before the identification takes covariance-driven SSI with unit weights",
            field="--merge preger",
            value=", ".join((*variant, *(("real_poles",) if settings.real_poles else ()))),
            allowed="ssi-cov, br, shift, without real_poles",
            remedy="leave these settings at their defaults, or take --merge poser",
        )
