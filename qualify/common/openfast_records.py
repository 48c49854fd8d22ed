"""Ten-minute records of a jacket by OpenFAST 5 with known moments: SubDyn's jacket in HydroDyn's sea.

Steel and feet are told to OpenFAST as SubDyn deck and static springs; the tower is ElastoDyn's, with two
shapes in each direction; the rotor is AeroDyn's in a turbulent box, standing feathered or turning at a fixed
speed and pitch.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from openfast import at_rest, execute, on_feet, reduced_to_interface
from rotor_forces import EACH_SIDE, GRID_M, aero_files, write_box

from common.hydrodyn_deck import Water, write_water
from common.openfast_deck import TOWER_NODES, Run, Turbine, write_case
from jackettwin.arrays import FloatArray
from jackettwin.decks.subdyn_writer import write_subdyn
from jackettwin.loads import operating_point, read_rotor
from jackettwin.loads.aerodynamics.turbulence import turbulence
from jackettwin.loads.aerodynamics.wind import Wind
from jackettwin.records.readers.openfast import read_text
from jackettwin.simulate import Asset as StandingAsset, asset_model, modes_with_rotor
from jackettwin.soil import read_support, with_static_reactions
from jackettwin.structure import Structure
from jackettwin.structure.cut import at_interface

DISCARD_S, DURATION_S, STEP_S = 30.0, 600.0, 0.05
FEATHERED_DEG, IDLING_RPM = 90.0, 0.3
GAUGES = (26, 7)
"""Nodes of the tower near 77 and 41 m."""
ACCELERATIONS = (
    *("YawBrTAxp", "YawBrTAyp", "TwHt1ALxt", "TwHt1ALyt", "TwHt2ALxt", "TwHt2ALyt", "PtfmTAxi", "PtfmTAyi"),
)
"""At the tower's top, both gauges and its bottom, along the wind and across it."""
TOWER_BASE, BED = ("TwrBsMxt", "TwrBsMyt"), ("ReactMXss", "ReactMYss")
_WIND_STEP_S = 0.25


@dataclass(frozen=True)
class Weather:
    """State, wind [m/s], waves' height [m], peak period [s] and direction [°], and the seed of both."""

    state: str
    wind: float
    height_m: float
    period_s: float
    direction_deg: float
    seed: int


@dataclass(frozen=True)
class Asset:
    """A jacket, what its truth has and a twin is not told: feet [N/m], drag, added mass, growth, steel."""

    structure: Structure
    feet_n_m: float
    drag: float
    added_mass: float
    growth_m: float
    tower_damping_percent: float
    depth_m: float

    @property
    def legs(self) -> tuple[tuple[str, ...], ...]:
        """Return the names of the legs' members, bay by bay from the lowest."""
        bays: dict[str, list[str]] = {}
        for bar in self.structure.members:
            if bar.name.startswith("leg_"):
                bays.setdefault(bar.name.rpartition("_bay_")[2], []).append(bar.name)
        return tuple(tuple(bays[bay]) for bay in sorted(bays, key=int))


def made(program: str, decks: Path, folder: Path, asset: Asset, weather: Weather) -> Path:
    """Run OpenFAST in a folder; return the file of its results."""
    folder.mkdir(parents=True, exist_ok=True)
    pitch_deg, speed_rpm = FEATHERED_DEG, IDLING_RPM if weather.state == "idling" else 0.0
    feet, thrust = f"kelvin-voigt:k={asset.feet_n_m},c=0", None
    if weather.state == "operating":
        rotor, control = read_rotor("iea15")
        at = operating_point(rotor, control, weather.wind)
        pitch_deg, speed_rpm = float(np.degrees(at.pitch)), at.rotor_speed * 30.0 / np.pi
        still = on_feet("at work", feet, pitch_deg, asset.structure)
        thrust = modes_with_rotor(
            asset_model(StandingAsset(still.structure, still.support)), rotor, at, shaft="locked"
        )[0].load
    standing = on_feet("a record's asset", feet, pitch_deg, asset.structure)
    machine = standing.turbine
    _deck(folder, asset)
    if weather.height_m > 0.0:
        _water(folder, asset, weather)
    _air(decks, folder, asset.structure, machine, weather)
    run = Run(
        flexible=True,
        rest=at_rest(standing.structure, reduced_to_interface(standing), thrust=thrust),
        duration_s=DISCARD_S + DURATION_S,
        step_s=STEP_S,
        sub=1,
        wind=True,
        water=weather.height_m > 0.0,
        rotor_rpm=speed_rpm,
        tower_damping_percent=asset.tower_damping_percent,
        gauges=GAUGES,
        channels=(*ACCELERATIONS, *TOWER_BASE),
    )
    primary = write_case(
        folder, standing.structure, machine, run, foundation="deck.dat", depth_m=asset.depth_m
    )
    execute(program, primary)
    return folder / "case.out"


def _deck(folder: Path, asset: Asset) -> None:
    """Write SubDyn's deck, which tells the forces at the lower end of every leg in every bay."""
    foundation, _ = at_interface(asset.structure.with_masses(()))
    support = read_support(f"kelvin-voigt:k={asset.feet_n_m},c=0", foundation)
    halved = replace(with_static_reactions(foundation, support), subdivide=2)
    write_subdyn(halved, folder / "deck.dat")
    names = [bar.name for bar in halved.bars]
    legs = [names.index(leg) + 1 for bay in asset.legs for leg in bay]
    text = (folder / "deck.dat").read_text()
    at = text.index("           0   NMOutputs")
    head = f"{len(legs):>12}   NMOutputs\nMemberID NOutCnt NodeCnt\n(-) (-) (-)\n"
    rows = "".join(f"{number} 1 1\n" for number in legs)
    asked = [name for k in range(len(legs)) for name in leg_channels(k)]
    wanted = "".join(f'"{name}"\n' for name in (*asked, *BED))
    text = f"{text[:at]}{head}{rows}---- SSOutList\n{wanted}END\n"
    (folder / "deck.dat").write_text(text)


def _water(folder: Path, asset: Asset, weather: Weather) -> None:
    steel = asset.structure.with_masses(())
    write_water(
        folder,
        steel,
        Water(
            asset.depth_m,
            weather.height_m,
            weather.period_s,
            waves="2",
            drag=asset.drag,
            added_mass=asset.added_mass,
            growth_m=asset.growth_m,
            duration_s=DISCARD_S + DURATION_S,
            piece_m=6.0,
            slender_m=1.0,
            direction_deg=weather.direction_deg,
            seed=weather.seed,
            grid=(11, 11, 16),
        ),
    )


def _air(decks: Path, folder: Path, structure: Structure, machine: Turbine, weather: Weather) -> None:
    """Write a turbulent box around the rotor, and AeroDyn's files."""
    r = machine.rotor
    top = structure.nodes[structure.top_node][2] - structure.sea_level_z_m
    hub = top + float(r.hub_height)
    wind = Wind(weather.wind, hub, turbulence="B")
    steps = GRID_M * np.arange(-EACH_SIDE, EACH_SIDE + 1)
    nodes = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2) + [0.0, hub]
    field = turbulence(
        wind,
        nodes,
        duration=DISCARD_S + DURATION_S,
        sample_rate_hz=1.0 / _WIND_STEP_S,
        seed=weather.seed,
        coherent="u",
    )
    box = field.reshape(-1, steps.size, steps.size, 3).transpose(0, 2, 1, 3).copy()
    box[..., 0] += wind.mean(hub + steps)[None, :, None]
    write_box(folder / "wind.bts", box, speed=weather.wind, hub=hub, step_s=_WIND_STEP_S)
    aero = {"TwrPotent": "0", "TwrShadow": "0", "TwrAero": "True"}
    standing = {"Wake_Mod": "0", "UA_Mod": "0"}
    working = {"UA_Mod": "3", "DBEMT_Mod": "2"}
    aero |= working if weather.state == "operating" else standing
    aero_files(decks, folder, inflow={"WindType": "3", "FileName_BTS": '"wind.bts"'}, aero=aero)
    # what happens at every blade's node fills the results and is not asked
    text = (folder / "aero.dat").read_text()
    (folder / "aero.dat").write_text(text.partition("====== Outputs for all blade stations")[0])


def tower_height_m(structure: Structure, gauge: int) -> float:
    """Return the height above the sea of a node of ElastoDyn's tower."""
    base = structure.nodes[structure.interface_nodes[0]][2] - structure.sea_level_z_m
    top = structure.nodes[structure.top_node][2] - structure.sea_level_z_m
    return base + (gauge - 0.5) / TOWER_NODES * (top - base)


def kept(path: Path, asset: Asset) -> dict[str, FloatArray]:
    """Return what is kept of a result after its beginning, {name: (n_samples,)}, in N, m and s."""
    found = read_text(path)
    after = found.times_s >= DISCARD_S
    wanted = (
        *ACCELERATIONS,
        *TOWER_BASE,
        *BED,
        *(name for leg in range(sum(map(len, asset.legs))) for name in leg_channels(leg)),
    )
    return {name: found.data[found.names.index(name)][after] for name in wanted}


def leg_channels(number: int) -> tuple[str, str, str]:
    """Return the names of axial force and both moments at the lower end of leg ``number`` of all bays."""
    k = number + 1
    return f"M{k}N1FKze", f"M{k}N1MKxe", f"M{k}N1MKye"
