"""Reading and writing at the border: YAML, JSON, whole files or nothing."""

from jackettwin.files.atomic import atomic_folder, atomic_path
from jackettwin.files.json import Streamed, json_pieces, write_json
from jackettwin.files.schema import Schema, validate
from jackettwin.files.shipped import find_file, shipped
from jackettwin.files.yaml import read_mapping, read_yaml

__all__ = [
    "atomic_folder",
    "atomic_path",
    "find_file",
    "json_pieces",
    "read_mapping",
    "read_yaml",
    "Schema",
    "shipped",
    "Streamed",
    "validate",
    "write_json",
]
