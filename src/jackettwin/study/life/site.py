"""The site of a structure: bins of wind, sea and state with the share of time that each has."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from jackettwin.errors import located, require
from jackettwin.files import Angle, Schema, find_file, read_yaml, validate

_SEA_SEEDS = 1_000_000
"""Wave seeds start here, so that no wind shares one."""
_WHOLE = 1.0 + 1e-6


class SiteBin(Schema):
    """A part of all time: its share, and wind, sea and state in it; without ``hs_m`` there are no waves."""

    share: Annotated[float, Field(gt=0.0, le=1.0)]
    state: Literal["parked", "idling", "operating"]
    speed_m_s: Annotated[float, Field(ge=0.0, le=70.0)]
    hs_m: Annotated[float, Field(gt=0.0, le=30.0)] | None = None
    tp_s: Annotated[float, Field(ge=1.0, le=40.0)] | None = None
    misalignment_deg: Angle = 0.0
    seeds: Annotated[int, Field(ge=1, le=100)] | None = None
    records: list[str] = []


class _SiteSchema(Schema):
    scenario: str
    twin: str | None = None
    seeds: Annotated[int, Field(ge=1, le=100)] = 2
    years: Annotated[float, Field(gt=0.0, le=200.0)] = 25.0
    age_years: Annotated[float, Field(ge=0.0, le=200.0)] = 0.0
    target_index: Annotated[float, Field(ge=0.0, le=6.0)] = 3.3
    bins: Annotated[list[SiteBin], Field(min_length=1)]
    variants: dict[str, dict[str, Any]] = {}


@dataclass(frozen=True)
class Site:
    """Conditions and states of a structure over its life.

    Attributes
    ----------
    path, scenario : files of the site, and of what all its bins share
    data : content of the scenario
    twin : file whose updated supports replace the scenario's, and that records are told with
    bins : tuple of SiteBin
    seeds : simulations of a bin without records, unless it states its own number
    years, age_years : design life, and what of it has passed
    target_index : reliability index that no year may fall below
    variants : {name: keys of the scenario that differ}, to set beside
    """

    path: Path
    scenario: Path
    data: dict[str, Any]
    twin: Path | None
    bins: tuple[SiteBin, ...]
    seeds: int
    years: float
    age_years: float
    target_index: float
    variants: dict[str, dict[str, Any]]

    @property
    def share(self) -> float:
        """Share of all time that the bins cover."""
        return sum(one.share for one in self.bins)

    def simulations(self, index: int, overrides: dict[str, Any]) -> list[dict[str, Any]]:
        """Return the contents of a bin's scenario files; variants have the same seeds."""
        one = self.bins[index]
        base = {**self.data, **overrides}
        base["rotor"] = {**(base.get("rotor") or {}), "state": one.state}
        wind, waves = base.get("wind") or {}, base.get("waves") or {"type": "jonswap"}
        found = []
        for k in range(one.seeds or self.seeds):
            seed = 100 * index + k + 1
            content = {**base, "wind": {**wind, "speed_m_s": one.speed_m_s, "seed": seed}}
            content.pop("waves", None)
            if one.hs_m is not None:
                content["waves"] = {
                    **waves,
                    "hs_m": one.hs_m,
                    "tp_s": one.tp_s,
                    "direction_deg": one.misalignment_deg,
                    "seed": _SEA_SEEDS + seed,
                }
            found.append(content)
        return found

    def records(self, index: int) -> list[Path]:
        """Return the files of a bin's records."""
        return [self.path.parent / name for name in self.bins[index].records]


def read_site(path: Path) -> Site:
    """Read a site file.

    Raises
    ------
    InputError
        If the file or one that it names is missing, or anything in it is wrong.
    """
    said = validate(_SiteSchema, read_yaml(path, what="site file"), file=path)
    with located(file=path):
        total = sum(one.share for one in said.bins)
        require(total <= _WHOLE, "bins share more than all time", field="bins", value=total, allowed="≤ 1")
        for i, one in enumerate(said.bins):
            with located(field=f"bins.{i}"):
                require(
                    (one.hs_m is None) == (one.tp_s is None), "hs_m and tp_s go together", field="hs_m",
                    remedy="give both or neither",
                )  # fmt: skip
                require(
                    not one.records or said.twin is not None, "records need a twin", field="records",
                    remedy="state twin: FILE",
                )  # fmt: skip
        require("as stated" not in said.variants, "is the scenario itself", field="variants.as stated")
        scenario = find_file(said.scenario, "scenarios", folder=path.parent)
    site = Site(
        path, scenario, read_yaml(scenario, what="scenario file"),
        None if said.twin is None else path.parent / said.twin, tuple(said.bins), said.seeds, said.years,
        said.age_years, said.target_index, said.variants,
    )  # fmt: skip
    for i in range(len(site.bins)):
        for record in site.records(i):
            require(record.exists(), "no such file", file=path, field=f"bins.{i}.records", value=record.name)
    return site
