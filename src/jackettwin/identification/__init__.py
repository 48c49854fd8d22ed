"""Records to modes: operational modal analysis with honest uncertainty."""

from jackettwin.identification.automatic import identify
from jackettwin.identification.estimate import (
    Identification,
    ModalEstimate,
    Rejected,
    Spectrum,
    Stabilisation,
)
from jackettwin.identification.fdd import fdd
from jackettwin.identification.fusion import FusedIdentification, FusedMode, fuse
from jackettwin.identification.mac import mac
from jackettwin.identification.settings import IdentificationSettings
from jackettwin.identification.ssi_cov import ssi_cov

__all__ = [
    "FusedIdentification",
    "FusedMode",
    "Identification",
    "IdentificationSettings",
    "ModalEstimate",
    "Rejected",
    "Spectrum",
    "Stabilisation",
    "fdd",
    "fuse",
    "identify",
    "mac",
    "ssi_cov",
]
