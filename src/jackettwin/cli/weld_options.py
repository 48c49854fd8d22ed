"""Options of the commands on welds, and the limit that shows a wrong unit of their stress."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from jackettwin.cli.console import FiniteFloat

STRONGEST_PA = 2e9
"""Stress range above which the unit must be wrong."""
USUAL_PA = 1e6
"""Largest range of welds below which the unit is doubted."""


def joint_options(command: Any) -> Any:
    """Add the options that choose the S-N curve of joints and the safety against it."""
    curve = click.option("--curve", default="T", show_default=True, help="S-N curve of tubular joints.")
    factor = click.option(
        "--design-factor", default=1.0, show_default=True, type=FiniteFloat(min=1.0, max=10.0),
        help="Design fatigue factor.",
    )  # fmt: skip
    return curve(factor(command))


def details_option(command: Any) -> Any:
    """Add the option that names the file of details of tubes."""
    said = "File (YAML or JSON) of butt_welds, and of details of tubes with their factors."
    return click.option("--details", type=click.Path(path_type=Path), help=said)(command)


def edition_option(command: Any) -> Any:
    """Add the option that chooses the edition of the S-N curves."""
    said = "A shipped set of S-N curves or a YAML file; default: the newest."
    return click.option("--edition", default=None, help=said)(command)
