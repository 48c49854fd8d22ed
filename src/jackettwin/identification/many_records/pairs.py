r"""Alignment of close pairs: two modes of similar shape in two directions, which one record cannot separate.

If a pair is closer than its bandwidth, the plane of its shapes is well determined but the shapes in it are
not: the stronger mode leaks into the weaker. If symmetry defines the directions of the modes, as that of a
rotor does in its own axes, the shapes are rotated within their plane; nothing outside the plane is added:

.. math:: \phi_{fa}, \phi_{ss} = \arg\max, \min_{\phi \in \mathrm{span}(\phi_1, \phi_2)}
          \frac{\lVert P_{fa}\,\phi \rVert^2}{\lVert \phi \rVert^2}
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.findings import Finding
from jackettwin.identification.mode_shapes import aligned, mac, mpc, mpd_rad, normalised

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import Identification, ModalEstimate
    from jackettwin.records import Channel


CLOSE_DISTANCE = 2.0
"""Two modes are a pair if their frequencies differ by less than this times the sum of half bandwidths."""
MIN_AXIS_SHARE = 0.95
"""Smallest share of energy along one axis for the plane to contain a shape of that axis."""
SEPARATED_MAC = 0.99
"""MAC with the aligned shapes above which the record itself separates the modes and nothing is rotated."""
MIN_HORIZONTAL = 0.9
"""Smallest horizontal part of the unit vector of a channel."""


def along_axes(found: Identification) -> Identification:
    """Return the identification with the shapes of close pairs rotated to the first two axes.

    Only pairs whose plane contains a shape of each axis are rotated.
    The original shapes are kept in ``mode_shape_unaligned``, and a note reports the rotation.
    """
    first = _first_axis(found.channels)
    if first is None:
        return found
    modes, notes = list(found.modes), []
    for i, j in close_pairs(modes):
        turned = _rotated(modes[i], modes[j], first)
        if turned is not None:
            notes.append(_note(modes[i], modes[j], first))
            modes[i], modes[j] = turned
    return replace(found, modes=tuple(modes), notes=(*found.notes, *notes))


def close_pairs(modes: Sequence[ModalEstimate]) -> list[tuple[int, int]]:
    """Return overlapping neighbours in frequency, each mode in at most one pair, the closest first."""
    gaps = []
    for i, (a, b) in enumerate(zip(modes, modes[1:], strict=False)):
        width = a.damping_ratio * a.frequency_hz + b.damping_ratio * b.frequency_hz
        gaps.append(((b.frequency_hz - a.frequency_hz) / width, i))
    taken: set[int] = set()
    out = []
    for gap, i in sorted(gaps):
        if gap < CLOSE_DISTANCE and not taken & {i, i + 1}:
            taken |= {i, i + 1}
            out.append((i, i + 1))
    return sorted(out)


def _first_axis(channels: Sequence[Channel]) -> FloatArray | None:
    """Return squared cosines with the first horizontal axis; None unless all channels lie along two axes."""
    x, y = np.abs([c.direction[:2] for c in channels]).T
    if np.any(np.maximum(x, y) < MIN_HORIZONTAL) or not np.any(x > y) or not np.any(y > x):
        return None
    return np.asarray((x > y).astype(float))


def _share(shape: ComplexArray, first: FloatArray) -> float:
    power = np.abs(shape) ** 2
    return float(first @ power / power.sum())


def _rotated(
    a: ModalEstimate, b: ModalEstimate, first: FloatArray
) -> tuple[ModalEstimate, ModalEstimate] | None:
    plane, _ = np.linalg.qr(np.array([a.mode_shape, b.mode_shape]).T)
    shares, vectors = np.linalg.eigh(plane.conj().T @ (first[:, None] * plane))
    if shares[0] > 1.0 - MIN_AXIS_SHARE or shares[1] < MIN_AXIS_SHARE:
        return None
    pure = (plane @ vectors).T
    subspace_mac = mac(np.array([a.mode_shape, b.mode_shape]), pure)
    if subspace_mac.max(axis=1).min() > SEPARATED_MAC:
        return None
    swapped = subspace_mac[0, 1] + subspace_mac[1, 0] > subspace_mac[0, 0] + subspace_mac[1, 1]
    for_a, for_b = pure[::-1] if swapped else pure
    return _with_shape(a, for_a), _with_shape(b, for_b)


def _with_shape(mode: ModalEstimate, shape: ComplexArray) -> ModalEstimate:
    """Return the mode with another shape; its certainty then rests on the symmetry, not on the record."""
    shape = normalised(aligned(np.asarray(shape)))
    return replace(
        mode,
        mode_shape=shape,
        mode_shape_unaligned=mode.mode_shape,
        mode_shape_std=None,
        mpc=float(mpc(shape)),
        mpd_rad=float(mpd_rad(shape)),
    )


def _note(a: ModalEstimate, b: ModalEstimate, first: FloatArray) -> Finding:
    low, high = (float(_share(m.mode_shape, first)) for m in (a, b))
    params = {"low_hz": a.frequency_hz, "high_hz": b.frequency_hz, "low_share": low, "high_share": high}
    return Finding("pair_rotated", params=params)
