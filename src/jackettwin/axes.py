"""Frames and degrees of freedom.

Global frame: right-handed, x along the wind of the reference direction (fore-aft, downwind),
y to the left of it (side-side), z up. Every structure states the z of the mean sea level in its own
frame; heights of sensors are above that level. Harmonic time dependence is ``e^{+iωt}``; a damped
mode is ``λ = −ζω + iω√(1−ζ²)``.
"""

from __future__ import annotations

DOFS_PER_NODE = 6
"""Three displacements and three rotations."""
TRANSLATIONS = (0, 1, 2)
