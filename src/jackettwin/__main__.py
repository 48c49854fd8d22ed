"""Start the command line, here and as ``python -m jackettwin``."""

from __future__ import annotations

import os
import sys


def main() -> None:
    """Run a command on one BLAS thread: our matrices are small, and two threads are slower than one."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    try:
        from jackettwin.cli import main as command  # after the limits: NumPy reads them once
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        sys.exit(130)
    sys.exit(command())


if __name__ == "__main__":
    main()
