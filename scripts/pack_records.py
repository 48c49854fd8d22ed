"""Write the records that are shipped as second differences, a fifth smaller, and check that no bit is lost.

Usage: ``python scripts/pack_records.py RECORD.parquet…``; records of single precision only, packed in place.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from jackettwin.records.readers.parquet import ENCODING, MAGNITUDE, restored


def differences(values: npt.NDArray[np.float32]) -> npt.NDArray[np.int32]:
    """Return second differences of single-precision numbers as whole numbers, from which each bit comes back.

    The bits of a positive float are a whole number that grows with it; those of a negative one are mirrored.
    Differences are taken modulo 2³², and written with their sign in the lowest bit, so that their high bytes
    are zeros, which compress well.

    Examples
    --------
    >>> x = np.array([0.5, 0.25, -0.125, 0.0, np.nan], np.float32)
    >>> bool((restored(differences(x)).view(np.int32) == x.view(np.int32)).all())
    True
    """
    bits = values.view(np.int32)
    ordered = np.where(bits < 0, bits ^ MAGNITUDE, bits).view(np.uint32)
    second = np.diff(ordered, n=2, prepend=np.zeros(2, np.uint32)).view(np.int32)
    return (second << 1) ^ (second >> 31)


def pack(path: Path) -> None:
    """Replace a Parquet file of float32 columns by the file of their differences."""
    table = pq.read_table(path)
    columns = {name: table.column(name).to_numpy() for name in table.column_names}
    packed = {name: differences(values) for name, values in columns.items()}
    for name, values in columns.items():
        assert np.array_equal(restored(packed[name]).view(np.int32), values.view(np.int32)), name
    pq.write_table(
        pa.table(packed).replace_schema_metadata({ENCODING: b"1"}),
        path,
        compression="brotli",
        compression_level=11,
        use_dictionary=False,
        write_statistics=False,
        column_encoding=dict.fromkeys(packed, "BYTE_STREAM_SPLIT"),
    )


if __name__ == "__main__":
    for name in sys.argv[1:]:
        pack(Path(name))
