r"""Mode shapes from several setups: some sensors are moved between records, others remain.

Each setup determines its part of a shape up to a factor.
The shared sensors connect the parts ("post-separate-estimation re-scaling"; Reynders, Magalhães,
De Roeck & Cunha 2009): factors and whole shape follow from

.. math:: \min_{\Phi,\, \alpha_r} \sum_r \lVert \alpha_r \phi_r - \Phi_{(r)} \rVert^2,
          \quad \sum_r \lVert\Phi_{(r)}\rVert^2 = 1

with :math:`\Phi_{(r)}` the entries of the channels of setup r. Elimination of the factors leaves
an eigenvalue problem of the size of the channels, :math:`G\Phi = \mu D\Phi` with the largest μ.
G is the sum of :math:`\phi_r\phi_r^H/\lVert\phi_r\rVert^2` and D counts the setups of each channel,
so that sums over any number of records suffice.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.errors import InputError
from jackettwin.identification.mode_shapes import normalised

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.records import Channel


WEAK_CONNECTION = 0.05
"""Share of a shape's energy at the shared sensors below which setups are hardly connected."""


@dataclass(frozen=True)
class ShapeSum:
    """Sums over the shapes of one mode.

    Attributes
    ----------
    gram : (n_channels, n_channels) complex
        Sum of the outer products of the shapes, each of unit length.
    count : (n_channels,)
        Number of shapes that contain each channel.
    """

    gram: ComplexArray
    count: FloatArray

    @classmethod
    def none(cls, n_channels: int) -> ShapeSum:
        """Return the sum of no shapes."""
        return cls(np.zeros((n_channels, n_channels), dtype=complex), np.zeros(n_channels))

    def with_shape(self, shape: ComplexArray, at: Int64Array) -> ShapeSum:
        """Return the sum with one more shape, at these channels."""
        own = ShapeSum.none(int(at.max()) + 1)
        own.gram[np.ix_(at, at)] = np.outer(shape, shape.conj()) / np.sum(np.abs(shape) ** 2)
        own.count[at] = 1.0
        return self.plus(own)

    def plus(self, other: ShapeSum) -> ShapeSum:
        """Return the sum of both; the channels of the smaller are the first of the larger."""
        small, large = sorted((self, other), key=lambda total: len(total.count))
        n = len(small.count)
        out = ShapeSum(large.gram.copy(), large.count.copy())
        out.gram[:n, :n] += small.gram
        out.count[:n] += small.count
        return out

    def mean(self) -> ComplexArray:
        """Return the shape, (n_channels,), 1 at its largest entry; NaN where no setup has the channel.

        Examples
        --------
        >>> top, low = np.array([1.0, 0.5]), np.array([2.0j, -0.5j])
        >>> total = ShapeSum.none(3).with_shape(top, np.array([0, 1])).with_shape(low, np.array([0, 2]))
        >>> total.mean().round(12).real.tolist()
        [1.0, 0.5, -0.25]
        """
        has = self.count > 0.0
        root = np.sqrt(self.count[has])
        _, vectors = np.linalg.eigh(self.gram[np.ix_(has, has)] / np.multiply.outer(root, root))
        shape = np.full(len(has), np.nan, dtype=complex)
        shape[has] = normalised(np.asarray(vectors[:, -1] / root, dtype=complex))
        return shape


def add_channels(known: dict[str, Channel], channels: Sequence[Channel], record: str) -> None:
    """Add the channels of a record to the known ones, in the order in which they appear.

    Raises
    ------
    InputError
        If one name is used for sensors of different kind, position or direction.
    """
    for channel in channels:
        before = known.setdefault(channel.name, channel)
        if _differ(before, channel):
            raise InputError(
                "one name is used for different sensors",
                file=record,
                field=f"channels.{channel.name}",
                value=_description(channel),
                allowed=_description(before),
                remedy="rename the sensor that moved",
            )


def tied(sets: Sequence[Sequence[str]]) -> bool:
    """Return whether sets of channels are connected, directly or through others.

    >>> tied([("a", "b"), ("c",), ("b", "c")]), tied([("a",), ("b",)])
    (True, False)
    """
    reached, left = set(sets[0]), list(sets[1:])
    while left:
        near = [one for one in left if reached & set(one)]
        if not near:
            return False
        reached |= set().union(*near)
        left = [one for one in left if one not in near]
    return True


def tie(shape: ComplexArray, shared: Int64Array) -> float:
    """Return the share of a shape's energy at the shared channels."""
    return float(np.sum(np.abs(shape[shared]) ** 2) / np.nansum(np.abs(shape) ** 2))


def _differ(a: Channel, b: Channel) -> bool:
    """Return whether two descriptions of a channel conflict; zeros and None are unknown."""
    placed = [(a.node, b.node), (a.height_m, b.height_m)]
    if a.quantity != b.quantity or any(None not in pair and pair[0] != pair[1] for pair in placed):
        return True
    known = any(a.direction) and any(b.direction)
    return known and float(np.dot(a.direction, b.direction)) < 0.999


def _description(channel: Channel) -> str:
    place = channel.node if channel.node is not None else f"{channel.height_m} m"
    return f"{channel.quantity} at {place} along {channel.direction}"
