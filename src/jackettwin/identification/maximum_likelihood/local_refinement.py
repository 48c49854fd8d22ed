"""Refinement in narrow bands, for records whose whole band does not follow the model.

The model assumes that force spectra are powers of frequency and that no mode outside the band acts in it.
Turbulence on a rotor violates both over a wide band. Around one group of close modes, however,
every smooth spectrum is nearly a power of frequency. Modes just outside the band are included
with fixed frequencies and damping; those farther away form a background (``background.py``).
Shapes may have a phase lag: the aerodynamic damping of a rotor makes the perpendicular direction respond with
a delay, and with little noise a lag of a few degrees changes the estimated damping.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.identification.maximum_likelihood.band_fit import BandFit
from jackettwin.identification.maximum_likelihood.directions import directions, expand_to_channels, project
from jackettwin.identification.maximum_likelihood.refinement import NarrowBand, refine

if TYPE_CHECKING:
    from collections.abc import Sequence


GROUP_RATIO = 1.35
"""Modes whose frequency ratio is below this are fitted together, in a band that extends by the same ratio
beyond them."""

DITHER_SHARES = (1.0, 10.0)
"""Shares of the local median spectrum added as dither, tried in turn until a fit describes the lines.
Since one force moves all channels, the ratios of the channels between the peaks would determine the damping
more sharply than the accuracy of the model justifies; a larger dither reduces their weight."""

NEIGHBOUR_RATIO = 2.0
"""Modes within this ratio of the edges of the band are modelled as modes, not as background."""

FEW_LINES_FACTOR = 1.5
"""Factor on the covariance, since a narrow band has few lines for its many parameters."""


@dataclass(frozen=True)
class FitGroup:
    """Candidates that are fitted together, and their band.

    Attributes
    ----------
    members : (n_candidates,) bool
    band_hz : (low, high)
    """

    members: BoolArray
    band_hz: tuple[float, float]


def groups(frequency_hz: FloatArray, sure: BoolArray, band_hz: tuple[float, float]) -> list[FitGroup]:
    """Divide the sure candidates into groups whose frequencies differ by more than ``GROUP_RATIO``.

    Doubtful candidates join the group in whose band they lie. The bands of neighbouring groups meet halfway.

    Examples
    --------
    >>> import numpy as np
    >>> f = np.array([0.18, 0.19, 0.7, 0.72])
    >>> [g.members.sum() for g in groups(f, np.array([True, True, True, False]), (0.1, 2.0))]
    [np.int64(2), np.int64(2)]
    """
    f = np.sort(frequency_hz[sure])
    parts = np.split(f, np.flatnonzero(f[1:] / f[:-1] > GROUP_RATIO) + 1)
    low, high = (np.array([edge(part) for part in parts]) for edge in (np.min, np.max))
    middle = np.sqrt(high[:-1] * low[1:])
    lower = np.maximum(low / GROUP_RATIO, np.append(band_hz[0], middle))
    upper = np.minimum(high * GROUP_RATIO, np.append(middle, band_hz[1]))
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
    max_lack_of_fit: float = np.inf,
) -> BandFit:
    """Fit one group; parameters and candidate numbers are those of ``refine``.

    Many channels are projected onto the directions in which they move in the band (``directions.py``).
    A lack of fit above 1 multiplies the covariance.
    """
    among = np.flatnonzero(group.members)
    low, high = group.band_hz
    outside = (
        sure
        & ~group.members
        & (frequency_hz > low / NEIGHBOUR_RATIO)
        & (frequency_hz < high * NEIGHBOUR_RATIO)
    )
    own = shapes[group.members & sure]
    basis = directions(y, sample_rate_hz, group.band_hz, own) if len(set(derivatives)) == 1 else None
    if basis is not None:
        y = project(y, basis)
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
        narrow=NarrowBand(dither_share, frequency_hz[outside], damping_ratio[outside], shapes[outside]),
        max_lack_of_fit=max_lack_of_fit,
    )
    wider = FEW_LINES_FACTOR * max(fit.lack_of_fit, 1.0)
    if basis is not None:
        fit = expand_to_channels(fit, basis)
    return replace(
        fit,
        candidate=among[fit.candidate],
        covariance=wider * fit.covariance,
        shape_covariance=wider * fit.shape_covariance,
    )
