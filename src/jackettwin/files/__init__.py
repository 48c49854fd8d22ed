"""Reading and writing at the border: YAML, JSON, whole files or nothing."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.files.atomic import atomic_folder, atomic_path
    from jackettwin.files.json import Streamed, json_pieces, write_json
    from jackettwin.files.room import check_room
    from jackettwin.files.schema import Schema, validate
    from jackettwin.files.shipped import find_file, shipped
    from jackettwin.files.yaml import read_mapping, read_yaml

__all__ = [
    "Schema",
    "Streamed",
    "atomic_folder",
    "atomic_path",
    "check_room",
    "find_file",
    "json_pieces",
    "read_mapping",
    "read_yaml",
    "shipped",
    "validate",
    "write_json",
]

door(
    __name__,
    {
        "atomic": "atomic_folder atomic_path",
        "json": "Streamed json_pieces write_json",
        "room": "check_room",
        "schema": "Schema validate",
        "shipped": "find_file shipped",
        "yaml": "read_mapping read_yaml",
    },
)
