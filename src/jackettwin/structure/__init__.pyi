from .assemble import Assembly as Assembly, assemble as assemble
from .blades import BladeModes as BladeModes, BladeStructure as BladeStructure, blade_modes as blade_modes
from .check import (
    ModelCheck as ModelCheck,
    check as check,
    few as few,
    posture as posture,
    rigid_body_motion as rigid_body_motion,
)
from .cut import at_interface as at_interface
from .damping import Rayleigh as Rayleigh, RayleighSchema as RayleighSchema
from .eigen import (
    AT_REST as AT_REST,
    below_zero as below_zero,
    definite_factor as definite_factor,
    dense as dense,
    lowest_modes as lowest_modes,
    refined_modes as refined_modes,
)
from .forces import (
    SectionForces as SectionForces,
    element_weight as element_weight,
    section_forces as section_forces,
    tube_radius as tube_radius,
    von_mises_stress as von_mises_stress,
)
from .jacket import jacket as jacket
from .masses import (
    body_from_static_moments as body_from_static_moments,
    cross_matrix as cross_matrix,
    rigid_body_mass as rigid_body_mass,
    rigid_transfer as rigid_transfer,
)
from .model import (
    PILES as PILES,
    STEEL as STEEL,
    Beam as Beam,
    Material as Material,
    Member as Member,
    PointMass as PointMass,
    Reaction as Reaction,
    RigidLink as RigidLink,
    Section as Section,
    Structure as Structure,
    Vector as Vector,
)
from .property_change import (
    GROWTH_KG_M3 as GROWTH_KG_M3,
    PROPERTIES as PROPERTIES,
    adjusted as adjusted,
    foot_stiffness as foot_stiffness,
)
from .rotor_modes import (
    FlexibleRotor as FlexibleRotor,
    turned_nacelle as turned_nacelle,
    with_rotor as with_rotor,
    without_rotor as without_rotor,
)
from .sections import i_section as i_section, rectangular_section as rectangular_section
from .two_node import (
    BeamSection as BeamSection,
    TwoNodeElement as TwoNodeElement,
    spring_matrix as spring_matrix,
    two_node_element as two_node_element,
)
