"""Methods side by side, and against pyOMA2."""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, ModalEstimate, identify, mac
from jackettwin.identification.comparison import Comparison, compare_methods, paired
from jackettwin.identification.subspace.ssi_cov import frequency_and_damping, order_poles
from jackettwin.identification.subspace.ssi_dat import ssi_dat
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Record

F, ZETA = np.array([0.5, 1.1, 1.9]), np.array([0.02, 0.015, 0.01])
SHAPES = np.array([[1.0, 0.6, 0.2], [-0.6, 0.8, 0.7], [0.4, -0.9, 1.0]])
RATE = 8.0


@pytest.fixture(scope="module")
def record() -> Record:
    system = ModalSystem(F, ZETA, SHAPES, np.diag(F**-2.0))
    return simulate(system, np.random.default_rng(2), duration_s=1200.0, sample_rate_hz=RATE)


@pytest.fixture(scope="module")
def compared(record: Record) -> Comparison:
    settings = IdentificationSettings(lowest_frequency_hz=0.3, highest_frequency_hz=3.0, refine=False)
    return compare_methods(record, identify(record, settings), settings)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """pyOMA2 warns, and writes bars to stderr."""
    with warnings.catch_warnings(), contextlib.redirect_stderr(io.StringIO()):
        warnings.simplefilter("ignore")
        yield


def test_well_separated_modes_are_the_same_by_every_method(compared: Comparison) -> None:
    assert list(compared.modes) == ["ssi-cov", "ssi-dat", "plscf", "efdd", "bayoma"]
    for method, modes in compared.modes.items():
        for k, mode in enumerate(modes):
            assert mode is not None, method
            assert mode.method == method
            # four standard deviations of the best possible estimate; EFDD's resolution adds damping
            limit = 1.0 / np.sqrt(2 * np.pi * ZETA[k] * F[k] * 1200.0)
            assert mode.frequency_hz == pytest.approx(F[k], rel=4 * ZETA[k] * limit)
            assert mode.damping_ratio == pytest.approx(ZETA[k], rel=(8 if method == "efdd" else 4) * limit)
            assert mac(mode.mode_shape, SHAPES[k]) > 0.99


def test_a_method_that_refuses_the_record_says_why(record: Record, compared: Comparison) -> None:
    data = record.data.copy()
    data[:, ::25] = np.nan
    gappy = compare_methods(replace(record, data=data), compared.reference)
    assert "too little for SSI-dat" in gappy.refused["ssi-dat"]
    assert "ssi-cov" in gappy.modes


def test_each_mode_is_given_once() -> None:
    def mode(f: float, *shape: float) -> ModalEstimate:
        return ModalEstimate(f, 0.01, np.array(shape, dtype=complex), 1.0, 0.0, 1.0)

    wanted = [mode(0.300, 1, 0), mode(0.303, 0, 1), mode(2.0, 1, 1)]
    found = [mode(0.3025, 1, 0), mode(0.3005, 0, 1)]
    assert paired(wanted, found) == (found[0], found[1], None)
    assert paired([], found) == ()


def test_ssi_dat_equals_pyoma2(record: Record) -> None:
    """The same projection, poles of order 12 at 20 block rows: f to 1e-7, ζ to 1e-6."""
    with quiet():
        ssi = pytest.importorskip("pyoma2.functions.ssi")
        y = record.data - record.data.mean(axis=1, keepdims=True)
        hankel, _ = ssi.build_hank(y, y, 20, "dat")
        observability, a, c, _ = ssi.SSI_fast(hankel, 20, 12, step=1)
        fn, xi, *_ = ssi.SSI_poles(observability, a, c, 12, 1.0 / RATE, xi_max=0.1)
    (poles,) = order_poles(ssi_dat(y, block_rows=20, max_order=12), [12])
    f, zeta = frequency_and_damping(poles.eigenvalues, RATE)
    for k in range(3):
        ours = int(np.argmin(np.abs(f - F[k]) / F[k] + np.abs(zeta - ZETA[k])))
        theirs = np.nanargmin(np.abs(fn[:, -1] - F[k]) / F[k] + np.abs(xi[:, -1] - ZETA[k]))
        assert f[ours] == pytest.approx(fn[theirs, -1], rel=1e-7)
        assert zeta[ours] == pytest.approx(xi[theirs, -1], rel=1e-6)


def test_plscf_and_efdd_have_the_frequencies_of_pyoma2(record: Record, compared: Comparison) -> None:
    """Other spectra, the same record: within 0.15 % for pLSCF and 1 % for EFDD.

    Damping is not compared: at these settings pyOMA2 1.4.3 leaves the damping of the exponential window in
    (5.6, 3.1, 2.1 %), and its EFDD has 3.5, 3.3, 3.0 % where the truth is 2, 1.5, 1 % (ours 2.6, 1.6, 1.3 %).
    """
    with quiet():
        fdd = pytest.importorskip("pyoma2.functions.fdd")
        plscf = pytest.importorskip("pyoma2.functions.plscf")
        y = record.data - record.data.mean(axis=1, keepdims=True)
        lines, s = fdd.SD_est(y, y, 1.0 / RATE, 1024, method="per")
        efdd_f, *_ = fdd.EFDD_mpe(s, lines, 1.0 / RATE, list(F), "per", method="EFDD", DF2=0.3)
        _, s = fdd.SD_est(y, y, 1.0 / RATE, 512, method="cor")
        fitted = plscf.pLSCF(s, 1.0 / RATE, 10, sgn_basf=1)
        plscf_f = plscf.pLSCF_poles(*fitted, 1.0 / RATE, "cor", 512)[0][:, -1]
    for k in range(3):
        ours = compared.modes["plscf"][k]
        assert ours is not None
        assert np.nanmin(np.abs(plscf_f / ours.frequency_hz - 1.0)) < 1.5e-3
        ours = compared.modes["efdd"][k]
        assert ours is not None
        assert ours.frequency_hz == pytest.approx(efdd_f.ravel()[k], rel=0.01)
