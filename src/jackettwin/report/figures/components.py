"""Mode shapes at sensors of unknown position: one bar per channel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification import ModalEstimate
from jackettwin.records import Channel
from jackettwin.report.figures import style
from jackettwin.report.tables.numbers import frequency, percent, words

_COLUMNS = 3


def components(shape: ComplexArray) -> FloatArray:
    """Return a shape's channels at the phase of largest motion: real, largest entry 1.

    The phase maximises the sum of squares of the real parts: half the argument of Σφ².

    Examples
    --------
    >>> components(np.array([1j, -0.5j])).tolist()
    [1.0, -0.5]
    """
    turned = (shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))).real
    largest = turned[np.argmax(np.abs(turned))]
    return np.asarray(turned / largest if largest else turned)


def shape_components(channels: Sequence[Channel], modes: Sequence[tuple[str, ModalEstimate]]) -> go.Figure:
    """Draw every mode as bars, one per channel in the record's order.

    Parameters
    ----------
    modes : sequence of (label, mode)
        Labels may be empty.
    """
    n_columns = min(len(modes), _COLUMNS)
    n_rows = -(-len(modes) // n_columns)
    titles = [
        f"<b>{words(label) if label else 'mode'}</b>  {frequency(mode.frequency_hz)} Hz  "
        f"ζ {percent(mode.damping_ratio)} %"
        for label, mode in modes
    ]
    figure = make_subplots(n_rows, n_columns, shared_yaxes=True, subplot_titles=titles)
    names = [channel.name for channel in channels]
    for i, (label, mode) in enumerate(modes):
        bars = go.Bar(
            x=components(mode.mode_shape),
            y=names,
            orientation="h",
            marker={"color": style.mode_look(label or "mode").colour},
            hovertemplate="%{y} %{x:.2f}<extra></extra>",
            showlegend=False,
        )
        figure.add_trace(bars, row=i // n_columns + 1, col=i % n_columns + 1)
    figure.update_xaxes(range=[-1.1, 1.1], title_text=style.title("share of the largest", "-"))
    figure.update_yaxes(autorange="reversed", type="category")
    height = n_rows * (110 + 22 * len(names))
    return style.finish(figure, height=height, margin={"l": 130, "r": 24, "t": 40, "b": 54})
