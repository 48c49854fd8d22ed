"""Measured mode shapes beside those of a structure, at the sensors: the modal assurance criterion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from jackettwin.errors import require
from jackettwin.identification import mac
from jackettwin.response import Sensor, mode_kinds, mode_labels, observation_matrix, sees
from jackettwin.structure import Assembly
from jackettwin.updating import numbered_modes

AS_ALIKE = 0.1
"""Difference of MAC from the largest up to which modes of the structure are as like, since few channels see
the same of many modes: the nearest of them in frequency is taken."""
COMPARED = 20
"""Number of the structure's lowest modes that are compared."""


def beside_model(document: Mapping[str, Any], assembly: Assembly) -> dict[str, Any]:
    """Return the MAC of each identified mode with the structure's modes, and which is most like it.

    The structure stands on pinned feet: what the ground does to shapes at sensors is little, what it does to
    frequencies is what an update is for.

    Parameters
    ----------
    document : mapping
        Of ``jackettwin identify``: ``modes`` and ``channels``.

    Returns
    -------
    dict
        ``channels`` that were compared, ``modes`` of the structure, ``mac`` (n_identified, n_modes), and
        ``pairs``, one an identified mode, with the number of other modes that are as like it at these
        channels; None for a mode that none of the channels saw.

    Raises
    ------
    InputError
        If no channel says where it sits and points, or one sits where the structure has no place.
    """
    sensors = tuple(
        Sensor(name, tuple(c["direction"]), c["node"], None if c["node"] else c["height_m"],
               quantity=sees(c["quantity"]))
        for name, c in document["channels"].items()
        if any(c["direction"]) and (c["node"] or c["height_m"] is not None)
    )  # fmt: skip
    require(
        sensors,
        "no channel says where it sits and points",
        field="channels",
        value=list(document["channels"]),
        remedy="give height_m or node, and direction, in the JSON beside the record",
    )
    model = numbered_modes(assembly, COMPARED)
    labels = mode_labels(mode_kinds(assembly, model.shapes, model.frequency_hz))
    at = observation_matrix(assembly, sensors) @ model.shapes
    names = [sensor.channel for sensor in sensors]
    alike = [_macs(mode["mode_shape"], names, at) for mode in document["modes"]]
    return {
        "channels": names,
        "modes": [
            {"label": label, "frequency_hz": float(f)}
            for label, f in zip(labels, model.frequency_hz, strict=True)
        ],
        "mac": [None if row is None else row.tolist() for row in alike],
        "pairs": [
            None if row is None else _pair(mode, row, labels, model.frequency_hz)
            for mode, row in zip(document["modes"], alike, strict=True)
        ],
    }


def _macs(shape: Mapping[str, Any], names: list[str], at: np.ndarray[Any, Any]) -> Any:
    """Return the MAC with every mode of the structure at the channels of a shape; None without any."""
    seen = [i for i, name in enumerate(names) if name in shape]
    if not seen:
        return None
    own = np.array([complex(*shape[names[i]]) for i in seen])
    return np.nan_to_num(mac(own, at[seen].T))


def _pair(
    mode: Mapping[str, Any], row: np.ndarray[Any, Any], labels: tuple[str, ...], f: np.ndarray[Any, Any]
) -> dict[str, Any]:
    alike = np.flatnonzero(row >= row.max() - AS_ALIKE)
    best = int(alike[np.argmin(np.abs(np.log(f[alike] / mode["frequency_hz"])))])
    return {
        "frequency_hz": mode["frequency_hz"],
        "status": mode["status"],
        "label": labels[best],
        "model_frequency_hz": float(f[best]),
        "relative_difference": mode["frequency_hz"] / float(f[best]) - 1.0,
        "mac": float(row[best]),
        "modes_as_alike": len(alike) - 1,
    }
