"""Records to modes: operational modal analysis with honest uncertainty."""

from jackettwin.identification.automatic import identify
from jackettwin.identification.estimate import (
    Identification,
    ModalEstimate,
    RealPole,
    Rejected,
    Spectrum,
    Stabilisation,
)
from jackettwin.identification.frequency_domain.fdd import fdd
from jackettwin.identification.mac import mac
from jackettwin.identification.many_records.fusion import FusedIdentification, FusedMode, fuse
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.subspace.ssi_cov import ssi_cov

__all__ = [
    "FusedIdentification",
    "FusedMode",
    "Identification",
    "IdentificationSettings",
    "ModalEstimate",
    "RealPole",
    "Rejected",
    "Spectrum",
    "Stabilisation",
    "fdd",
    "fuse",
    "identify",
    "mac",
    "ssi_cov",
]
