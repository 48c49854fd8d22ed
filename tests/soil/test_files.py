"""Supports as users write them."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.decks import read_structure
from jackettwin.errors import InputError
from jackettwin.soil import Support, pinned, read_support
from jackettwin.soil.laws.viscoelastic import Prony, Springpot, kelvin_voigt, maxwell_3, zener

STRUCTURE = read_structure("jacket15")


def read(text: str | Path | None, folder: Path | None = None) -> Support:
    return read_support(text, STRUCTURE, first_frequency_hz=lambda: 0.18, folder=folder)


@pytest.mark.parametrize(
    ("text", "law"),
    [
        ("kelvin-voigt:k=2.5e9,c=7.6e8", kelvin_voigt(2.5e9, 7.6e8)),
        ("zener:k0=2.62e9,c=8.65e8,k1=9.99e9", zener(2.62e9, 8.65e8, 9.99e9)),
        ("maxwell:k0=1e9,branches=2e8/0.5;3e8/2", Prony(1e9, 0.0, (2e8, 3e8), (0.5, 2.0))),
        ("springpot:k=1e9,alpha=0.06,f0=0.2", Springpot(1e9, 0.06, 2 * np.pi * 0.2)),
        ("springpot:k=1e9,alpha=0.06", Springpot(1e9, 0.06, 2 * np.pi * 0.18)),
        ("maxwell-3:k=1e9,loss_factor=0.1", maxwell_3(1e9, 0.1, 0.18)),
        ("elastic:k=1e9", Prony(1e9)),
    ],
)
def test_short_forms(text: str, law) -> None:
    support = read(text)
    assert [spring.law for spring in support.springs] == [law] * 4
    assert not support.fixed


def test_the_first_frequency_is_asked_for_only_if_needed() -> None:
    def never() -> float:
        raise AssertionError

    read_support("kelvin-voigt:k=1,c=1", STRUCTURE, first_frequency_hz=never)
    read_support("springpot:k=1,alpha=.1,f0=1", STRUCTURE, first_frequency_hz=never)


def test_no_support_is_the_structure_s_own() -> None:
    assert read(None) == read("pinned") == pinned(STRUCTURE)


FILE = """
supports:
  - nodes: reaction
    stiffness: [1e8, 2e8, 3e8]
    law: {type: kelvin-voigt, tau_s: 0.02}
  - nodes: [foot_1, foot_2]
    stiffness: [1e8, 1e8, 1e9, 1e10, 1e10, 1e9]
    law: {type: maxwell, g0: 0.8, branches: [{g: 0.4, tau_s: 0.1}]}
  - nodes: [foot_3]
    stiffness: [[3e8,0,0,0,-1e9,0], [0,3e8,0,1e9,0,0], [0,0,1e9,0,0,0],
                [0,1e9,0,1e10,0,0], [-1e9,0,0,0,1e10,0], [0,0,0,0,0,1e9]]
    law: {type: springpot, alpha: 0.06, omega0_rad_s: 1.14}
"""


def test_support_file(tmp_path: Path) -> None:
    (tmp_path / "soil.yaml").write_text(FILE)
    support = read("soil.yaml", tmp_path)
    assert len(support.springs) == 4 + 2 + 1
    np.testing.assert_array_equal(np.diag(support.springs[0].matrix), [1e8, 2e8, 3e8, 0, 0, 0])
    # K·(1 + τs), K·(g0 + g τs/(1+τs)), K·(s/ω0)^α at s = 2i
    s = 2j
    laws = [complex(support.springs[i].law.stiffness(s)) for i in (0, 4, 6)]
    assert laws == pytest.approx([1 + 0.02 * s, 0.8 + 0.4 * 0.1 * s / (1 + 0.1 * s), (s / 1.14) ** 0.06])
    assert support.springs[6].matrix[0, 4] == -1e9


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "kelvin-vogt:k=1,c=1",
            "unknown support or law .*did you mean 'kelvin-voigt'",
        ),
        ("piles", "unknown support or law"),
        ("", "unknown support or law"),
        ("kelvin-voigt:k=1", "support.kelvin-voigt.c: argument is missing"),
        ("kelvin-voigt:k=1,c=1,d=2", "unknown argument .got 'd=2'."),
        ("kelvin-voigt:k=1,c=1,k=2", "given twice"),
        ("kelvin-voigt:k=abc,c=1", "not a finite number .got 'abc'."),
        ("kelvin-voigt:k=nan,c=1", "not a finite number .got 'nan'."),
        ("kelvin-voigt:k=1e999,c=1", "not a finite number"),
        ("kelvin-voigt:k=1e300,c=1", "support.kelvin-voigt.k: .*1e.300"),
        ("kelvin-voigt:k=-1,c=1", "support.kelvin-voigt.k: .*got -1"),
        ("zener:k0=1,c=1,k1=0", "must be positive"),
        ("maxwell:k0=1,branches=", "branches are pairs"),
        ("maxwell:k0=1,branches=1;2", "branches are pairs"),
        ("maxwell:k0=1,branches=1/0", "must be positive"),
        ("springpot:k=1,alpha=1.5", "exponent out of range .got 1.5."),
        ("springpot:k=1,alpha=.1,f0=0", "f0: must be positive"),
        ("maxwell-3:k=1,loss_factor=2", "loss factor out of range .got 2.0."),
        ("gone.yaml", "no such support file"),
    ],
)
def test_bad_short_forms_are_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(text)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("kelvin-voigt", "kelvin-vogt", "soil.yaml: supports.0.law.*kelvin-vogt"),
        ("tau_s: 0.02", "tau_s: -0.02", "soil.yaml: supports.0.law.*tau_s.*-0.02"),
        (
            "tau_s: 0.02",
            "tau: 0.02",
            "supports.0.law.*unknown key .got 'tau'.*did you mean 'tau_s'",
        ),
        ("[foot_1, foot_2]", "[foot_9]", "soil.yaml: supports.1.nodes: no such node .got 'foot_9'"),
        ("[1e8, 2e8, 3e8]", "[1e8, 2e8]", "soil.yaml: supports.0.stiffness: .*wrong shape"),
        (
            "[1e8, 2e8, 3e8]",
            "[1e8, 2e8, -3e8]",
            "supports.0.stiffness: stiffness gives energy out",
        ),
        ("[1e8, 2e8, 3e8]", "[1e8, 2e8, .nan]", "soil.yaml: supports.0.stiffness"),
        ("[1e8, 2e8, 3e8]", "[1e8, 2e8, soft]", "soil.yaml: supports.0.stiffness.*soft"),
        ("[3e8,0,0,0,-1e9,0]", "[3e8,0,0,0,-2e9,0]", "soil.yaml: supports.2.stiffness: .*not symmetric"),
        ("[3e8,0,0,0,-1e9,0]", "[3e8,0,0,0]", "soil.yaml: supports.2.stiffness: .*differ in length"),
        ("branches: [{g: 0.4, tau_s: 0.1}]", "branches: []", "supports.1.law.*branches"),
        ("alpha: 0.06", "alpha: 1.06", "supports.2.law.*alpha"),
        ("supports:", "support:", "unknown key .got 'support'.*did you mean 'supports'"),
    ],
)
def test_bad_support_files_are_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    (tmp_path / "soil.yaml").write_text(FILE.replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        read("soil.yaml", tmp_path)


def test_without_a_first_frequency_the_reference_must_be_stated() -> None:
    with pytest.raises(InputError, match="f0: reference frequency is missing; give f0"):
        read_support("springpot:k=1e9,alpha=0.06", STRUCTURE)
