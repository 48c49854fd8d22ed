from .processing.filters import remove_line as remove_line
from .processing.merge import merge as merge, shared_channels as shared_channels
from .processing.prepare import bandpass as bandpass, decimate as decimate, detrend as detrend
from .processing.spectra import spectral_matrix as spectral_matrix, welch_densities as welch_densities
from .processing.yaw import to_global_axes as to_global_axes, to_rotor_axes as to_rotor_axes
from .quality.record_quality import assess as assess
from .quality.repair import repair as repair
from .readers import read_record as read_record, write_record as write_record
from .readers.delimited import MISSING as MISSING, text_table as text_table
from .readers.registry import Format as Format
from .readers.table import ReadTable as ReadTable
from .record import Channel as Channel, Record as Record
