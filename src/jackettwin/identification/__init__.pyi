from .automatic import identify as identify
from .estimate import (
    Identification as Identification,
    ModalEstimate as ModalEstimate,
    RealPole as RealPole,
    Rejected as Rejected,
    Spectrum as Spectrum,
    Stabilisation as Stabilisation,
)
from .frequency_domain.fdd import fdd as fdd
from .many_records.fusion import (
    FusedIdentification as FusedIdentification,
    FusedMode as FusedMode,
    fuse as fuse,
)
from .mode_shapes import mac as mac
from .pole_methods import PoleMethod as PoleMethod
from .preparation.prepared import Prepared as Prepared
from .settings import IdentificationSettings as IdentificationSettings
from .subspace.ssi_cov import OrderPoles as OrderPoles, ssi_cov as ssi_cov
