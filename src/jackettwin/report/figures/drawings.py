"""Drawings of the first page: Campbell diagram, damping by source, posterior of the ground."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, floor, log, log10

from markupsafe import Markup

from jackettwin.answers import Answers, GroundAnswer, ModeAnswer, Span
from jackettwin.report.figures import style
from jackettwin.report.figures.svg import Canvas, spread
from jackettwin.report.tables.numbers import digits_of, quantity, words
from jackettwin.report.tables.sentences import MARGIN, verdict_words
from jackettwin.soil import parameter_words

SOURCE_COLOURS = {
    "structure": style.GREY,
    "soil": style.ORANGE,
    "rotor": style.SKY,
    "water": style.BLUE,
}
SOURCE_NAMES = {"structure": "steel", "soil": "ground", "rotor": "rotor", "water": "water"}
_WIDTH = 560.0


def ticks(low: float, high: float, most: int) -> list[float]:
    """Return at most a given number of round values between two limits.

    >>> ticks(0.0, 0.42, 5)
    [0.0, 0.1, 0.2, 0.3, 0.4]
    """
    span = (high - low) / most
    power = 10.0 ** floor(log10(span))
    step = next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= span)
    return [round(k * step, 10) for k in range(ceil(low / step), floor(high / step) + 1)]


def campbell(a: Answers) -> Markup | None:
    """Draw measured frequencies against the rotor's speed, with 1P, 3P and the usual margin about them."""
    modes = [m for m in a.modes if m.measured_hz is not None]
    if a.rotor_speed_hz is None or not modes:
        return None
    slow, fast = a.rotor_speed_hz
    top = 1.12 * max(
        a.blades * fast * (1.0 + MARGIN), min(m.measured_hz.value for m in modes if m.measured_hz)
    )
    c = Canvas(_WIDTH, 300.0, "Measured frequencies against the speed of the rotor")
    left, right, upper, lower = 52.0, 402.0, 12.0, 256.0
    edge = 1.15 * fast

    def x(speed: float) -> float:
        return left + (right - left) * speed / edge

    def y(f: float) -> float:
        return lower - (lower - upper) * min(f, top) / top

    for hertz in ticks(0.0, top, 6):
        c.line(left, y(hertz), right, y(hertz), colour=style.GRID)
        c.text(left - 6, y(hertz) + 4, f"{hertz:g}", anchor="end")
    for rpm in ticks(0.0, 60.0 * edge, 7):
        c.line(x(rpm / 60.0), lower, x(rpm / 60.0), lower + 4, colour=style.GREY)
        c.text(x(rpm / 60.0), lower + 18, f"{rpm:g}", anchor="middle")
    c.box(x(slow), upper, x(fast) - x(slow), lower - upper, colour=style.GRID, opacity=0.55)
    labels: list[tuple[float, str, str]] = []
    for multiple in (1, a.blades):
        band = [
            (x(s), y(multiple * s * (1.0 + sign * MARGIN)))
            for sign, speeds in ((-1.0, (slow, fast)), (1.0, (fast, slow)))
            for s in speeds
        ]
        c.polygon(band, colour=style.PURPLE, opacity=0.3)
        end = min(edge, top / multiple)
        c.line(x(0.0), y(0.0), x(end), y(multiple * end), colour=style.PURPLE, width=1.5)
        labels.append((y(multiple * end), f"{multiple}P", style.PURPLE))
    for m in modes:
        if m.measured_hz is None or m.measured_hz.value > top:
            continue
        colour, f = style.mode_look(m.label).colour, m.measured_hz
        c.box(
            left,
            y(f.high or f.value),
            right - left,
            y(f.low or f.value) - y(f.high or f.value),
            colour=colour,
            opacity=0.35,
        )
        c.line(left, y(f.value), right, y(f.value), colour=colour, width=2.0)
        labels.append((y(f.value), f"{words(m.label)} {f.value:.3f}", colour))
    for place, (_, text, colour) in zip(
        spread([at for at, _, _ in labels], 16.0, upper + 4.0, lower), labels, strict=True
    ):
        c.text(right + 6, place + 4, text, colour=colour)
    c.line(left, lower, right, lower, colour=style.GREY)
    c.line(left, upper, left, lower, colour=style.GREY)
    c.text((left + right) / 2, lower + 38, "rotor speed [rpm]; shaded: in operation", anchor="middle")
    c.text(4, upper + 4, "Hz")
    return c.markup


def damping_bars(modes: Sequence[ModeAnswer]) -> Markup | None:
    """Draw one bar per mode: the damping from steel, ground, rotor and water, and the unexplained part.

    The measured damping is below it.
    """
    shown = [m for m in modes if m.given_sources]
    if not shown:
        return None
    sources = [s for s in SOURCE_COLOURS if any(s in m.given_sources for m in shown)]
    row, head = 30.0, 24.0
    c = Canvas(_WIDTH, head + row * len(shown) + 40.0, "Damping of each mode by source")
    left, right = 112.0, _WIDTH - 18.0
    most = max(
        max(
            sum(s.value for s in m.given_sources.values()),
            0.0 if m.measured_damping is None else m.measured_damping.high or m.measured_damping.value,
        )
        for m in shown
    )

    def x(zeta: float) -> float:
        return left + (right - left) * min(zeta / most, 1.0)

    at = left
    for source in sources:
        c.box(at, 2, 14, 14, colour=SOURCE_COLOURS[source])
        c.text(at + 19, 14, SOURCE_NAMES[source])
        at += 76
    if any(m.unexplained for m in shown):
        c.box(at, 2, 14, 14, colour="white", edge=style.INK)
        c.text(at + 19, 14, "unexplained")
        at += 110
    c.line(at, 9, at + 18, 9, width=2.0)
    c.dot(at + 9, 9)
    c.text(at + 24, 14, "measured")
    bottom = head + row * len(shown)
    for zeta in ticks(0.0, 100.0 * most, 6):
        c.line(x(zeta / 100.0), head, x(zeta / 100.0), bottom, colour=style.GRID)
        c.text(x(zeta / 100.0), bottom + 16, f"{zeta:g}", anchor="middle")
    for i, m in enumerate(shown):
        y, start = head + row * i, 0.0
        c.text(left - 8, y + 18, words(m.label), anchor="end")
        for source in sources:
            if source in m.given_sources:
                value = max(m.given_sources[source].value, 0.0)
                c.box(x(start), y + 4, x(start + value) - x(start), 13, colour=SOURCE_COLOURS[source])
                start += value
        if m.unexplained is not None:
            c.box(x(start), y + 4, x(start + m.unexplained) - x(start), 13, colour="white", edge=style.INK)
        _whisker(c, m.measured_damping, x, y + 23)
    c.line(left, bottom, right, bottom, colour=style.GREY)
    c.text((left + right) / 2, bottom + 34, "damping ratio [%]", anchor="middle")
    return c.markup


def _whisker(c: Canvas, span: Span | None, x: Callable[[float], float], y: float) -> None:
    """Draw a value with its interval."""
    if span is None:
        return
    if span.low is not None and span.high is not None:
        c.line(x(span.low), y, x(span.high), y, width=2.0)
    c.dot(x(span.value), y)


def ground_intervals(ground: Sequence[GroundAnswer], law: str, *, fits: bool = True) -> Markup | None:
    """Draw the prior and posterior interval of each parameter, each on its own logarithmic axis."""
    if not ground:
        return None
    row, head = 56.0, 24.0
    c = Canvas(_WIDTH, head + row * len(ground), "The ground before and after the data")
    left, right, colour = 60.0, _WIDTH - 60.0, style.law_look(law).colour
    c.box(left, 2, 22, 12, colour=style.PALE)
    c.text(left + 28, 13, "prior")
    c.box(left + 150, 5, 22, 7, colour=colour)
    c.text(left + 178, 13, "now: 90 %, and the median")
    for i, g in enumerate(ground):
        top = head + row * i
        ends = [
            v for s in (g.before, g.value) if s is not None for v in (s.low or s.value, s.high or s.value)
        ]
        low, high = min(ends) / 1.1, max(ends) * 1.1

        def x(value: float, low: float = low, high: float = high) -> float:
            return left + (right - left) * log(value / low) / log(high / low)

        c.text(4, top + 14, parameter_words(g.name).capitalize(), bold=True)
        c.text(_WIDTH - 4, top + 14, verdict_words(g) if fits else "does not fit", anchor="end")
        y = top + 28.0
        if g.before is not None:
            a, b = g.before.low or g.before.value, g.before.high or g.before.value
            c.box(x(a), y - 8, x(b) - x(a), 16, colour=style.PALE, opacity=0.7)
            c.line(x(g.before.value), y - 8, x(g.before.value), y + 8, colour=style.GREY, width=1.5)
        v = g.value
        if v.low is not None and v.high is not None:
            c.box(x(v.low), y - 4, x(v.high) - x(v.low), 8, colour=colour, opacity=0.9)
        c.dot(x(v.value), y)
        _ends(c, g, x, y)
    return c.markup


def _ends(c: Canvas, g: GroundAnswer, x: Callable[[float], float], y: float) -> None:
    """Label the ends of the posterior interval below it, without overlap."""
    v = g.value
    values = [v.value] if v.low is None or v.high is None else [v.low, v.value, v.high]
    places = spread([x(value) for value in values], 84.0, 40.0, _WIDTH - 40.0)
    digits = digits_of(values[0], values[-1]) if len(values) > 1 else 2
    for value, place in zip(values, places, strict=True):
        c.text(place, y + 23, quantity(value, g.unit, digits=digits), anchor="middle")
