"""The commands of jackettwin."""

from jackettwin.cli.main import main

__all__ = ["main"]
