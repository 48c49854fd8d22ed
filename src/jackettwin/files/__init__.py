"""Reading and writing at the border: YAML, JSON, whole files or nothing."""

from jackettwin.files.atomic import atomic_folder, atomic_path, write_json
from jackettwin.files.schema import Schema, validate
from jackettwin.files.yaml import read_yaml

__all__ = ["atomic_folder", "Schema", "atomic_path", "read_yaml", "validate", "write_json"]
