"""Inputs of a run as a flat table of values, by which two runs are compared."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from jackettwin.twin.config import TwinConfig

_NOT_ASKED = ("name", "path", "records", "assigned", "of_records")
"""Excluded fields: names, files, whose content is in the provenance, and derived values."""
_NAMES = ("name", "channel", "node", "leader", "mode")
"""Keys that identify the items of a list, if an item has them."""

Scalar = str | float | int | bool | None


def inputs_document(config: TwinConfig) -> dict[str, Scalar]:
    """Return every value of a twin by its path, such as ``water.level_m``, in the order of the twin."""
    return {
        name: value
        for f in fields(config)
        if f.name not in _NOT_ASKED
        for name, value in _flat(getattr(config, f.name), f.name)
    }


def _flat(value: Any, name: str) -> Iterator[tuple[str, Scalar]]:
    if isinstance(value, BaseModel):
        value = {key: getattr(value, key) for key in type(value).model_fields}
    elif is_dataclass(value) and not isinstance(value, type):
        value = {f.name: getattr(value, f.name) for f in fields(value) if f.init}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _flat(item, f"{name}.{key}")
    elif isinstance(value, (tuple, list, set, frozenset)):
        yield from _items(sorted(value, key=str) if isinstance(value, (set, frozenset)) else value, name)
    else:
        yield name, _scalar(value)


def _items(items: Any, name: str) -> Iterator[tuple[str, Scalar]]:
    """Yield the items of a list by their identifying keys; numbers and texts form one value."""
    if all(item is None or isinstance(item, (str, int, float)) for item in items):
        yield name, ", ".join(str(_scalar(item)) for item in items)
        return
    keys = [next((str(getattr(item, k)) for k in _NAMES if hasattr(item, k)), "") for item in items]
    for i, (key, item) in enumerate(zip(keys, items, strict=True), start=1):
        alone = key and keys.count(key) == 1
        yield from _flat(item, f"{name}.{key if alone else i}")


def _scalar(value: Any) -> Scalar:
    if isinstance(value, Enum):
        return _scalar(value.value)
    if isinstance(value, (float, np.floating)):
        return float(value) if isfinite(value) else None
    if value is None or isinstance(value, (bool, int, str)):
        return value
    return value.name if isinstance(value, Path) else str(value)
