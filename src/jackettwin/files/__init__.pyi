from .atomic import atomic_folder as atomic_folder, atomic_path as atomic_path
from .cache import NOT_KEPT as NOT_KEPT, Keep as Keep, KeptInFolder as KeptInFolder, kept as kept
from .codec import encode as encode, named as named
from .disk_space import check_room as check_room
from .json import (
    Streamed as Streamed,
    json_pieces as json_pieces,
    null_for_nan as null_for_nan,
    write_json as write_json,
)
from .limits import (
    Angle as Angle,
    ForceCoefficient as ForceCoefficient,
    Frequency as Frequency,
    Height as Height,
    Seed as Seed,
)
from .plausible import refuse_tiny as refuse_tiny
from .schema import Placed as Placed, Schema as Schema, one_of as one_of, validate as validate
from .shipped_files import find_file as find_file, shipped as shipped
from .stored_schema import DIGITS as DIGITS, StoredSchema as StoredSchema, digest as digest
from .windio import Part as Part, WindIO as WindIO, windio as windio
from .yaml import (
    parse_yaml as parse_yaml,
    read_mapping as read_mapping,
    read_text as read_text,
    read_yaml as read_yaml,
    with_key as with_key,
)
