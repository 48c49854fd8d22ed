"""Section forces that another program computed: a table's columns on the sections of a structure."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.decks import SECTION_CHANNELS, MemberOutput
from jackettwin.errors import InputError, look_up, require
from jackettwin.structure import Assembly, SectionForces

_PARTS = ("axial", "bending_y", "bending_z")
_COLUMN = re.compile(
    r"^(?P<member>.+)\.(?P<end>start|end)\.(?P<part>axial|bending_y|bending_z)_(?P<unit>[kM]?(?:n|nm))$",
    re.IGNORECASE,
)
_PREFIX = {"": 1.0, "k": 1e3, "m": 1e6}
_BLOCK = 1000
_NEAR = 1e-6


@dataclass(frozen=True)
class GivenSections:
    """Section forces at some places along the members of an assembly; between them they run straight.

    Attributes
    ----------
    assembly : Assembly
    places : {member: (k,) shares of its length from its start, rising}
    forces : {member: (k, 3, n)} axial force [N], moments about local y and z [N·m]
    """

    assembly: Assembly
    places: Mapping[str, FloatArray]
    forces: Mapping[str, FloatArray]

    @property
    def n_samples(self) -> int:
        """Number of samples."""
        return int(next(iter(self.forces.values())).shape[-1])

    @property
    def known(self) -> BoolArray:
        """Whether the forces at both ends of each element are known, (n_elements, 2)."""
        found = np.zeros((self.assembly.mesh.start.size, 2), dtype=bool)
        for elements, at, shares in self._elements():
            found[elements] = (shares >= at[0] - _NEAR) & (shares <= at[-1] + _NEAR)
        return found

    def blocks(self) -> Iterator[SectionForces]:
        """Yield section forces (n, n_elements, 2), a thousand samples at a time; zero where unknown."""
        known = self.known
        for first in range(0, self.n_samples, _BLOCK):
            n = min(_BLOCK, self.n_samples - first)
            parts = np.zeros((3, n, *known.shape))
            for (elements, at, shares), values in zip(self._elements(), self.forces.values(), strict=True):
                here = values[:, :, first : first + n]
                right = np.clip(np.searchsorted(at, shares - _NEAR), 1, max(len(at) - 1, 1))
                left = right - 1
                right = np.minimum(right, len(at) - 1)
                span = np.where(right > left, at[right] - at[left], 1.0)
                share = ((shares - at[left]) / span)[..., None, None]
                between = (1.0 - share) * here[left] + share * here[right]
                parts[:, :, elements] = between.transpose(2, 3, 0, 1)
            axial, bending_y, bending_z = np.where(known, parts, 0.0)
            nothing = np.zeros(axial.shape)
            yield SectionForces(axial, nothing, nothing, nothing, bending_y, bending_z)

    def _elements(self) -> Iterator[tuple[np.ndarray, FloatArray, FloatArray]]:
        """Yield the elements (k,) of each member, its places, and the shares (k, 2) of the elements' ends."""
        numbers = {m.name: i for i, m in enumerate(self.assembly.structure.members)}
        for name, at in self.places.items():
            mine = np.flatnonzero(self.assembly.mesh.member == numbers[name])
            shares = (np.arange(mine.size)[:, None] + [0, 1]) / mine.size
            yield mine, at, shares


def given_sections(
    assembly: Assembly,
    names: Sequence[str],
    data: FloatArray,
    outputs: Sequence[MemberOutput] = (),
) -> GivenSections:
    """Return the section forces in a table's columns.

    Columns are called as ``simulate --section-forces`` writes them: MEMBER.start.axial_n,
    MEMBER.start.bending_y_nm, … (also in kn, mn, knm, mnm). Those of SubDyn, M1N1FKze, M1N1MKxe and M1N1MKye
    [N, N·m], stand at the nodes that its deck names.

    Parameters
    ----------
    data : (n_columns, n_samples)
    outputs : what a SubDyn deck asks for

    Raises
    ------
    InputError
        If no column is a section force, one of a section's three is missing, or a member is unknown.
    """
    rows = dict(zip(names, data, strict=True))
    found: dict[tuple[str, float], dict[str, FloatArray]] = {}
    members = {m.name: None for m in assembly.structure.members}
    for name, values in rows.items():
        match = _COLUMN.match(name)
        if match is not None:
            look_up(members, match["member"], "member", field=name)
            part, unit = match["part"].lower(), match["unit"].lower()
            moment = unit.endswith("nm")
            require(
                moment == (part != "axial"), "is not a unit of this", field=name, value=match["unit"],
                allowed="n, kn, mn of forces; nm, knm, mnm of moments",
            )  # fmt: skip
            scale = _PREFIX[unit.removesuffix("m" if moment else "").removesuffix("n")]
            place = (match["member"], 0.0 if match["end"].lower() == "start" else 1.0)
            found.setdefault(place, {})[part] = scale * values
    for one in outputs:
        own = {
            part: rows.get(f"{one.prefix}{suffix}")
            for part, suffix in zip(_PARTS, SECTION_CHANNELS, strict=True)
        }
        if any(values is not None for values in own.values()):
            found[one.member, one.position] = _turned(assembly, one, _whole(one.prefix, own))
    if not found:
        raise InputError(
            "no column is a section force of the structure", field="columns", value=", ".join(names[:5]),
            allowed="MEMBER.start.axial_n, MEMBER.start.bending_y_nm, … or SubDyn's M1N1FKze, M1N1MKxe, …",
            remedy="name the columns so; of SubDyn's give its deck as the structure",
        )  # fmt: skip
    places, forces = {}, {}
    for member in dict.fromkeys(member for member, _ in found):
        at = sorted(position for name, position in found if name == member)
        places[member] = np.array(at)
        whole = [_whole(f"{member} at {x:g}", dict(found[member, x])) for x in at]
        forces[member] = np.array([[one[part] for part in _PARTS] for one in whole])
    return GivenSections(assembly, places, forces)


def _whole(section: str, parts: Mapping[str, FloatArray | None]) -> dict[str, FloatArray]:
    missing = [part for part in _PARTS if parts.get(part) is None]
    require(
        not missing, "a section needs its axial force and both bending moments", field=section,
        value=f"without {', '.join(missing)}", remedy="write all three",
    )  # fmt: skip
    return {part: values for part, values in parts.items() if values is not None}


def _turned(assembly: Assembly, one: MemberOutput, parts: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return SubDyn's forces with the moments about the assembly's own local axes."""
    structure, mesh = assembly.structure, assembly.mesh
    number = next(i for i, m in enumerate(structure.members) if m.name == one.member)
    axes = mesh.axes[int(np.flatnonzero(mesh.member == number)[0])][1:]
    moments = axes @ one.axes.T @ np.array([parts["bending_y"], parts["bending_z"]])
    return {"axial": parts["axial"], "bending_y": moments[0], "bending_z": moments[1]}
