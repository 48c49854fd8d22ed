"""Sections of SACS decks other than tubes: by the properties that a SECT card gives, or by their dimensions.

A SECT card has AX, J, IY, IZ in columns 19 to 48 and the sides A, B, C, D from column 50 on: of a wide flange
(WF) the flange's width and thickness, depth and web; of a box (BOX) depth with the thickness of its walls,
width with theirs. IY is that about the member's local y, which is level: of a beam, about its section's x.
"""

from __future__ import annotations

from math import inf

from jackettwin.structure import STEEL, BeamSection, i_section, rectangular_section

NAMES = {"WF": "I-section", "WFC": "I-section", "BOX": "box", "PRI": "any section"}
"""Names of beams of a SACS shape; other shapes are general sections."""


def sacs_section(
    shape: str, properties: tuple[float, float, float, float], sides: tuple[float, float, float, float]
) -> BeamSection | None:
    """Return the section of a SECT card in SI units; None if the card does not say enough.

    Parameters
    ----------
    properties : AX [m²], J, IY, IZ [m⁴]; 0 where they are left blank
    sides : A, B, C, D [m]; 0 where they are left blank

    Examples
    --------
    >>> section = sacs_section("WF", (0, 0, 0, 0), (0.3, 0.03, 0.6, 0.015))
    >>> round(section.A, 4), section.I_x > section.I_y
    (0.0261, True)
    >>> sacs_section("PRI", (0, 0, 0, 0), (0.3, 0.2, 0, 0)) is None
    True
    """
    area, J, about_y, about_z = properties
    if min(properties) > 0.0:
        return BeamSection(area, inf, inf, about_y, about_z, about_y + about_z, J)
    a, b, c, d = sides
    if shape.startswith("WF") and min(sides) > 0.0 and 2.0 * b < c and d < a:
        return i_section(a, c, b, d)
    even = d in (0.0, b)
    if shape == "BOX" and min(a, b, c) > 0.0 and even and b < 0.5 * min(a, c):
        return rectangular_section(c, a, b, poisson_ratio=STEEL.poisson_ratio)
    return None
