"""Tracking of the stiffness day by day: filtered, smoothed and forecast values.

The filter's state before a window of some weeks is stored, and every run evaluates the days of the window
again. So later days correct those of the window, the cost of a day does not depend on the number before it,
and a continued run gives the same result as one run over all days, bit for bit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jackettwin.change import Days
from jackettwin.files import digest
from jackettwin.study.in_time.stiffness import (
    Normalisation,
    Reference,
    Sensitivity,
    Span3,
    StiffnessLevel,
    change_of,
    level_of,
    levels_of,
    normalisation_of,
    readings_of,
)
from jackettwin.twin import TwinModel
from jackettwin.watching import (
    Hypotheses,
    Lagged,
    Readings,
    after_row,
    forecast,
    fresh,
    halved,
    no_rows,
    rooted,
    smoothed,
)

LEARNT_DAYS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32)
"""Numbers of days after which conditions are standardised anew, slopes are computed anew and all days are
evaluated again. Later this would cost too much for a day and change little, since the standard deviation of a
condition only scales the prior of its coefficient."""
STEP_DAYS = 20
"""Number of oldest days that become final and leave the window when it has twice this length. On such a day
four times as many rows are evaluated, which takes longer than any other day."""
SURE = 0.95
"""Probability from which a jump is reported as a change."""
AHEAD_DAYS = (30, 90, 365)
"""Horizons of the forecast in days after the last one."""


@dataclass(frozen=True)
class SuddenChange:
    """A change of the stiffness within days.

    Attributes
    ----------
    probability : of the change, when it was first reported
    days : quantiles of 5, 50 and 95 % of its time, in days since 1970
    factor : quantiles of 5, 50 and 95 % of the ratio of the stiffness after it to that before
    """

    probability: float
    days: Span3
    factor: Span3


@dataclass(frozen=True)
class Tracked:
    """State of the track that is stored between runs.

    Attributes
    ----------
    normal : normalisation of the rows
    start, lagged : states of the filter and of lagged regressors before the window; None before the first row
    days : number of days before the window
    identified, of : number of days that this state depends on, and their identity
    copied : dates after which the mean level so far became the reference
    final : {date: StiffnessLevel} of days before the window, smoothed
    changes : sudden changes found so far
    settled, settled_changes : number of days when the window last moved or conditions were last learnt, and
        the changes found by then; later days are evaluated again if they changed
    """

    normal: Normalisation
    start: Hypotheses | None = None
    lagged: Lagged | None = None
    days: int = 0
    identified: int = 0
    of: str = ""
    copied: tuple[str, ...] = ()
    final: Mapping[str, StiffnessLevel] = field(default_factory=dict)
    changes: tuple[SuddenChange, ...] = ()
    settled: int = 0
    settled_changes: tuple[SuddenChange, ...] = ()

    def until(self, date: str) -> Tracked:
        """Return the stored state as of the day, of given date, when the window last moved."""
        copied = tuple(one for one in self.copied if one <= date)
        return replace(self, copied=copied, changes=self.settled_changes)


@dataclass(frozen=True)
class StiffnessTrack:
    """The track of the stiffness up to a day.

    Attributes
    ----------
    model, every : model, and its days
    dates : of all days so far
    kept : stored state; None before the first day with a usable mode
    bank, lagged : states of the filter and of lagged regressors after the last day
    window : rows of the window, with the noise used for them
    half : the track after the first ``STEP_DAYS`` of the window, if there are so many
    """

    model: TwinModel
    every: Days
    dates: tuple[str, ...] = ()
    kept: Tracked | None = None
    bank: Hypotheses | None = None
    lagged: Lagged | None = None
    window: tuple[Readings, ...] = ()
    copied: tuple[str, ...] = ()
    half: StiffnessTrack | None = None

    def with_day(self, date: str, about: Sensitivity, *, copied: bool) -> StiffnessTrack:
        """Return the track after one more day.

        Parameters
        ----------
        about : present estimate of the sensitivity of frequencies to the stiffness
        copied : whether all records were evaluated together after this day
        """
        track = replace(
            self, dates=(*self.dates, date), copied=(*self.copied, date) if copied else self.copied
        )
        if self.kept is None or self.bank is None or len(track.dates) in LEARNT_DAYS:
            return track._learnt_anew(about)
        track = track._ran((date,))
        return track._halved() if len(track.dates) - self.kept.days == STEP_DAYS else track

    def _learnt_anew(self, about: Sensitivity) -> StiffnessTrack:
        known = normalisation_of(self.model, self.every, self.dates, about)
        if known is None:
            return self
        changes = () if self.kept is None else self.kept.changes
        n, of = len(self.dates), _chained("", self.every, self.dates)
        kept = Tracked(known, identified=n, of=of, changes=changes, settled=n, settled_changes=changes)
        return replace(self, kept=kept)._from_start(self.dates)

    def _from_start(self, dates: Sequence[str]) -> StiffnessTrack:
        """Return the track with the days of its window evaluated again."""
        if self.kept is None:
            raise ValueError("a track that has not begun")
        start, lagged = _start(self.kept)
        begun = replace(self, bank=start, lagged=lagged, window=(), half=None)._ran(dates[:STEP_DAYS])
        if len(dates) < STEP_DAYS:
            return begun
        return begun._halved()._ran(dates[STEP_DAYS:])

    def _halved(self) -> StiffnessTrack:
        """Return the track that remembers itself, the window's days so far being those that become final."""
        if self.bank is None:
            raise ValueError("a track that has not begun")
        return replace(self, bank=halved(self.bank), half=self)

    def _ran(self, dates: Sequence[str]) -> StiffnessTrack:
        """Return the track with the rows of some more days."""
        kept, bank, lagged, window = self.kept, self.bank, self.lagged, self.window
        if kept is None or bank is None or lagged is None:
            raise ValueError("a track that has not begun")
        read, lagged = readings_of(kept.normal, self.every, dates, lagged, self.copied)
        noise = read.noise.copy()
        for r in range(read.days.size):
            bank, noise[r] = after_row(bank, read, r)
        window = (*window, replace(read, noise=noise)) if read.days.size else window
        return replace(self, bank=bank, lagged=lagged, window=window)

    def level(self, reference: Reference) -> StiffnessLevel | None:
        """The stiffness on the last day."""
        if self.kept is None or self.bank is None:
            return None
        return level_of(self.bank.mixture, reference, self.kept.normal.about)

    def ahead(self, reference: Reference) -> dict[int, StiffnessLevel]:
        """The forecast so many days after the last one."""
        if self.kept is None or self.bank is None:
            return {}
        return {
            days: level_of(forecast(self.bank, days), reference, self.kept.normal.about)
            for days in AHEAD_DAYS
        }

    def with_changes(self, reference: Reference) -> StiffnessTrack:
        """Return the track with a jump that is now certain, in place of an earlier estimate of it."""
        if self.kept is None or self.bank is None:
            return self
        jump, about = self.bank.jump, self.kept.normal.about
        if jump is None or jump.probability < SURE:
            return self
        found = SuddenChange(jump.probability, jump.days, change_of(jump, reference, about))
        changes = (*(c for c in self.kept.changes if c.days[2] < found.days[0] - 1.0), found)
        kept = replace(self.kept, changes=changes)
        if kept.settled == len(self.dates):
            kept = replace(kept, settled_changes=changes)
        return replace(self, kept=kept)

    def levels(self, reference: Reference) -> dict[str, StiffnessLevel]:
        """The smoothed stiffness of each day, in the window and before."""
        if self.kept is None:
            return {}
        return {**self.kept.final, **self._window_levels(reference)}

    def _window_levels(self, reference: Reference, before: str = "9999") -> dict[str, StiffnessLevel]:
        """Return the smoothed stiffness of the window's days before a date."""
        kept, bank = self.kept, self.bank
        if kept is None or bank is None or not self.window:
            return {}
        whole = joined(self.window)
        every = smoothed(_start(kept)[0], bank, whole)
        days = np.floor(whole.days).astype(np.intp)
        last = {int(day): i for i, day in enumerate(days)}
        epoch = np.datetime64("1970-01-01")
        rows = {date: i for day, i in last.items() if (date := str(epoch + day)) < before}
        found = levels_of([every[i] for i in rows.values()], reference, kept.normal.about)
        return dict(zip(rows, found, strict=True))

    def moved(self, reference: Reference) -> StiffnessTrack:
        """Return the track with the oldest days of a too long window made final."""
        kept, n = self.kept, len(self.dates)
        if kept is None or n - kept.days < 2 * STEP_DAYS:
            return self
        cut = n - STEP_DAYS
        before = self.half
        if self.bank is None or before is None or before.bank is None:
            raise ValueError("a track that has not begun")
        gone = self._window_levels(reference, before=self.dates[cut])
        start = rooted(before.bank, self.bank)
        known = max(kept.identified, cut)
        window = replace(
            kept, start=start, lagged=before.lagged, days=cut, final={**kept.final, **gone}, identified=known,
            of=_chained(kept.of, self.every, self.dates[kept.identified : known]), settled=n,
            settled_changes=kept.changes,
        )  # fmt: skip
        return replace(self, kept=window)._from_start(self.dates[cut:])

    def stored(self) -> Tracked | None:
        """Return the state from which the next run continues."""
        return None if self.kept is None else replace(self.kept, copied=self.copied)


def joined(parts: Sequence[Readings]) -> Readings:
    """Return the rows of several parts as one."""
    fields = ("days", "rows", "values", "noise", "copied")
    return Readings(*(np.concatenate([getattr(part, name) for part in parts]) for name in fields))


def _chained(of: str, every: Days, dates: Sequence[str]) -> str:
    """Return the identity of days appended to those of identity ``of``."""
    for date in dates:
        of = digest([of, date, every.identities[date]])
    return of


def resumed(
    model: TwinModel, every: Days, kept: Tracked, dates: Sequence[str], *, unchanged: bool = False
) -> StiffnessTrack:
    """Return the track after some days from an earlier run's state; empty if that is of other days.

    Parameters
    ----------
    unchanged : whether the days are already known to be those of the earlier run
    """
    empty, n = StiffnessTrack(model, every), kept.identified
    if n > len(dates) or not (unchanged or kept.of == _chained("", every, dates[:n])):
        return empty
    return replace(empty, dates=tuple(dates), kept=kept, copied=kept.copied)._from_start(dates[kept.days :])


def _start(kept: Tracked) -> tuple[Hypotheses, Lagged]:
    """Return the states of the filter and of lagged regressors before the window."""
    if kept.start is not None and kept.lagged is not None:
        return kept.start, kept.lagged
    design, about = kept.normal.design, kept.normal.about
    return no_rows(about.slopes, design.coefficients(kept.normal.spread).std), fresh(design)
