r"""One shape from several setups: sensors moved between records, a few left in place.

Each setup knows its part of a shape up to a factor. The sensors they share tie the parts ("post-separate-
estimation re-scaling"; Reynders, Magalhães, De Roeck & Cunha 2009): factors and whole shape follow from

.. math:: \min_{\Phi,\, \alpha_r} \sum_r \lVert \alpha_r \phi_r - \Phi_{(r)} \rVert^2,
          \quad \lVert\Phi\rVert = 1

with :math:`\Phi_{(r)}` the entries of the channels of setup r, by alternating least squares.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.identification.mac import normalised

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import Identification
    from jackettwin.records import Channel

ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]

ROUNDS = 200
SETTLED = 1e-12
"""Change of the shape, of unit length, at which the rounds end."""
WEAK_TIE = 0.05
"""Share of a shape's energy at the shared sensors, below which setups are hardly tied."""


def all_channels(found: Sequence[Identification]) -> tuple[Channel, ...]:
    """Return the channels of all records, each once, in the order in which they appear.

    Raises
    ------
    InputError
        If one name stands for sensors of different kind, place or direction.
    """
    channels: dict[str, Channel] = {}
    for result in found:
        for channel in result.channels:
            known = channels.setdefault(channel.name, channel)
            if _differ(known, channel):
                raise InputError(
                    "one name stands for different sensors",
                    file=result.records[0],
                    field=f"channels.{channel.name}",
                    value=_said(channel),
                    allowed=_said(known),
                    remedy="rename the sensor that moved",
                )
    return tuple(channels.values())


def merged_shape(
    shapes: Sequence[ComplexArray], rows: Sequence[IntArray], shared: IntArray, n_channels: int
) -> ComplexArray:
    """Return the shape at all channels, 1 at its largest entry; NaN where no setup has the channel.

    Parameters
    ----------
    shapes : (n_channels of the setup,) each
    rows : (n_channels of the setup,) int each
        Positions of the setup's channels among all.
    shared : (n_shared,) int
        Positions of the channels that all setups have.
    n_channels : int

    Examples
    --------
    >>> import numpy as np
    >>> top, low = np.array([1.0, 0.5]), np.array([2.0j, -0.5j])
    >>> merged_shape([top, low], [np.array([0, 1]), np.array([0, 2])], np.array([0]), 3).real.tolist()
    [1.0, 0.5, -0.25]
    """
    parts = np.zeros((len(shapes), n_channels), dtype=complex)
    has = np.zeros((len(shapes), n_channels))
    for r, (shape, at) in enumerate(zip(shapes, rows, strict=True)):
        parts[r, at], has[r, at] = shape, 1.0
    count = has.sum(axis=0)
    start = np.linalg.svd(parts[:, shared])[2][0]
    power = np.sum(np.abs(parts[:, shared]) ** 2, axis=1)
    factors = (parts[:, shared].conj() @ start) / np.maximum(power, np.finfo(float).tiny)
    whole = _mean(parts, factors, count)
    for _ in range(ROUNDS):
        factors = np.sum(parts.conj() * whole, axis=1) / np.sum(np.abs(parts) ** 2, axis=1)
        before, whole = whole, _mean(parts, factors, count)
        if np.linalg.norm(whole - before) < SETTLED:
            break
    shape = normalised(whole)
    shape[count == 0] = np.nan
    return shape


def tie(shape: ComplexArray, shared: IntArray) -> float:
    """Return the share of a shape's energy at the shared channels."""
    return float(np.sum(np.abs(shape[shared]) ** 2) / np.nansum(np.abs(shape) ** 2))


def _mean(parts: ComplexArray, factors: ComplexArray, count: npt.NDArray[np.float64]) -> ComplexArray:
    mean = factors @ parts / np.maximum(count, 1.0)
    return np.asarray(mean / np.linalg.norm(mean))


def _differ(a: Channel, b: Channel) -> bool:
    """Tell whether what both channels say of themselves differs; zeros and None say nothing."""
    placed = [(a.node, b.node), (a.height_m, b.height_m)]
    if a.quantity != b.quantity or any(None not in pair and pair[0] != pair[1] for pair in placed):
        return True
    known = any(a.direction) and any(b.direction)
    return known and float(np.dot(a.direction, b.direction)) < 0.999


def _said(channel: Channel) -> str:
    place = channel.node if channel.node is not None else f"{channel.height_m} m"
    return f"{channel.quantity} at {place} along {channel.direction}"
