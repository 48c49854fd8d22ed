"""Reading and writing at the border: YAML, JSON, whole files or nothing."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.files.atomic import atomic_folder as atomic_folder, atomic_path as atomic_path
    from jackettwin.files.json import (
        Streamed as Streamed,
        json_pieces as json_pieces,
        write_json as write_json,
    )
    from jackettwin.files.room import check_room as check_room
    from jackettwin.files.schema import Schema as Schema, validate as validate
    from jackettwin.files.shipped import find_file as find_file, shipped as shipped
    from jackettwin.files.yaml import read_mapping as read_mapping, read_yaml as read_yaml

door(__name__)
