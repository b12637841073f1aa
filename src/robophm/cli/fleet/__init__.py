"""``robophm fleet``: many robots that report to one service. Each command is a file here."""

from __future__ import annotations

import typer

from robophm.cli.shared.command_group import CommandGroup

ENDS_BY_ITSELF = True

COMMANDS = {
    "serve": "Collect the reports of robots, until interrupted.",
    "token": "Make a robot's token, and print how it reports to the fleet with it.",
    "status": "How each robot of a fleet is by its last report, and what was lost or refused.",
    "worst": "The robots that will most probably fail within a horizon, worst first, and the parts that cause it.",
    "trend": "How the fleet was, day by day: robots expected to fail, and how their probabilities spread.",
    "history": "The figures of one robot over time.",
    "learn": "Failure rates by what all robots of the fleet have gone through.",
    "propose": "Propose a design with the rates that the fleet has seen, with evidence, for a person to take.",
    "proposals": "The designs that were proposed, and what was decided; or one of them with its evidence.",
    "accept": "Take a proposal: put its design into the file, and keep who did.",
    "roll-back": "Undo a proposal that was accepted: put the design before it into the file, and keep who did.",
    "calibrate": "The failures that robots promised over their last thirty days, against those noted, by cohort.",
    "assign": "Assign tasks to robots so that all are most probably completed, and explain why.",
    "simulate": "Simulate robots that work, really fail, and report to a running fleet; their records end now.",
    "replay": "Compute the health of many robots from their recordings; an interrupted run is continued.",
    "export": "Write the reports of robots as a table or day by day, or their ledgers.",
}


class _Fleet(CommandGroup):
    package = "robophm.cli.fleet"
    lines = COMMANDS


command = typer.Typer(cls=_Fleet, no_args_is_help=True, add_completion=False, rich_markup_mode=None)


@command.callback()
def _fleet() -> None:
    """Many robots: collect their reports, and see how each is and which will fail first."""
