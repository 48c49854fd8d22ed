r"""A foundation as a superelement: the six motions of its interface and N internal coordinates.

Craig–Bampton reduction uses the static shapes of the interface and fixed-interface modes of the *undamped*
structure. A strong dashpot under a foot practically fixes that foot at the frequencies of interest; no
undamped mode has this shape, and more of them hardly help. The first internal shapes are therefore taken from
the damped response to a motion of the interface,

.. math:: U(iω) = -F_{ii}^{-1}(iω) F_{ib}(iω) B,

its real and imaginary parts at two frequencies, as far as they have strain energy of their own;
fixed-interface modes complete the number. The reduction is a congruent transformation of the second-order
form with internal variables

.. math::

    M ẍ + C ẋ + K x + Σ k S (x − y) = f, \qquad τ S ẏ = S (x − y)

so that M, C and K are symmetric and the element is dissipative for all laws of the ground.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.axes import DOFS_PER_NODE
from jackettwin.decks import DeckDamping
from jackettwin.errors import InputError, NumericalError, require
from jackettwin.response.motion.static import self_weight
from jackettwin.response.state import Branch, factorised, maxwell_branches
from jackettwin.response.system import Pencil, System
from jackettwin.soil import Law, Prony, Springpot, prony_fit
from jackettwin.structure import Assembly, Structure, Vector, lowest_modes, rigid_transfer

INTERFACE = DOFS_PER_NODE
"""Number of interface coordinates, which come first."""
RUNGE_KUTTA = 2.78
"""|λ|·step up to which the fourth-order method is stable for every decaying pole λ."""
_SHIFTS = (0.25, 1.0)
"""Frequencies at which the damped response is sampled, as shares of the band's upper limit."""
_NEW = 1e-5
"""Share of strain energy below which a sampled shape is left out."""
_SPRINGPOT_HZ = (1e-3, 100.0)
"""Range in which a springpot is approximated by a finite number of states; below it is a spring."""


@dataclass(frozen=True)
class Superelement:
    """M q̈ + C q̇ + K q = f for the six interface motions and the internal coordinates.

    Attributes
    ----------
    M, C, K : (n, n) symmetric mass, damping and stiffness
    reference_m : point whose motion the first six coordinates describe [m]
    weight_n : (n,) self-weight on the coordinates
    basis : (assembly.n_dof, n) shapes of the coordinates; empty if read from a file without them
    n_damped : number of internal coordinates from the damped response
    """

    M: FloatArray
    C: FloatArray
    K: FloatArray
    reference_m: Vector
    weight_n: FloatArray
    basis: FloatArray
    n_damped: int = 0

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return int(self.M.shape[0])

    @property
    def interface_stiffness(self) -> FloatArray:
        """Static (Guyan) stiffness of the interface, (6, 6)."""
        return self.K[:INTERFACE, :INTERFACE]

    @property
    def interface_mass(self) -> FloatArray:
        """Guyan mass of the interface, (6, 6)."""
        return self.M[:INTERFACE, :INTERFACE]

    @property
    def guyan_frequency_hz(self) -> FloatArray:
        """Frequencies of the six interface coordinates without internal ones."""
        w2 = la.eigvalsh(self.interface_stiffness, self.interface_mass)
        return np.asarray(np.sqrt(np.maximum(w2, 0.0)) / (2.0 * pi))

    @property
    def held_frequency_hz(self) -> FloatArray:
        """Undamped frequencies of the internal coordinates with the interface fixed."""
        inner = slice(INTERFACE, None)
        if self.n == INTERFACE:
            return np.empty(0)
        w2 = la.eigvalsh(self.K[inner, inner], self.M[inner, inner])
        return np.asarray(np.sqrt(np.maximum(w2, 0.0)) / (2.0 * pi))

    @property
    def fastest_pole_rad_s(self) -> float:
        """Largest |λ| with the interface fixed, which limits the step of an explicit integrator."""
        inner = slice(INTERFACE, None)
        return float(
            np.abs(poles(self.M[inner, inner], self.C[inner, inner], self.K[inner, inner])).max(initial=0.0)
        )


@dataclass(frozen=True)
class _Interface:
    """The interface's DOFs b of a pencil, the others i, and B with x_b = B q."""

    b: IntArray
    i: IntArray
    B: FloatArray


def superelement(
    system: System,
    *,
    number: int,
    reference_m: Vector | None = None,
    band_hz: float = 1.0,
    damped: bool = True,
) -> Superelement:
    """Return a foundation reduced to its interface.

    Parameters
    ----------
    system : System
        The foundation on its support up to its interface nodes, which move as one rigid body.
    number : int
        Number of internal coordinates.
    reference_m : (x, y, z), optional
        Point that moves with the interface; default: the centroid of its nodes.
    band_hz : float
        Upper limit of the frequencies for which the damping of the supports is accurate.
    damped : bool
        False gives plain Craig–Bampton reduction, which suffices for supports without damping.

    Raises
    ------
    InputError
        If the support acts on the interface or the numbers are out of range.
    NumericalError
        If the foundation cannot stand on its support.
    """
    require(
        0 <= number <= most_internal(system),
        "more internal coordinates than the foundation has degrees of freedom inside",
        field="modes",
        value=number,
        allowed=f"0 to {most_internal(system)}",
    )
    require(0.0 < band_hz < np.inf, "must be positive", field="band_hz", value=band_hz, allowed="> 0")
    point = interface_centroid(system.assembly.structure) if reference_m is None else reference_m
    at = _interface(system, point)
    pencil = system.pencil.with_laws([_finite(group.law) for group in system.pencil.groups])
    static = _response(pencil, at, 0.0)
    n_damped = 0
    inner = np.zeros((static.shape[0], 0))
    if damped and any(group.law.dissipates for group in pencil.groups):
        inner = _damped_shapes(pencil, at, static, band_hz, number)
        n_damped = inner.shape[1]
    inner = np.hstack([inner, _fixed_modes(pencil, at, number - n_damped)[1]])
    M, C, K = _reduced(pencil, inner)
    # classical form: unit modal mass and a diagonal stiffness inside
    _, V = la.eigh(K, M)
    basis = np.hstack([static, inner @ V])
    M, C, K = _reduced(pencil, basis)
    K[:INTERFACE, INTERFACE:] = K[INTERFACE:, :INTERFACE] = (
        0.0  # static shapes: exactly zero but for rounding
    )
    shapes = system.expand(basis[: pencil.n])
    return Superelement(M, C, K, point, shapes.T @ self_weight(system.assembly), shapes, n_damped)


def most_internal(system: System) -> int:
    """Return the largest number of internal coordinates of a foundation."""
    return int(system.pencil.n) - INTERFACE - 1


def fixed_interface_frequencies(system: System, number: int) -> FloatArray:
    """Return the lowest undamped frequencies [Hz] with the interface fixed."""
    at = _interface(system, interface_centroid(system.assembly.structure))
    return np.asarray(_fixed_modes(system.pencil, at, number)[0] / (2.0 * pi))


def held_displacement(system: System, load: FloatArray) -> FloatArray:
    """Return displacements (n_dof, ...) under constant loads (n_dof, ...) with the interface held at rest."""
    at = _interface(system, interface_centroid(system.assembly.structure))
    K = sp.csc_array(system.pencil.static_stiffness())[at.i][:, at.i]
    u = np.zeros((system.pencil.n, *np.shape(load)[1:]))
    u[at.i] = factorised(sp.csc_array(K)).solve(np.asarray(load)[system.free][at.i])
    return np.asarray(system.expand(u))


def slowed(element: Superelement, *, step_s: float, band_hz: float) -> Superelement:
    r"""Return the element with its fast poles slowed so that Runge–Kutta steps of ``step_s`` are stable.

    Inertia is added to internal coordinates whose dashpots or springs are too stiff, until
    :math:`C + K/r ≤ r M`, which ensures :math:`|λ| ≤ 1.62\,r`. Stiffness is added that cancels it at the
    upper end of the band. The static stiffness of the interface does not change.
    """
    r = RUNGE_KUTTA / 1.62 / step_s
    i = slice(INTERFACE, None)
    M, C, K = element.M.copy(), element.C, element.K.copy()
    gamma, V = la.eigh(C[i, i] / r + K[i, i] / r**2, M[i, i])
    W = (M[i, i] @ V)[:, gamma > 1.0]
    added = (W * (gamma[gamma > 1.0] - 1.0)) @ W.T
    M[i, i] += added
    K[i, i] += (2.0 * pi * band_hz) ** 2 * added
    return replace(element, M=M, K=K)


def with_deck_damping(element: Superelement, damping: DeckDamping) -> Superelement:
    """Return the element with a SubDyn deck's damping: modal inside, Guyan's of the interface."""
    b, i = slice(INTERFACE), np.arange(INTERFACE, element.n)
    C = element.C.copy()
    C[b, b] += damping.interface + damping.alpha * element.M[b, b] + damping.beta * element.K[b, b]
    C[i, i] += 2.0 * damping.ratios(i.size) * np.sqrt(np.maximum(element.K[i, i], 0.0))
    return replace(element, C=C)


def interface_centroid(structure: Structure) -> Vector:
    """Return the mean of the interface nodes [m]."""
    x, y, z = np.mean([structure.nodes[name] for name in structure.interface_nodes], axis=0)
    return (float(x), float(y), float(z))


def interface_motion(assembly: Assembly, point: Vector) -> tuple[IntArray, FloatArray]:
    """Return the interface nodes' DOFs and their motion per unit motion of the point, (n_interface, 6)."""
    structure = assembly.structure
    leader = {link.follower: link.leader for link in structure.rigid_links}
    nodes = list(dict.fromkeys(leader.get(name, name) for name in structure.interface_nodes))
    B = np.vstack([rigid_transfer(np.subtract(structure.nodes[name], point)) for name in nodes])
    return np.concatenate([assembly.dofs(name) for name in nodes]), B


def _interface(system: System, point: Vector) -> _Interface:
    dofs, B = interface_motion(system.assembly, point)
    if not np.isin(dofs, system.free).all():
        raise InputError(
            "the support acts on the interface",
            field="interface_nodes",
            value=list(system.assembly.structure.interface_nodes),
            remedy="name nodes above the ground",
        )
    b = np.searchsorted(system.free, dofs)
    return _Interface(b, np.setdiff1d(np.arange(system.free.size), b), B)


def _finite(law: Law) -> Law:
    """Return a law with finitely many states: a springpot's slowest branch becomes a spring."""
    if not isinstance(law, Springpot):
        return law
    fit = prony_fit(law, *_SPRINGPOT_HZ)
    return Prony(k0=fit.k0 + sum(fit.k[:1]), c=fit.c, k=fit.k[1:], tau=fit.tau[1:])


def _response(pencil: Pencil, at: _Interface, s: complex) -> FloatArray:
    """Return the response to unit motions of the interface with its internal variables; real if s = 0."""
    F = sp.csc_array(pencil.F(s) if s else pencil.static_stiffness())
    try:
        u_i = -factorised(F[at.i][:, at.i]).solve(np.asarray(F[at.i][:, at.b] @ at.B))
    except RuntimeError as error:
        raise NumericalError(f"the foundation cannot stand on its support: {error}") from error
    U = np.zeros((pencil.n, INTERFACE), dtype=u_i.dtype)
    U[at.b], U[at.i] = at.B, u_i
    return _lifted(pencil, U, s)


def _lifted(pencil: Pencil, u: FloatArray, s: complex = 0.0) -> FloatArray:
    """Return shapes with the internal variables y = u/(1 + τs) of every Maxwell branch appended."""
    return np.vstack([u, *(u[branch.dofs] / (1.0 + s * branch.tau) for branch in maxwell_branches(pencil))])


def _fixed_modes(pencil: Pencil, at: _Interface, number: int) -> tuple[FloatArray, FloatArray]:
    """Return ω and shapes, with internal variables, of the undamped modes with the interface fixed."""
    if number == 0:
        return np.empty(0), _lifted(pencil, np.zeros((pencil.n, 0)))
    i = at.i
    omega, phi = lowest_modes(
        sp.csc_array(pencil.static_stiffness())[i][:, i], sp.csc_array(pencil.M)[i][:, i], number
    )
    u = np.zeros((pencil.n, omega.size))
    u[i] = phi
    return omega, _lifted(pencil, u)


def _damped_shapes(
    pencil: Pencil, at: _Interface, static: FloatArray, band_hz: float, number: int
) -> FloatArray:
    """Return the shapes with most strain energy of the damped response, apart from the static one."""
    samples = []
    for share in _SHIFTS:
        beyond = _response(pencil, at, 2j * pi * share * band_hz) - static
        both = np.hstack([beyond.real, beyond.imag])
        energy = np.einsum("ii->i", _reduced(pencil, both)[2]).max()
        samples.append(both / np.sqrt(energy))
    X = np.hstack(samples)
    # strain energy makes rotations and translations comparable
    energy, V = la.eigh(_reduced(pencil, X)[2])
    order = np.argsort(energy)[::-1][:number]
    order = order[energy[order] > _NEW * energy[-1]]
    return np.asarray(X @ (V[:, order] / np.sqrt(energy[order])))


def _reduced(pencil: Pencil, basis: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return M, C, K of a pencil on shapes with internal variables (n + n_internal, m)."""
    u = basis[: pencil.n]
    M, K = _on(u, pencil.M), _on(u, pencil.K)
    C = pencil.rayleigh.alpha * M + pencil.rayleigh.beta * K
    for group in pencil.groups:
        law, spring = group.law, _on(u, group.S)
        K = K + law.static_stiffness * spring
        C = C + law.dashpot * spring
    at = pencil.n
    for branch in maxwell_branches(pencil):
        y = basis[at : at + branch.dofs.size]
        S = _square(branch)
        K = K + branch.k * _on(u[branch.dofs] - y, S)
        C = C + branch.k * branch.tau * _on(y, S)
        at += branch.dofs.size
    return M, C, K


def _square(branch: Branch) -> sp.csc_array:
    return sp.csc_array(branch.S[branch.dofs][:, branch.dofs])


def _on(u: FloatArray, matrix: sp.csc_array) -> FloatArray:
    product = u.T @ (matrix @ u)
    return np.asarray(0.5 * (product + product.T))


def poles(M: FloatArray, C: FloatArray, K: FloatArray) -> ComplexArray:
    """Return all poles of M q̈ + C q̇ + K q = 0 [rad/s]."""
    n = M.shape[0]
    if n == 0:
        return np.empty(0, dtype=np.complex128)
    A = np.zeros((2 * n, 2 * n))
    A[:n, n:] = np.eye(n)
    A[n:] = -la.solve(M, np.hstack([K, C]), assume_a="pos")
    return np.asarray(la.eigvals(A))
