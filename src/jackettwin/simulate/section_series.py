"""Section forces and reactions of a scenario as time series, and files of them for other programs."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, look_up
from jackettwin.files import atomic_path
from jackettwin.simulate.members import deflections
from jackettwin.simulate.motion.motion import simulate_motion
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.structure import Assembly, SectionForces, section_forces

SUFFIXES = (".parquet", ".outb")
_SECTION = ("axial_n", "shear_y_n", "shear_z_n", "torsion_nm", "bending_y_nm", "bending_z_nm")
_REACTION = ("fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm")
_NAME_LENGTH_IN_FILE = 4
"""Identifier of OpenFAST's binary whose names have a length of their own (WrBinFAST, NWTC library)."""


@dataclass(frozen=True)
class ForceSeries:
    """Series (n_channels, n_times) [N, N·m] with names, in steps of ``step_s``.

    Section forces are those of ``check``: MEMBER.start.axial_n …; reactions, NODE.reaction.fx_n …, are what
    the structure does to the ground along global axes, the inertia of the foot itself left out.
    """

    names: tuple[str, ...]
    values: FloatArray
    step_s: float


def force_series(scenario: Scenario, members: Sequence[str] = ()) -> ForceSeries:
    """Return section forces at both ends of members, and the reactions of all feet, over a scenario.

    Parameters
    ----------
    members : names of members; none are those that stand on the ground or carry the interface

    Raises
    ------
    InputError
        If there is no such member, or a part of the scenario does not fit.
    """
    for name in members:
        every = {member.name: None for member in scenario.asset.structure.members}
        look_up(every, name, "member", field="--members")
    motion = simulate_motion(scenario)
    return series_of(motion.model.assembly, deflections(scenario, motion), members, motion.step_s)


def series_of(
    assembly: Assembly, blocks: Iterable[tuple[FloatArray, FloatArray]], members: Sequence[str], step_s: float
) -> ForceSeries:
    """Return the series of blocks of displacements (n, n_dof) and loads along the elements.

    Without ``members`` those that stand on the ground or carry the interface.
    """
    structure = assembly.structure
    held = {*structure.reaction_nodes, *structure.interface_nodes}
    chosen = tuple(members) or tuple(m.name for m in structure.members if held & {m.start, m.end})
    parts = []
    for u, along in blocks:
        forces = section_forces(assembly, u, along=along)
        parts.append(np.vstack([_ends(assembly, forces, chosen), *_reactions(assembly, forces)]))
    names = [f"{name}.{end}.{part}" for name in chosen for end in ("start", "end") for part in _SECTION]
    names += [f"{node}.reaction.{part}" for node in structure.reaction_nodes for part in _REACTION]
    return ForceSeries(tuple(names), np.hstack(parts), step_s)


def _ends(assembly: Assembly, forces: SectionForces, members: Sequence[str]) -> FloatArray:
    """Return the six section forces at start and end of members, (12 n_members, n_times)."""
    numbers = {member.name: k for k, member in enumerate(assembly.structure.members)}
    rows = []
    for name in members:
        mine = np.flatnonzero(assembly.mesh.member == numbers[name])
        for element, end in ((mine[0], 0), (mine[-1], 1)):
            rows += [component[:, element, end] for component in forces]
    return np.array(rows)


def _reactions(assembly: Assembly, forces: SectionForces) -> list[FloatArray]:
    """Return the force and moment (6, n_times) of each foot on the ground, in global axes."""
    mesh = assembly.mesh
    found = []
    for node in assembly.structure.reaction_nodes:
        at = np.asarray(assembly.structure.nodes[node])
        total = np.zeros((6, forces.axial.shape[0]))
        for ends, end, sign in ((mesh.start, 0, 1.0), (mesh.end, 1, -1.0)):
            for element in np.flatnonzero(np.linalg.norm(mesh.coordinates[ends] - at, axis=1) < 1e-6):
                local = np.stack([component[:, element, end] for component in forces])
                axes = mesh.axes[element]
                total += sign * np.vstack([axes.T @ local[:3], axes.T @ local[3:]])
        found.append(total)
    return found


def write_force_series(series: ForceSeries, path: Path) -> None:
    """Write series as Parquet (a column each, and ``time_s``) or as an OpenFAST binary.

    Raises
    ------
    InputError
        If the file's name ends in neither.
    """
    if path.suffix == ".parquet":
        _write_parquet(series, path)
    elif path.suffix == ".outb":
        with atomic_path(path) as scratch:
            scratch.write_bytes(openfast_binary(series))
    else:
        raise InputError(
            "unknown kind of file", field="--section-forces", value=path.name, allowed=", ".join(SUFFIXES)
        )


def _write_parquet(series: ForceSeries, path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    time = series.step_s * np.arange(series.values.shape[1])
    columns = {"time_s": time, **dict(zip(series.names, series.values, strict=True))}
    with atomic_path(path) as scratch:
        pq.write_table(pa.table(columns), scratch)


def openfast_binary(series: ForceSeries) -> bytes:
    """Return series as WrBinFAST writes them: 16-bit integers, each channel with its slope and offset."""
    low, high = series.values.min(axis=1), series.values.max(axis=1)
    spread = high - low
    slope = np.where(spread > 0.0, 65534.0 / np.where(spread > 0.0, spread, 1.0), 1.0).astype("<f4")
    offset = (-0.5 * slope.astype(np.float64) * (low + high)).astype("<f4")
    packed = np.round(series.values * slope.astype(np.float64)[:, None] + offset.astype(np.float64)[:, None])
    names = ["Time", *series.names]
    units = ["(s)", *("(N)" if name.endswith("_n") else "(N-m)" for name in series.names)]
    width = max(map(len, names))
    text = b"section forces and reactions"
    n, n_times = series.values.shape
    parts = [
        struct.pack("<hhii", _NAME_LENGTH_IN_FILE, width, n, n_times),
        struct.pack("<dd", 0.0, series.step_s),
    ]
    parts += [slope.tobytes(), offset.tobytes(), struct.pack("<i", len(text)), text]
    parts += [word.ljust(width).encode("ascii", "replace") for word in (*names, *units)]
    parts.append(np.clip(packed, -32768, 32767).T.astype("<i2").tobytes())
    return b"".join(parts)
