"""Motions in a view: modes, passage of a wave, motion during a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.response import Passage, Playback, Sensor, damping_ratio, observation_matrix, sensor_positions
from jackettwin.structure import Assembly, section_forces, tube_radius

_MOTION = "motion"
"""The kind of sensors whose way can be drawn: not strains, not inclinations."""


@dataclass(frozen=True)
class SensorMotion:
    """Measured motion of the sensors in a mode, in the phase and scale of the model's.

    Attributes
    ----------
    places : (n_places, 3)
        Positions of the sensors at rest [m], z above the mean sea level.
    nodes : (n_places,) int
        Nearest node of the model to each sensor.
    shapes : (2, 3·n_places)
        Real part and negative imaginary part of the displacements, in the scale of the motion.
    """

    places: FloatArray
    nodes: Int64Array
    shapes: FloatArray

    def document(self, scale: float) -> dict[str, Any]:
        """Return plain data, displacements times a scale."""
        drawn = zip(np.round(self.places, 3).tolist(), self.nodes.tolist(), strict=True)
        return {
            "places": [{"at": at, "node": node} for at, node in drawn],
            "shapes": np.round(self.shapes * scale, 5).tolist(),
        }


@dataclass(frozen=True)
class DrawnMotion:
    """Displacements of every node over time as shapes times coordinates.

    Attributes
    ----------
    name, note : str
        Name of the motion and a remark on it.
    group : str
        Heading under which the page lists it.
    shapes : (n_shapes, 3·n_nodes) translations, any scale
    q : (n_frames, n_shapes)
    step_s : float
        Time between frames.
    start_s : float
        Time of the first frame.
    cyclic : bool
        Whether the frames are periodic; a record is not.
    wave : dict, optional
        ``height_m``, ``length_m``, ``direction_rad``: the surface, with its crest at the origin in frame 0.
    load_kn_m : (n_frames, n_elements), optional
    measured : SensorMotion, optional
    stress : (n_shapes, 6·n_elements), optional
        Stress of each shape [Pa], as in :func:`section_stress`.
    """

    name: str
    note: str
    group: Literal["undamped modes", "damped modes", "another program", "loads and response"]
    shapes: FloatArray
    q: FloatArray
    step_s: float
    cyclic: bool = True
    start_s: float = 0.0
    wave: dict[str, float] | None = None
    load_kn_m: FloatArray | None = None
    measured: SensorMotion | None = None
    stress: FloatArray | None = None

    def document(self) -> dict[str, Any]:
        """Return plain data; shapes are scaled so that the largest translation over time is one.

        Stresses are in the same scale [MPa/m].
        """
        largest = float(np.abs(self._extreme()).max(initial=0.0))
        scale = 1.0 / largest if largest > 0.0 else 1.0
        return {
            "name": self.name,
            "note": self.note,
            "group": self.group,
            "shapes": [np.round(shape * scale, 5).tolist() for shape in self.shapes],
            "q": [[float(f"{v:.5g}") for v in row] for row in self.q],
            "largest_m": largest if self.group == "loads and response" else None,
            "step_s": self.step_s,
            "start_s": self.start_s,
            "cyclic": self.cyclic,
            "wave": self.wave,
            "measured": None if self.measured is None else self.measured.document(scale),
            "stress": None
            if self.stress is None
            else [[float(f"{v:.3g}") for v in row] for row in self.stress * scale / 1e6],
            "load": None if self.load_kn_m is None else np.round(self.load_kn_m, 3).tolist(),
        }

    def _extreme(self) -> FloatArray:
        return self.q @ self.shapes


_FRAMES = 48


def undamped_motion(assembly: Assembly, name: str, frequency_hz: float, shape: FloatArray) -> DrawnMotion:
    """Return an undamped mode."""
    theta = 2.0 * np.pi * np.arange(_FRAMES) / _FRAMES
    return DrawnMotion(
        name,
        f"{frequency_hz:.4f} Hz, undamped",
        "undamped modes",
        _translations(assembly, shape[None]),
        np.cos(theta)[:, None],
        1.0 / (frequency_hz * _FRAMES),
        stress=section_stress(assembly, shape[None]),
    )


def damped_motion(
    assembly: Assembly,
    name: str,
    eigenvalue: complex,
    shape: ComplexArray,
    measured: SensorMotion | None = None,
) -> DrawnMotion:
    """Return a complex mode, whose points are not in phase. Its decay is not drawn."""
    f = abs(eigenvalue) / (2.0 * np.pi)
    theta = 2.0 * np.pi * np.arange(_FRAMES) / _FRAMES
    parts = np.stack([shape.real, -shape.imag])
    zeta = float(damping_ratio(eigenvalue))
    return DrawnMotion(
        name,
        f"{f:.4f} Hz, ζ = {100 * zeta:.2f} %",
        "damped modes",
        _translations(assembly, parts),
        np.stack([np.cos(theta), np.sin(theta)], axis=1),
        1.0 / (f * _FRAMES),
        measured=measured,
        stress=section_stress(assembly, parts),
    )


def section_stress(assembly: Assembly, shapes: FloatArray) -> FloatArray:
    r"""Return the nominal stress of shapes at both ends of every element, (n_shapes, 6·n_elements) [Pa].

    Of each end N/A, :math:`M_y R/I` and :math:`M_z R/I`: the largest stress of its section is
    :math:`|σ_N| + \sqrt{σ_y^2 + σ_z^2}`, also of a sum of shapes.

    Parameters
    ----------
    shapes : (n_shapes, assembly.n_dof)
    """
    p, forces = assembly.mesh.properties, section_forces(assembly, shapes)
    outer = (tube_radius(p) / p.I)[:, None]
    parts = (forces.axial / p.A[:, None], forces.bending_y * outer, forces.bending_z * outer)
    return np.stack(parts, axis=-1).reshape(shapes.shape[0], -1)


def measured_shape(
    assembly: Assembly, sensors: Sequence[Sensor], measured: ComplexArray, shape: ComplexArray
) -> SensorMotion | None:
    r"""Return a measured shape in the model's amplitude and phase; None if no sensor measures motion.

    A measured shape has any amplitude and phase: it is multiplied by
    :math:`a = \varphi_m^H \varphi / \varphi_m^H \varphi_m`, which brings it as near to the model's
    :math:`\varphi` at the sensors as a factor can. Where nothing was measured the model's motion is drawn.

    Parameters
    ----------
    measured : (n_sensors,)
    shape : (assembly.n_dof,)
        Of the model.
    """
    moving = [k for k, sensor in enumerate(sensors) if sensor.quantity == _MOTION]
    if not moving:
        return None
    chosen, found = [sensors[k] for k in moving], measured[moving]
    own = np.asarray(observation_matrix(assembly, tuple(chosen)) @ shape)
    found = found * (np.vdot(found, own) / np.vdot(found, found).real)
    at = sensor_positions(assembly, chosen)
    nodes = assembly.mesh.coordinates - [0.0, 0.0, assembly.structure.sea_level_z_m]
    near = np.argmin(np.linalg.norm(nodes[None] - at[:, None], axis=2), axis=1)
    places, of = np.unique(np.column_stack([near, at]), axis=0, return_inverse=True)
    index = places[:, 0].astype(np.int64)
    moved = np.asarray(assembly.expand @ shape).reshape(-1, 6)[index, :3].astype(complex)
    for k, sensor in enumerate(chosen):
        direction = np.asarray(sensor.direction) / np.linalg.norm(sensor.direction)
        moved[of[k]] += (found[k] - moved[of[k]] @ direction) * direction
    return SensorMotion(places[:, 1:], index, np.stack([moved.real.ravel(), -moved.imag.ravel()]))


def wave_motion(assembly: Assembly, passage: Passage) -> DrawnMotion:
    """Return the passage of a wave with quasi-static displacements of the structure."""
    rest = _translations(assembly, passage.displacement)
    # a few shapes represent all phases
    u, s, vt = np.linalg.svd(rest, full_matrices=False)
    kept = s > 1e-4 * s[0] if s[0] > 0.0 else np.arange(s.size) < 1
    return DrawnMotion(
        "regular wave",
        f"H {passage.height_m:g} m, T {passage.period_s:g} s, length {passage.length_m:.0f} m, "
        f"towards {np.degrees(passage.direction_rad):.0f}° from +x; quasi-static",
        "loads and response",
        vt[kept],
        u[:, kept] * s[kept],
        passage.period_s / len(rest),
        wave={
            "height_m": passage.height_m,
            "length_m": passage.length_m,
            "direction_rad": passage.direction_rad,
        },
        load_kn_m=passage.load_n_m / 1e3,
    )


def record_motion(assembly: Assembly, name: str, found: Playback) -> DrawnMotion:
    """Return the motion during a record."""
    end = found.start_s + found.step_s * len(found.q)
    return DrawnMotion(
        f"record {name}",
        f"{found.start_s:.0f} to {end:.0f} s, {found.shapes.shape[1]} modes",
        "loads and response",
        _translations(assembly, found.shapes.T),
        found.q,
        found.step_s,
        cyclic=False,
        start_s=found.start_s,
        stress=section_stress(assembly, found.shapes.T),
    )


def _translations(assembly: Assembly, shapes: FloatArray) -> FloatArray:
    """Return (n_shapes, 3·n_nodes) from shapes (n_shapes, assembly.n_dof)."""
    full = np.asarray((assembly.expand @ shapes.T).T)
    return full.reshape(shapes.shape[0], -1, 6)[:, :, :3].reshape(shapes.shape[0], -1)
