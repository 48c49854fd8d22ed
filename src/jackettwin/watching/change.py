"""A detected change: its kind, onset and size."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.intervals import QUANTILES
from jackettwin.watching.block import BROAD, Block, model_of_change
from jackettwin.watching.directions import log_ramps
from jackettwin.watching.scatter import STRONGER
from jackettwin.watching.state import Watch

_LOOSE = 1.0
"""Prior precision of the changes of all other quantities while some are evaluated; it leaves them free."""


@dataclass(frozen=True)
class Change:
    """A detected change.

    Attributes
    ----------
    day : day of the alarm
    kind : "frequency", "damping" or "scatter"
    direction : name of the direction
    began, began_interval_90 : onset and its 90 % interval [days]
    members : (m_all,) bool, which quantities changed
    size, size_std : (m_all,) change of the logarithms and its standard deviation; for scatter, of the noise
    info, score, log_stake : (n, m_all, m_all), (n, m_all), (n,) for each onset, the information A and score b
        of a step of all quantities, and ln of its weight; the diagnosis uses them
    log_scatter : (n, m_all, n_factors) ln of the likelihood ratios of increased noise
    log_r : ln of the detection statistic
    by_mode : (m_all,) squared change of each quantity over its variance
    """

    day: float
    kind: str
    direction: str
    began: float
    began_interval_90: tuple[float, float]
    members: BoolArray
    size: FloatArray
    size_std: FloatArray
    info: FloatArray
    score: FloatArray
    log_stake: FloatArray
    log_scatter: FloatArray
    log_r: float
    by_mode: FloatArray

    def restricted(self, chosen: BoolArray) -> Change:
        """Return the information on some quantities, with the changes of the others left free."""
        if chosen.all():
            return self
        other = ~chosen
        inner = self.info[:, other][:, :, other] + _LOOSE * np.eye(int(other.sum()))
        cross = self.info[:, chosen][:, :, other]
        weight = np.swapaxes(np.linalg.solve(inner, np.swapaxes(cross, 1, 2)), 1, 2)
        return replace(
            self,
            members=self.members[chosen],
            size=self.size[chosen],
            size_std=self.size_std[chosen],
            info=self.info[:, chosen][:, :, chosen] - weight @ np.swapaxes(cross, 1, 2),
            score=self.score[:, chosen] - np.einsum("tij,tj->ti", weight, self.score[:, other]),
            log_scatter=self.log_scatter[:, chosen],
            by_mode=self.by_mode[chosen],
        )


def change_of(watch: Watch, worth: FloatArray, log_r: float, begun_by: float = np.inf) -> tuple[Change, int]:
    """Return the most likely change with an onset by ``begun_by``, and the onset's index if it is a step."""
    begins = watch.begins
    posterior = np.exp(begins.log_stake[:, None] + worth - log_r)
    bet = int(np.argmax(posterior.sum(axis=0)))
    kind, direction, members = _bet(watch, bet)
    # the onset follows from all tested changes of the same kind as the most likely one
    same = [b for b in range(worth.shape[1]) if _bet(watch, b)[0] == kind]
    by_begin = posterior[:, same].sum(axis=1)
    low, mid, high = _quantiles(_gradual(watch, kind, direction, by_begin))
    until = np.append(
        begins.since[1:], min(watch.last_day, begun_by)
    )  # an onset represents those merged with it
    info, score = _all_info(watch)
    size, std = (
        _louder(watch, by_begin)
        if kind == "scatter"
        else _sizes(info, score, by_begin, _prior_precision(watch))
    )
    change = Change(
        watch.last_day, kind, direction,
        float(0.5 * (begins.since[mid] + until[mid])), (float(begins.since[low]), float(until[high])),
        members, size, std, info, score, begins.log_stake, begins.log_scatter, log_r,
        (size / np.where(std > 0.0, std, np.inf)) ** 2,
    )  # fmt: skip
    return change, _quantiles(by_begin)[1]


def _quantiles(by_begin: FloatArray) -> tuple[int, ...]:
    cumulative = np.cumsum(by_begin) / by_begin.sum()
    return tuple(int(np.searchsorted(cumulative, p).clip(0, by_begin.size - 1)) for p in QUANTILES)


def _gradual(watch: Watch, kind: str, direction: str, by_begin: FloatArray) -> FloatArray:
    """Return the weights of onsets for a step or, equally likely, a continuing ramp."""
    block = next((b for b in watch.blocks if b.kind == kind), None)
    if block is None or block.banks[0].cross is None:  # a bank stored by an earlier version has none
        return by_begin
    u, begins = _along(block, direction, int(np.argmax(by_begin))), watch.begins
    logs = log_ramps(block.directions, u, block.banks[0], begins.days, watch.last_day) + begins.log_stake
    ramp, step = np.logaddexp.reduce(logs, axis=1)
    share = 1.0 / (1.0 + np.exp(np.clip(step - ramp, -500.0, 500.0)))
    return np.asarray((1.0 - share) * by_begin / by_begin.sum() + share * np.exp(logs[0] - ramp))


def _along(block: Block, direction: str, begun: int) -> FloatArray:
    """Return the vector of a direction; for "any", that of the observed step."""
    place = block.directions.names.index(direction)
    if place < len(block.directions.vectors):
        return np.asarray(block.directions.vectors[place])
    info, score = block.banks[0].info[begun], block.banks[0].score[begun]
    delta = np.linalg.solve(info + _LOOSE * np.eye(len(score)), score)
    return np.asarray(-delta / np.abs(delta).max())


def _bet(watch: Watch, bet: int) -> tuple[str, str, BoolArray]:
    """Return kind, direction and members of a tested change."""
    total = sum(len(block.kept) for block in watch.blocks)
    members = np.zeros(total, dtype=np.bool_)
    first = 0
    for block in watch.blocks:
        n, m = len(block.directions.names), len(block.kept)
        if bet < n:
            members[first : first + m] = block.directions.members[bet]
            return block.kind, block.directions.names[bet], members
        bet, first = bet - n, first + m
    q = bet // len(STRONGER)
    members[q] = True
    kind, mode = watch.quantities[q]
    return "scatter", f"scatter of the {kind} of {watch.labels[mode]}", members


def _all_info(watch: Watch) -> tuple[FloatArray, FloatArray]:
    """Return A and b of steps of all quantities under the models that are most likely given a change."""
    n, m = watch.begins.log_scatter.shape[:2]
    info, score = np.zeros((n, m, m)), np.zeros((n, m))
    first = 0
    for block in watch.blocks:
        bank = block.banks[model_of_change(block, watch.begins.log_stake)]
        place = slice(first, first + len(block.kept))
        info[:, place, place], score[:, place] = bank.info, bank.score
        first += len(block.kept)
    return info, score


def _prior_precision(watch: Watch) -> FloatArray:
    return np.concatenate([np.full(len(b.kept), BROAD[b.kind] ** -2.0) for b in watch.blocks])


def _sizes(
    info: FloatArray, score: FloatArray, by_begin: FloatArray, prior: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation of the change of each quantity, averaged over onsets."""
    share = by_begin / by_begin.sum()
    covariance = np.linalg.inv(info + np.diag(prior))
    each = np.einsum("tij,tj->ti", covariance, score)
    mean = share @ each
    variance = share @ (np.einsum("tii->ti", covariance) + (each - mean) ** 2)
    return mean, np.sqrt(variance)


def _louder(watch: Watch, by_begin: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return ln of the mean noise factor of each quantity over the tested factors, which include 1."""
    share = by_begin / by_begin.sum()
    m = watch.begins.log_scatter.shape[1]
    logs = np.concatenate(
        [np.zeros((*watch.begins.log_scatter.shape[:2], 1)), watch.begins.log_scatter], axis=2
    )
    weight = np.exp(logs - np.logaddexp.reduce(logs, axis=2)[..., None])
    ln_g = np.log(np.concatenate([[1.0], STRONGER]))
    mean = share @ (weight @ ln_g)
    square = share @ (weight @ ln_g**2)
    return mean, np.sqrt(np.maximum(square - mean**2, 0.01)).reshape(m)
