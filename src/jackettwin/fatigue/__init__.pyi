from .basis import basis_page as basis_page, design_basis as design_basis
from .curves import (
    ENVIRONMENTS as ENVIRONMENTS,
    Environment as Environment,
    SNCurve as SNCurve,
    read_curve as read_curve,
    shipped_editions as shipped_editions,
)
from .cycles import Counter as Counter, Cycles as Cycles, count as count, equivalent_range as equivalent_range
from .efthymiou import (
    BraceTube as BraceTube,
    ConcentrationFactors as ConcentrationFactors,
    JointClass as JointClass,
    TubularJoint as TubularJoint,
    concentration as concentration,
    factors_document as factors_document,
    read_joint as read_joint,
)
from .environment import models_at_height as models_at_height
from .hot_spots import POSITIONS as POSITIONS, SIDES as SIDES, hot_spot_matrix as hot_spot_matrix
from .joint_life import HotSpot as HotSpot, JointStresses as JointStresses, joint_stresses as joint_stresses
from .life import LifeModel as LifeModel, SpotLife as SpotLife
from .remaining_life import RemainingLife as RemainingLife
from .spectral import dirlik as dirlik, tovo_benasciutti as tovo_benasciutti
from .strain import (
    STEEL_E_PA as STEEL_E_PA,
    STEEL_NU as STEEL_NU,
    SteadyStrain as SteadyStrain,
    rosette_stress as rosette_stress,
    steady_strain as steady_strain,
)
from .tube_life import TubeLife as TubeLife, read_details as read_details, tube_lives as tube_lives
from .tube_welds import (
    TUBE_POSITIONS as TUBE_POSITIONS,
    TubeDetails as TubeDetails,
    TubeWeld as TubeWeld,
    butt_weld_factor as butt_weld_factor,
    tube_welds as tube_welds,
)
from .weld_life import ModelsAtHeight as ModelsAtHeight, WeldLife as WeldLife, weld_lives as weld_lives
