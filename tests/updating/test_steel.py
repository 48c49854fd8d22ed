"""Staged refinement of the steel (thesis section 5.4)."""

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.updating.steel import Factor, fit_steel, only_parts


def test_planted_factors_come_back() -> None:
    structure = read_structure("jacket15")
    planted = structure.with_material("tower", youngs_modulus=1.1).with_material("jacket", density=0.8)
    factors = (Factor("tower", "youngs_modulus"), Factor("jacket", "density"))
    truth = fit_steel(planted, (Factor("tower", "density"),), {1: 0.19}).before_hz
    # the frequencies of the planted structure are the targets
    target = dict(zip((1, 2, 3, 4, 5), _frequencies(planted), strict=True))
    assert truth[0] == pytest.approx(target[1])
    fit = fit_steel(structure, factors, target)
    assert fit.factors["tower.youngs_modulus"] == pytest.approx(1.1, rel=1e-5)
    assert fit.factors["jacket.density"] == pytest.approx(0.8, rel=1e-5)
    np.testing.assert_allclose(fit.after_hz, fit.target_hz, rtol=1e-7)


def test_the_jacket_alone_meets_the_first_pair_of_table_5_2() -> None:
    jacket = only_parts(read_structure("jacket15"), ("jacket",))
    fit = fit_steel(jacket, (Factor("jacket", "density"),), {1: 0.901, 2: 0.901})
    assert np.abs(fit.after_hz / fit.target_hz - 1).max() < np.abs(fit.before_hz / fit.target_hz - 1).max()


def test_more_factors_than_frequencies() -> None:
    with pytest.raises(InputError, match="more factors than frequencies"):
        fit_steel(
            read_structure("jacket15"), (Factor("tower", "density"), Factor("jacket", "density")), {1: 0.18}
        )


def test_unknown_part() -> None:
    with pytest.raises(InputError, match="no such part .got 'monopile'"):
        only_parts(read_structure("jacket15"), ("monopile",))


def _frequencies(structure) -> np.ndarray:
    from jackettwin.structure import assemble
    from jackettwin.updating import numbered_modes

    return numbered_modes(assemble(structure), 5).frequency_hz
