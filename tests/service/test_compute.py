"""Workers: there are as many as were asked for, whatever becomes of them."""

import os
import time
from pathlib import Path

from jackettwin.service import ServiceSettings
from jackettwin.service.compute import Compute


def test_a_worker_that_was_given_up_is_replaced(tmp_path: Path) -> None:
    """As after a kill while it was starting, which Dask does not mend."""
    compute = Compute(ServiceSettings(tmp_path, workers=1))
    try:
        before = compute.submit(os.getpid).result(timeout=60)
        (nanny,) = compute._cluster.workers.values()  # type: ignore[union-attr]
        compute._cluster.sync(nanny.close)  # type: ignore[union-attr]
        end = time.monotonic() + 60.0
        while not compute.workers and time.monotonic() < end:
            compute.mend()
            time.sleep(0.2)
        assert compute.submit(os.getpid).result(timeout=60) != before
        assert compute.workers == 1
    finally:
        compute.close()
