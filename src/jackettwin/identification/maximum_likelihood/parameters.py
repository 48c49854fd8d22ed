"""Parameters of the spectral model: modes, their forces and the noise of the sensors."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array

MAX_PAIRS = 91
"""Most coherences fitted: those of all pairs of fourteen modes."""


@dataclass(frozen=True)
class Parameters:
    """Parameters of the spectral model; ``vector`` holds them in this order.

    Attributes
    ----------
    log_f, log_zeta, colour : (n_modes,)
    shapes : (n_modes, n_channels)
        Real parts of the shapes, scaled by the root of the force density at the mode's frequency.
    coherence : (n_pairs,) complex
        Coherences of the modal forces.
    noise : (2, n_channels)
        Logarithm of the noise density at the middle of the band, and its exponent.
    pairs : (n_pairs, 2) int
        Modes i < j whose forces may be coherent; not a parameter.
    background : int
        Number of background shapes, which come first: modes far below the band, whose response is therefore
        proportional to their force. They represent the modes far outside the band.
    outside : int
        Number of modes outside the band, which come next; their frequencies and damping ratios are fixed.
    exponent : float
        Common exponent of the force spectra, the centre of the prior of ``colour``; not a parameter.
    lag : (n_modes − n_fixed, n_channels) or (0, 0)
        Imaginary parts of the shapes of the fitted modes; empty if these are taken to be real.
    """

    log_f: FloatArray
    log_zeta: FloatArray
    colour: FloatArray
    shapes: FloatArray
    coherence: ComplexArray
    noise: FloatArray
    pairs: Int64Array
    background: int = 0
    outside: int = 0
    exponent: float = 0.0
    lag: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def n_fixed(self) -> int:
        """Number of modes whose f and ζ are fixed: background shapes, and modes outside the band."""
        return self.background + self.outside

    @cached_property
    def gamma(self) -> ComplexArray:
        """Hermitian matrix of the coherences, (n_modes, n_modes)."""
        out = np.eye(len(self.log_f), dtype=complex)
        i, j = self.pairs.T
        out[i, j], out[j, i] = self.coherence, self.coherence.conj()
        return out

    @cached_property
    def complex_shapes(self) -> ComplexArray | FloatArray:
        """Shapes with their imaginary parts, real if these are empty, (n_modes, n_channels)."""
        if not self.lag.size:
            return self.shapes
        return self.shapes + 1j * np.vstack([np.zeros_like(self.shapes[: self.n_fixed]), self.lag])

    @property
    def lagging_size(self) -> FloatArray:
        """Norms of the shapes with a phase lag, (n_lagging, 1)."""
        last = self.shapes[len(self.shapes) - len(self.lag) :]
        return np.asarray(np.linalg.norm(last, axis=1, keepdims=True))

    @property
    def vector(self) -> FloatArray:
        """All parameters, (n_parameters,)."""
        modal = (self.log_f, self.log_zeta, self.colour, self.shapes)
        rest = (self.coherence.real, self.coherence.imag, self.noise, self.lag)
        return np.concatenate([np.ravel(part) for part in (*modal, *rest)])

    def moved(self, step: FloatArray) -> Parameters:
        """Return the parameters with ``step`` added to their vector."""
        n, n_pairs = len(self.log_f), len(self.coherence)
        cuts = np.cumsum([n, n, n, self.shapes.size, n_pairs, n_pairs, self.noise.size])
        f, zeta, colour, shape, re, im, noise, lag = np.split(self.vector + step, cuts)
        return Parameters(
            f,
            zeta,
            colour,
            shape.reshape(self.shapes.shape),
            re + 1j * im,
            noise.reshape(self.noise.shape),
            self.pairs,
            self.background,
            self.outside,
            self.exponent,
            lag.reshape(self.lag.shape),
        )

    def without(self, mode: int) -> Parameters:
        """Return the parameters without one mode."""
        kept = ~np.any(self.pairs == mode, axis=1)
        f, zeta, colour = (np.delete(x, mode) for x in (self.log_f, self.log_zeta, self.colour))
        pairs = self.pairs[kept]
        return replace(
            self,
            log_f=f,
            log_zeta=zeta,
            colour=colour,
            shapes=np.delete(self.shapes, mode, axis=0),
            coherence=self.coherence[kept],
            pairs=pairs - (pairs > mode),
            lag=np.delete(self.lag, mode - self.n_fixed, axis=0) if self.lag.size else self.lag,
        )

    def with_mode(self, log_f: float, log_zeta: float, shape: FloatArray) -> Parameters:
        """Return the parameters with another mode added last, under a force independent of the others."""
        n = len(self.log_f)
        f = np.append(self.log_f, log_f)
        pairs = coherent_pairs(f)
        gamma = np.eye(n + 1, dtype=complex)
        gamma[:n, :n] = self.gamma
        return replace(
            self,
            log_f=f,
            log_zeta=np.append(self.log_zeta, log_zeta),
            colour=np.append(self.colour, np.median(self.colour[self.n_fixed :])),
            shapes=np.vstack([self.shapes, shape]),
            coherence=gamma[pairs[:, 0], pairs[:, 1]],
            pairs=pairs,
            lag=np.vstack([self.lag, np.zeros_like(shape)]) if self.lag.size else self.lag,
        )


def coherent_pairs(log_f: FloatArray) -> Int64Array:
    """Return the pairs of modes whose forces may be coherent, (n_pairs, 2): the nearest neighbours."""
    i, j = np.triu_indices(len(log_f), 1)
    nearest = np.argsort(np.abs(log_f[i] - log_f[j]), kind="stable")[:MAX_PAIRS]
    return np.stack([i, j], axis=1)[np.sort(nearest)].astype(np.int64)
