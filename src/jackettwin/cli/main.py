"""Entry point; each command has its own file, which is imported when the command is called."""

from __future__ import annotations

import click

from jackettwin.cli.console import Commands
from jackettwin.version import __version__

GROUPS = {
    "Start": {
        "run": "Go from records to modes to updated supports, and report it.",
        "init": "Write a commented twin file for STRUCTURE and RECORDS.",
        "compare": "Compare run B with run A, relative to their uncertainty.",
        "verify": "Recompute every published number of the thesis.",
    },
    "Measured": {
        "identify": "Identify the modes of RECORDS: files, or folders of files.",
        "update": "Update TWIN's supports under one law or all; writes nothing.",
        "explore": "Show the effect of TWIN's law parameters on modes and cost.",
        "follow": "Update the supports of TWIN day after day, and find drift.",
        "watch": "Report whether the modes in TABLE have changed, and why.",
    },
    "Modelled": {
        "modes": "Compute undamped and damped modes of STRUCTURE.",
        "refine": "Fit steel, masses and springs to known frequencies.",
        "stages": "Compute frequencies of STRUCTURE as its parts are added.",
        "view": "Draw STRUCTURE on a page to turn, colour and animate.",
        "soil": "Compute curves, stiffness, capacity of a pile of FOUNDATION.",
        "law": "Draw creep, relaxation, storage and loss of support laws.",
        "check": "Check members and joints of STRUCTURE, or of a scenario.",
        "operation": "Compute damping and excitation by a rotor in operation.",
        "fatigue": "Count cycles, and compute damage and life of welds.",
    },
    "Simulated": {
        "loads": "Compute wave and wind loads of SCENARIO on a still asset.",
        "simulate": "Simulate SCENARIO and write its record.",
        "simulate-set": "Simulate every case of SET on all cores.",
    },
    "Living": {
        "serve": "Serve the living twin in STORE: records in, answers out.",
        "asset": "Manage the turbines of a living twin and their versions.",
        "intake": "Take records from PATHS, files or folders, into a store.",
        "rebuild": "Recompute the states from observations or raw records.",
        "backup": "Write everything of STORE into FILE, while it is served.",
        "restore": "Fill the empty STORE from a backup FILE.",
        "user": "Manage the users of a server.",
        "token": "Manage the tokens with which machines log in.",
        "alerts": "List the messages sent on a store's findings, newest first.",
        "audit": "List the actions of users in a store, newest first.",
    },
    "To other programs": {
        "superelement": "Reduce the foundation of STRUCTURE to 6 + N coordinates.",
        "recover": "Recover forces below the interface from its MOTION.",
        "export": "Write the foundation of STRUCTURE as a SubDyn input file.",
    },
}
"""Help text of every command by the README's groups: the first sentence of its docstring, given here so that
``--help`` need not import the command. ``simulate-set`` is ``simulate_set_command`` in
``jackettwin/cli/simulate_set.py``.
"""


@click.group(cls=Commands, groups=GROUPS, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
@click.option("--traceback", is_flag=True, help="Show the traceback of an internal error.")
def main(traceback: bool) -> None:
    """Digital twin for the jacket foundations of offshore wind turbines.

    Start with `jackettwin run`: it needs no argument.
    """
