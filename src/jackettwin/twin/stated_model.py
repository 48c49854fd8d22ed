"""What records of a known model say of it: keys that a twin file leaves out are taken from there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from jackettwin.errors import InputError
from jackettwin.records.readers import described_by

MODEL_KEYS = ("gravity", "beam", "rotary_inertia", "subdivide")
"""Keys of scenarios and twins that say how a structure is modelled."""


def stated_model(metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a model that a record's metadata states, none for a record of a real structure.

    >>> stated_model({"model": {"structure": "jacket15", "gravity": False}})
    {'gravity': False}
    """
    said = metadata.get("model")
    return {key: said[key] for key in MODEL_KEYS if key in said} if isinstance(said, dict) else {}


def model_of_records(records: Iterable[Path]) -> dict[str, Any]:
    """Return what the JSON beside the first record that is there says of its model."""
    first = next((path for path in records if path.is_file()), None)
    try:
        known = None if first is None else described_by(first)
    except InputError:  # said when the record is read, with all that is wrong of it
        known = None
    return {} if known is None else stated_model(known.metadata)
