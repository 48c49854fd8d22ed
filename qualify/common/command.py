"""The command line of a campaign: what it takes, each with a usual value, and ``--help``."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any


def arguments(doc: str | None, **usual: Any) -> argparse.Namespace:
    """Return what was given, of the type of the usual value, or that.

    Values are in the order of the names; a tuple takes any number of them, ``False`` is an option, and None
    stands for a folder or file that a campaign may go without.

    Parameters
    ----------
    doc : docstring of the script, which ``--help`` prints
    """
    shape = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=doc, formatter_class=shape)
    for name, value in usual.items():
        if value is False:
            parser.add_argument(f"--{name}", action="store_true")
        elif isinstance(value, tuple):
            kind = type(value[0]) if value else str
            parser.add_argument(name, nargs="*", default=value, type=kind)
        else:
            kind = type(value) if isinstance(value, int | float | str) else Path
            parser.add_argument(name, nargs="?", default=value, type=kind, help=f"default: {value}")
    return parser.parse_args()
