from .atomic import atomic_folder as atomic_folder, atomic_path as atomic_path
from .disk_space import check_room as check_room
from .json import Streamed as Streamed, json_pieces as json_pieces, write_json as write_json
from .schema import Placed as Placed, Schema as Schema, one_of as one_of, validate as validate
from .shipped import find_file as find_file, shipped as shipped
from .yaml import read_mapping as read_mapping, read_yaml as read_yaml
