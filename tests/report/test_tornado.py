"""The tornado: bars by sign and size, labels inside the drawing."""

import re
from types import SimpleNamespace

import numpy as np

from jackettwin.report.figures.tornado import tornado


def scrutiny(effects: dict[str, float]) -> SimpleNamespace:
    movers = [
        SimpleNamespace(effect=np.array([size]), tolerance=SimpleNamespace(words=words))
        for words, size in effects.items()
    ]
    return SimpleNamespace(movers=lambda parameter: movers)


def test_the_longest_label_begins_inside_the_drawing() -> None:
    long = "growth of the ground's loss with frequency"
    drawn = tornado(scrutiny({"mass of the tower": 0.06, long: -0.01}), 0, "vertical stiffness")
    assert drawn is not None
    (end,) = re.findall(r'<text[^>]*\bx="([\d.]+)"[^>]*>' + long.replace("'", "&#39;"), str(drawn))
    # DejaVu Sans, the widest of the page's fonts, takes 0.56 of its size a letter on average
    assert float(end) >= 0.56 * 13.0 * len(long)


def test_what_is_not_felt_is_not_drawn() -> None:
    drawn = tornado(scrutiny({"mass of the tower": 0.06, "drag": 0.001}), 0, "vertical stiffness")
    assert drawn is not None and "drag" not in drawn
    assert "+6.2 %" in drawn and "change of the vertical stiffness" in drawn  # exp(0.06) − 1
    assert tornado(scrutiny({"drag": 0.001}), 0, "vertical stiffness") is None
