"""Modelling keys stated by simulated records, used where a twin file omits them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from jackettwin.errors import InputError
from jackettwin.records.readers import described_by

MODEL_KEYS = ("gravity", "beam", "rotary_inertia", "subdivide")
"""Keys of scenarios and twins for the modelling of a structure."""


def stated_model(metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a model that a record's metadata states, none for a record of a real structure.

    >>> stated_model({"model": {"structure": "jacket15", "gravity": False}})
    {'gravity': False}
    """
    said = metadata.get("model")
    return {key: said[key] for key in MODEL_KEYS if key in said} if isinstance(said, dict) else {}


def model_of_records(records: Iterable[Path]) -> dict[str, Any]:
    """Return the modelling keys in the JSON description of the first existing record."""
    first = next((path for path in records if path.is_file()), None)
    try:
        known = None if first is None else described_by(first)
    except InputError:  # reported when the record is read
        known = None
    return {} if known is None else stated_model(known.metadata)
