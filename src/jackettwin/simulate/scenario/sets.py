"""Sets of simulations: one scenario under many winds, seas, misalignments and seeds (IEC 61400-3-1 DLC 6.4).

A set is a file: the scenario that all cases share, and what differs. Each case has seeds of its own.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from itertools import product
from pathlib import Path
from typing import Annotated, Any

from pydantic import AwareDatetime, Field

from jackettwin.errors import InputError, located
from jackettwin.files import Angle, Schema, find_file, read_yaml, shipped, validate
from jackettwin.simulate.scenario.air import WindSpeed
from jackettwin.simulate.scenario.sea import Period, SignificantHeight
from jackettwin.version import __version__

Heading = Annotated[float, Field(ge=-180.0, le=180.0)]
_SEA_SEEDS = 1_000_000
"""Wave seeds start here, sensor seeds at twice this: no two streams share a seed."""


class BinSchema(Schema):
    """A bin of wind with its sea; no ``hs_m`` is no waves."""

    speed_m_s: WindSpeed
    hs_m: SignificantHeight | None = None
    tp_s: Period | None = None


class SetSchema(Schema):
    """A set file."""

    scenario: str
    bins: list[BinSchema] = Field(min_length=1)
    misalignment_deg: list[Angle] = Field(default=[0.0], min_length=1)
    yaw_deg: list[Heading] = Field(default=[0.0], min_length=1)
    seeds: Annotated[int, Field(ge=1, le=1000)] = 6
    first_seed: Annotated[int, Field(ge=0, lt=_SEA_SEEDS)] = 1
    start_utc: AwareDatetime | None = None
    every_hours: Annotated[float, Field(gt=0.0, le=8760.0)] = 1.0


@dataclass(frozen=True)
class Case:
    """One simulation of a set: the content of its scenario file, which stands for ``path``.

    ``start_utc`` is when its record begins; None for the same time as any other record.
    """

    name: str
    path: Path
    data: dict[str, Any]
    start_utc: datetime | None = None

    @property
    def key(self) -> str:
        """Tells a finished record of this very case from any other."""
        start = [] if self.start_utc is None else [self.start_utc.isoformat()]
        text = json.dumps([self.data, __version__, *start], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclass(frozen=True)
class ScenarioSet:
    """A set of cases."""

    name: str
    path: Path
    cases: tuple[Case, ...]


def shipped_sets() -> tuple[str, ...]:
    """Return the names of the sets that come with the package."""
    return shipped("sets")


def read_set(source: str | Path) -> ScenarioSet:
    """Read a set: a shipped name or a YAML file.

    Raises
    ------
    InputError
        If the file or its scenario is missing, or anything in it is wrong.
    """
    path = find_file(source, "sets")
    schema = validate(SetSchema, read_yaml(path, what="set file"), file=path)
    with located(file=path):
        base = find_file(schema.scenario, "scenarios", folder=path.parent)
    data = read_yaml(base, what="scenario file")
    for index, entry in enumerate(schema.bins):
        if (entry.hs_m is None) != (entry.tp_s is None):
            raise InputError(
                "hs_m and tp_s go together", file=path, field=f"bins.{index}", remedy="give both or neither"
            )
    every = product(schema.bins, schema.misalignment_deg, schema.yaw_deg, range(schema.seeds))
    cases = tuple(
        replace(
            _case(base, data, entry, misalignment, yaw, schema.first_seed + number),
            start_utc=schema.start_utc and schema.start_utc + timedelta(hours=number * schema.every_hours),
        )
        for number, (entry, misalignment, yaw, _) in enumerate(every)
    )
    return ScenarioSet(path.stem, path, cases)


def _case(
    path: Path, data: dict[str, Any], entry: BinSchema, misalignment: float, yaw: float, seed: int
) -> Case:
    """Return the base with this bin's wind and sea; waves run ``misalignment`` from the wind, which is +x."""
    wind = {**(data.get("wind") or {}), "speed_m_s": entry.speed_m_s, "yaw_deg": yaw, "seed": seed}
    content = {**data, "wind": wind, "sensor_seed": 2 * _SEA_SEEDS + seed}
    content.pop("waves", None)
    name = f"U{entry.speed_m_s:g}"
    if entry.hs_m is not None:
        content["waves"] = {
            **(data.get("waves") or {"type": "jonswap"}),
            "hs_m": entry.hs_m,
            "tp_s": entry.tp_s,
            "direction_deg": misalignment,
            "seed": _SEA_SEEDS + seed,
        }
        name += f"_m{misalignment:g}"
    name += f"_y{yaw:g}_s{seed}"
    return Case(name.replace("-", "n").replace(".", "p"), path, content)
