r"""Levels and corners of the latent forces, and sensor noise, by Whittle's likelihood of a record's spectra.

.. math:: -\ln L = \sum_{f>0} \ln\det S(f) + \mathrm{tr}\,S(f)^{-1} [y_f y_f^H + E(f)], \qquad
          S(f) = \sum_j S_j(f)\,h_j(f) h_j(f)^H + h\,R + E(f), \qquad E = ε^2\,\mathrm{diag}\,|y_f|^2

with the Fourier coefficients y_f of a record, the responses h_j of its sensors to each force, the density of
white noise, and a share ε of each channel's own motion that tells nothing, as a model's shapes are never
exact: without it forces must explain all of it, at any level (Whittle 1953). It is added to the record, too,
as its expectation: a model that lacks nothing has then no bias. With E in S alone it stood for a part of the
record, and waves beneath a motion that wind makes were found a fifth to a third too weak. The gradient of
each force's density is one number a frequency,
:math:`h_j^H S^{-1} h_j - h_j^H S^{-1} [y y^H + E] S^{-1} h_j`, and Fisher's information of two
:math:`|h_i^H S^{-1} h_j|^2` times their densities, so that a search costs tens of milliseconds.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import exp, log

import numpy as np
from scipy.optimize import minimize

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.sensing.latent_forces import LatentForce
from jackettwin.signals import tukey

_NOISE_STD = 3.0
"""Of the logarithm of the noise's variance beforehand: it may be twenty times more or less."""
_MISFIT = 0.5
"""Of a model at a frequency, as a share of the motion there: a second mode may lie a tenth off.

Evidence cannot choose it, as the motion itself would fit best; three simulated jackets with growth that
the model lacked did."""
_TAPERED = 0.2
"""Share of a record over which it fades in and out. Cut off sharply, a lightly damped mode leaks into slow
frequencies a hundred times what moves there, and slow forces are found three times too strong."""
_SMOOTHED = 4
"""Frequencies to each side over which a channel's motion is averaged for it, and no further than half of its
own: accelerations rise with f², and slow ones would be lost among quicker ones."""
_DELTA = 1e-4
_SCORED = 4
_SHORTER, _SHORTEST = 0.4, 0.1
"""Steps by which the search begins, and how one is shortened that goes too far."""
_ROUNDS, _SETTLED = 4, 2.0
"""Searches, each in the units where the last one ended, until −ln L promises to fall by no more than this: at
work the first alone ended up to 140 too early."""
_REACH = 8.0
"""Of a search about its start, in logarithms."""
_MORE, _NEAREST = 2.0, 0.05
"""Of −ln L, by which a drawn level may be worse than a normal distribution says; and how near it comes."""


@dataclass(frozen=True)
class Levels:
    """Levels of forces and noise estimated from a record.

    Attributes
    ----------
    forces : tuple of LatentForce
    noise : (n_channels,) variances of white noise
    log_likelihood : float
    evaluations : int
    others : forces at other levels, as probable as these
    """

    forces: tuple[LatentForce, ...]
    noise: FloatArray
    log_likelihood: float
    evaluations: int
    others: tuple[tuple[LatentForce, ...], ...] = ()


def find_levels(
    y: FloatArray,
    step_s: float,
    transfer: ComplexArray,
    which: IntArray,
    forces: tuple[LatentForce, ...],
    groups: tuple[int, ...],
    *,
    slow: FloatArray | float = 1.0,
    draws: int = 0,
    seed: int = 0,
) -> Levels:
    """Return the most probable levels, rates and noise of a record, and ``draws`` other levels.

    Parameters
    ----------
    y : (n_channels, n_samples)
    transfer : (n_frequencies, n_channels, n_forces) of unit forces
    which : (n_frequencies,) the FFT's frequencies that are used
    groups : channels of one group share one noise level
    slow : (n_frequencies, n_channels) density of a channel's noise over that of its white part
    """
    evidence = _Evidence.of(y, step_s, transfer, which, forces, groups, slow)
    z, cost, evaluations = evidence.most_probable()
    return Levels(
        evidence.forces_at(z),
        np.exp(evidence.split(z)[2]) @ evidence.members,
        -cost,
        evaluations,
        tuple(evidence.forces_at(x) for x in evidence.draws(z, draws, np.random.default_rng(seed))),
    )


@dataclass(frozen=True)
class _Evidence:
    """Whittle's likelihood of a record by z: ln levels, ln rates of the bands over their own, ln noise.

    Attributes
    ----------
    Y, power : (n_frequencies, n_channels) Fourier coefficients, and their smoothed squares
    H : (n_frequencies, n_channels, n_forces)
    omega : (n_frequencies,)
    step_s : float
    unit : the forces at level 1
    band : (n_forces,) of each force
    members : (n_groups, n_channels) 1 where a channel is of a group
    slow : (n_frequencies, n_channels) noise over its white part
    start, std : (n,) what is known of z beforehand
    prior : (n, n) from what z exceeds ``start`` to its parts that are known apart, in their deviations
    last : what was computed last
    """

    Y: ComplexArray
    power: FloatArray
    H: ComplexArray
    omega: FloatArray
    step_s: float
    unit: tuple[LatentForce, ...]
    band: IntArray
    members: FloatArray
    slow: FloatArray | float
    start: FloatArray
    std: FloatArray
    prior: FloatArray
    last: dict[bytes, tuple[FloatArray, FloatArray, FloatArray, _Whittle]] = field(
        default_factory=dict, init=False
    )

    @classmethod
    def of(
        cls,
        y: FloatArray,
        step_s: float,
        transfer: ComplexArray,
        which: IntArray,
        forces: tuple[LatentForce, ...],
        groups: tuple[int, ...],
        slow: FloatArray | float = 1.0,
    ) -> _Evidence:
        """Return that of readings (n_channels, n_samples), as :func:`find_levels` takes them."""
        n = y.shape[1]
        taper = tukey(n, _TAPERED)
        whole = np.fft.rfft(taper * y, axis=1) * np.sqrt(step_s / (taper @ taper))
        Y, power = whole[:, which].T, _smoothed(np.abs(whole) ** 2)[:, which].T
        omega = np.asarray(2.0 * np.pi * np.fft.rfftfreq(n, step_s)[which], dtype=np.float64)
        bands = tuple(dict.fromkeys((f.kind, f.rate, f.rate_log_std) for f in forces))
        band = np.array([bands.index((f.kind, f.rate, f.rate_log_std)) for f in forces])
        members = np.array([[group == g for group in groups] for g in range(max(groups) + 1)], dtype=float)
        floor = np.array([_floor(Y, members[g] > 0.0) / step_s for g in range(len(members))])
        start = np.concatenate([[log(f.level) for f in forces], np.zeros(len(bands)), np.log(floor)])
        std = [f.level_log_std for f in forces] + [s for _, _, s in bands] + [_NOISE_STD] * len(members)
        unit = tuple(force.with_level(1.0) for force in forces)
        prior = _apart(forces, np.array(std))
        return cls(Y, power, transfer, omega, step_s, unit, band, members, slow, start, np.array(std), prior)

    def split(self, z: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return ln levels, ln rates over their own, ln noise."""
        level, rate, noise = np.split(z, [len(self.unit), z.size - len(self.members)])
        return level, rate, noise

    def forces_at(self, z: FloatArray) -> tuple[LatentForce, ...]:
        """Return the forces at z."""
        level, rate, _ = self.split(z)
        return tuple(
            f.with_level(exp(a), f.rate * exp(rate[b]))
            for f, a, b in zip(self.unit, level, self.band, strict=True)
        )

    def densities(self, z: FloatArray, which: BoolArray | None = None) -> FloatArray:
        """Return the densities of the forces, or of some of them, (n, n_frequencies)."""
        level, rate, _ = self.split(z)
        chosen = range(len(self.unit)) if which is None else np.flatnonzero(which)
        shapes = {b: self.shape(b, rate[b]) for b in {int(self.band[j]) for j in chosen}}
        return np.array([np.exp(2.0 * level[j]) * shapes[int(self.band[j])] for j in chosen])

    def shape(self, band: int, log_rate: float) -> FloatArray:
        """Return the density (n_frequencies,) that the forces of a band share at level 1."""
        one = self.unit[int(np.argmax(self.band == band))]
        return one.with_level(1.0, one.rate * exp(log_rate)).density(self.omega)

    def noise(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the density (n_frequencies, n_channels) of noise, and of all that no force explains."""
        own = self.slow * (np.exp(self.split(z)[2]) @ self.members * self.step_s)
        return own, own + _MISFIT**2 * self.power

    def most_probable(self) -> tuple[FloatArray, float, int]:
        """Return the most probable z, −ln of likelihood and prior there, and how often they were computed.

        Steps of Newton with the expected curvature come near in few; the rest is searched in its units.
        """
        # of what stands beside another, the sum of both
        reach = np.minimum(_REACH, 4.0 * np.linalg.norm(np.linalg.inv(self.prior), axis=1))
        low, high = self.start - reach, self.start + reach
        z, (value, gradient), evaluations = self.start, self.cost(self.start), 1
        for _ in range(_SCORED):
            step, share = np.linalg.solve(self.information(z), gradient), 1.0
            while share >= _SHORTEST:
                tried = np.clip(z - share * step, low, high)
                there, evaluations = self.cost(tried), evaluations + 1
                if there[0] < value:
                    break
                share *= _SHORTER
            if not there[0] < value:
                break
            z, (value, gradient) = tried, there
        for _ in range(_ROUNDS):
            curvature = self.information(z)
            # a level at a bound is free to come back from it
            outwards = ((z <= low) & (gradient > 0.0)) | ((z >= high) & (gradient < 0.0))
            free = np.where(outwards, 0.0, gradient)
            if 0.5 * float(free @ np.linalg.solve(curvature, free)) < _SETTLED:
                break
            z, value, number = self._searched(z, np.linalg.inv(np.linalg.cholesky(curvature)), low, high)
            gradient = self.cost(z)[1]
            evaluations += number
        return z, value, evaluations

    def _searched(
        self, z: FloatArray, unit: FloatArray, low: FloatArray, high: FloatArray
    ) -> tuple[FloatArray, float, int]:
        """Return the best z (n,) near another, between bounds, its cost, and the number of evaluations.

        Beyond a bound the likelihood does not change, so that a search that knew of its slope there would end
        before its time; how far it is beyond counts instead, so that it finds its way back.
        """

        def cost(x: FloatArray) -> tuple[float, FloatArray]:
            there = z + x @ unit
            inside = np.clip(there, low, high)
            here, slope = self.cost(inside)
            beyond = there - inside
            return here + 0.5 * float(beyond @ beyond), np.asarray(
                unit @ np.where(beyond == 0.0, slope, beyond)
            )

        found = minimize(cost, 0.0 * z, jac=True, method="L-BFGS-B", options={"maxiter": 60, "ftol": 3e-6})
        return np.clip(z + found.x @ unit, low, high), float(found.fun), int(found.nfev)

    def cost(self, z: FloatArray) -> tuple[float, FloatArray]:
        """Return −ln of likelihood and prior, and its gradient."""
        S_f, white, r, (value, slope, *_) = self._seen_at(z)
        k = len(self.unit)
        of_rates = (slope[:, :k] * self._with_rate(z, S_f)).sum(axis=0)
        gradient = [
            2.0 * slope[:, :k].sum(axis=0),
            self._of_bands(of_rates),
            self.members @ (slope[:, k:] * (white / r)).sum(axis=0),
        ]
        away = self.prior @ (z - self.start)
        return value + 0.5 * float(away @ away), np.concatenate(gradient) + self.prior.T @ away

    def information(self, z: FloatArray) -> FloatArray:
        """Return Fisher's information of likelihood and prior, (n, n): the curvature that is expected."""
        S_f, white, r, (_, _, h, seen, inverse) = self._seen_at(z)
        # |c_i^H S⁻¹ c_j|² of columns c: those of forces, and unit vectors of noise
        forces, between, noise = (
            np.square(c.real) + np.square(c.imag) for c in (h.conj().transpose(0, 2, 1) @ seen, seen, inverse)
        )
        rho, share = self._with_rate(z, S_f), white / r
        both = np.einsum("fij,fj->ij", forces, rho)
        blocks = (
            4.0 * forces.sum(axis=0),
            2.0 * self._of_bands(both.T).T,
            2.0 * np.einsum("fij,fi->ji", between, share) @ self.members.T,
            self._of_bands(self._of_bands(np.einsum("fi,fij,fj->ij", rho, forces, rho)).T),
            self._of_bands(np.einsum("fij,fi,fj->ji", between, share, rho)) @ self.members.T,
            self.members @ np.einsum("fi,fij,fj->ij", share, noise, share) @ self.members.T,
        )
        LL, LR, LN, RR, RN, NN = blocks
        return np.block([[LL, LR, LN], [LR.T, RR, RN], [LN.T, RN.T, NN]]) + self.prior.T @ self.prior

    def _seen_at(self, z: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, _Whittle]:
        """Return densities of forces, of white noise and of all noise, and what they make of the record.

        The last point is kept, as its cost and its curvature are asked one after the other.
        """
        key = z.tobytes()
        if key not in self.last:
            S_f, (white, r) = self.densities(z), self.noise(z)
            self.last.clear()
            self.last[key] = S_f, white, r, _whittle(self.Y, self.H, S_f, r, _MISFIT**2 * self.power)
        return self.last[key]

    def _with_rate(self, z: FloatArray, S_f: FloatArray) -> FloatArray:
        """Return how ln of densities grows with ln of their rates, (n_frequencies, n_forces)."""
        at = z.copy()
        at[len(self.unit) : z.size - len(self.members)] += _DELTA
        return np.asarray((self.densities(at) / S_f - 1.0).T / _DELTA)

    def _of_bands(self, of_forces: FloatArray) -> FloatArray:
        """Return sums over the forces (n_forces, …) of each band."""
        return np.array([of_forces[self.band == band].sum(axis=0) for band in range(self.band.max() + 1)])

    def draws(self, z: FloatArray, number: int, rng: np.random.Generator) -> list[FloatArray]:
        """Return other levels as probable as z, in pairs about it.

        Normal by Fisher's information; where the evidence falls faster than that, as it does for a force that
        the record does not show and would if it were large, they come nearer.
        """
        k = len(self.unit)
        root = np.linalg.cholesky(self.information(z)[:k, :k])
        best, found = self.cost(z)[0] if number else 0.0, []
        for i in range(number):
            if i % 2 == 0:
                u = rng.standard_normal(k)
            away = np.zeros(z.size)
            away[:k] = (1.0 - 2.0 * (i % 2)) * np.linalg.solve(root.T, u)
            share = 1.0
            while share > _NEAREST:
                rise = self.cost(z + share * away)[0] - best
                if rise <= 0.5 * float(u @ u) * share**2 + _MORE:
                    break
                share *= 0.6
            found.append(z + share * away)
        return found


def _apart(forces: tuple[LatentForce, ...], std: FloatArray) -> FloatArray:
    """Return the rows (n, n) of what is known of levels, of one apart from that which it stands beside.

    Forces of a band that share a deviation s beside their own b have the covariance b² I + s² 1 1ᵀ, whose
    inverse root is I/b + (1/√(b² + n s²) − 1/b) 1 1ᵀ/n.
    """
    rows, names = np.diag(1.0 / std), [force.name for force in forces]
    for rate in {force.rate for force in forces if force.shared_log_std}:
        own = [j for j, force in enumerate(forces) if force.rate == rate and force.shared_log_std]
        b, s, n = forces[own[0]].level_log_std, forces[own[0]].shared_log_std, len(own)
        rows[np.ix_(own, own)] += (1.0 / np.sqrt(b**2 + n * s**2) - 1.0 / b) / n
    for j, force in enumerate(forces):
        if force.beside is not None:
            rows[j, names.index(force.beside)] = -rows[j, j]
    return rows


_Whittle = tuple[float, FloatArray, ComplexArray, ComplexArray, ComplexArray]


def _whittle(
    Y: ComplexArray, H: ComplexArray, S_f: FloatArray, r: FloatArray, beside: FloatArray
) -> _Whittle:
    """Return −ln L, its slope, and in the noise's own scale h, S⁻¹h and S⁻¹.

    What stands ``beside`` the record (n, m) is the expectation of what is added to its squares.

    The slope (n, n_forces + m) is by the logarithms of the densities of forces S_f (n_forces, n) and of
    noise r (n, m).
    """
    scale = 1.0 / np.sqrt(r)
    h = H * (scale[:, :, None] * np.sqrt(S_f.T)[:, None, :])
    y = Y * scale
    S = h @ h.conj().transpose(0, 2, 1) + np.eye(r.shape[1])
    inverse = np.linalg.inv(S)
    logdet = 2.0 * np.log(np.diagonal(np.linalg.cholesky(S), axis1=1, axis2=2).real).sum()
    solved, seen = (inverse @ y[:, :, None])[:, :, 0], np.asarray(inverse @ h)
    diagonal, b = np.diagonal(inverse, axis1=1, axis2=2).real, beside / r
    value = float(logdet + np.log(r).sum() + (y.conj() * solved).real.sum() + (b * diagonal).sum())
    own = (h.real * seen.real + h.imag * seen.imag).sum(axis=1)
    fit = np.abs((solved.conj()[:, None, :] @ h)[:, 0, :]) ** 2
    fit += (b[:, None, :] @ (np.square(seen.real) + np.square(seen.imag)))[:, 0, :]
    of_noise = diagonal - np.abs(solved) ** 2
    of_noise -= (b[:, None, :] @ (np.square(inverse.real) + np.square(inverse.imag)))[:, 0, :]
    slope: FloatArray = np.concatenate([own - fit, of_noise], axis=1)
    return value, slope, h, seen, np.asarray(inverse)


def _smoothed(power: FloatArray) -> FloatArray:
    """Return powers (n_channels, n) averaged over the frequencies beside each."""
    n = power.shape[1]
    total = np.pad(np.cumsum(power, axis=1), ((0, 0), (1, 0)))
    at = np.arange(n)
    half = np.minimum(np.minimum(_SMOOTHED, at // 2), n - 1 - at)
    return np.asarray((total[:, at + half + 1] - total[:, at - half]) / (2 * half + 1))


def _floor(Y: ComplexArray, which: FloatArray) -> float:
    """Return the density of the noise to start from: the quietest twentieth of the spectra."""
    power = np.abs(Y[:, which]) ** 2
    return float(np.quantile(power, 0.05) / -np.log(0.95))
