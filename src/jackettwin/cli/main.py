"""Entry point; each command lives in a file of its own, which is read when the command is called."""

from __future__ import annotations

import click

from jackettwin.cli.console import Commands
from jackettwin.version import __version__

COMMANDS = {
    "run": "Go from records to modes to updated supports: report.html, result.json, figures.",
    "init": "Write a commented twin file for STRUCTURE and RECORDS, check it, and say what is missing.",
    "compare": "Say what changed from run A to run B, and by how much of its uncertainty.",
    "verify": "Recompute every published number of the thesis; exit 1 if one fails.",
    "modes": "Undamped and damped modes of STRUCTURE: a shipped name, a YAML file, or a SubDyn .dat file.",
    "identify": "Identify the modes of RECORDS: files, or folders of files.",
    "update": "Update the supports of TWIN under one law; writes nothing.",
    "follow": "Update the supports of TWIN day after day; say whether their stiffness drifts.",
    "watch": "Say whether the modes in TABLE have changed, since when, by how much, and why.",
    "refine": "Scale E and ρ of the steel, part by part, to known frequencies; writes nothing.",
    "superelement": "Reduce what stands below the interface of STRUCTURE to 6 + N coordinates; say how right "
    "that is.",
    "soil": "Reaction curves, head stiffness, capacity and pushover of a pile of FOUNDATION, and a page of "
    "them.",
    "export": "Write what stands below the interface of STRUCTURE as a SubDyn input file.",
    "stages": "Frequencies of STRUCTURE on pinned feet as its parts are added: jacket, transition piece, "
    "tower.",
    "check": "Check members and joints of STRUCTURE at rest under weight and forces given, or of a scenario.",
    "simulate": "Simulate SCENARIO, a shipped name or a YAML file, and write its record.",
    "simulate-set": "Simulate every case of SET, a shipped name (dlc64) or a YAML file; finished cases are "
    "kept.",
    "loads": "Wave and wind loads of SCENARIO on an asset that stands still, about still water and about the "
    "bed.",
    "view": "Draw STRUCTURE in space, in one self-contained page: members, modes, waves, a record.",
    "serve": "Serve the living twin in STORE: records in, answers out; STORE is made if it is not there.",
    "asset": "Turbines of a living twin: add, list, show, adopt, archive, conditions.",
    "intake": "Take records from PATHS, files or folders, into a store; a server observes them.",
    "rebuild": "Make the states again from stored observations, or with --observe from raw records.",
    "backup": "Write everything of STORE into FILE, while it is served or not; whole or not at all.",
    "restore": "Fill the empty STORE from a backup FILE; whole or not at all.",
    "user": "Users of a server; with the first one, everybody must log in.",
    "token": "Tokens with which machines log in.",
}
"""What ``--help`` says of every command, the first sentence of its docstring, without reading the command.

``simulate-set`` is ``simulate_set_command`` in ``jackettwin/cli/simulate_set.py``, and so on.
"""


@click.group(cls=Commands, summaries=COMMANDS, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
@click.option("--traceback", is_flag=True, help="Show the traceback of an internal error.")
def main(traceback: bool) -> None:
    """Digital twin for the jacket foundations of offshore wind turbines.

    Start with `jackettwin run`: it needs no argument.
    """
