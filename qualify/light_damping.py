"""Damping of modes whose decay lasts about as long as the record: single records and fused pieces.

Usage: ``python qualify/light_damping.py [--sets 12] [--pieces 12] [--lines 0] [--zft 0.2 0.45 0.7 1.5]
[--scatter 0.0] [--seed 41] [--out FILE.md]``.
The world is not the product's: a shear frame of four storeys under forces held for a sample, discretised
exactly; each piece is a record of its own time. Intervals of 90 and of 95 % are judged two-sided.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.signal import cont2discrete, lfilter

from jackettwin.identification import FusedMode, ModalEstimate, fuse, identify
from jackettwin.identification.many_records.joint_damping import joint_damping, jointly
from jackettwin.identification.maximum_likelihood.line_likelihood import (
    between_nodes,
    damping_log_likelihood,
    likelihood_ends,
    likelihood_interval,
    over_noise,
)
from jackettwin.identification.selection.light_damping import HALF_BAND_LINES
from jackettwin.intervals import NORMAL_95
from jackettwin.records import Channel, Record

STOREYS = 4
FIRST_HZ, OTHER_DAMPING, NOISE = 0.3, 0.012, 0.03
DURATION_S, RATE_HZ = 600.0, 10.0
OUT = Path("docs/verification/light_damping.md")
EXPLANATION = f"""\
A shear frame of four storeys, first mode {FIRST_HZ:g} Hz, the others damped {100 * OTHER_DAMPING:g} %, sensor
noise {100 * NOISE:g} %, records of {DURATION_S:g} s, each of a different time. ζfT is the half
bandwidth of the first mode in lines of a record: below 1 its decay lasts longer than a sixth of it. *Held*:
90 % intervals of ζ, as printed, and 95 % intervals of the same likelihood, that contain the true value; then
those above and below it; *statuses*: ok / damping unknown / doubtful / not found. Modes of every status are
included. *Lines*: the likelihood alone, of the first mode's motion by the true shapes: its median as
reported, its maximum and the mean of ζ; of *all lines together* the 90 % interval stands under held. *Mean of
ln*: e to the mean of the logarithm of ζ over true.
"""


def frame(ratio: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return frequencies [Hz], damping ratios and mass-normalised shapes (modes, storeys) of the frame."""
    k = 2.0 * np.eye(STOREYS) - np.eye(STOREYS, k=1) - np.eye(STOREYS, k=-1)
    k[-1, -1] = 1.0
    squares, shapes = np.linalg.eigh(k)
    f = FIRST_HZ * np.sqrt(squares / squares[0])
    return f, np.array([ratio, *[OTHER_DAMPING] * (STOREYS - 1)]), shapes.T


def record(ratio: float, rng: np.random.Generator, name: str) -> Record:
    """Return accelerations of the storeys after a run-in of six decays."""
    f, zeta, shapes = frame(ratio)
    n = round(DURATION_S * RATE_HZ)
    before = round(6.0 / (2.0 * np.pi * FIRST_HZ * ratio) * RATE_HZ)
    force = rng.standard_normal((STOREYS, before + n))
    y = np.zeros((STOREYS, n))
    for f_i, zeta_i, shape in zip(f, zeta, shapes, strict=True):
        omega = 2.0 * np.pi * f_i
        a = np.array([[0.0, 1.0], [-(omega**2), -2.0 * zeta_i * omega]])
        b = np.array([[0.0], [1.0]])
        ad, bd, *_ = cont2discrete((a, b, np.eye(2), np.zeros((2, 1))), 1.0 / RATE_HZ)
        # x[k+1] = Ad x[k] + Bd u[k], its velocity and displacement as filters of u
        poles = np.poly(ad)
        modal = shape @ force
        position = lfilter([0.0, bd[0, 0], ad[0, 1] * bd[1, 0] - ad[1, 1] * bd[0, 0]], poles, modal)
        speed = lfilter([0.0, bd[1, 0], ad[1, 0] * bd[0, 0] - ad[0, 0] * bd[1, 0]], poles, modal)
        acceleration = a[1] @ np.array([position, speed]) + modal
        y += shape[:, None] * acceleration[-n:]
    y += NOISE * y.std(axis=1, keepdims=True) * rng.standard_normal(y.shape)
    return Record(y, RATE_HZ, tuple(Channel(f"storey_{j}") for j in range(STOREYS)), name=name)


@dataclass(frozen=True)
class Outcome:
    """Estimate of a damping ratio over the truth, and its intervals of 90 and 95 %."""

    ratio: float
    interval_90: tuple[float, float]
    interval_95: tuple[float, float]


def outside(interval: tuple[float, float]) -> int:
    """Return 0 if the truth is held, 1 if the interval lies above it, −1 if below."""
    return int(interval[0] > 1.0) - int(interval[1] < 1.0)


def by_likelihood(log_likelihood: np.ndarray, ratio: float) -> Outcome:
    """Return the estimate of a likelihood of ln ζ (n_nodes,)."""
    middle, *ends, _ = np.exp(likelihood_interval(log_likelihood)) / ratio
    far = np.exp(likelihood_ends(log_likelihood, NORMAL_95)) / ratio
    return Outcome(float(middle), (ends[0], ends[1]), (far[0], far[1]))


def outcome(mode: ModalEstimate | FusedMode, ratio: float) -> Outcome:
    """Return the printed estimate; 95 % are of the likelihood if the printed 90 % are its own."""
    if isinstance(mode, FusedMode):
        joint = joint_damping(mode.sightings)
        log_likelihood = None if joint is None else joint.log_likelihood
    else:
        each = mode.damping_log_likelihood
        log_likelihood = None if each is None else over_noise(each)
    printed = tuple(np.array(mode.damping_ratio_interval_90) / ratio)
    if log_likelihood is not None:
        found = by_likelihood(log_likelihood, ratio)
        if np.allclose(found.interval_90, printed):
            return found
    std = NORMAL_95 * float(np.sqrt(mode.log_covariance[1, 1]))
    middle = mode.damping_ratio / ratio
    return Outcome(middle, printed, (middle * np.exp(-std), middle * np.exp(std)))


def row(kind: str, zft: float, found: list[Outcome], rest: str) -> str:
    """Return a row of the table."""
    ratio = np.array([one.ratio for one in found])
    error = ratio.std(ddof=1) / np.sqrt(len(ratio)) if len(ratio) > 1 else np.nan
    held = []
    for level in (0.90, 0.95):
        side = np.array([outside(getattr(one, f"interval_{100 * level:.0f}")) for one in found])
        chance = 100 * np.sqrt(level * (1.0 - level) / len(found))
        held.append(
            f"{100 * np.mean(side == 0):.1f} ± {chance:.1f} % | {np.sum(side > 0)} / {np.sum(side < 0)}"
        )
    return (
        f"| {zft:g} | {kind} | {len(found)} | {ratio.mean():.3f} ± {error:.3f} | {np.median(ratio):.3f} "
        f"| {np.exp(np.log(ratio).mean()):.3f} | {' | '.join(held)} | {rest} |"
    )


def lines_alone(zft: float, number: int, pieces: int, seed: int, scatter: float) -> list[str]:
    """Return the rows of the likelihood by which the damping is estimated, without what identifies a mode."""
    ratio = zft / (FIRST_HZ * DURATION_S)
    inverse = np.linalg.pinv(frame(ratio)[2].T)[0]
    peak = round(FIRST_HZ * DURATION_S)
    line = np.arange(peak - HALF_BAND_LINES, peak + HALF_BAND_LINES + 1)
    likelihoods = []
    other: dict[str, list[float]] = {"maximum": [], "mean of ζ": []}
    for k in range(number):
        rng = np.random.default_rng([seed, k])
        own = ratio * np.exp(scatter * rng.standard_normal() - 0.5 * scatter**2) if scatter else ratio
        data = record(own, rng, "lines").data
        x = inverse @ np.fft.rfft(data - data.mean(axis=1, keepdims=True))[:, line]
        x /= RATE_HZ * np.sqrt(DURATION_S)
        likelihoods.append(damping_log_likelihood(x, FIRST_HZ, line / DURATION_S, DURATION_S))
        log_zeta, values = between_nodes(over_noise(likelihoods[-1]))
        weight = np.exp(values - values.max())
        other["maximum"].append(np.exp(log_zeta[np.argmax(values)]) / ratio)
        other["mean of ζ"].append(weight @ np.exp(log_zeta) / weight.sum() / ratio)
    each = np.array(likelihoods)
    sets = [jointly(each[k : k + pieces]) for k in range(0, number - pieces + 1, pieces)]
    together = jointly(each)
    middle, (low, high) = together.damping_ratio / ratio, np.array(together.interval_90) / ratio
    return [
        row("lines", zft, [by_likelihood(over_noise(one), ratio) for one in each], "–"),
        *(
            f"| {zft:g} | lines, {name} | {number} | {np.mean(of):.3f} ± {np.std(of) / np.sqrt(number):.3f} "
            f"| {np.median(of):.3f} | {np.exp(np.mean(np.log(of))):.3f} | – | – | – | – | – |"
            for name, of in other.items()
        ),
        row(f"lines, {pieces} fused", zft, [by_likelihood(one.log_likelihood, ratio) for one in sets], "–"),
        f"| {zft:g} | all lines together | 1 | {middle:.3f} | – | – | {low:.3f}–{high:.3f} | – | – | – | – |",
    ]


def first_mode(modes):
    near = [m for m in modes if abs(m.frequency_hz / FIRST_HZ - 1.0) < 0.05]
    return min(near, key=lambda m: abs(m.frequency_hz - FIRST_HZ)) if near else None


def study(zft: float, sets: int, pieces: int, seed: int) -> list[str]:
    """Return the rows of one damping ratio."""
    ratio = zft / (FIRST_HZ * DURATION_S)
    single, fused, statuses = [], [], []
    started = time.process_time()
    for s in range(sets):
        results = [
            identify(record(ratio, np.random.default_rng([seed, s, k]), f"{s}_{k}")) for k in range(pieces)
        ]
        for result in results:
            mode = first_mode(result.modes)
            statuses.append("–" if mode is None else mode.status.value)
            if mode is not None:
                single.append(outcome(mode, ratio))
        mode = first_mode(fuse(results).modes)
        if mode is not None:
            fused.append(outcome(mode, ratio))
    said = " / ".join(str(statuses.count(w)) for w in ("ok", "damping unknown", "doubtful", "–"))
    cost = (time.process_time() - started) / (sets * pieces)
    return [
        row("single", zft, single, said),
        row(f"{pieces} fused", zft, fused, f"{cost:.2f} CPU-s a record"),
    ]


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--sets", type=int, default=12)
    parser.add_argument("--pieces", type=int, default=12)
    parser.add_argument("--lines", type=int, default=0)
    parser.add_argument("--scatter", type=float, default=0.0, help="of ln ζ between the records of lines")
    parser.add_argument("--seed", type=int, default=41)
    parser.add_argument("--zft", type=float, nargs="+", default=[0.2, 0.45, 0.7, 1.5])
    parser.add_argument("--out", type=Path, default=OUT)
    given = parser.parse_args()
    lines = ["# Lightly damped modes", "", EXPLANATION]
    lines += [f"`python qualify/light_damping.py {' '.join(sys.argv[1:])}`", ""]
    heads = "ζfT| |number|ζ over true|median|mean of ln|held of 90|above / below|of 95|above / below|statuses"
    lines += [f"| {heads.replace('|', ' | ')} |", "|" + "---|" * 11]
    for zft in given.zft:
        lines += study(zft, given.sets, given.pieces, given.seed) if given.sets else []
        lines += lines_alone(zft, given.lines, given.pieces, given.seed, given.scatter) if given.lines else []
        sys.stderr.write("\n".join(lines[-2:]) + "\n")
    given.out.write_text("\n".join([*lines, ""]), encoding="utf-8")
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
