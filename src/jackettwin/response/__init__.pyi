from .condensation.condensed import (
    Condensed as Condensed,
    condense as condense,
    strongest_beta as strongest_beta,
    widest_band_hz as widest_band_hz,
)
from .condensation.newton import law_response as law_response
from .condensation.numbered_modes import (
    NumberedModes as NumberedModes,
    Points as Points,
    numbered_poles as numbered_poles,
)
from .condensation.relaxation import Relaxation as Relaxation, nearest_relaxation as nearest_relaxation
from .modes.comparison import (
    ModeComparison as ModeComparison,
    compare_modes as compare_modes,
    expanded as expanded,
    nodal_modes as nodal_modes,
)
from .modes.direction import principal_direction as principal_direction
from .modes.labels import (
    LOCAL as LOCAL,
    mode_kinds as mode_kinds,
    mode_labels as mode_labels,
    read_mode_label as read_mode_label,
)
from .modes.modal import (
    DampedModes as DampedModes,
    UndampedModes as UndampedModes,
    damped_modes as damped_modes,
    undamped_modes as undamped_modes,
)
from .modes.modal_damping import modal_damping as modal_damping
from .modes.multiple import aligned as aligned, aligned_coordinates as aligned_coordinates
from .modes.on_springs import OnSprings as OnSprings
from .modes.own_damping import own_damping as own_damping
from .modes.poles import damping_ratio as damping_ratio
from .modes.tracking import near_degenerate as near_degenerate, track_modes as track_modes
from .motion.passage import Passage as Passage, wave_passage as wave_passage
from .motion.playback import Playback as Playback, playback as playback, record_sensors as record_sensors
from .motion.static import (
    beyond_basis as beyond_basis,
    nodal_load as nodal_load,
    self_weight as self_weight,
    static_displacement as static_displacement,
)
from .motion.tide import tide_slopes as tide_slopes
from .motion.time import (
    Feedback as Feedback,
    Hold as Hold,
    StateSpace as StateSpace,
    first_order_hold as first_order_hold,
    free_decay as free_decay,
    march as march,
    march_with_feedback as march_with_feedback,
    periodic_start as periodic_start,
    state_space as state_space,
)
from .reduction import Reduced as Reduced, reduced as reduced
from .sdof import (
    FreeVibration as FreeVibration,
    free_vibration as free_vibration,
    poles as poles,
    sdof as sdof,
)
from .sensors import (
    SENSOR_KINDS as SENSOR_KINDS,
    Sensor as Sensor,
    SensorKind as SensorKind,
    observation_matrix as observation_matrix,
    sees as sees,
    sensor_kinds as sensor_kinds,
    sensor_positions as sensor_positions,
)
from .state import maxwell_branches as maxwell_branches, state_matrix as state_matrix
from .state_model import (
    StateModel as StateModel,
    state_model as state_model,
    write_state_model as write_state_model,
)
from .superelement.accuracy import (
    ReducedModes as ReducedModes,
    default_band_hz as default_band_hz,
    hertz as hertz,
    reduced_modes as reduced_modes,
)
from .superelement.craig_bampton import (
    INTERFACE as INTERFACE,
    RUNGE_KUTTA as RUNGE_KUTTA,
    Superelement as Superelement,
    fixed_interface_frequencies as fixed_interface_frequencies,
    held_displacement as held_displacement,
    slowed as slowed,
    with_deck_damping as with_deck_damping,
)
from .superelement.extptfm_writer import DEFAULT as DEFAULT, LAYOUTS as LAYOUTS, Layout as Layout
from .superelement.files import (
    is_superelement as is_superelement,
    read_superelement as read_superelement,
    require_format as require_format,
    write_superelement as write_superelement,
)
from .system import (
    Group as Group,
    Matrix as Matrix,
    System as System,
    build_system as build_system,
    with_inner_piles as with_inner_piles,
)
