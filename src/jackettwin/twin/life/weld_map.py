"""Stress at every weld of a structure from a motion of its model."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import AnyFloatArray, FloatArray
from jackettwin.checks import joint_plans
from jackettwin.errors import require
from jackettwin.fatigue import Cycles, JointStresses, TubeWeld, count, joint_stresses
from jackettwin.response import System, nodal_load, self_weight, static_displacement
from jackettwin.sensing import MotionModel, Weather, section_rows
from jackettwin.structure import Assembly, SectionForces, element_weight, section_forces
from jackettwin.twin.water import WaterConfig, still_loads

_YIELD_PA = 355e6
"""Yield strength that the design of joints requires and fatigue does not use."""


class RestingLoads(NamedTuple):
    """What loads a structure at rest: on the DOFs (n_dof,), and along its elements (n_elements, 12).

    Forces at rest decide how the axial force of a brace is shared between K, Y and X joints, whose factors
    differ by three.
    """

    on_dofs: FloatArray
    along: FloatArray

    @classmethod
    def of(cls, dry: Assembly, water: WaterConfig | None = None) -> RestingLoads:
        """Return the weight of steel, and of growth and water inside less buoyancy.

        Parameters
        ----------
        dry : with the mass of steel alone
        water : none whose mass is in the structure's own, as it is unknown then which members are flooded
        """
        load, along = self_weight(dry), element_weight(dry)
        if water is None or not water.adds_mass:
            return cls(load, along)
        wet = still_loads(water, dry)
        return cls(load + wet.load, along + wet.along)

    def under(self, weather: Weather, assembly: Assembly) -> RestingLoads:
        """Return the loads with the mean thrust of a rotor at work that is known."""
        if not weather.working or weather.rotor is None:
            return self
        c, s = np.cos(weather.heading_rad), np.sin(weather.heading_rad)
        push = weather.rotor.thrust_n * np.array([c, s, 0.0, 0.0, 0.0, 0.0])
        at_top = nodal_load(assembly, {assembly.structure.top_node: tuple(push)})
        return self._replace(on_dofs=self.on_dofs + at_top)


@dataclass(frozen=True)
class WeldMap:
    """Stress at every weld from the coordinates of a motion.

    Attributes
    ----------
    joints : tuple of JointStresses
    rows : for every joint, (n_braces, 3, n_coordinates) nominal stress at unit coordinates; no braces where
        stresses are not asked
    at_rest : likewise, (n_braces, 3) nominal stress under weight and buoyancy
    tubes : for every weld around a tube, (8 points, n_coordinates) stress at unit coordinates
    """

    joints: tuple[JointStresses, ...]
    rows: tuple[FloatArray, ...]
    at_rest: tuple[FloatArray, ...]
    tubes: tuple[FloatArray, ...] = ()

    def stress(self, joint: int, motion: FloatArray, braces: Sequence[int] | None = None) -> FloatArray:
        """Return stresses (n_braces, 2, 8, n) [Pa] of a joint, or of some of its braces.

        Parameters
        ----------
        motion : (n, n_coordinates)
        """
        nominal = self.rows[joint] @ motion.T + self.at_rest[joint][:, :, None]
        return self.joints[joint].stress_under(nominal, braces)

    def parts(self, joint: int, motion: AnyFloatArray, braces: Sequence[int]) -> FloatArray:
        """Return K's, Y's and X's parts of the nominal stresses of some braces of a joint, (n_braces, 9, n).

        They are as precise as the motion is.
        """
        rows, rest = (part.astype(motion.dtype) for part in (self.rows[joint], self.at_rest[joint]))
        axial = rows[:, 0] @ motion.T + rest[:, :1]
        bending = rows[braces, 1:] @ motion.T + rest[braces, 1:, None]
        nominal = np.concatenate([axial[braces][:, None], bending], axis=1)
        return self.joints[joint].parts(axial, nominal, braces)

    def cycles(self, motion: FloatArray) -> list[list[list[Cycles]]]:
        """Return the cycles at (welds, 2 sides, 8 points) of a motion."""
        return [
            [[count(series) for series in side] for side in weld]
            for joint in range(len(self.joints))
            for weld in self.stress(joint, motion)
        ]


def planned_joints(assembly: Assembly) -> tuple[JointStresses, ...]:
    """Return the joints of tubes of a structure with their welds; none where no brace stands on a chord."""
    return joint_stresses(assembly.structure, joint_plans(assembly, _YIELD_PA))


def weld_map(
    system: System,
    model: MotionModel,
    rest: RestingLoads,
    joints: tuple[JointStresses, ...] | None = None,
    *,
    of: Collection[int] | None = None,
    tubes: Sequence[TubeWeld] = (),
) -> WeldMap:
    """Return the map from a motion of the model to the stresses of the structure's welds.

    Parameters
    ----------
    rest : what the structure bears at rest
    joints : of the structure, if they are planned already
    of : numbers of the joints whose stresses are asked; of all without it
    tubes : welds around tubes

    Raises
    ------
    InputError
        If no brace is welded to a chord.
    """
    joints = planned_joints(model.assembly) if joints is None else joints
    require(joints, "no brace is welded to a chord", field="structure", remedy="joints of tubes are checked")
    u = static_displacement(system, rest.on_dofs)
    still = section_forces(model.assembly, u[None], along=rest.along[None])
    # at rest is one coordinate more
    unit = section_rows(model)
    forces = SectionForces(*(np.concatenate(pair) for pair in zip(unit, still, strict=True)))
    asked, none = range(len(joints)) if of is None else of, np.zeros((0, 3, 1 + len(forces.axial)))
    nominal = [
        joint.nominal(model.assembly, forces) if j in asked else none for j, joint in enumerate(joints)
    ]
    return WeldMap(
        joints,
        tuple(n[:, :, :-1] for n in nominal),
        tuple(n[:, :, -1] for n in nominal),
        tuple(weld.stress(unit) for weld in tubes),
    )
