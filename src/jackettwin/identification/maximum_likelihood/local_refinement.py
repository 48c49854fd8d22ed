"""Refinement in narrow bands, where the spectrum of the whole band is not that of the model.

Over a wide band the model asks that force spectra be powers of frequency and that no mode outside act in it.
Turbulence on a rotor keeps neither. Around one group of close modes every smooth spectrum is a power of
frequency; the modes beside the band take part with the frequencies and damping they have, and what is farther
is a background (``background.py``). Shapes may lag: a rotor's dashpot lets the other direction take part
late, and with little noise a few degrees move the damping.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.identification.maximum_likelihood.directions import at_channels, directions, projected
from jackettwin.identification.maximum_likelihood.refined import Refined
from jackettwin.identification.maximum_likelihood.refinement import Narrow, refine

if TYPE_CHECKING:
    from collections.abc import Sequence


REACH = 1.35
"""Modes nearer than this ratio are fitted together, in a band wider by this ratio on both sides."""

DITHER_SHARES = (1.0, 10.0)
"""Share of the local median spectrum added; the next one where a fit with the one before does not describe
the lines. One force moves all channels, and between the peaks their ratios fix the damping more sharply than
the record allows, as far as the model is exact; the more is added, the less they count."""

BESIDE = 2.0
"""Modes outside the band, but nearer to its edge than this ratio, do more in it than a background can."""

FEW_LINES = 1.5
"""The covariance is multiplied by this: a narrow band holds few lines for its many parameters."""


@dataclass(frozen=True)
class FitGroup:
    """Neighbouring modes, the candidates among them, and the band they are fitted in.

    Attributes
    ----------
    members : (n_candidates,) bool
    band_hz : (low, high)
    """

    members: BoolArray
    band_hz: tuple[float, float]


def groups(frequency_hz: FloatArray, sure: BoolArray, band_hz: tuple[float, float]) -> list[FitGroup]:
    """Part the sure candidates where neighbours are farther apart than the reach.

    Doubtful ones join the group in whose band they lie. Bands of neighbouring groups meet halfway.

    Examples
    --------
    >>> import numpy as np
    >>> f = np.array([0.18, 0.19, 0.7, 0.72])
    >>> [g.members.sum() for g in groups(f, np.array([True, True, True, False]), (0.1, 2.0))]
    [np.int64(2), np.int64(2)]
    """
    f = np.sort(frequency_hz[sure])
    parts = np.split(f, np.flatnonzero(f[1:] / f[:-1] > REACH) + 1)
    low, high = (np.array([edge(part) for part in parts]) for edge in (np.min, np.max))
    middle = np.sqrt(high[:-1] * low[1:])
    lower = np.maximum(low / REACH, np.append(band_hz[0], middle))
    upper = np.minimum(high * REACH, np.append(middle, band_hz[1]))
    return [
        FitGroup((frequency_hz > a) & (frequency_hz < b), (float(a), float(b)))
        for a, b in zip(lower, upper, strict=True)
    ]


def refine_group(
    y: FloatArray,
    sample_rate_hz: float,
    group: FitGroup,
    *,
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    shapes: FloatArray,
    sure: BoolArray,
    derivatives: Sequence[int],
    avoid_hz: Sequence[tuple[float, float]] = (),
    dither_share: float = DITHER_SHARES[0],
    most_lack_of_fit: float = np.inf,
) -> Refined:
    """Fit one group; parameters as of ``refine``, candidates counted as there.

    Of many channels only the directions that move in the band are fitted (``directions.py``). What the lack
    of fit exceeds 1 by multiplies the covariance.
    """
    among = np.flatnonzero(group.members)
    low, high = group.band_hz
    beside = sure & ~group.members & (frequency_hz > low / BESIDE) & (frequency_hz < high * BESIDE)
    own = shapes[group.members & sure]
    basis = directions(y, sample_rate_hz, group.band_hz, own) if len(set(derivatives)) == 1 else None
    if basis is not None:
        y = projected(y, basis)
        shapes, derivatives = shapes @ basis, derivatives[: basis.shape[1]]
    fit = refine(
        y,
        sample_rate_hz,
        group.band_hz,
        frequency_hz=frequency_hz[among],
        damping_ratio=damping_ratio[among],
        shapes=shapes[among],
        sure=sure[among],
        derivatives=derivatives,
        avoid_hz=avoid_hz,
        background=True,
        narrow=Narrow(dither_share, frequency_hz[beside], damping_ratio[beside], shapes[beside]),
        most_lack_of_fit=most_lack_of_fit,
    )
    wider = FEW_LINES * max(fit.lack_of_fit, 1.0)
    if basis is not None:
        fit = at_channels(fit, basis)
    return replace(
        fit,
        candidate=among[fit.candidate],
        covariance=wider * fit.covariance,
        shape_covariance=wider * fit.shape_covariance,
    )
