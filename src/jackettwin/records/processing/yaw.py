r"""Rotate horizontal vibrations between global axes and the axes of the rotor.

With the yaw ψ of the nacelle about the vertical, anticlockwise seen from above and zero where the
rotor axis lies along global x,

.. math:: a_{fa} = a_x \cos ψ + a_y \sin ψ, \qquad a_{ss} = -a_x \sin ψ + a_y \cos ψ .

The rotor turns with the wind, and the modes turn with the rotor: only in its axes do mode shapes of
different records compare. In a rotated record ``direction`` refers to the rotor's axes, and
``metadata["axes"]`` says so. (A compass yaw runs clockwise from north: bring it to this convention
first.)
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.processing.filters import bridge

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jackettwin.records.record import Channel, Record


ROTOR, GLOBAL = ("fore_aft", "side_side"), ("x", "y")
MIN_SINE = 0.5
"""Two sensors span the plane if the sine of the angle between them is at least this."""
_ENDING = re.compile(r"[_ .\-]?(fore_aft|side_side|[xyXY])$")


def to_rotor_axes(
    record: Record, *, yaw_rad: float | FloatArray | None = None, rename: bool = True
) -> Record:
    """Return the record with each horizontal pair as ``…_fore_aft`` and ``…_side_side``.

    The yaw is the argument (a number or one for every sample), else the record's channel of quantity
    yaw, sample by sample, else ``conditions["yaw_deg"]``. Two horizontal channels at one place need not
    lie along x and y; those of frame ``nacelle`` are in these axes already. One without a partner cannot
    be rotated and is left out; its name is kept in ``metadata["without_partner"]``. Remove offsets first: a
    turning nacelle makes signals of them. Without ``rename`` channels keep their names, the one nearer to x
    becoming the fore-aft one.

    Raises
    ------
    InputError
        If the yaw is not known, or the record is in rotor axes already.
    """
    if record.metadata.get("axes") == "rotor":
        raise InputError(
            "is in rotor axes already", file=record.name, field="axes", remedy="use to_global_axes"
        )
    rotated = _rotate(record, _yaw(record, yaw_rad), ROTOR if rename else None)
    return replace(rotated, metadata={**rotated.metadata, "axes": "rotor"})


def to_global_axes(record: Record, *, yaw_rad: float | None = None, rename: bool = True) -> Record:
    """Return a record in rotor axes with its pairs as ``…_x`` and ``…_y`` again; else with their own names.

    Raises
    ------
    InputError
        If the yaw is not known, or the record is in global axes already.
    """
    if record.metadata.get("axes") != "rotor":
        raise InputError(
            "is in global axes already", file=record.name, field="axes", remedy="use to_rotor_axes"
        )
    rotated = _rotate(record, -_yaw(record, yaw_rad), GLOBAL if rename else None)
    return replace(rotated, metadata={**rotated.metadata, "axes": "global"})


def knows_yaw(record: Record) -> bool:
    """Tell whether the record says how the nacelle stood."""
    measured = any(
        channel.quantity == "yaw" and np.isfinite(row).any()
        for channel, row in zip(record.channels, record.data, strict=True)
    )
    return measured or record.conditions.get("yaw_deg") is not None


def yaw_of(record: Record) -> FloatArray:
    """Return the yaw [rad] of every sample: of the channel of quantity yaw, else of the conditions.

    Raises
    ------
    InputError
        If the yaw is not known.
    """
    return _yaw(record, None)


def _rotate(record: Record, yaw: FloatArray, endings: tuple[str, str] | None) -> Record:
    """Rotate every pair by ``yaw``; what is not horizontal, or turns with the nacelle, stays as it is."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    data, channels = record.data.copy(), list(record.channels)
    pairs = list(_pairs(record))
    for i, j in pairs:
        spanned = np.array([record.channels[i].direction[:2], record.channels[j].direction[:2]])
        x, y = np.linalg.solve(spanned, record.data[[i, j]])
        data[i], data[j] = cos * x + sin * y, cos * y - sin * x
        names = endings or (None, None)
        channels[i] = _turned(channels[i], names[0], (1.0, 0.0, 0.0))
        channels[j] = _turned(channels[j], names[1], (0.0, 1.0, 0.0))
    paired = {i for pair in pairs for i in pair}
    alone = [i for i, channel in enumerate(channels) if _rotates(channel) and i not in paired]
    kept = [i for i in range(len(channels)) if i not in alone]
    metadata = dict(record.metadata)
    if alone:
        metadata["without_partner"] = [channels[i].name for i in alone]
    return replace(record, data=data[kept], channels=tuple(channels[i] for i in kept), metadata=metadata)


def _pairs(record: Record) -> Iterator[tuple[int, int]]:
    """Yield the horizontal channels of one quantity and place, the one nearer to x first."""
    left = [i for i, channel in enumerate(record.channels) if _rotates(channel)]
    while left:
        i = left.pop(0)
        first = record.channels[i]
        for j in left:
            second = record.channels[j]
            if _place(first) == _place(second) and abs(_sine(first, second)) >= MIN_SINE:
                left.remove(j)
                yield (i, j) if abs(first.direction[0]) >= abs(second.direction[0]) else (j, i)
                break


def _rotates(channel: Channel) -> bool:
    """Tell whether a channel is horizontal and fixed to the structure below the nacelle."""
    return channel.frame == "global" and is_horizontal(channel)


def is_horizontal(channel: Channel) -> bool:
    """Tell whether a channel measures horizontal motion."""
    x, y, z = channel.direction
    return channel.quantity in VIBRATIONS and abs(z) < 1e-3 and (x, y) != (0.0, 0.0)


def _place(channel: Channel) -> tuple[object, ...]:
    """Return what two sensors at one point share; without height or node, the name up to its axis."""
    unknown = channel.height_m is None and channel.node is None
    return channel.quantity, channel.height_m, channel.node, _ENDING.sub("", channel.name) if unknown else ""


def _sine(first: Channel, second: Channel) -> float:
    (a, b, _), (c, d, _) = first.direction, second.direction
    return a * d - b * c


def _turned(channel: Channel, ending: str | None, direction: tuple[float, float, float]) -> Channel:
    name = channel.name if ending is None else f"{_ENDING.sub('', channel.name)}_{ending}"
    return replace(channel, name=name, direction=direction)


def _yaw(record: Record, yaw_rad: float | FloatArray | None) -> FloatArray:
    """Return the yaw [rad] of every sample."""
    n = record.data.shape[1]
    if isinstance(yaw_rad, np.ndarray):
        return np.broadcast_to(yaw_rad, (n,))
    if yaw_rad is not None:
        return np.full(n, _finite(record, yaw_rad, "yaw_rad"))
    rows = [i for i, channel in enumerate(record.channels) if channel.quantity == "yaw"]
    if rows and np.isfinite(record.data[rows[0]]).any():
        row = record.data[rows[0]].copy()
        finite = np.isfinite(row)
        row[finite] = np.unwrap(row[finite])
        return bridge(row)
    if record.conditions.get("yaw_deg") is not None:
        return np.full(n, np.radians(_finite(record, record.conditions["yaw_deg"], "conditions.yaw_deg")))
    raise InputError(
        "yaw is not known",
        file=record.name,
        field="conditions.yaw_deg",
        allowed="a number of degrees, or a channel of quantity yaw",
        remedy='add "yaw_deg" to the conditions of the record',
    )


def _finite(record: Record, value: object, field: str) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool) and np.isfinite(value):
        return float(value)
    raise InputError(
        "is not a number", file=record.name, field=field, value=value, remedy="give a finite angle"
    )
