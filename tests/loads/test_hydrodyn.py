"""Loads on the OC3 tripod under an Airy wave against HydroDyn's own output (OpenFAST 3.2, r-test).

60 members, some tapered, inclined and through the surface; C_D = C_a = C_p = 1, all axial coefficients 1.

The HydroDyn of that output lumps loads at nodes 1 m apart. At the node below still water it takes the stretch
up to the surface *off* the lumped length instead of adding it, and it loads half an element that lies below
the bed. Both are done here too, in a lumping of our own, to reach the printed totals.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from jackettwin.loads.members.coefficients import Coefficients
from jackettwin.loads.members.ends import EndCoefficients, end_forces, member_ends
from jackettwin.loads.members.morison import above_bed, morison_points, point_forces, wetness
from jackettwin.loads.sea.wave_series import resultant_columns
from jackettwin.loads.sea.waves import airy_wave
from jackettwin.structure import Section, Structure, assemble
from jackettwin.structure.model import STEEL, Member

DATA = json.loads((Path(__file__).parents[1] / "data/hydrodyn/oc3_tripod.json").read_text())
RHO, DEPTH = DATA["wave"]["density_kg_m3"], DATA["wave"]["depth_m"]
WAVE = airy_wave(height=DATA["wave"]["height_m"], period=DATA["wave"]["period_s"], depth=DEPTH)
JOINTS = {name: np.array(xyz) for name, xyz in DATA["joints"].items()}
TOTAL = DATA["total"]
TIMES = np.array(TOTAL["time_s"])


@pytest.fixture(scope="module")
def tripod():
    tube = {name: Section(*size) for name, size in DATA["sections"].items()}
    members = tuple(
        Member(str(i + 1), str(a), str(b), tube[str(p)], tube[str(q)], STEEL)
        for i, (a, b, p, q) in enumerate(DATA["members"])
    )
    return assemble(Structure("tripod", {k: tuple(v) for k, v in JOINTS.items()}, members, sea_level_z_m=0.0))


@pytest.fixture(scope="module")
def end_loads(tripod):
    """Force and moment about still water of the pressure, added mass and drag on ends, (n_times, 6)."""
    ends = member_ends(tripod, EndCoefficients(1.0, 1.0, 1.0), Coefficients(), highest_z=0.0, lowest_z=-DEPTH)
    return end_forces(ends, WAVE, TIMES).reshape(TIMES.size, -1) @ resultant_columns(ends.points)


def lumped(spacing: float, *, as_printed: bool) -> np.ndarray:
    """Return Morison's force and moment from nodes along the members, as HydroDyn sums them."""
    places, arms, lengths, radii, axes = [], [], [], [], []
    for a, b, p, q in DATA["members"]:
        start, end = JOINTS[str(a)], JOINTS[str(b)]
        if start[2] < -DEPTH and not as_printed:
            continue
        L = float(np.linalg.norm(end - start))
        n, axis = int(np.ceil(L / spacing - 1e-9)), (end - start) / L
        dl, (d0, d1) = L / n, (DATA["sections"][str(k)][0] for k in (p, q))
        for i in range(n + 1):
            x = start + (end - start) * i / n
            if not -DEPTH <= x[2] <= 0.0:
                continue
            left, right = (0.5 * dl if i > 0 else 0.0), (0.5 * dl if i < n else 0.0)
            if i < n and x[2] + axis[2] * dl > 0.0:
                to_surface = -x[2] / axis[2]
                left, right = (left - to_surface, 0.0) if as_printed else (left, to_surface)
            places.append(x)
            arms.append(x + 0.5 * (right - left) * axis)
            lengths.append(left + right)
            radii.append(0.5 * (d0 + (d1 - d0) * i / n))
            axes.append(axis)
    r, k = np.array(radii)[:, None], np.array(axes)
    u, du = WAVE.motion(np.array(places), TIMES)
    v, acc = (field - np.einsum("tnj,nj,ni->tni", field, k, k) for field in (u, du))
    f = RHO * r * np.linalg.norm(v, axis=-1, keepdims=True) * v + 2.0 * RHO * np.pi * r**2 * acc
    f *= np.array(lengths)[:, None]
    return np.hstack([f.sum(axis=1), np.cross(np.array(arms), f).sum(axis=1)])


def test_the_water_moves_as_in_hydrodyn() -> None:
    """Velocity and acceleration at the end of member 19, to the printed digits."""
    known = DATA["member_19_end"]
    u, du = WAVE.motion(JOINTS["19"][None], np.array(known["time_s"]))
    for ours, theirs in (
        (u[:, 0, 0], "velocity_x"),
        (u[:, 0, 2], "velocity_z"),
        (du[:, 0, 0], "acceleration_x"),
    ):
        np.testing.assert_allclose(ours, known[theirs], rtol=2e-6)


def test_loads_per_length_of_an_inclined_brace(tripod) -> None:
    """Drag and inertia at the end of member 19, from a point of ours moved there."""
    known = DATA["member_19_end"]
    grid = morison_points(tripod, highest_z=0.0, lowest_z=-DEPTH)
    last = np.flatnonzero(grid.member == 18)[-1]
    u, du = (np.zeros((len(known["time_s"]), grid.weight.size, 3)) for _ in range(2))
    u[:, last], du[:, last] = (
        field[:, 0] for field in WAVE.motion(JOINTS["19"][None], np.array(known["time_s"]))
    )
    drag, inertia = (
        point_forces(grid, a, b)[:, last] / grid.weight[last] for a, b in ((u, 0 * du), (0 * u, du))
    )
    for ours, what in ((drag, "drag"), (inertia, "inertia")):
        for axis, i in (("x", 0), ("z", 2)):
            # printed from single-precision fields; drag passes through zero
            theirs = np.array(known[f"{what}_{axis}"])
            np.testing.assert_allclose(ours[:, i], theirs, rtol=2e-5, atol=1e-6 * np.abs(theirs).max())


def test_force_and_moment_are_hydrodyns(tripod, end_loads) -> None:
    """Totals with its own lumping: 0.04 % of the largest force, 0.19 % of the largest moment."""
    total = lumped(1.0, as_printed=True) + end_loads
    for ours, theirs, rtol in (
        (total[:, 0], np.array(TOTAL["force_x_n"]), 1e-3),
        (total[:, 4], np.array(TOTAL["moment_y_n_m"]), 2.5e-3),
    ):
        np.testing.assert_allclose(ours, theirs, atol=rtol * np.abs(theirs).max())


def test_vertical_force_is_hydrodyns_but_for_buoyancy(end_loads) -> None:
    """The column widens from 3.4 to 5.7 m: pressure on its cone is 0.4 MN of what the waves lift.

    HydroDyn prints buoyancy with it, which stands still; its own sum for this tripod is 8.852 MN, and 0.1 m
    deeper, as it stood, some 40 kN more.
    """
    waves = lumped(1.0, as_printed=True)[:, 2] + end_loads[:, 2]
    buoyancy = np.array(TOTAL["force_z_n"]) - waves
    assert buoyancy.mean() == pytest.approx(8.852e6 + 40e3, rel=2e-3)
    # 2.8 % of the range of the waves' part, 0.26 MN; without the cone's pressure it would be twice that range
    assert np.ptp(buoyancy) < 0.03 * np.ptp(waves)


@pytest.mark.parametrize("spacing", [0.25, 0.5, 1.0])
def test_integration_needs_no_lumping(tripod, spacing: float) -> None:
    """Our Gauss points against the lumping done right, 5 cm apart: 0.1 % of force and moment."""
    grid = morison_points(tripod, highest_z=0.0, lowest_z=-DEPTH, spacing=spacing)
    wet = wetness(grid, WAVE.surface(grid.points, TIMES)) * above_bed(grid, DEPTH)
    forces = point_forces(grid, *WAVE.motion(grid.points, TIMES), wet=wet)
    ours = forces.reshape(TIMES.size, -1) @ resultant_columns(grid.points)
    exact = lumped(0.05, as_printed=False)
    for i in (0, 4):
        np.testing.assert_allclose(ours[:, i], exact[:, i], atol=1e-3 * np.abs(exact[:, i]).max())
