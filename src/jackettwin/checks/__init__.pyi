from .calculation_sheet import (
    SheetLine as SheetLine,
    calculation_sheet as calculation_sheet,
    joint_sheet as joint_sheet,
)
from .columns import StraightRun as StraightRun, columns as columns
from .grouted_joints import (
    GroutedConnection as GroutedConnection,
    GroutUse as GroutUse,
    grout_uses as grout_uses,
    read_grouted as read_grouted,
)
from .iso19902 import EDITIONS as EDITIONS
from .iso19902_joints import IN_PLANE as IN_PLANE, KINDS as KINDS
from .joint_check import (
    BraceUse as BraceUse,
    JointPlan as JointPlan,
    brace_forces as brace_forces,
    joint_plans as joint_plans,
    joint_shares as joint_shares,
)
from .member_check import (
    ALL_CHECKS as ALL_CHECKS,
    DesignBasis as DesignBasis,
    FrameUse as FrameUse,
    MemberUse as MemberUse,
    frame_use as frame_use,
)
from .scope import left_out as left_out
from .vortices import CLAUSES as CLAUSES, VortexUse as VortexUse, vortex_uses as vortex_uses
