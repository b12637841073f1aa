"""The list of commands; the options and the work of each are in the file of its name."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.cli import EXIT_CODES, NotOursError
from robophm.cli.shared.command_group import CommandGroup

COMMANDS = {
    "new": "Draft a robot's design from its URDF, its recordings and its parts lists, and say its first health.",
    "bind": "Propose bindings for the inputs of a design by what recordings have, and write those that are accepted.",
    "learn": "What failures in the field say of a design's rates.",
    "service": "Tell a robot's ledger that a part was replaced or repaired, or that it failed.",
    "fit": "Fit life data: distributions, lives at stress, repaired systems (needs robophm[fit]).",
    "maintain": "When to replace which part, with which spares, at what cost; whether watching it pays.",
    "wear": "The wear that signals show: trend, change, and what remains of parts and robot.",
    "fmeca": "Failure modes, effects and criticality, the effects from the robot's structure.",
    "diagnose": "What sees which failure, which it is given the alarms, and which sensor would tell most.",
    "history": "A robot's figures and what happened to it, over any stretch of its past.",
    "serve": "The page: design a robot, bind its sensors and watch its health, in any browser.",
    "users": "Who may use the page of a robot, and in which role.",
    "audit": "Who changed what in a robot's design, and what else was done on its page.",
    "report": "Write a robot's health on one page that needs nothing else, not even JavaScript.",
    "check": "Say whether a design is valid, and what in it is odd.",
    "show": "Draw a design and state what it promises when new.",
    "rate": "The hazard rate that a handbook gives for a part.",
    "models": "The hazard models for a kind of part.",
    "parts": "The library of robot parts: what they fail by, and where each figure is from.",
    "predict": "Say what lies ahead: remaining life, task completion.",
    "task": "Say whether a robot can do its tasks: the probability that each will be completed, and what decides it.",
    "replay": "A robot's health after what it recorded: drives in the order of their time, however many.",
    "watch": "The health of a robot that runs, from ROS or MQTT and back to it, until it is interrupted.",
    "topics": "What a robot that runs publishes: topics, types, rates, and the last value of each number.",
    "import-bom": "Put the parts of a list into a design, rated where enough is known, and say what was assumed.",
    "import-legacy": "Make a design of a file of the 2020 tool, and say what is odd in it.",
    "calibrate": "Say whether predictions were honest.",
    "cutsets": "The smallest sets of parts whose failure fails a robot, the likeliest first.",
    "fault-tree": "The probability of a fault tree's top event, and its minimal cut sets; of a robot, also "
                  "its fault tree.",
    "why": "Why a robot's health is as it is: what decides it, and what would restore it.",
    "importance": "What matters most to a robot's health, and what to replace first.",
    "allocate": "Which parts a robot should have more of, for a budget or for a wanted reliability.",
    "demonstrate": "How many to test, for how long, so that few failures demonstrate a reliability.",
    "availability": "How often a robot that is repaired fails, and for which share of the time it is down.",
    "schema": "Print the JSON Schema of the design file.",
    "demo": "Watch a synthetic robot work for a day.",
    "simulate": "Let robots of a design work and really fail: their recordings, tasks and failures.",
    "doctor": "Say what is installed here and whether it works.",
    "data": "Look at measured data: `robophm data BAGS` lists it.",
    "alarms": "The alarms of a robot: which go on, since when and why, and who has taken note of them.",
    "fleet": "Many robots: take their reports, and say how each is and which fail first.",
    "store": "Look after a store, where a robot's past is kept.",
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
        bool, typer.Option("--version", callback=_version, is_eager=True, help="print it and end")
    ] = False,
    messages: Annotated[
        list[Path] | None,
        typer.Option("--messages", help="folders with .msg files of types that recordings do not define; several"),
    ] = None,
) -> None:
    """The honest health of a robot: hazard rate, reliability, remaining life and task completion."""
    if messages:
        from robophm.transports.signals.installed_definitions import use_folders

        use_folders(messages)
