"""The living model: the main job, from a twin file to a result."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.twin.advance import advance as advance, advance_all as advance_all
    from jackettwin.twin.config import TwinConfig as TwinConfig
    from jackettwin.twin.document import (
        observation_document as observation_document,
        run_document as run_document,
        update_document as update_document,
    )
    from jackettwin.twin.examine import (
        Examination as Examination,
        examine as examine,
        examine_file as examine_file,
    )
    from jackettwin.twin.files import read_twin as read_twin, shipped_twins as shipped_twins
    from jackettwin.twin.judge import (
        JUDGED as JUDGED,
        Days as Days,
        Judged as Judged,
        finding_of as finding_of,
        judge as judge,
    )
    from jackettwin.twin.model import TwinModel as TwinModel, twin_model as twin_model
    from jackettwin.twin.observation import OBSERVATION as OBSERVATION, Observation as Observation
    from jackettwin.twin.observe import observe as observe
    from jackettwin.twin.result import DampingExcess as DampingExcess, TwinResult as TwinResult
    from jackettwin.twin.run import count_steps as count_steps, run_twin as run_twin
    from jackettwin.twin.state import STATE as STATE, TwinState as TwinState, empty_state as empty_state

door(__name__)
