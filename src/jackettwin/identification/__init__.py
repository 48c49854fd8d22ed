"""Records to modes: operational modal analysis with honest uncertainty."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.identification.automatic import identify as identify
    from jackettwin.identification.estimate import (
        Identification as Identification,
        ModalEstimate as ModalEstimate,
        RealPole as RealPole,
        Rejected as Rejected,
        Spectrum as Spectrum,
        Stabilisation as Stabilisation,
    )
    from jackettwin.identification.frequency_domain.fdd import fdd as fdd
    from jackettwin.identification.mac import mac as mac
    from jackettwin.identification.many_records.fusion import (
        FusedIdentification as FusedIdentification,
        FusedMode as FusedMode,
        fuse as fuse,
    )
    from jackettwin.identification.settings import IdentificationSettings as IdentificationSettings
    from jackettwin.identification.subspace.ssi_cov import ssi_cov as ssi_cov

door(__name__)
