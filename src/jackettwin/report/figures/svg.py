"""Small scalable drawings without scripts, for page and print."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup, escape

from jackettwin.report.figures import style


class Canvas:
    """Canvas in pixels from the upper left."""

    def __init__(self, width: float, height: float, title: str) -> None:
        self.width, self.height, self.title = width, height, title
        self._parts: list[str] = []

    def line(
        self, x1: float, y1: float, x2: float, y2: float, *, colour: str = style.INK, width: float = 1.0
    ) -> None:
        """Draw a straight line."""
        self._parts.append(
            f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" '
            f'stroke-width="{width:g}"/>'
        )

    def box(
        self, x: float, y: float, width: float, height: float, *, colour: str, opacity: float = 1.0,
        edge: str = "none",
    ) -> None:  # fmt: skip
        """Draw a filled rectangle."""
        self._parts.append(
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{max(width, 0.0):.1f}" height="{max(height, 0.0):.1f}" '
            f'fill="{colour}" fill-opacity="{opacity:g}" stroke="{edge}"/>'
        )

    def dot(self, x: float, y: float, *, radius: float = 4.0) -> None:
        """Draw a filled circle."""
        self._parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" fill="{style.INK}"/>')

    def polygon(self, points: Sequence[tuple[float, float]], *, colour: str, opacity: float = 1.0) -> None:
        """Fill a polygon."""
        corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self._parts.append(f'<polygon points="{corners}" fill="{colour}" fill-opacity="{opacity:g}"/>')

    def path(self, d: str, *, colour: str, width: float) -> None:
        """Draw a path of SVG commands."""
        self._parts.append(
            f'<path d="{d}" fill="none" stroke="{colour}" stroke-width="{width:g}" stroke-linecap="round"/>'
        )

    def text(
        self, x: float, y: float, text: str, *, anchor: str = "start", colour: str = style.INK,
        bold: bool = False,
    ) -> None:  # fmt: skip
        """Write a line of text; ``anchor`` is start, middle or end."""
        weight = ' font-weight="650"' if bold else ""
        self._parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}"{weight}>'
            f"{escape(text)}</text>"
        )

    @property
    def markup(self) -> Markup:
        """The drawing, as wide as there is room."""
        return Markup(
            '<svg xmlns="http://www.w3.org/2000/svg" font-family="sans-serif" font-size="13" '
            f'viewBox="0 0 {self.width:g} {self.height:g}" role="img" '
            f'aria-label="{escape(self.title)}" width="{self.width:g}">'
            f"{''.join(self._parts)}</svg>"
        )


def spread(wanted: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """Return places at least ``gap`` apart, near those wanted, between two limits; in the same order.

    >>> spread([10.0, 11.0, 50.0], 5.0, 0.0, 100.0)
    [10.0, 15.0, 50.0]
    """
    order = sorted(range(len(wanted)), key=wanted.__getitem__)
    placed: dict[int, float] = {}
    last = low - gap
    for i in order:
        placed[i] = last = max(wanted[i], last + gap)
    limit = high
    for i in reversed(order):
        placed[i] = min(placed[i], limit)
        limit = placed[i] - gap
    return [placed[i] for i in range(len(wanted))]
