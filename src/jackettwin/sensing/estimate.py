"""Motion, section forces and stress of a structure from its sensors, with what is not known of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg as la

from jackettwin.arrays import FloatArray
from jackettwin.response import System, UndampedModes
from jackettwin.sensing.latent_forces import LatentForce
from jackettwin.sensing.levels import Levels, find_levels
from jackettwin.sensing.motion_model import MotionModel, motion_model
from jackettwin.sensing.readings import ACCELERATION, SensorReadings, Weather, thinned
from jackettwin.sensing.rotor_by_wind import damped_at_work, pushed_at_work
from jackettwin.sensing.sea import SeaOnMembers
from jackettwin.sensing.smoother import SteadySmoother, discrete, steady_smoother
from jackettwin.sensing.wind_forces import RotorPlace, passing_forces, wind_forces
from jackettwin.structure import Assembly, SectionForces, section_forces

_WATER_LOG_STD = np.array([0.47, 0.1, 0.25])
"""Of the growth's thickness, C_a and C_D: a factor of 1.6, a tenth, and 0.65 for smooth members but 1.05 for
rough ones (DNV-RP-C205 (2021), 6.7)."""
SECTION_REMAINDER = 0.03
"""Standard deviation of the logarithm of ranges of moments at tower base and bed: by so much estimates missed
the truths of 24 simulated records beyond what was drawn."""
_ABOVE, _BELOW, _AT_WORK, _REACHED_M = 0.03, 0.06, 0.09, 15.0
"""The same of stress at welds: above the sea's reach [m] nothing acts on members, and what is left is that
of moments; below it braces bend under waves and vibrate; no sensor sees what a working rotor turns."""
_FIRST, _DAMPING_LOG_STD = 2, 0.4
"""Modes whose damping records tell, and the logarithm's deviation of that of others: 0.3 to 1 % in steel."""
_DRIFT_STD, _DRIFT_HZ = 1e-3, 0.01
"""Offset of an accelerometer [m/s²], and the frequency below which its drift is more than its white noise.

Integrated twice, an offset of a hundredth of that moves a tower top by a metre in eight minutes: with none
of its own, what is left of a removed mean is read as a push, and slow moments are made of it."""
BAND_HZ = 2.2
"""Modes up to here move with their own inertia; what is beyond follows the forces at once."""


def stress_remainder(z_m: float, *, working: bool) -> float:
    """Return the standard deviation of ln of stress ranges that no draw covers, at a weld of an elevation.

    Parameters
    ----------
    z_m : above the sea
    working : whether the rotor is at work
    """
    return _AT_WORK if working else _ABOVE if z_m > _REACHED_M else _BELOW


@dataclass(frozen=True)
class MotionEstimate:
    """Motion of a structure through a record.

    Coordinates are the modes, the levels of the forces, and those of local waves, of which sensors tell
    nothing: what a section feels is linear in all.

    Attributes
    ----------
    model : MotionModel
        With the levels found.
    smoother : SteadySmoother
    readings : SensorReadings
    levels : Levels
    """

    model: MotionModel
    smoother: SteadySmoother
    readings: SensorReadings
    levels: Levels

    @property
    def to_coordinates(self) -> FloatArray:
        """Coordinates from the state, (n_coordinates, n_states)."""
        own = self.of_state(self.model.force_rows())
        unseen = np.zeros((len(self.model.local), own.shape[1]))
        return np.vstack([np.eye(self.model.n_modes, own.shape[1]), own, unseen])

    def of_state(self, rows: FloatArray) -> FloatArray:
        """Return rows (k, n) of the model's state as rows of the smoother's, behind which drifts follow."""
        return np.pad(rows, ((0, 0), (0, self.smoother.F.shape[0] - rows.shape[1])))

    def _local(self) -> tuple[tuple[int, LatentForce], ...]:
        """Return the place of each process of local waves among the coordinates, and the process."""
        first = self.model.n_modes + len(self.model.forces)
        return tuple(enumerate(self.model.local_forces(), start=first))

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the coordinates at any instant far from the record's ends."""
        T = self.to_coordinates
        found = T @ self.smoother.smoothed @ T.T
        for k, force in self._local():
            found[k, k] = force.level**2
        return np.asarray(found)

    def mean(self) -> FloatArray:
        """Return the most probable coordinates, (n_samples, n_coordinates)."""
        return self.smoother.smooth(self.readings.y.T, rows=self.to_coordinates)[0]

    def draws(self, number: int, *, seed: int = 0, mean: FloatArray | None = None) -> Iterator[FloatArray]:
        """Yield motions (n_samples, n_coordinates) as probable as the real one.

        A motion drawn from the model, less what its readings say of it, is as wrong as the estimate is
        (Durbin & Koopman 2002): added to the mean.
        """
        mean = self.mean() if mean is None else mean
        rng, s, T, local = np.random.default_rng(seed), self.smoother, self.to_coordinates, self._local()
        for _ in range(number):
            drawn, y = s.draw(len(mean), rng, T)
            found = mean + drawn - s.smooth(y, rows=T)[0]
            for k, force in local:
                found[:, k] = force.drawn(len(mean), self.readings.step_s, rng)
            yield found


def estimate_motion(system: System, readings: SensorReadings, weather: Weather) -> MotionEstimate:
    """Return the motion of a supported structure from what its sensors read.

    Raises
    ------
    InputError
        If no tube reaches into the water, or no mode lies in the band.
    NumericalError
        If the filter does not come to rest.
    """
    return motion_from(sensed_model(system, weather), readings)


def sensed_model(system: System, weather: Weather) -> MotionModel:
    """Return modes and forces of a structure in a weather: what records in it share."""
    return _model_in(system, weather, SeaOnMembers.of(system.assembly, weather))


def _model_in(
    system: System, weather: Weather, sea: SeaOnMembers, near: UndampedModes | None = None
) -> MotionModel:
    rotor, speed = weather.rotor, weather.wind_m_s
    place = RotorPlace(weather.hub, weather.heading_rad, weather.radius_m)
    wind = wind_forces(system.assembly, place, wind_m_s=speed, working=weather.working)
    if weather.working and rotor is not None and rotor.passing_hz is not None:
        wind = (*wind, *passing_forces(wind, rotor.passing_hz))
    forces = (*wind, *sea.forces())
    model = motion_model(system, forces, below_hz=BAND_HZ, drag=sea.damping(), near=near, local=sea.local())
    return _pushed(_damped(model, weather), weather)


def _damped(model: MotionModel, weather: Weather, away: float = 0.0) -> MotionModel:
    """Return a model that its rotor damps if it works, ``away`` deviations from what is expected."""
    if not weather.working:
        return model
    return damped_at_work(model, weather.rotor, weather.heading_rad, away)


def _pushed(model: MotionModel, weather: Weather) -> MotionModel:
    """Return a model whose rotor pushes as is expected if it works."""
    if not weather.working:
        return model
    return pushed_at_work(model, weather.rotor, weather.heading_rad, weather.wind_m_s)


def motion_from(model: MotionModel, readings: SensorReadings, *, draws: int = 0) -> MotionEstimate:
    """Return the motion of a model from what sensors read; ``draws`` other levels are in its levels."""
    n, h = readings.y.shape[1], readings.step_s
    which = thinned(n, h, min(0.9 * BAND_HZ, 0.4 / h))
    omega = np.asarray(2.0 * np.pi * np.fft.rfftfreq(n, h)[which], dtype=np.float64)
    seen = model.transfer(readings.rows, readings.tilt, readings.derivative, omega)
    drifts = np.equal(readings.derivative, ACCELERATION)
    slow = 1.0 + drifts * (2.0 * np.pi * _DRIFT_HZ / omega[:, None]) ** 2
    levels = find_levels(readings.y, h, seen, which, model.forces, readings.groups, slow=slow, draws=draws)
    return motion_at_levels(model.with_forces(levels.forces), readings, levels)


def likely_motions(
    systems: Sequence[System],
    readings: SensorReadings,
    weather: Weather,
    *,
    damped: Callable[[MotionModel], MotionModel] = lambda model: model,
    near: UndampedModes | None = None,
    seed: int = 0,
) -> tuple[MotionEstimate, ...]:
    """Return the motion of each of some structures that are as likely as the first.

    Levels of the forces are those that the evidence finds on the first; each other structure has others that
    are as probable, other drag on its motion and other damping of its higher modes.

    Parameters
    ----------
    damped : what is known besides of the damping of a model's modes
    near : modes of a structure similar to the first
    """
    first, *others = systems
    sea = SeaOnMembers.of(first.assembly, weather)
    estimate = motion_from(
        _pushed(damped(_model_in(first, weather, sea, near)), weather), readings, draws=len(others)
    )
    found = [estimate]
    rng, away = np.random.default_rng(seed), np.zeros(5)
    for k, (system, forces) in enumerate(zip(others, estimate.levels.others, strict=True)):
        away = rng.standard_normal(5) if k % 2 == 0 else -away
        other = sea.with_other_water(*np.exp(_WATER_LOG_STD * away[2:]))
        model = motion_model(
            system,
            _on_other_water(forces, other),
            below_hz=BAND_HZ,
            drag=other.damping(),
            near=estimate.model.computed,
            local=other.local(),
        )
        model = model.with_damping_beyond(_FIRST, float(np.exp(_DAMPING_LOG_STD * away[0])))
        model = damped(_damped(model, weather, away[1]))
        found.append(motion_at_levels(model, readings, estimate.levels))
    return tuple(found)


def _on_other_water(forces: tuple[LatentForce, ...], sea: SeaOnMembers) -> tuple[LatentForce, ...]:
    """Return forces at their levels, those of waves with the patterns of another sea."""
    waves = {force.name: force for force in sea.forces()}
    return tuple(replace(waves[f.name], level=f.level, rate=f.rate) if f.name in waves else f for f in forces)


def motion_at_levels(model: MotionModel, readings: SensorReadings, levels: Levels) -> MotionEstimate:
    """Return the motion of a model whose forces have levels, whoever found them."""
    h, (F, Q) = readings.step_s, discrete(*model.dynamics(), readings.step_s)
    C = model.motion_rows(readings.rows, readings.tilt, readings.derivative)
    drifts = np.eye(len(C))[:, np.equal(readings.derivative, ACCELERATION)]
    walk = levels.noise @ drifts * (2.0 * np.pi * _DRIFT_HZ * h) ** 2
    kept = np.sqrt(np.maximum(1.0 - walk / _DRIFT_STD**2, 0.0))
    F, Q = la.block_diag(F, np.diag(kept)), la.block_diag(Q, np.diag(_DRIFT_STD**2 * (1.0 - kept**2)))
    smoother = steady_smoother(F, Q, np.hstack([C, drifts]), levels.noise)
    return MotionEstimate(model, smoother, readings, levels)


def section_rows(model: MotionModel) -> SectionForces:
    """Return the section forces that unit coordinates make, each (n_coordinates, n_elements, 2)."""
    still = np.zeros((model.n_modes, *model.forces[0].along.shape))
    along = np.concatenate([still, np.stack([force.along for force in model.forces])])
    found = section_forces(model.assembly, np.vstack([model.shapes.T, model.flexibility.T]), along=along)
    unseen = (
        _as_one(model.assembly, section_forces(model.assembly, bent.T, along=waves.along))
        for waves, bent in zip(model.local, model.bent, strict=True)
    )
    return SectionForces(*map(np.concatenate, zip(found, *unseen, strict=True)))


def _as_one(assembly: Assembly, forces: SectionForces) -> SectionForces:
    """Return the section forces (1, n_elements, 2) that vary as those of independent cases (n, …) together.

    At each section by itself, along what varies most of its axial and bending stress: what damages a weld is
    its own stress, whatever others have at the time.
    """
    p = assembly.mesh.properties
    # of a thin tube: I/A = R²/2
    per_force = np.stack([1.0 / p.A, *[np.sqrt(2.0 / (p.A * p.I))] * 2], axis=-1)
    stress = np.stack([forces.axial, forces.bending_y, forces.bending_z], axis=-1) * per_force[:, None]
    values, ways = np.linalg.eigh(np.einsum("neic,neid->eicd", stress, stress))
    most = np.einsum("neic,eic->nei", stress, ways[..., -1])
    whole = np.sqrt(np.square(stress).sum(axis=(0, -1))) / np.maximum(values[..., -1], 1e-300)
    return SectionForces(*((most * part).sum(axis=0, keepdims=True) * whole for part in forces))


def spread_of(rows: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return standard deviations (n,) of what ``rows`` (n, n_coordinates) see of coordinates."""
    root = la.cholesky(covariance + 1e-12 * np.diag(np.diag(covariance)), lower=True)
    return np.asarray(np.linalg.norm(rows @ root, axis=1))
