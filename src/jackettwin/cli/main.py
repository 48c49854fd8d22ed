"""Entry point; each command lives in a file of its own."""

from __future__ import annotations

import click

from jackettwin.cli.check import check_command
from jackettwin.cli.console import Commands
from jackettwin.cli.export import export_command
from jackettwin.cli.follow import follow_command
from jackettwin.cli.identify import identify_command
from jackettwin.cli.loads import loads_command
from jackettwin.cli.modes import modes_command
from jackettwin.cli.refine import refine_command
from jackettwin.cli.run import run_command
from jackettwin.cli.simulate import simulate_command
from jackettwin.cli.simulate_set import simulate_set_command
from jackettwin.cli.stages import stages_command
from jackettwin.cli.superelement import superelement_command
from jackettwin.cli.update import update_command
from jackettwin.cli.verify import verify_command
from jackettwin.cli.view import view_command
from jackettwin.cli.watch import watch_command
from jackettwin.version import __version__


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
@click.option("--traceback", is_flag=True, help="Show the traceback of an internal error.")
def main(traceback: bool) -> None:
    """Digital twin for the jacket foundations of offshore wind turbines.

    Start with `jackettwin run`: it needs no argument.
    """


for command in (
    run_command,
    verify_command,
    modes_command,
    identify_command,
    update_command,
    follow_command,
    watch_command,
    refine_command,
    superelement_command,
    export_command,
    stages_command,
    check_command,
    simulate_command,
    simulate_set_command,
    loads_command,
    view_command,
):
    main.add_command(command)
