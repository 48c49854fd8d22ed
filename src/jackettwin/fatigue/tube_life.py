"""The worst point of every weld around a tube, and the file that names details."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import Field

from jackettwin.arrays import FloatArray
from jackettwin.errors import located, require, require_between
from jackettwin.fatigue.curves import Environment
from jackettwin.fatigue.cycles import Cycles
from jackettwin.fatigue.life import SpotLife
from jackettwin.fatigue.tube_welds import TUBE_POSITIONS, Detail, TubeDetails, TubeWeld
from jackettwin.fatigue.weld_life import ModelsAtHeight, worst_point
from jackettwin.files import Schema, read_mapping, validate
from jackettwin.structure import Structure

_BUTT_CURVE = "D"


@dataclass(frozen=True)
class TubeLife:
    """The worst of the eight points around a tube.

    Attributes
    ----------
    weld : TubeWeld
    position : angle of the point
    curve : name of the S-N curve
    environment : what corrodes it
    damage_by_point : (8,) by the design curve
    largest_range_pa : float
    life : SpotLife
    """

    weld: TubeWeld
    position: str
    curve: str
    environment: Environment
    damage_by_point: FloatArray
    largest_range_pa: float
    life: SpotLife


def tube_lives(
    structure: Structure,
    welds: Sequence[TubeWeld],
    cycles: Sequence[Sequence[Cycles]],
    duration_s: float,
    *,
    times: int = 1,
    others: Sequence[dict[str, FloatArray]] | None = None,
) -> tuple[TubeLife, ...]:
    """Return the life of every weld around a tube, shortest first.

    Parameters
    ----------
    cycles : for every weld, at its 8 points
    times : how often the cycles tell the time over
    others : for every weld, {source: variance of ln D (8,)}
    """
    found = []
    for i, (weld, points) in enumerate(zip(welds, cycles, strict=True)):
        environment, model = weld.models(weld.z_m - structure.sea_level_z_m)
        beside = [{} if others is None else {n: float(v[p]) for n, v in others[i].items()} for p in range(8)]
        worst, damage, largest, life = worst_point(
            model, points, duration_s, weld.section.thickness_m, beside, times=times
        )
        found.append(
            TubeLife(weld, TUBE_POSITIONS[worst], model.curve.name, environment, damage, largest, life)
        )
    return tuple(sorted(found, key=lambda one: one.life.life_years))


class _ButtWeldsSchema(Schema):
    curve: str = _BUTT_CURVE
    misalignment_m: float = 0.0


class _DetailSchema(Schema):
    name: str = Field(min_length=1)
    member: str
    position: float
    curve: str
    scf: float = 1.0


class _DetailsSchema(Schema):
    butt_welds: _ButtWeldsSchema = _ButtWeldsSchema()
    details: list[_DetailSchema] = []


def read_details(path: Path | None, models: Callable[[str], ModelsAtHeight]) -> TubeDetails:
    """Return what a YAML or JSON file says of welds around tubes; without one, butt welds on curve D.

    Parameters
    ----------
    models : from the name of an S-N curve to curves by elevation

    Raises
    ------
    InputError
        If the file cannot be read, or a number or a curve is none that can be.
    """
    if path is None:
        return TubeDetails(models(_BUTT_CURVE))
    said = validate(_DetailsSchema, read_mapping(path), file=path)
    own = []
    with located(file=path):
        with located(field="butt_welds"):
            require_between("misalignment_m", said.butt_welds.misalignment_m, 0.0, 0.1, "m")
            butt = models(said.butt_welds.curve)
        for i, one in enumerate(said.details):
            with located(field=f"details.{i}"):
                require_between("position", one.position, 0.0, 1.0)
                require_between("scf", one.scf, 1.0, 100.0)
                own.append(Detail(one.name, one.member, one.position, one.scf, models(one.curve)))
        names = [one.name for one in own]
        require(
            len(set(names)) == len(names),
            "two details have one name",
            field="details",
            value=", ".join(names),
        )
    return TubeDetails(butt, said.butt_welds.misalignment_m, tuple(own), path)
