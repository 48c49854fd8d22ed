from .automatic import identify as identify
from .comparison import Comparison as Comparison
from .decays.relaxations import (
    ReleaseRelaxations as ReleaseRelaxations,
    release_relaxations as release_relaxations,
)
from .document import (
    channels_document as channels_document,
    identification_document as identification_document,
    limits_document as limits_document,
)
from .estimate import (
    Identification as Identification,
    ModalEstimate as ModalEstimate,
    RealPole as RealPole,
    Rejected as Rejected,
    ResolvedSettings as ResolvedSettings,
    Spectrum as Spectrum,
    Stabilisation as Stabilisation,
)
from .examination import Examination as Examination, examine as examine, examine_file as examine_file
from .frequency_domain.fdd import fdd as fdd
from .many_records.convergence import convergence as convergence
from .many_records.fusion import (
    FusedIdentification as FusedIdentification,
    FusedMode as FusedMode,
    fuse as fuse,
    fused_records as fused_records,
)
from .maximum_likelihood.spectral_fit import modal_fit as modal_fit
from .methods import method_names as method_names
from .mode_shapes import mac as mac
from .picks import Pick as Pick, parse_picks as parse_picks, refuse_strangers as refuse_strangers
from .pole_methods import PoleMethod as PoleMethod
from .preger import identify_setups as identify_setups, preger_document as preger_document
from .preparation.prepared_record import PreparedRecord as PreparedRecord
from .record_steps import moving_channels as moving_channels
from .relaxation_limits import AmbientLimits as AmbientLimits, ambient_limits as ambient_limits
from .settings import IdentificationSettings as IdentificationSettings
from .subspace.ssi_cov import OrderPoles as OrderPoles, ssi_cov as ssi_cov
