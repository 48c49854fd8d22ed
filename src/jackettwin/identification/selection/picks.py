"""Modes picked by the user replace the criteria on clusters of poles."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import Int64Array
from jackettwin.errors import InputError
from jackettwin.findings import Finding

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jackettwin.identification.estimate import Stabilisation
    from jackettwin.identification.picks import Pick
    from jackettwin.identification.selection.candidates import Candidate
    from jackettwin.identification.selection.clustering import Cluster

MAX_PICK_DISTANCE = 0.02
"""Largest relative distance of a picked frequency from a pole."""


def picked_clusters(poles: Stabilisation, found: Sequence[Cluster], picks: Sequence[Pick]) -> list[Cluster]:
    """Return the cluster of each picked pole, with the pole as its representative.

    Raises
    ------
    InputError
        If there is no pole near a pick, two picks mean one pole, or the pole belongs to no mode.
    """
    out: dict[int, Cluster] = {}
    for pick in picks:
        k = _pole(poles, found, pick)
        if k in out:
            raise InputError(
                "two picks mean one pole",
                field="picks",
                value=pick.frequency_hz,
                allowed=f"a pole once, here that at {poles.frequency_hz[k]:.6g} Hz",
                remedy="remove one of them",
            )
        cluster = next((c for c in found if k in c.poles), None)
        if cluster is None:
            raise InputError(
                "the picked pole is alone",
                field="picks",
                value=pick.frequency_hz,
                allowed="poles that appear in other model orders as well",
                remedy="pick a pole of a column in the stabilisation diagram",
            )
        out[k] = replace(cluster, representative=k)
    return list(out.values())


def with_verdicts(picks: Sequence[Pick], judged: Sequence[Candidate]) -> list[Candidate]:
    """Return the candidates as picked: without objection, and doubtful only if the pick is marked so."""
    return [
        replace(c, objection=None, doubt=(c.doubt or "doubtful by the picks") if pick.doubtful else None)
        for pick, c in zip(picks, judged, strict=True)
    ]


def left_out(judged: Sequence[Candidate], picked: Sequence[Cluster]) -> tuple[Finding, ...]:
    """Return the finding on modes that would be chosen but are not picked: the fitted model lacks them."""
    taken = {int(k) for cluster in picked for k in cluster.poles}
    free = [c for c in judged if c.objection is None and c.doubt is None]
    f = [c.mode.frequency_hz for c in free if not taken & {int(k) for k in c.cluster.poles}]
    if not f:
        return ()
    listed = ", ".join(f"{x:.4g}" for x in sorted(f))
    return (Finding("picks_leave_out", params={"frequencies_hz": listed}),)


def _pole(poles: Stabilisation, found: Sequence[Cluster], pick: Pick) -> int:
    """Return the index of the pole that a pick refers to."""
    if pick.order is None:
        among = np.array([c.representative for c in found], dtype=np.int64)
    else:
        among = np.flatnonzero(poles.order == pick.order)
    away = np.abs(poles.frequency_hz[among] / pick.frequency_hz - 1.0)
    if not len(away) or away.min() > MAX_PICK_DISTANCE:
        orders = sorted(set(poles.order.tolist()))
        raise InputError(
            "no pole near the pick" + ("" if pick.order is None else f" in order {pick.order}"),
            field="picks",
            value=pick.frequency_hz,
            allowed=f"within {MAX_PICK_DISTANCE:.0%} of a pole; orders {orders[0]} to {orders[-1]}"
            if orders
            else "none",
            remedy=_nearest(poles, among, pick),
        )
    return int(among[np.argmin(away)])


def _nearest(poles: Stabilisation, among: Int64Array, pick: Pick) -> str:
    """Return a text on the nearest pole of the picked order and the nearest order that has a pole there."""
    said = []
    if len(among):
        k = among[np.argmin(np.abs(poles.frequency_hz[among] - pick.frequency_hz))]
        said.append(f"the nearest is at {poles.frequency_hz[k]:.6g} Hz")
    near = np.abs(poles.frequency_hz / pick.frequency_hz - 1.0) <= MAX_PICK_DISTANCE
    if pick.order is not None and near.any():
        order = min(set(poles.order[near].tolist()), key=lambda n: (abs(n - (pick.order or 0)), n))
        of_it = poles.frequency_hz[near & (poles.order == order)]
        best = of_it[np.argmin(np.abs(of_it - pick.frequency_hz))]
        said.append(f"the nearest order with one is {order}: {best:.6g} Hz")
    return "; ".join(said) or "use the settings the picks were made with"
