"""``robophm data``: what was measured. Each command is declared here and done in ``measured.py``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from robophm.cli.output import Json


class _Listing(TyperGroup):
    """``robophm data BAGS`` is ``robophm data list BAGS``."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        from difflib import get_close_matches

        known = [*self.commands, "--help"]
        slip = args and not Path(args[0]).exists() and get_close_matches(args[0], self.commands)
        if args and args[0] not in known and not slip:
            args = ["list", *args]
        return super().parse_args(ctx, args)


data = typer.Typer(cls=_Listing, no_args_is_help=True, help="Look at measured data: `robophm data BAGS` lists it.")

Bags = Annotated[list[Path], typer.Argument(help=".bag, .db3, .mcap, rosbag2 folders, or folders of them")]
SignalName = Annotated[str, typer.Option("--signal", help="/topic.field, /topic.field[2], /topic.field[name]")]
SignalNames = Annotated[list[str], typer.Option("--signal", help="/topic.field, [2] or [name] of an array; several")]
Gap = Annotated[str, typer.Option("--gap", help="a value holds so long at most; after that nothing is known")]
Together = Annotated[bool, typer.Option("--together", help="the recordings are one drive, not each for itself")]
Force = Annotated[bool, typer.Option("--force", help="also where the file exists")]
Bins = Annotated[int, typer.Option("--bins", help="levels at most", min=2, max=1000)]
Most = Annotated[int, typer.Option("--most", help="to list", min=1, max=100_000)]
Page = Annotated[Path | None, typer.Option("--report", help="write a page about it, HTML")]


@data.command("list")
def list_(
    bags: Bags,
    gap: Annotated[
        str | None, typer.Option("--gap", help="so long without a message; default 10 times the topic's interval")
    ] = None,
    as_json: Json = False,
) -> None:
    """What recordings hold: topics, fields, units, time spans, gaps."""
    from robophm.cli.measured import listed

    listed(bags, gap, as_json=as_json)


@data.command()
def find(
    bags: Bags,
    signal: SignalName,
    above: Annotated[str | None, typer.Option(help="e.g. '70 degC'; with --below, between")] = None,
    below: Annotated[str | None, typer.Option(help="e.g. '22 V'")] = None,
    faster: Annotated[str | None, typer.Option(help="changes by more, up or down, e.g. '2 K/s'")] = None,
    stuck: Annotated[bool, typer.Option("--stuck", help="says the very same again and again")] = False,
    missing: Annotated[bool, typer.Option("--missing", help="says nothing")] = False,
    at_least: Annotated[str, typer.Option("--for", help="without interruption, e.g. '10 s'")] = "0 s",
    gap: Gap = "5 s",
    together: Together = False,
    most: Most = 20,
    as_json: Json = False,
) -> None:
    """Where a value is above, below or between levels, changes fast, is stuck or missing, for at least so long."""
    from robophm.cli.measured import Search, found

    found(bags, signal, Search(above, below, faster, stuck, missing, at_least), gap, most, together=together,
          as_json=as_json)  # fmt: skip


@data.command()
def statistics(
    bags: Bags,
    signal: SignalNames,
    every: Annotated[str | None, typer.Option(help="also of each such stretch of time, e.g. '1 min'")] = None,
    bins: Bins = 20,
    gap: Gap = "5 s",
    together: Together = False,
    to: Annotated[Path | None, typer.Option(help="write those of --every, or of all, as a table, .csv")] = None,
    report: Page = None,
    force: Force = False,
    most: Most = 20,
    as_json: Json = False,
) -> None:
    """Lowest, mean, highest, deviation, course and time at level of signals, and of each stretch of time."""
    from robophm.cli.measured import summed_up

    summed_up(bags, signal, every, bins, gap, most, to, report, together=together, force=force, as_json=as_json)


@data.command()
def profile(
    design: Annotated[Path, typer.Argument(help="the robot's design file", metavar="ROBOT.YAML")],
    bags: Bags,
    to: Annotated[Path | None, typer.Option(help="write it as a load to come, .yaml: see predict --plan")] = None,
    bins: Bins = 20,
    report: Page = None,
    skip_missing: Annotated[
        bool, typer.Option("--skip-missing", help="bound topics that are not recorded stay silent")
    ] = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Stress profiles: at which levels each part of a robot lived, and for how long."""
    from robophm.cli.measured_profile import profiled

    profiled(design, bags, bins, to, report, skip_missing=skip_missing, force=force, as_json=as_json)


@data.command()
def export(
    bags: Bags,
    signal: SignalNames,
    to: Annotated[Path, typer.Option(help="the table to write, .csv or .parquet")],
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Samples of signals as a table, in order of time; all recordings together."""
    from robophm.cli.measured import exported

    exported(bags, signal, to, force=force, as_json=as_json)
