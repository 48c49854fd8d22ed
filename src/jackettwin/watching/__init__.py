"""Watching: has a structure changed, since when, by how much and why; of any structure, on arrays."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.watching.causes import (
        Cause as Cause,
        general_causes as general_causes,
        sizes_about as sizes_about,
        sensor_noise as sensor_noise,
    )
    from jackettwin.watching.diagnosis import (
        Diagnosis as Diagnosis,
        CauseVerdict as CauseVerdict,
        diagnose as diagnose,
    )
    from jackettwin.watching.design import Slope as Slope
    from jackettwin.watching.directions import Pattern as Pattern
    from jackettwin.watching.history import History as History
    from jackettwin.watching.next_look import expected_information as expected_information
    from jackettwin.watching.watch import (
        Change as Change,
        Look as Look,
        Watch as Watch,
        start as start,
        step as step,
    )

door(__name__)
