"""The steel's E and ρ, fitted part by part and stage by stage to frequencies on pinned feet (thesis 5.4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.optimize import least_squares

from jackettwin.arrays import FloatArray
from jackettwin.errors import located, require
from jackettwin.response import UndampedModes, track_modes
from jackettwin.structure import Assembly, Structure, assemble, check
from jackettwin.updating.band import numbered_modes


@dataclass(frozen=True)
class Factor:
    """A factor on one property of one part of the steel."""

    part: str
    what: Literal["youngs_modulus", "density"]
    low: float = 0.1
    high: float = 10.0

    def __post_init__(self) -> None:
        require(
            0.0 < self.low < self.high,
            "bounds are reversed or not positive",
            field="bounds",
            value=[self.low, self.high],
            allowed="0 < low < high",
            remedy="give [low, high]",
        )

    @property
    def name(self) -> str:
        """``part.property``."""
        return f"{self.part}.{self.what}"


@dataclass(frozen=True)
class SteelFit:
    """A refined structure and how well it meets its frequencies on pinned feet.

    Attributes
    ----------
    factors : mapping of factor name to value
    modes : mode numbers
    target_hz, before_hz, after_hz : (n_modes,)
    """

    structure: Structure
    factors: Mapping[str, float]
    modes: tuple[int, ...]
    target_hz: FloatArray
    before_hz: FloatArray
    after_hz: FloatArray


def only_parts(structure: Structure, parts: tuple[str, ...]) -> Structure:
    """Return the structure with only some of its parts and what stands on their nodes.

    Raises
    ------
    InputError
        If no member belongs to a part.
    """
    known = sorted({member.part for member in structure.bars})
    for part in parts:
        require(part in known, "no such part", field="parts", value=part, allowed=", ".join(known))
    members = tuple(member for member in structure.members if member.part in parts)
    beams = tuple(beam for beam in structure.beams if beam.part in parts)
    used = {node for bar in structure.bars if bar.part in parts for node in (bar.start, bar.end)}
    return replace(
        structure,
        nodes={name: xyz for name, xyz in structure.nodes.items() if name in used},
        members=members,
        beams=beams,
        masses=tuple(mass for mass in structure.masses if mass.node in used),
        rigid_links=tuple(link for link in structure.rigid_links if {link.leader, link.follower} <= used),
        elements=tuple(e for e in structure.elements if {e.start, e.end} <= used),
        interface_nodes=tuple(node for node in structure.interface_nodes if node in used),
    )


def fit_steel(structure: Structure, factors: tuple[Factor, ...], target_hz: Mapping[int, float]) -> SteelFit:
    r"""Return the structure whose scaled parts meet the target frequencies on pinned feet.

    Gauss–Newton in the logarithms, with :math:`∂ω²/∂\ln p = φ^T(∂K/∂\ln p − ω² ∂M/∂\ln p)φ`; modes are
    followed by shape from the start.

    Raises
    ------
    InputError
        If there are more factors than targets. Without factors the frequencies are only compared.
    """
    modes = tuple(sorted(target_hz))
    require(
        len(factors) <= len(modes),
        "more factors than frequencies cannot be told apart",
        field="free",
        value=[f.name for f in factors],
        allowed=f"up to {len(modes)} factors",
    )
    target = np.array([target_hz[mode] for mode in modes])
    rows, number = [mode - 1 for mode in modes], max(modes) + 3
    start = assemble(structure)
    reference = numbered_modes(start, number)
    parts = [(assemble(_scaled(structure, (factor,), np.array([2.0]))), factor) for factor in factors]
    K_parts = [a.stiffness - start.stiffness for a, _ in parts]
    M_parts = [a.mass - start.mass for a, _ in parts]

    def evaluate(z: FloatArray) -> tuple[FloatArray, FloatArray]:
        scale = np.exp(z)
        at = assemble(_scaled(structure, factors, scale))
        found = numbered_modes(at, number)
        order = track_modes(start.mass, reference.omega, reference.shapes, found.shapes)[rows]
        omega, phi = found.omega[order], found.shapes[:, order]
        slopes = np.empty((len(modes), len(factors)))
        for j, (K, M) in enumerate(zip(K_parts, M_parts, strict=True)):
            stiffness = np.einsum("ij,ij->j", phi, K @ phi)
            inertia = np.einsum("ij,ij->j", phi, M @ phi)
            slopes[:, j] = scale[j] * (stiffness - omega**2 * inertia) / (2.0 * omega**2)
        frequency = omega / (2.0 * np.pi)
        return frequency / target - 1.0, slopes * (frequency / target)[:, None]

    def residuals(z: FloatArray) -> FloatArray:
        return evaluate(z)[0]

    def jacobian(z: FloatArray) -> FloatArray:
        return evaluate(z)[1]

    z = np.zeros(len(factors))
    if factors:
        bounds = (np.log([f.low for f in factors]), np.log([f.high for f in factors]))
        z = least_squares(residuals, z, jac=jacobian, bounds=bounds, xtol=1e-10).x
    values = np.exp(z)
    return SteelFit(
        structure=_scaled(structure, factors, values),
        factors={factor.name: float(value) for factor, value in zip(factors, values, strict=True)},
        modes=modes,
        target_hz=target,
        before_hz=reference.frequency_hz[rows],
        after_hz=(residuals(z) + 1.0) * target,
    )


def _scaled(structure: Structure, factors: tuple[Factor, ...], values: FloatArray) -> Structure:
    for factor, value in zip(factors, values, strict=True):
        structure = structure.with_material(factor.part, **{factor.what: float(value)})
    return structure


@dataclass(frozen=True)
class RefinementStage:
    """One stage: some parts on pinned feet, their measured frequencies and what may change.

    Attributes
    ----------
    parts : tuple of str
        Empty for the whole structure.
    target_hz : mapping of mode number to frequency
    factors : tuple of Factor
        Empty for a stage that only compares.
    """

    parts: tuple[str, ...]
    target_hz: Mapping[int, float]
    factors: tuple[Factor, ...]


@dataclass(frozen=True)
class Refinement:
    """The refined structure and what each stage did.

    Attributes
    ----------
    factors : mapping of part to property to the product of all stages' factors
    """

    structure: Structure
    stages: tuple[SteelFit, ...]
    factors: Mapping[str, Mapping[str, float]]


def refine(structure: Structure, stages: tuple[RefinementStage, ...]) -> Refinement:
    """Fit stage after stage; each starts from what the earlier ones found.

    Raises
    ------
    InputError
        If a stage names an unknown part or has more factors than frequencies; the field says which stage.
    """
    fits: list[SteelFit] = []
    factors: dict[str, dict[str, float]] = {}
    for i, stage in enumerate(stages):
        with located(field=f"stages.{i}"):
            standing = only_parts(structure, stage.parts) if stage.parts else structure
            fit = fit_steel(standing, stage.factors, stage.target_hz)
        for factor in stage.factors:
            value = fit.factors[factor.name]
            structure = structure.with_material(factor.part, **{factor.what: value})
            part = factors.setdefault(factor.part, {})
            part[factor.what] = part.get(factor.what, 1.0) * value
        fits.append(fit)
    return Refinement(structure, tuple(fits), factors)


@dataclass(frozen=True)
class Stage:
    """Some parts of a structure on pinned feet.

    Attributes
    ----------
    parts : names of the parts standing
    mass_kg : float
    assembly : Assembly
    modes : UndampedModes
    """

    parts: tuple[str, ...]
    mass_kg: float
    assembly: Assembly
    modes: UndampedModes

    @property
    def frequency_hz(self) -> FloatArray:
        """Undamped frequencies (n_modes,)."""
        return self.modes.frequency_hz

    @property
    def name(self) -> str:
        """``jacket``, then ``+ transition_piece`` and so on: the part added last."""
        last = self.parts[-1] or "members of no named part"
        if len(self.parts) > 1:
            return f"+ {last}"
        return self.parts[0] or "whole structure"


def stages(structure: Structure, number: int, *, gravity: bool = False) -> tuple[Stage, ...]:
    """Return a stage for every part, in the order the structure names them; the last is the whole.

    Raises
    ------
    InputError
        If the first part does not stand on its own: parts must be named from the ground upwards.
    """
    parts = tuple(dict.fromkeys(one.part for one in structure.bars)) or ("",)
    found = []
    for k in range(1, len(parts) + 1):
        # the whole keeps what no member holds, rigid links' ends among them
        standing = structure if k == len(parts) else only_parts(structure, parts[:k])
        assembly = assemble(standing, gravity=gravity)
        found.append(Stage(parts[:k], check(assembly).mass_kg, assembly, numbered_modes(assembly, number)))
    return tuple(found)
