"""Damping and stiffness that an operating rotor with bending blades adds at the tower top of a twin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.errors import located
from jackettwin.loads import (
    OPERATING_LEAST_RATIO,
    Control,
    Rotor,
    operating_damping,
    operating_point,
    read_rotor,
    read_schedule,
)
from jackettwin.response import Matrix, UndampedModes
from jackettwin.sensing import RotorByWind
from jackettwin.structure import Assembly
from jackettwin.twin.config import TwinConfig
from jackettwin.updating import DASHPOTS

USUAL_WIND_M_S = 12.0
"""Where the wind is not known: from 10 to 25 m/s the stiffness changes by a tenth."""
AT_WORK_STD = 0.3
"""Relative standard deviation of the stiffness: frequencies agree with OpenFAST 5 within a fifth of the 6 to
8 % that it adds (docs/verification/operation.md); a controller and gusts are assumed."""
_ROUNDS = 2
_SIDES = {"c_fore_aft": (0, 2, 4), "c_side_side": (1, 3, 5)}
"""Degrees of freedom of the tower top that a rotor without yaw error couples with each other."""


@dataclass(frozen=True)
class RotorSide:
    """A rotor at work as the first bending mode of one direction sees it.

    Attributes
    ----------
    dashpot : at the tower top, that takes as much of this mode [N·s/m]
    pattern : (6, 6) matrix of a dashpot of 1 N·s/m, symmetric
    stiffness : (6, 6), symmetric
    """

    dashpot: float
    pattern: FloatArray
    stiffness: FloatArray


def of_side(matrix: FloatArray, dashpot: str) -> FloatArray:
    """Return the symmetric part of a rotor's matrix (6, 6) on the degrees of freedom of one direction."""
    dofs = np.ix_(_SIDES[dashpot], _SIDES[dashpot])
    part = np.zeros((6, 6))
    part[dofs] = 0.5 * (matrix + matrix.T)[dofs]
    return part


def rotor_at_work(
    config: TwinConfig, assembly: Assembly, numbered: UndampedModes, wind: float
) -> Mapping[str, RotorSide]:
    """Return the rotor of a twin at work in a wind [m/s], by dashpot.

    What a first mode loses is the real part of its own pole among the first two, which the rotor couples;
    it is at least the smallest that can be told from nothing.

    Raises
    ------
    InputError
        If the rotor's files are wrong, or its schedule does not reach the wind.
    """
    given = config.update
    rotor, control = _files(config)
    with located(file=config.path, field="update"):
        operation = operating_point(rotor, control, wind)
    top = numbered.shapes[assembly.dofs(assembly.structure.top_node)][:, :2]
    omega = numbered.omega[:2]
    found = {}
    for name, axis in DASHPOTS.items():
        own = int(np.argmax(np.abs(top[axis])))
        pole = 1j * omega[own]
        for _ in range(_ROUNDS):
            mean = operating_damping(rotor, operation, pole=pole, shaft=given.shaft or "free")
            C, K = (top.T @ matrix @ top for matrix in (mean.damping, mean.stiffness))
            state = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.diag(omega**2) - K, -C]])
            poles, shapes = np.linalg.eig(state)
            pole = poles[np.argmax(np.where(poles.imag > 0.0, np.abs(shapes[own]), 0.0))]
        c = max(-2.0 * pole.real, 2.0 * OPERATING_LEAST_RATIO * omega[own]) / top[axis, own] ** 2
        part, phi = of_side(mean.damping, name), top[:, own]
        direct = float(phi @ part @ phi / phi[axis] ** 2)
        if direct <= 0.0:
            part, direct = np.zeros((6, 6)), 1.0
            part[axis, axis] = 1.0
        found[name] = RotorSide(float(c), part / direct, of_side(mean.stiffness, name))
    return found


def rotor_by_wind(config: TwinConfig, first_hz: float) -> RotorByWind | None:
    """Return a twin's rotor in any wind, for what it does at a first frequency; None without its files.

    Raises
    ------
    InputError
        If the rotor's files are wrong.
    """
    if config.update.rotor is None:
        return None
    return RotorByWind(*_files(config), first_hz, config.update.shaft or "free")


def _files(config: TwinConfig) -> tuple[Rotor, Control]:
    given = config.update
    with located(file=config.path, field="update"):
        rotor, control = read_rotor(given.rotor or "")
        if given.rotor_schedule is not None:
            control = replace(control, schedule=read_schedule(Path(given.rotor_schedule)))
    return rotor, control


def stiffness_at_work(sides: Mapping[str, RotorSide], assembly: Assembly) -> Matrix:
    """Return what a rotor at work adds to a structure's stiffness, (assembly.n_dof, assembly.n_dof)."""
    K = np.sum([side.stiffness for side in sides.values()], axis=0)
    dofs = assembly.dofs(assembly.structure.top_node)
    rows, columns = np.meshgrid(dofs, dofs, indexing="ij")
    return sp.csc_array((K.ravel(), (rows.ravel(), columns.ravel())), shape=assembly.stiffness.shape)
