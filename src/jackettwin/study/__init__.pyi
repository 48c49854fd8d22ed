from .document import (
    ranking_document as ranking_document,
    run_document as run_document,
    series_sentence as series_sentence,
    update_document as update_document,
)
from .explore import (
    CostLandscape as CostLandscape,
    Exploration as Exploration,
    ExploreSettings as ExploreSettings,
    exploration_document as exploration_document,
    explore as explore,
    explore_model as explore_model,
    explore_update as explore_update,
    sensitivity_rows as sensitivity_rows,
)
from .follow import follow as follow, follow_days as follow_days
from .follow_result import (
    Followed as Followed,
    days_document as days_document,
    in_time_document as in_time_document,
)
from .life.asset_life import AssetLife as AssetLife, asset_life as asset_life
from .life.life_detail import (
    candidates as candidates,
    damage_by_band as damage_by_band,
    with_one_more as with_one_more,
)
from .life.life_so_far import LIFE_SO_FAR as LIFE_SO_FAR, LifeSoFar as LifeSoFar
from .life.record_life import (
    RecordLife as RecordLife,
    life_of_record as life_of_record,
    readings_and_weather as readings_and_weather,
    record_life as record_life,
)
from .life.site import Site as Site, read_site as read_site
from .life.site_life import SiteLife as SiteLife, SiteWeld as SiteWeld, site_life as site_life
from .life.updated_system import (
    updated as updated,
    updated_systems as updated_systems,
    with_record as with_record,
)
from .many_records.export import ALWAYS as ALWAYS, WRITERS as WRITERS, export_modes as export_modes
from .many_records.long_records import LONG as LONG, PIECE_S as PIECE_S
from .many_records.model_shapes import beside_model as beside_model
from .measurements import MeasuredMode as MeasuredMode, sensors_of as sensors_of
from .modes_in_time import MODES_IN_TIME as MODES_IN_TIME, write_modes_in_time as write_modes_in_time
from .result import DampingExcess as DampingExcess, TwinResult as TwinResult
from .run import count_steps as count_steps, run_twin as run_twin
from .scrutiny import Condition as Condition, Scrutiny as Scrutiny
from .truth import true_parameters as true_parameters
