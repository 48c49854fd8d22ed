"""The sea during one record."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.loads.sea.waves import AirySea, irregular_sea


@dataclass(frozen=True)
class SeaState:
    """A JONSWAP sea: Hs [m], Tp [s], heading from +x [rad]; the rest as in ``irregular_sea``."""

    Hs: float
    Tp: float
    direction: float = 0.0
    gamma: float | None = None
    spreading: float | None = None

    def waves(self, *, depth: float, duration: float, seed: int) -> AirySea:
        """Return the sea's random waves."""
        return irregular_sea(
            Hs=self.Hs,
            Tp=self.Tp,
            depth=depth,
            duration=duration,
            seed=seed,
            gamma=self.gamma,
            direction=self.direction,
            spreading=self.spreading,
        )
