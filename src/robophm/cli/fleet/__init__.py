"""``robophm fleet``: many robots that report to one service. Each command is a file here."""

from __future__ import annotations

import typer

from robophm.cli.shared.command_group import CommandGroup

ENDS_BY_ITSELF = True

COMMANDS = {
    "serve": "Take the reports of robots, until it is interrupted.",
    "token": "Make a robot's token, and print how it reports to the fleet with it.",
    "status": "How each robot of a fleet is, by what it last sent, and what was lost or refused.",
    "worst": "The robots that fail most probably within a horizon, worst first, and by what.",
    "history": "The figures of one robot over time.",
    "assign": "Which robot takes which task, so that all are most probably completed, and why.",
    "simulate": "Let simulated robots work, really fail, and report to a running fleet; their records end now.",
    "replay": "The health of many robots after what they recorded, several at once; begun anew, it goes on.",
    "export": "Write the reports of robots as a table, or their ledgers.",
}


class _Fleet(CommandGroup):
    package = "robophm.cli.fleet"
    lines = COMMANDS


command = typer.Typer(cls=_Fleet, no_args_is_help=True, add_completion=False, rich_markup_mode=None)


@command.callback()
def _fleet() -> None:
    """Many robots: take their reports, and say how each is and which fail first."""
