from .clocks.another_time import channel_axes as channel_axes, comparable_channels as comparable_channels
from .conditions import with_conditions as with_conditions
from .processing.merge import merge as merge, shared_channels as shared_channels
from .processing.prepare import bandpass as bandpass, decimate as decimate, detrend as detrend
from .processing.spectra import (
    spectral_matrix as spectral_matrix,
    spectral_values as spectral_values,
    welch_densities as welch_densities,
)
from .processing.tones import knows_rotor_speed as knows_rotor_speed, less_phase as less_phase
from .processing.yaw import (
    knows_yaw as knows_yaw,
    to_global_axes as to_global_axes,
    to_rotor_axes as to_rotor_axes,
)
from .quality.record_quality import assess as assess
from .quality.repair import repair as repair
from .readers import (
    read_record as read_record,
    read_record_pieces as read_record_pieces,
    record_files as record_files,
    write_record as write_record,
)
from .readers.bladed import read_output as read_output
from .readers.channels import FileDefaults as FileDefaults
from .readers.delimited import MISSING as MISSING, text_table as text_table
from .readers.registry import Format as Format, read_table as read_table
from .readers.stamps import day_zero as day_zero, parse_time as parse_time, read_zone as read_zone
from .readers.table import ReadTable as ReadTable
from .record import (
    Channel as Channel,
    Record as Record,
    record_content as record_content,
    record_id as record_id,
)
