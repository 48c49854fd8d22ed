"""The commands of jackettwin."""

from __future__ import annotations

import click

from jackettwin import __version__


@click.group()
@click.version_option(__version__)
def main() -> None:
    """Digital twin for the jacket foundations of offshore wind turbines."""
