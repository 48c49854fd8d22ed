"""What somebody else's package may add: one of each kind that docs/design/008-extending.md names."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from jackettwin.change import Happening, Standing
from jackettwin.identification import OrderPoles, ssi_cov
from jackettwin.identification.subspace.covariances import covariances
from jackettwin.identification.subspace.ssi_cov import order_poles
from jackettwin.records import Format, ReadTable
from jackettwin.response import SENSOR_KINDS
from jackettwin.soil import Curve, Family, Law, Parameter, SoilCurve, family, soil_curves
from jackettwin.structure import Assembly
from jackettwin.structure.model import PointMass
from jackettwin.updating import NuisanceParameter


class Lagging(Family):
    """D = k (1 + τ s): Kelvin and Voigt's law by its time instead of its dashpot."""

    name = "lagging"
    words = "a spring whose force comes late"
    parameters = (
        Parameter("k", 1e7, 1e14, "N/m", words="stiffness"),
        Parameter("tau_s", 1e-4, 1e2, "s", words="time by which the force is late"),
    )

    def build(self, values: np.ndarray, reference_hz: float) -> Law:
        """Return the law."""
        return family("kelvin-voigt").build(_with_dashpot(values[None])[0], reference_hz)

    def rows(self, values: np.ndarray, reference_hz: float) -> tuple[np.ndarray, np.ndarray]:
        """Return rows and slopes: c = k τ, so that k moves both."""
        rows, slopes = family("kelvin-voigt").rows(_with_dashpot(values), reference_hz)
        return rows, slopes @ np.array([[1.0, 0.0], [1.0, 1.0]])


def _with_dashpot(values: np.ndarray) -> np.ndarray:
    return np.column_stack([values[:, 0], values[:, 0] * values[:, 1]])


def read(path: Path) -> ReadTable:
    """Return a line of JSON with names and rate, and little-endian floats behind it."""
    head, _, body = path.read_bytes().partition(b"\n")
    said = json.loads(head)
    samples = np.frombuffer(body, "<f4").reshape(len(said["names"]), -1).astype(float)
    return ReadTable(tuple(said["names"]), samples, sample_rate_hz=said["rate_hz"], unit="m/s^2")


def poles_by_covariances(ready: Any, settings: Any) -> list[OrderPoles]:
    """Return the poles of covariance-driven subspace identification, without their uncertainty."""
    resolved = ready.settings
    lagged = covariances(ready.y, 2 * resolved.block_rows)[:, :, ready.references]
    subspace = ssi_cov(lagged, block_rows=resolved.block_rows, max_order=resolved.orders[-1])
    return order_poles(subspace, subspace.orders(resolved.orders))


@dataclass(frozen=True)
class HalfAsFar:
    """A curve that another reaches at twice the displacement."""

    other: Curve

    @property
    def initial_stiffness(self) -> float:
        """Slope the curve starts with."""
        return 2.0 * self.other.initial_stiffness

    @property
    def capacity(self) -> float:
        """Largest reaction."""
        return self.other.capacity

    def force(self, y: Any) -> np.ndarray:
        """Return the reaction at a displacement."""
        return self.other.force(2.0 * np.asarray(y))


def half_as_far(point: Any, pile: Any, options: Any) -> Curve:
    """Return the curve of API, at half the displacement."""
    return HalfAsFar(soil_curves("sand_py")["rp2geo"].build(point, pile, options))


def _spring_at_the_top(assembly: Assembly) -> sp.csr_array:
    """Return a spring of 1 N/m on every translation of the highest node."""
    top = max(assembly.structure.nodes, key=lambda node: assembly.structure.nodes[node][2])
    diagonal = np.zeros(assembly.n_dof)
    diagonal[assembly.dofs(top)[:2]] = 1.0
    return sp.diags_array(diagonal, format="csr")


def crane_left_behind(standing: Standing) -> Iterator[Happening]:
    """Yield what becomes of a structure on whose top a crane is left."""
    top = max(standing.structure.nodes, key=lambda node: standing.structure.nodes[node][2])

    def loaded(before: Standing) -> Standing:
        masses = (*before.structure.masses, PointMass(top, 20e3))
        return replace(before, structure=replace(before.structure, masses=masses))

    yield Happening("crane", "a crane left on the top", loaded, per=20.0, median=20.0, spread=0.3, unit="t")


FORMAT = Format("logger of another make", (".xyz",), read)
LAGGING = Lagging()
CURVE = SoilCurve("sand_py", "half-as-far", "a curve of our own", half_as_far)
SENSOR = replace(SENSOR_KINDS["motion"], name="geophone")
PARAMETER = NuisanceParameter(
    Parameter("guy_wires", 1e3, 1e7, "N/m", 1e5, 1.0), "stiffness", matrix=_spring_at_the_top
)
