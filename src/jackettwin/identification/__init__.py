"""Records to modes: operational modal analysis with honest uncertainty."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
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

door(
    __name__,
    {
        "automatic": "identify",
        "estimate": "Identification ModalEstimate RealPole Rejected Spectrum Stabilisation",
        "frequency_domain.fdd": "fdd",
        "mac": "mac",
        "many_records.fusion": "FusedIdentification FusedMode fuse",
        "settings": "IdentificationSettings",
        "subspace.ssi_cov": "ssi_cov",
    },
)
