"""Tornado diagram: the effect of each tolerance on one parameter of the ground."""

from __future__ import annotations

from math import expm1

from markupsafe import Markup

from jackettwin.report.figures import style
from jackettwin.report.figures.svg import Canvas
from jackettwin.study import Scrutiny

_WIDTH = 620.0
_MOST = 8
"""Largest number of tolerances drawn; the table has all."""
_LETTER = 7.4
"""Upper limit of the mean width of a letter of the page's font [px]."""
_FELT = 0.002
"""Changes of a logarithm below this are not drawn."""


def tornado(s: Scrutiny, parameter: int, words: str) -> Markup | None:
    """Draw a bar for ± one standard deviation of each tolerance; None if none has a visible effect.

    Parameters
    ----------
    parameter : int
        Index of the parameter in the problem.
    words : str
        Name of the parameter.
    """
    shown = [m for m in s.movers(parameter)[:_MOST] if abs(float(m.effect[parameter])) > _FELT]
    if not shown:
        return None
    row, head, right = 26.0, 24.0, _WIDTH - 84.0
    left = 16.0 + _LETTER * max(len(m.tolerance.words) for m in shown)
    bottom = head + row * len(shown)
    c = Canvas(_WIDTH, bottom + 44.0, f"Effect of the tolerances on the {words}")
    most = 1.1 * max(abs(expm1(abs(float(m.effect[parameter])))) for m in shown)
    middle = 0.5 * (left + right)

    def x(change: float) -> float:
        return middle + 0.5 * (right - left) * change / most

    c.box(left, 2, 14, 14, colour=style.ORANGE)
    c.text(left + 19, 14, "stated value + σ")
    c.box(left + 180, 2, 14, 14, colour=style.SKY)
    c.text(left + 199, 14, "one σ less")
    for i, m in enumerate(shown):
        y, effect = head + row * i, float(m.effect[parameter])
        c.text(left - 8, y + 17, m.tolerance.words, anchor="end")
        for sign, colour in ((1.0, style.ORANGE), (-1.0, style.SKY)):
            end = x(expm1(sign * effect))
            c.box(min(end, middle), y + 4, abs(end - middle), 15, colour=colour)
        text = f"{100.0 * expm1(effect):+.2g} %".replace("-", "−")
        c.text(right + 6, y + 17, text)
    c.line(middle, head, middle, bottom, colour=style.GREY)
    for change in (-most / 1.1, most / 1.1):
        c.text(x(change), bottom + 16, f"{100.0 * change:+.2g} %".replace("-", "−"), anchor="middle")
    c.text(middle, bottom + 16, "0", anchor="middle")
    c.text(middle, bottom + 36, f"change of the {words}", anchor="middle")
    return c.markup
