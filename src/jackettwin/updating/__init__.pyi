from .band import numbered_modes as numbered_modes
from .budget import SOURCES as SOURCES, beyond_literature as beyond_literature
from .build import support_model as support_model
from .data.foot_stiffness import (
    STIFFEST_N_M as STIFFEST_N_M,
    Feet as Feet,
    modes_by_foot_stiffness as modes_by_foot_stiffness,
)
from .data.misfit import misfit as misfit
from .data.pairing import (
    LEAST_MAC as LEAST_MAC,
    Counterpart as Counterpart,
    counterparts as counterparts,
    pair as pair,
    pairing_score as pairing_score,
    subspace_mac_nearby as subspace_mac_nearby,
)
from .data.relaxations import RelaxationTarget as RelaxationTarget
from .data.shapes import ProfileTarget as ProfileTarget, ShapeTarget as ShapeTarget
from .data.targets import Residuals as Residuals, Target as Target
from .drift import Drift as Drift, find_drift as find_drift
from .explore.cost import (
    CostCurve as CostCurve,
    CostSurface as CostSurface,
    cost_curve as cost_curve,
    cost_surface as cost_surface,
)
from .explore.locus import Locus as Locus, root_locus as root_locus
from .explore.paths import SearchPath as SearchPath, search_paths as search_paths
from .explore.sensitivity import ModeSensitivity as ModeSensitivity, sensitivity as sensitivity
from .joint import Growth as Growth, joint as joint, single as single
from .law_choice import (
    PREFERRED as PREFERRED,
    LawRank as LawRank,
    approximate_probability as approximate_probability,
    likely as likely,
    ranked as ranked,
    recommended as recommended,
    series as series,
)
from .model import SupportModel as SupportModel
from .model_error.checks import (
    DatumCheck as DatumCheck,
    Objection as Objection,
    UndetectedError as UndetectedError,
    objection as objection,
)
from .model_error.directions import (
    Direction as Direction,
    Tolerance as Tolerance,
    ToleranceDirections as ToleranceDirections,
    moved_along as moved_along,
    on_unlike_feet as on_unlike_feet,
    possible as possible,
)
from .model_error.error_model import ErrorModel as ErrorModel
from .model_error.influence import Influence as Influence, influences as influences
from .model_error.measured_axes import PairDirection as PairDirection
from .model_error.mode_checks import (
    CheckedShape as CheckedShape,
    OrderCheck as OrderCheck,
    ShapeCheck as ShapeCheck,
    order_checks as order_checks,
    shape_checks as shape_checks,
)
from .nuisance_parameters import (
    DASHPOTS as DASHPOTS,
    NuisanceParameter as NuisanceParameter,
    NuisanceParameters as NuisanceParameters,
    matrix_of as matrix_of,
)
from .posterior.identifiability import (
    USABLE as USABLE,
    contradicted as contradicted,
    information as information,
)
from .posterior.importance_sampling import weighted_draws as weighted_draws
from .posterior.laplace import laplace_draws as laplace_draws
from .posterior.scatter import leg_scatter as leg_scatter
from .posterior.smc import Posterior as Posterior
from .problem import Problem as Problem, State as State
from .refined_quantity import Factor as Factor
from .refinement import (
    Refinement as Refinement,
    RefinementStage as RefinementStage,
    fit_stage as fit_stage,
    refine as refine,
)
from .search.solutions import (
    MOST_EVALUATIONS as MOST_EVALUATIONS,
    SearchMethod as SearchMethod,
    starting_points as starting_points,
)
from .search.start_points import points_of as points_of
from .steel import Stage as Stage, only_parts as only_parts, stages as stages
from .tie_groups import SIDES as SIDES, SPLIT_LEGS as SPLIT_LEGS
from .update import (
    Fit as Fit,
    Uncertainty as Uncertainty,
    Update as Update,
    law_probability as law_probability,
    posterior_or_status as posterior_or_status,
    update as update,
    with_posterior as with_posterior,
)
