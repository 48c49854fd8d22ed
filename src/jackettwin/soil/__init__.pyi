from .files import (
    named_foundation as named_foundation,
    parse_law as parse_law,
    read_family as read_family,
    read_law as read_law,
    read_support as read_support,
    read_supported as read_supported,
)
from .foundation import (
    Foundation as Foundation,
    PileModel as PileModel,
    read_foundation as read_foundation,
)
from .ground.curves import Curve as Curve
from .ground.profile import Clay as Clay, Layer as Layer, Point as Point, Sand as Sand, Scour as Scour
from .laws.coefficients import (
    BRANCHES as BRANCHES,
    K0 as K0,
    K_ALPHA as K_ALPHA,
    MASS as MASS,
    OMEGA0 as OMEGA0,
    C as C,
    law_slope as law_slope,
    law_stiffness as law_stiffness,
    static_rows as static_rows,
)
from .laws.curves import LawCurves as LawCurves, law_curves as law_curves
from .laws.families import (
    ABSENT as ABSENT,
    DEFAULT_LAWS as DEFAULT_LAWS,
    SERIES as SERIES,
    Family as Family,
    families as families,
    family as family,
    law_parameter as law_parameter,
    members as members,
    parameter_words as parameter_words,
)
from .laws.parameter import Parameter as Parameter
from .laws.viscoelastic import (
    Law as Law,
    Prony as Prony,
    Springpot as Springpot,
    one_branch as one_branch,
    prony_fit as prony_fit,
)
from .mudline import (
    MUDLINE as MUDLINE,
    MUDLINE_PATTERNS as MUDLINE_PATTERNS,
    MUDLINE_SUFFIXES as MUDLINE_SUFFIXES,
    moved_to_mudline as moved_to_mudline,
    mudline_exponents as mudline_exponents,
    mudline_parameters as mudline_parameters,
    on_mudline as on_mudline,
    sway_and_rocking as sway_and_rocking,
    tied_at_mudline as tied_at_mudline,
)
from .piles.pile_use import PileUse as PileUse, head_forces as head_forces, pile_use as pile_use
from .piles.piles import Pile as Pile, linear_springs as linear_springs
from .piles.radiation import Radiation as Radiation
from .piles.soil_curves import (
    CurveOptions as CurveOptions,
    SoilCurve as SoilCurve,
    soil_curves as soil_curves,
)
from .support import (
    Spring as Spring,
    Support as Support,
    clamped as clamped,
    feet_in_line as feet_in_line,
    held_where_sprung as held_where_sprung,
    on_translations as on_translations,
    own_support as own_support,
    pinned as pinned,
    standing as standing,
    with_static_reactions as with_static_reactions,
)
