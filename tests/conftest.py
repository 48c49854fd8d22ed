from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from typing import Any

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")  # before NumPy: two BLAS threads make small matrices ten times slower

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

# by the clock a loaded machine fails what a free one passes
settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any machine")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # a run in the background ignores Ctrl-C, and so would every program that a test starts and interrupts
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Leave the user's cache alone, and start with an empty one."""
    before = os.environ.get("XDG_CACHE_HOME")
    os.environ["XDG_CACHE_HOME"] = str(tmp_path_factory.mktemp("cache"))
    yield
    if before is None:
        del os.environ["XDG_CACHE_HOME"]
    else:
        os.environ["XDG_CACHE_HOME"] = before


@pytest.fixture(scope="session", autouse=True)
def each_identification_is_computed_once() -> Iterator[None]:
    """Scores of tests examine the same few shipped records: what keeps nothing on disk is remembered here."""
    from jackettwin.files import NOT_KEPT
    from jackettwin.identification import examination

    computed: dict[str, Any] = {}
    whole = examination.kept

    def remembered(keep: Any, schema: Any, key: str, compute: Callable[[], Any]) -> Any:
        if keep is not NOT_KEPT:
            return whole(keep, schema, key, compute)
        if key not in computed:
            if len(computed) >= 24:
                del computed[next(iter(computed))]
            computed[key] = compute()
        return computed[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(examination, "kept", remembered)
        yield


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20250117)


@pytest.fixture(scope="session")
def postgresql_url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """URL of a PostgreSQL of Debian's packages; skips the test where there is none."""
    from tests.service.servers import postgresql

    with postgresql(tmp_path_factory.mktemp("postgresql")) as url:
        yield url
