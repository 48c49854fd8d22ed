from .files import parse_law as parse_law, read_support as read_support
from .laws.families import DEFAULT_LAWS as DEFAULT_LAWS, family as family
from .laws.parameter import Parameter as Parameter
from .support import (
    Spring as Spring,
    Support as Support,
    clamped as clamped,
    on_translations as on_translations,
    own_support as own_support,
    pinned as pinned,
    with_static_reactions as with_static_reactions,
)
