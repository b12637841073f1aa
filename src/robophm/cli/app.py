"""The list of commands; the options and the work of each are in the file of its name."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.cli import EXIT_CODES, NotOursError
from robophm.cli.shared.command_group import CommandGroup

COMMANDS = {
    "new": "Draft a design from a URDF, recordings and parts lists, and give the robot's first health figures.",
    "bind": "Propose recorded signals for the inputs of a design, and write those that you accept.",
    "learn": "Update a design's failure rates by failures in the field.",
    "service": "Record that a part was replaced or repaired, or that it failed, or had not.",
    "fit": "Fit life data: distributions, lives at stress, repaired systems (needs robophm[fit]).",
    "maintain": "When to replace which part, with which spares, at what cost, and whether monitoring pays.",
    "wear": "Wear seen in signals: trend, changes, and the remaining life of parts and robot.",
    "fmeca": "Failure modes, effects and criticality (FMECA), with effects from the robot's structure.",
    "diagnose": "Which sensor detects which failure, what has failed given the alarms, and which sensor to add.",
    "history": "A robot's figures and events over any period of its past.",
    "serve": "Serve the web page: design a robot, bind its sensors and watch its health.",
    "users": "Manage the users of a robot's page and their roles.",
    "audit": "Who changed what in a robot's design, and what else was done on its page.",
    "report": "Write a robot's health as one page that needs no other file and no JavaScript.",
    "check": "Check a design for errors, and warn of odd values.",
    "show": "Draw a design and give its figures when new.",
    "rate": "Compute the hazard rate of a part by a handbook's model.",
    "models": "List the hazard models for a kind of part.",
    "parts": "Search the library of robot parts: failure modes, rates and their sources.",
    "predict": "Predict remaining life and task completion.",
    "task": "The probability that each task will be completed, and the parts that decide it.",
    "replay": "Compute a robot's health from its recordings, in the order of their time.",
    "watch": "Watch a running robot over ROS or MQTT, and publish its health, until interrupted.",
    "topics": "List what a running robot publishes: topics, types, rates and the last value of each number.",
    "import-bom": "Import a parts list into a design, with rates where enough is known, and list the assumptions.",
    "import-legacy": "Convert a file of the 2020 tool to a design, and list what is odd in it.",
    "calibrate": "Compare predictions with what happened, and say whether they were honest.",
    "cutsets": "Minimal cut sets: the smallest sets of parts whose failure fails a robot, the likeliest first.",
    "fault-tree": "The probability of a fault tree's top event and its minimal cut sets, also of a robot's own tree.",
    "why": "Explain a robot's health: what decides it, and what would restore it.",
    "importance": "Rank parts by their importance to a robot's health, and say what to replace first.",
    "allocate": "Choose redundant parts for a budget, or for a wanted reliability.",
    "demonstrate": "Plan a test that demonstrates a reliability: units, duration and allowed failures.",
    "availability": "How often a repaired robot fails, and for which share of the time it is down.",
    "schema": "Print the JSON Schema of the design file.",
    "demo": "Watch a synthetic robot work for a day.",
    "simulate": "Simulate robots of a design that really fail: recordings, tasks and failures.",
    "doctor": "Report what is installed here and whether it works.",
    "data": "Examine measured data; `robophm data BAGS` lists it.",
    "alarms": "List a robot's alarms: which are on, since when, why, and who acknowledged them.",
    "fleet": "Many robots: collect their reports, and see how each is and which will fail first.",
    "store": "Manage a store, the file that keeps a robot's past.",
}  # fmt: skip
"""Each with the first line of its help."""

GROUPS = {
    "A robot's design": ("new", "bind", "check", "show", "import-bom", "import-legacy", "schema"),
    "Rates of parts": ("parts", "models", "rate"),
    "Health, recorded and live": (
        "replay",
        "watch",
        "topics",
        "report",
        "history",
        "serve",
        "users",
        "audit",
        "alarms",
        "data",
        "service",
        "store",
    ),
    "What lies ahead, and why": ("predict", "task", "importance", "availability", "why"),
    "Structure and faults": ("cutsets", "fault-tree", "fmeca", "diagnose", "allocate"),
    "Many robots": ("fleet",),
    "Learning and upkeep": ("learn", "fit", "demonstrate", "wear", "maintain", "calibrate"),
    "To try it": ("demo", "simulate", "doctor"),
}
"""The commands by what they are for."""

FORMER = {
    ("report", "--output"): "--to", ("demo", "--output"): "--to", ("simulate", "--output"): "--to",
    ("show", "--hours"): "--at", ("fault-tree", "--time"): "--at", ("diagnose", "--after"): "--at",
    ("diagnose", "--hours"): "--within", ("fmeca", "--hours"): "--within", ("importance", "--after"): "--within",
    ("wear", "--at"): "--use",
}  # fmt: skip
"""Options that had another name."""

SOUGHT = {"draft": "new"}
"""Commands by what people call them."""


class _Commands(CommandGroup):
    package = "robophm.cli"
    lines = COMMANDS
    groups = GROUPS
    former = FORMER
    sought = SOUGHT

    def invoke(self, ctx: Any) -> Any:
        """Lets no library decide the exit code: typer makes 1 of these two, whoever raised them."""
        try:
            return super().invoke(ctx)
        except (EOFError, BrokenPipeError) as error:
            raise NotOursError from error


app = typer.Typer(
    cls=_Commands,
    help="The honest health of a robot: hazard rate, reliability, remaining life and task completion.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(version("robophm"))
        raise typer.Exit


@app.callback()
def robophm(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="print the version and exit")
    ] = False,
    messages: Annotated[
        list[Path] | None,
        typer.Option(
            "--messages", help="folder with .msg files of types that recordings do not define; may be repeated"
        ),
    ] = None,
) -> None:
    """The honest health of a robot: hazard rate, reliability, remaining life and task completion."""
    if messages:
        from robophm.transports.signals.installed_definitions import use_folders

        use_folders(messages)
