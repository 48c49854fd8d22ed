"""The first page: a light, five answers, and their drawings."""

from __future__ import annotations

from jackettwin.answers import Answers
from jackettwin.report.figures.drawings import campbell, damping_bars, ground_intervals
from jackettwin.report.figures.drawings_shapes import shape_drawings
from jackettwin.report.figures.tornado import tornado
from jackettwin.report.pages.page import Block, Drawing, FirstPage
from jackettwin.report.tables.light import light
from jackettwin.report.tables.sentences import MARGIN, FirstPageWords
from jackettwin.soil import parameter_words
from jackettwin.study import TwinResult
from jackettwin.updating import recommended

MODEL, GROUND, DAMPING, NEXT = (
    "Is the model right?",
    "How stiff and how damped is the ground?",
    "Whose damping is it?",
    "What to do next?",
)
"""Titles of the questions that continue in the engineer's part."""


def first_page(a: Answers, said: FirstPageWords) -> FirstPage:
    """Return the first page."""
    drawings = []
    speeds = campbell(a)
    if speeds is not None:
        caption = (
            "Does the rotor excite a mode? Measured frequencies with their 90 % intervals over its speed; "
            f"violet: 1P and {a.blades}P ± {100 * MARGIN:.0f} %. Higher modes are above the figure."
        )
        drawings.append(Drawing("campbell", caption, (speeds,)))
    bars = damping_bars(a.modes)
    if bars is not None:
        caption = (
            "What causes the damping? Each source's part of a mode's damping, and the unexplained part; "
            "dots: measured, with 90 % intervals."
        )
        drawings.append(Drawing("damping", caption, (bars,)))
    if speeds is None:
        drawings += ground_drawing(a)
    return FirstPage(light(a), said.questions, tuple(drawings))


def ground_drawing(a: Answers) -> list[Drawing]:
    """Return the drawing of prior and posterior of the ground."""
    drawn = ground_intervals(a.ground, a.law, fits=a.fits)
    if drawn is None:
        return []
    caption = (
        "What did the data add? Prior and posterior of each parameter of a foot, 90 %, logarithmic axis."
    )
    return [Drawing("ground", caption, (drawn,))]


def tornado_drawing(a: Answers) -> list[Drawing]:
    """Return the effects of tolerances on the best known stiffness of the ground."""
    stiff = [(i, g) for i, g in enumerate(a.ground) if g.kind == "stiffness" and g.factor is not None]
    if a.scrutiny is None or not a.scrutiny.influences or not stiff:
        return []
    i, g = min(stiff, key=lambda one: one[1].factor or 0.0)
    drawn = tornado(a.scrutiny, i, parameter_words(g.name))
    if drawn is None:
        return []
    caption = "What does that depend on? The fit repeated with one tolerance at a time changed by one σ."
    return [Drawing("tornado", caption, (drawn,))]


def shapes(result: TwinResult) -> list[Block]:
    """Return the updated and measured mode shapes."""
    u = recommended(result.updates)
    drawn = [] if u is None else shape_drawings(result, u)
    if not drawn:
        return []
    caption = (
        "Do measured and updated shapes agree? Pale: at rest; coloured: updated model, torsion seen from "
        "above; black: measured motion at the sensors, scaled to the model."
    )
    return [Drawing("mode_shapes", caption, tuple(drawn))]
