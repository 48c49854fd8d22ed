"""Support laws that can be updated: one class each, and their registry.

A law is a class with its parameters and their bounds, the law it builds, and its row of numbers with the
derivatives. It is entered in ``LAWS`` here, or by an installed package as an entry point. Updating, short
forms, twin files and the report find there all that they say of it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import product
from math import pi

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import look_up
from jackettwin.plugins import plugins_of_type
from jackettwin.soil.laws.coefficients import ALPHA, BRANCHES, K0, K_ALPHA, OMEGA0, C
from jackettwin.soil.laws.parameter import Parameter
from jackettwin.soil.laws.viscoelastic import (
    MAXWELL_3_BRANCHES,
    MAXWELL_3_TILT,
    MAXWELL_3_WEIGHTS,
    Law,
    Prony,
    Springpot,
    kelvin_voigt,
    maxwell_3,
    maxwell_3_scale,
    maxwell_3_times,
    zener,
)

# Bounds of the thesis, (8.6)–(8.10).
_K = (1e7, 1e14, "N/m")
_C = (1e4, 1e14, "N·s/m")
_APART = 2.0
"""Branches nearer than this factor in time cannot be told apart."""
ABSENT = 1e-10
"""Relative stiffness of a branch that is not there: a hundredth of the relative error of poles."""


class Family(ABC):
    """A law with free parameters.

    Attributes
    ----------
    name : str
        In files and on the command line.
    words : str
        What it is, for a reader who does not know the name.
    parameters : tuple of Parameter
        The first is its stiffness.
    needs_frequency : bool
        Whether stiffness and loss are stated at a reference frequency.
    relaxes : bool
        Whether a structure on it has real poles; a springpot's relaxation is a continuum.
    omissible : tuple of int
        Parameters that a part of the law vanishes with: the stiffness of each of several branches.
    """

    name: str
    words: str
    parameters: tuple[Parameter, ...]
    needs_frequency: bool = False
    relaxes: bool = True
    omissible: tuple[int, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its parameters."""
        return tuple(p.name for p in self.parameters)

    @abstractmethod
    def build(self, values: FloatArray, reference_hz: float) -> Law:
        """Return the law at values of its parameters, stated at ``reference_hz``.

        Raises
        ------
        InputError
            If a value is out of range.
        """

    @abstractmethod
    def rows(self, values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
        """Return the numbers of many laws at once, and their derivatives by ln θ.

        Parameters
        ----------
        values : (n, n_parameters)

        Returns
        -------
        (n, width) as in :mod:`jackettwin.soil.laws.coefficients`, and (n, width, n_parameters)
        """

    def priors(self, reference_hz: float) -> Mapping[str, tuple[float, float]]:
        """Return the lognormal priors that regularise it: median and standard deviation of ln θ by name.

        Laws whose parameters data of a few modes determine need none.
        """
        return {}

    def without(self, values: FloatArray, omitted: tuple[int, ...]) -> FloatArray:
        """Return the parameters (n_parameters,) of the law without some of its parts, those left first.

        Parameters
        ----------
        values : (n_parameters,)
        omitted : tuple of int
            Some of ``omissible``.
        """
        return values

    def between(self, start: FloatArray, end: FloatArray, shares: FloatArray) -> FloatArray:
        """Return laws on a way from one to another, (n, n_parameters), on which data hardly change.

        Parameters
        ----------
        start, end : (n_parameters,)
        shares : (n,) between 0 and 1
        """
        return np.asarray(start ** (1.0 - shares[:, None]) * end ** shares[:, None])

    def __reduce__(self) -> tuple[Callable[[str], Family], tuple[str]]:
        """A law crosses processes by its name: every process has the same laws."""
        return family, (self.name,)


class KelvinVoigt(Family):
    """D = k + c s, thesis (4.5)."""

    name = "kelvin-voigt"
    words = "a spring beside a dashpot"
    parameters = (Parameter("k", *_K, words="stiffness"), Parameter("c", *_C, words="dashpot"))

    def build(self, values: FloatArray, reference_hz: float) -> Law:
        """Return the law."""
        return kelvin_voigt(*map(float, values))

    def rows(self, values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
        """Return rows and slopes, as the base class says."""
        rows, slopes = _empty(values, branches=0)
        rows[:, K0], rows[:, C] = values.T
        slopes[:, K0, 0], slopes[:, C, 1] = values.T
        return rows, slopes


class Zener(Family):
    """D = k0 + k1 τ s/(1 + τ s) with τ = c/k1, thesis (4.7) and (7.5)."""

    name = "zener"
    words = "a spring beside a spring and dashpot in series"
    parameters = (
        Parameter("k0", *_K, words="static stiffness"),
        Parameter("c", *_C, words="dashpot"),
        Parameter("k1", *_K, words="stiffness of the damping branch"),
    )

    def build(self, values: FloatArray, reference_hz: float) -> Law:
        """Return the law."""
        return zener(*map(float, values))

    def rows(self, values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
        """Return rows and slopes, as the base class says."""
        rows, slopes = _empty(values, branches=1)
        k0, c, k1 = values.T
        tau = c / k1
        rows[:, K0], rows[:, BRANCHES], rows[:, BRANCHES + 1] = k0, k1, tau
        slopes[:, K0, 0], slopes[:, BRANCHES, 2] = k0, k1
        slopes[:, BRANCHES + 1, 1], slopes[:, BRANCHES + 1, 2] = tau, -tau
        return rows, slopes


class ThreeBranches(Family):
    """Three Maxwell branches of fixed shape beside a spring: a loss factor that frequency hardly changes."""

    name = "maxwell-3"
    words = "a loss factor that hardly depends on frequency, as soil's does"
    parameters = (
        Parameter("k", *_K, words="stiffness"),
        Parameter("loss_factor", 1e-4, 0.6, "-", words="loss factor"),
    )
    needs_frequency = True

    def build(self, values: FloatArray, reference_hz: float) -> Law:
        """Return the law."""
        return maxwell_3(float(values[0]), float(values[1]), reference_hz)

    def rows(self, values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
        """Return rows and slopes, as the base class says."""
        rows, slopes = _empty(values, branches=3)
        k, eta = values.T
        s, response, w = maxwell_3_scale(eta)
        # η times derivatives by η; those of the weights first
        dw = MAXWELL_3_TILT * np.multiply.outer(eta, np.arange(3.0))
        d_response = (w * dw) @ MAXWELL_3_BRANCHES
        ds = s * (1.0 - (d_response.imag - eta * (response.real + d_response.real)) * s / eta)
        # k0 = k/(1 + sR), k_j = s w_j k0
        shrink = 1.0 / (1.0 + s * response.real)
        dk0 = -(ds * response.real + s * d_response.real) * shrink
        k0 = k * shrink
        rows[:, K0] = k0
        rows[:, BRANCHES::2] = (s * k0)[:, None] * w
        rows[:, BRANCHES + 1 :: 2] = maxwell_3_times(reference_hz)
        slopes[:, K0, 0], slopes[:, BRANCHES::2, 0] = k0, rows[:, BRANCHES::2]
        slopes[:, K0, 1] = k0 * dk0
        slopes[:, BRANCHES::2, 1] = rows[:, BRANCHES::2] * ((ds / s + dk0)[:, None] + dw)
        return rows, slopes


class FractionalElement(Family):
    """D = k (s/ω₀)^α, a springpot."""

    name = "springpot"
    words = "one element between spring and dashpot"
    parameters = (
        Parameter("k", *_K, words="stiffness"),
        Parameter("alpha", 1e-4, 0.5, "-", words="springpot exponent"),
    )
    needs_frequency = True
    relaxes = False

    def build(self, values: FloatArray, reference_hz: float) -> Law:
        """Return the law."""
        return Springpot(float(values[0]), float(values[1]), 2.0 * pi * reference_hz)

    def rows(self, values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
        """Return rows and slopes, as the base class says."""
        rows, slopes = _empty(values, branches=0)
        rows[:, K_ALPHA], rows[:, ALPHA] = values.T
        rows[:, OMEGA0] = 2.0 * pi * reference_hz
        slopes[:, K_ALPHA, 0], slopes[:, ALPHA, 1] = values.T
        return rows, slopes


SERIES = "prony"
"""A Prony series whose branches are as many as the data tell."""
_NUMBERS = ("no", "one", "two", "three", "four")


class FreeBranches(Family):
    r"""Free Maxwell branches beside a spring: a Prony series, generalised Maxwell, thesis chapter 10.

    .. math:: D = k_0 \left(1 + \sum_j \frac{g_j τ_j s}{1 + τ_j s}\right), \quad τ_j = τ_{j-1}/r_j

    Relative stiffnesses g and ratios of times r (``spacing2``, …) are its parameters, so that each series has
    one set of numbers: with free times the N! orders of the branches would be as many equal solutions.
    Branches nearer than a factor of two cannot be told apart. The priors are centred on the three branches
    that give a constant loss factor, and wide. One branch is ``zener`` in other parameters.
    """

    def __init__(self, n: int) -> None:
        """Describe the law of n branches."""
        self.name = f"{SERIES}-{n}"
        self.words = f"a spring beside {_NUMBERS[n]} free Maxwell branch{'' if n == 1 else 'es'}"
        self.parameters = _free_branches(n)
        self.omissible = tuple(range(1, 2 * n, 2))

    def build(self, values: FloatArray, reference_hz: float) -> Law:
        """Return the law."""
        row = self.rows(np.asarray(values, dtype=float)[None], reference_hz)[0][0]
        k, tau = row[BRANCHES::2], row[BRANCHES + 1 :: 2]
        return Prony(float(row[K0]), 0.0, tuple(map(float, k)), tuple(map(float, tau)))

    def rows(self, values: FloatArray, reference_hz: float) -> tuple[FloatArray, FloatArray]:
        """Return rows and slopes, as the base class says."""
        n = len(self.parameters) // 2
        rows = np.zeros((len(values), BRANCHES + 2 * n))
        faster = values[:, 2::2].copy()
        faster[:, 0] = 1.0 / faster[:, 0]
        rows[:, K0], rows[:, OMEGA0] = values[:, 0], 1.0
        rows[:, BRANCHES::2] = values[:, :1] * values[:, 1::2]
        rows[:, BRANCHES + 1 :: 2] = 1.0 / np.cumprod(faster, axis=1)
        return rows, rows[:, :, None] * _powers(n)

    def without(self, values: FloatArray, omitted: tuple[int, ...]) -> FloatArray:
        """Return the law without some branches: those left first, with the same times."""
        left = [j for j, stiffness in enumerate(self.omissible) if stiffness not in omitted]
        tau = values[2] / np.cumprod([1.0, *values[4::2]])
        return self._series(values[0], values[1::2][left], tau[left])

    def between(self, start: FloatArray, end: FloatArray, shares: FloatArray) -> FloatArray:
        """Return mixtures of both laws, whose stiffness is linear in the share at every frequency.

        Where both have more branches together than this law, those nearest in time are one whose time moves.
        """
        ways = np.reshape(_paired(_branches(start), _branches(end), len(self.omissible)), (-1, 2, 2))
        mixed = np.stack([1.0 - shares, shares], axis=1)
        k0 = mixed @ np.array([start[0], end[0]])
        g, tau = mixed @ ways[:, :, 1].T / k0[:, None], np.exp(mixed @ np.log(ways[:, :, 0]).T)
        return np.array([self._series(*law) for law in zip(k0, g, tau, strict=True)])

    def _series(self, k0: float, g: FloatArray, tau: FloatArray) -> FloatArray:
        """Return the parameters of the law with these branches; others come last, without stiffness."""
        order, n = np.argsort(-tau), len(tau)
        values = np.full(len(self.parameters), _APART)
        values[0], values[1::2] = k0, ABSENT
        values[1 : 1 + 2 * n : 2] = np.maximum(g[order], ABSENT)
        values[2 : 2 + 2 * n : 2] = [*tau[order[:1]], *(tau[order[:-1]] / tau[order[1:]])]
        return values

    def priors(self, reference_hz: float) -> Mapping[str, tuple[float, float]]:
        """Return priors about a loss factor of 0.1 that frequency hardly changes."""
        times, g = maxwell_3_times(reference_hz), float(np.mean(MAXWELL_3_WEIGHTS))
        about = {"g": (g, 1.0), "tau": (float(times[0]), 1.0), "spacing": (float(times[0] / times[1]), 0.7)}
        return {name: about[name.rstrip("0123456789")] for name in self.names[1:]}


_Branch = tuple[float, float]
"""Relaxation time and stiffness."""


def _branches(values: FloatArray) -> list[_Branch]:
    """Return the branches of a series that have any stiffness."""
    tau = values[2] / np.cumprod([1.0, *values[4::2]])
    return [(t, values[0] * g) for t, g in zip(tau, values[1::2], strict=True) if g > 2.0 * ABSENT]


def _paired(first: list[_Branch], second: list[_Branch], most: int) -> list[tuple[_Branch, _Branch]]:
    """Return each branch at both ends of a way, without stiffness where the other law has none to pair."""
    pairs: list[tuple[_Branch, _Branch]] = []
    while first and second:
        a, b = min(product(first, second), key=lambda pair: abs(np.log(pair[0][0] / pair[1][0])))
        apart = max(a[0] / b[0], b[0] / a[0]) >= _APART
        if apart and len(pairs) + len(first) + len(second) <= most:
            break
        pairs.append((a, b))
        first.remove(a)
        second.remove(b)
    return [*pairs, *((a, (a[0], 0.0)) for a in first), *(((b[0], 0.0), b) for b in second)]


@cache
def _powers(n: int) -> FloatArray:
    """Return the powers of the parameters of n free branches in each entry of a row, (width, 2 n + 1)."""
    powers = np.zeros((BRANCHES + 2 * n, 1 + 2 * n))
    powers[K0, 0] = 1.0
    for j in range(n):
        stiffness = BRANCHES + 2 * j
        powers[stiffness, [0, 1 + 2 * j]] = 1.0
        powers[stiffness + 1, 2] = 1.0
        powers[stiffness + 1, 4 : 3 + 2 * j : 2] = -1.0
    return powers


def _free_branches(n: int) -> tuple[Parameter, ...]:
    parameters = [Parameter("k0", *_K, words="static stiffness")]
    for j in range(1, n + 1):
        words = f"relative stiffness of branch {j}"
        parameters.append(Parameter(f"g{j}", 1e-3, 10.0, "-", words=words))
        if j == 1:
            parameters.append(Parameter("tau1", 1e-2, 1e2, "s", words="relaxation time of branch 1"))
        else:
            words = f"times by which branch {j} relaxes faster than branch {j - 1}"
            parameters.append(Parameter(f"spacing{j}", _APART, 200.0, "-", words=words))
    return tuple(parameters)


def _empty(values: FloatArray, *, branches: int) -> tuple[FloatArray, FloatArray]:
    rows = np.zeros((len(values), BRANCHES + 2 * branches))
    rows[:, OMEGA0] = 1.0
    return rows, np.zeros((*rows.shape, values.shape[1]))


LAWS = (
    KelvinVoigt(),
    Zener(),
    ThreeBranches(),
    FractionalElement(),
    *(FreeBranches(n) for n in range(1, 5)),
)
_SERIES_LAWS = tuple(law.name for law in LAWS if isinstance(law, FreeBranches))
PLUGINS = "jackettwin.support_laws"
"""Group of entry points, each an instance of a :class:`Family`, entered by its name."""
DEFAULT_LAWS = ("maxwell-3", "kelvin-voigt", "zener", "springpot")
"""The first is the default: soil loses about as much at every frequency, and this law does, too."""


@cache
def families() -> Mapping[str, Family]:
    """Return every support law by name: ours, then those that installed packages bring."""
    entered = plugins_of_type(PLUGINS, Family)  # type: ignore[type-abstract]
    return {law.name: law for law in (*LAWS, *entered.values())}


def family(name: str, *, field: str | None = None) -> Family:
    """Look a law up, asked for by a field or an option.

    Raises
    ------
    InputError
        If the name is unknown.
    """
    return look_up(families(), name, "law", field=field)


def members(laws: Sequence[str]) -> tuple[str, ...]:
    """Return the names of laws with a series instead of ``prony``: one branch, then two, three and four.

    >>> members(("kelvin-voigt", "prony"))
    ('kelvin-voigt', 'prony-1', 'prony-2', 'prony-3', 'prony-4')
    """
    each = (_SERIES_LAWS if law == SERIES else (law,) for law in laws)
    return tuple(dict.fromkeys(name for names in each for name in names))


_ROTORS = {f"c_{axis}": f"rotor's {axis.replace('_', '-')} dashpot" for axis in ("fore_aft", "side_side")}

_AT_THE_MUDLINE = {"u": "sway", "theta": "rocking"}
"""Words for what stands behind k in one matrix for the whole foundation."""


def law_parameter(name: str) -> str:
    """Return which parameter of a law a name of the ground's is of, empty if of none.

    >>> law_parameter("loss_factor_vertical"), law_parameter("k1_foot_2@scoured")
    ('loss_factor', 'k1')
    """
    known = {p.name for law in families().values() for p in law.parameters}
    words = name.partition("@")[0].split("_")
    starts = ("_".join(words[:n]) for n in range(len(words), 0, -1))
    return next((start for start in starts if start in known), "")


def parameter_words(name: str) -> str:
    """Return the name of a parameter of the ground, or of a rotor's dashpot, as text.

    >>> parameter_words("loss_factor_vertical"), parameter_words("k0_foot_1_vertical"), parameter_words("c")
    ('vertical loss factor', 'static stiffness of foot 1 vertical', 'dashpot')
    >>> parameter_words("k_u"), parameter_words("k_theta")
    ('sway stiffness', 'rocking stiffness')
    >>> parameter_words("c_fore_aft")
    "rotor's fore-aft dashpot"
    """
    if name in _ROTORS:
        return _ROTORS[name]
    known = {p.name: p.words for law in families().values() for p in law.parameters}
    name, _, state = name.partition("@")
    base = law_parameter(name)
    rest = name[len(base) + 1 :].replace("_", " ") if base else ""
    said = known.get(base, name.replace("_", " "))
    rest = _AT_THE_MUDLINE.get(rest, rest)
    before = rest in ("horizontal", "vertical", *_AT_THE_MUDLINE.values())
    said = f"{rest} {said}" if before else f"{said} of {rest}" if rest else said
    return f"{said} ({state})" if state else said
