r"""A rotor's own bending as modal coordinates of the rotor–nacelle assembly.

The body on the tower top carries everything as one rigid mass (Craig–Bampton's static part); each mode η of
the blades clamped to the hub adds

.. math:: M = \begin{bmatrix} M_{rna} & L \\ L^T & I \end{bmatrix}, \quad K = \mathrm{diag}(0, ω^2), \quad
          C = \mathrm{diag}(0, 2ζω), \qquad L = \sum m\, R^T φ

with φ the mode's displacement of a piece m of blade and R that piece's rigid motion with the tower top.
What the modes left out would add stays with the rigid body. Three equal blades move together, or as the
cosine and the sine of their azimuth: then L does not depend on where the rotor stands, and an idling rotor's
is the same.

Six coordinates are one node, x_n = R_n x_top + P η, so that a rigid motion of all nodes bends no blade and
whatever holds of nodes (weight, drawings, sensors) holds of these. P is the rigid motion of the whole rotor
that a mode comes closest to: the node moves as the rotor does on average.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.structure.blades import BladeModes, BladeStructure, blade_modes
from jackettwin.structure.masses import about_vertical, rigid_body_mass, rigid_transfer, turned_body
from jackettwin.structure.model import PointMass, Structure, Vector
from jackettwin.structure.two_node import TwoNodeElement, two_node_element

KIND = "blades"
"""Kind of the elements that hold a rotor's coordinates."""
MODES_PER_BLADE = 4
"""First and second flap and edge (ElastoDyn has no second edge). Two of each blade make one node."""
_PER_NODE = 2
_WORST_CONDITION = 1e8
"""Beyond this condition number the modes move the rotor too little as a whole to show as rigid motion."""


@dataclass(frozen=True)
class FlexibleRotor:
    """Three blades on a hub; lengths [m] from the tower top, angles [rad].

    ``tilt`` is positive where the hub is lifted, ``cone`` where the tips stand upwind.
    """

    blade: BladeStructure
    hub_radius: float
    overhang: float
    hub_height: float
    tilt: float
    cone: float
    pitch: float = 0.5 * np.pi


@dataclass(frozen=True)
class RotorModes:
    """Modes of a rotor clamped at its hub.

    Attributes
    ----------
    omega : (n,) [rad/s]
    coupling : (6, n) L, about the tower top in the nacelle's frame
    rigid : (6, 6) mass of the blades about the tower top
    """

    omega: FloatArray
    coupling: FloatArray
    rigid: FloatArray


def rotor_modes(rotor: FlexibleRotor) -> RotorModes:
    """Return the modes of all blades: of each of a blade's, together, cosine and sine."""
    modes = blade_modes(rotor.blade, MODES_PER_BLADE, pitch=rotor.pitch)
    azimuths = 2.0 * np.pi * np.arange(3) / 3
    coupling, rigid = np.zeros((6, 3, MODES_PER_BLADE)), np.zeros((6, 6))
    for k, psi in enumerate(azimuths):
        own, body = _one_blade(rotor, modes, float(psi))
        rigid += body
        coupling[:, k] = own
    together = np.array(
        [np.full(3, np.sqrt(1 / 3)), np.sqrt(2 / 3) * np.cos(azimuths), np.sqrt(2 / 3) * np.sin(azimuths)]
    )
    mixed = np.einsum("ck,ikm->imc", together, coupling)
    return RotorModes(np.repeat(modes.omega, 3), mixed.reshape(6, -1), rigid)


def _one_blade(rotor: FlexibleRotor, modes: BladeModes, psi: float) -> tuple[FloatArray, FloatArray]:
    """Return L (6, n_modes) and the rigid mass (6, 6) of the blade at an azimuth, about the tower top."""
    shaft = np.array([np.cos(rotor.tilt), 0.0, -np.sin(rotor.tilt)])
    up = np.array([np.sin(rotor.tilt), 0.0, np.cos(rotor.tilt)])
    radial = np.cos(psi) * up + np.sin(psi) * np.cross(shaft, up)
    z = np.cos(rotor.cone) * radial - np.sin(rotor.cone) * shaft
    x = np.cos(rotor.cone) * shaft + np.sin(rotor.cone) * radial
    frame = np.array([x, np.cross(z, x), z])
    hub = np.array([-rotor.overhang, 0.0, rotor.hub_height])
    arms = hub + (rotor.hub_radius + modes.z)[:, None] * z
    L, rigid = np.zeros((6, modes.omega.size)), np.zeros((6, 6))
    for arm, mass, shape in zip(arms, modes.mass_kg, modes.shape, strict=True):
        moved = rigid_transfer(arm)[:3]
        L += mass * moved.T @ frame.T @ shape
        rigid += mass * moved.T @ moved
    return L, rigid


def with_rotor(structure: Structure, rotor: FlexibleRotor, node: str) -> Structure:
    """Return a structure whose rigid rotor–nacelle assembly on ``node`` has bending blades.

    Raises
    ------
    InputError
        If that body is lighter than its blades, or is not there.
    """
    modes = rotor_modes(rotor)
    bodies = [mass for mass in structure.masses if mass.node == node]
    _require_blades_within(bodies, modes)
    elements, nodes = [], dict(structure.nodes)
    x, y, z = structure.nodes[node]
    for k in range(MODES_PER_BLADE // _PER_NODE):
        name = f"{node}_blades_{k + 1}"
        at = slice(6 * k, 6 * k + 6)
        # beside the tower's axis and not above its top, whatever the hub's height
        nodes[name] = (x - rotor.overhang, y, z)
        elements.append(
            _element((node, name), modes.omega[at], modes.coupling[:, at], rotor, rigid=modes.rigid)
        )
    return replace(structure, nodes=nodes, elements=(*structure.elements, *elements))


def without_rotor(structure: Structure) -> Structure:
    """Return the structure with rigid blades."""
    gone = {element.end for element in structure.elements if element.kind == KIND}
    return replace(
        structure,
        nodes={name: place for name, place in structure.nodes.items() if name not in gone},
        elements=tuple(element for element in structure.elements if element.kind != KIND),
    )


def _element(
    nodes: tuple[str, str], omega: FloatArray, L: FloatArray, rotor: FlexibleRotor, *, rigid: FloatArray
) -> TwoNodeElement:
    P = np.linalg.solve(rigid, L)
    if np.linalg.cond(P / np.linalg.norm(P, axis=0)) > _WORST_CONDITION:
        P = np.eye(6) / np.sqrt(rigid[0, 0])
    inverse = np.linalg.inv(P)
    # η = P⁻¹ (x_n − R_n x_top)
    eta = np.hstack([-inverse @ rigid_transfer(np.array([-rotor.overhang, 0.0, 0.0])), inverse])
    top = np.hstack([np.eye(6), np.zeros((6, 6))])
    cross = top.T @ L @ eta
    damping = 2.0 * rotor.blade.damping_ratio * omega
    return two_node_element(
        nodes[1],
        KIND,
        nodes,
        eta.T @ (omega[:, None] ** 2 * eta),
        cross + cross.T + eta.T @ eta,
        damping=eta.T @ (damping[:, None] * eta),
    )


def turned_nacelle(structure: Structure, angle: float) -> Structure:
    """Return the structure with what stands on its top turned about the vertical by ``angle`` [rad]."""
    top = structure.top_node
    masses = tuple(turned_body(m, angle) if m.node == top else m for m in structure.masses)
    elements = tuple(_turned(e, angle) if e.kind == KIND else e for e in structure.elements)
    at = np.array(structure.nodes[top])
    moved: dict[str, Vector] = {}
    for e in structure.elements:
        if e.kind == KIND:
            x, y, z = map(float, at + about_vertical(angle) @ (np.array(structure.nodes[e.end]) - at))
            moved[e.end] = (x, y, z)
    return replace(structure, nodes={**structure.nodes, **moved}, masses=masses, elements=elements)


def _turned(element: TwoNodeElement, angle: float) -> TwoNodeElement:
    R = np.kron(np.eye(4), about_vertical(angle))

    def turned(matrix: tuple[tuple[float, ...], ...]) -> FloatArray:
        return np.asarray(R @ np.array(matrix) @ R.T)

    return two_node_element(
        element.name,
        element.kind,
        (element.start, element.end),
        turned(element.stiffness),
        turned(element.mass),
        damping=None if element.damping is None else turned(element.damping),
    )


def _require_blades_within(bodies: list[PointMass], modes: RotorModes) -> None:
    whole = sum((rigid_body_mass(body) for body in bodies), np.zeros((6, 6)))
    rest = whole - modes.coupling @ modes.coupling.T
    scale = np.sqrt(np.maximum(np.diag(modes.rigid), 1.0))
    if np.linalg.eigvalsh(rest / np.outer(scale, scale))[0] < 0.0:
        raise InputError(
            "the rotor–nacelle assembly does not hold its blades",
            field="rna",
            value=float(whole[0, 0]),
            allowed=f"more than its blades' {modes.rigid[0, 0]:.4g} kg, and their inertia",
            remedy="state mass, centre of gravity and inertia of the whole, blades included",
        )
