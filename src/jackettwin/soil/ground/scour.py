"""Scour: how much ground is gone, and how much of the overburden with it."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.errors import require_between

_AT_MOST = 300.0
"""Metres, or pile diameters."""


@dataclass(frozen=True)
class Scour:
    """General scour lowers the whole seabed, local scour is a hole around the pile.

    Under a hole the vertical effective stress σ'_v grows linearly from zero at its bottom to its value
    without the hole at ``recovery_diameters`` pile diameters below (6 D: API RP 2GEO 2011, section 8.3 and
    its figure of the overburden reduction depth; DNV-ST-0126).
    """

    general_m: float = 0.0
    local_m: float = 0.0
    recovery_diameters: float = 6.0

    def __post_init__(self) -> None:
        for field in ("general_m", "local_m", "recovery_diameters"):
            require_between(f"scour.{field}", getattr(self, field), 0.0, _AT_MOST)

    @property
    def total_m(self) -> float:
        """Depth of the hole's bottom below the original mudline [m]."""
        return self.general_m + self.local_m

    def recovery_m(self, diameter: float) -> float:
        """Return how far below the hole's bottom σ'_v has its value without the hole again [m].

        >>> Scour(local_m=2.0).recovery_m(1.5)
        9.0
        """
        return self.recovery_diameters * diameter if self.local_m > 0.0 else 0.0


NO_SCOUR = Scour()
