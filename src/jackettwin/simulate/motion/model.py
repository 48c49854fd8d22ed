"""Linear model of a scenario: structure, ground, and the mean effects of water and air."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import pi

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.loads import (
    Linearised,
    OperatingPoint,
    in_global_axes,
    linearise,
    morison_points,
    operating_damping,
    operating_point,
    rotation,
    water_mass,
)
from jackettwin.response import (
    Group,
    Reduced,
    aligned,
    build_system,
    damping_ratio,
    mode_kinds,
    mode_labels,
    own_damping,
    reduced,
    state_matrix,
)
from jackettwin.simulate.scenario.air import Air, Turbine
from jackettwin.simulate.scenario.asset import Asset
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.simulate.scenario.sea import Sea
from jackettwin.simulate.scenario.tuning import tuned_damping
from jackettwin.soil import Prony
from jackettwin.structure import Assembly, assemble, turned_nacelle

BAND_HZ = 5.0
"""Modes inside the structure are kept up to here."""
_OVERDAMPED = 0.5
"""Damping ratio from which a pole is no mode: of the supports' dashpots, not of the structure."""
SOURCES = ("structure", "soil", "rotor", "water")


@dataclass(frozen=True)
class Model:
    """An asset reduced to a few coordinates.

    Attributes
    ----------
    assembly : Assembly
    reduced : Reduced
    top : (6, n) motion of the top node from the coordinates
    sources : what each group of the pencil belongs to, of ``SOURCES``
    """

    assembly: Assembly
    reduced: Reduced
    top: FloatArray
    sources: tuple[str, ...]

    def with_forces_of_motion(self, source: str, *, damping: FloatArray, stiffness: FloatArray) -> Model:
        """Return the model with forces −C q̇ − K q on its coordinates, (n, n); they need not be symmetric."""
        pencil = self.reduced.pencil
        everywhere = np.arange(pencil.n)
        added = (Group(Prony(c=1.0), damping, everywhere), Group(Prony(k0=1.0), stiffness, everywhere))
        pencil = replace(pencil, groups=(*pencil.groups, *added))
        sources = (*self.sources, source, source)
        return replace(self, reduced=replace(self.reduced, pencil=pencil), sources=sources)


@dataclass(frozen=True)
class TrueMode:
    """A mode of the linear model, aerodynamics and water included; its damping also by source."""

    label: str
    frequency_hz: float
    damping_ratio: float
    damping_by_source: dict[str, float] = field(default_factory=dict)

    @property
    def pole(self) -> complex:
        """λ of its motion e^{λt} [rad/s]."""
        zeta = self.damping_ratio
        return 2.0 * pi * self.frequency_hz * complex(-zeta, (1.0 - zeta**2) ** 0.5)


def build_model(scenario: Scenario) -> Model:
    """Return the asset of a scenario in still air, its tower tuned if that is asked."""
    return asset_model(
        scenario.asset, sea=scenario.sea, yaw=scenario.heading_rad, pushed=scenario.pushed_nodes
    )


def asset_model(
    asset: Asset, *, sea: Sea | None = None, yaw: float = 0.0, pushed: tuple[str, ...] = ()
) -> Model:
    """Return an asset in still air, its nacelle turned by ``yaw`` [rad], its tower tuned if that is asked.

    Nodes that are ``pushed`` keep coordinates of their own: they yield to a force as the whole model does.
    """
    top_node = asset.structure.top_node
    assembly = asset_assembly(asset, sea=sea, yaw=yaw)
    own = own_damping(assembly, asset.rayleigh)
    system = build_system(assembly, asset.support, rayleigh=asset.rayleigh, spread=own)
    small = reduced(system, below_hz=BAND_HZ, keep=_own_dofs(assembly, (top_node, *pushed)))
    rows = assembly.expand[assembly.mesh.node_dofs(top_node)]
    sources = (*("soil",) * (len(small.pencil.groups) - len(own)), *("structure",) * len(own))
    model = Model(assembly, small, np.asarray(rows @ small.basis), sources)
    if asset.coupled_damping is None:
        return model
    damping = tuned_damping(assembly, small, asset.coupled_damping)
    return model.with_forces_of_motion("structure", damping=damping, stiffness=np.zeros_like(damping))


def asset_assembly(asset: Asset, *, sea: Sea | None = None, yaw: float = 0.0) -> Assembly:
    """Return the matrices of an asset's steel, with the water's mass if the sea adds it."""
    assembly = assemble(
        turned_nacelle(asset.structure, yaw),
        beam_theory=asset.beam,
        rotary_inertia=asset.rotary_inertia,
        subdivide=asset.subdivide,
        gravity=asset.gravity,
    )
    if sea is None or sea.water is None:
        return assembly
    grid = morison_points(assembly, highest_z=0.0, coefficients=sea.coefficients)
    return replace(assembly, mass=assembly.mass + water_mass(assembly, grid, sea.water).tocsc())


def _own_dofs(assembly: Assembly, nodes: tuple[str, ...]) -> tuple[int, ...]:
    """Return the independent DOFs that move nodes, those of the leader of one on a rigid link."""
    rows = np.concatenate([assembly.mesh.node_dofs(node) for node in nodes])
    return tuple(int(dof) for dof in np.unique(assembly.expand[rows].indices))


@dataclass(frozen=True)
class Aerodynamics:
    """The rotor about the mean wind, at the tower top in global axes."""

    mean: Linearised
    operation: OperatingPoint | None
    turbine: Turbine

    @property
    def turns(self) -> bool:
        """Whether the rotor turns; an idling one is too slow to."""
        return self.operation is not None


def aerodynamics(air: Air, turbine: Turbine) -> Aerodynamics:
    """Return the rotor linearised about the mean wind at the hub, averaged over the nacelle's headings."""
    speed, operation = air.wind.speed_m_s, None
    if turbine.state == "operating":
        operation = operating_point(turbine.rotor, turbine.control, speed)
        turbine = replace(turbine, pitch=operation.pitch)
    parts = [_linearised_at(yaw, speed, turbine, operation) for yaw in air.headings()]
    mean = Linearised(*(np.mean(matrices, axis=0) for matrices in zip(*parts, strict=True)))
    return Aerodynamics(mean, operation, turbine)


def _linearised_at(
    yaw: float, speed: float, turbine: Turbine, operation: OperatingPoint | None
) -> Linearised:
    """Return the rotor's load, damping and stiffness at a heading [rad], in global axes."""
    if operation is not None:
        found = operating_damping(turbine.rotor, operation, yaw_error=-yaw)
    else:
        found = linearise(
            turbine.rotor,
            speed,
            pitch=turbine.pitch,
            yaw_error=-yaw,
            azimuth=turbine.azimuth,
            shaft="free" if turbine.state == "idling" else "locked",
        )
    R = np.kron(np.eye(2), rotation(np.array([0.0, 0.0, 1.0]), yaw))
    return Linearised(
        R @ found.load, in_global_axes(found.damping, yaw), in_global_axes(found.stiffness, yaw)
    )


def with_aerodynamics(model: Model, mean: Linearised) -> Model:
    """Return the model with the rotor's mean damping and stiffness at its top."""
    top = model.top
    return model.with_forces_of_motion(
        "rotor", damping=top.T @ mean.damping @ top, stiffness=top.T @ mean.stiffness @ top
    )


def true_modes(model: Model, *, below_hz: float, heading_rad: float = 0.0) -> tuple[TrueMode, ...]:
    """Return the modes of the linear model, by frequency, named by the axes of a nacelle of this heading."""
    pencil = model.reduced.pencil
    values, states = np.linalg.eig(state_matrix(pencil))
    keep = (values.imag > 0.0) & (np.abs(values) < 2.0 * pi * below_hz)
    keep &= -values.real < _OVERDAMPED * np.abs(values)
    order = np.flatnonzero(keep)[np.argsort(np.abs(values[keep]))]
    shapes = model.reduced.basis @ states[: pencil.n, order]
    shapes = aligned(model.assembly, values[order], shapes, heading_rad=heading_rad)
    frequency_hz = np.abs(values[order]) / (2.0 * pi)
    labels = mode_labels(mode_kinds(model.assembly, shapes, frequency_hz, heading_rad=heading_rad))
    return tuple(
        TrueMode(
            label,
            float(abs(v)) / (2.0 * pi),
            float(damping_ratio(v)),
            damping_by_source(model, complex(v), states[: pencil.n, i]),
        )
        for label, v, i in zip(labels, values[order], order, strict=True)
    )


def damping_by_source(model: Model, pole: complex, x: ComplexArray) -> dict[str, float]:
    """Return each source's part of the damping ratio of a mode with shape x (n,).

    The imaginary part of xᴴF(λ)x = 0 is a sum over the parts of F; what is not symmetric in the rotor's
    matrices belongs to it.
    """
    pencil = model.reduced.pencil
    parts = dict.fromkeys(SOURCES, 0.0)

    def form(matrix: FloatArray) -> complex:
        return complex(x.conj() @ matrix @ x)

    m = form(pencil.M).real
    steel = pencil.rayleigh.alpha * m + pencil.rayleigh.beta * form(pencil.K).real
    parts["structure"] = steel
    for group, source in zip(pencil.groups, model.sources, strict=True):
        parts[source] += (complex(group.law.stiffness(pole)) * form(group.S)).imag / pole.imag
    return {source: part / (2.0 * abs(pole) * m) for source, part in parts.items()}
