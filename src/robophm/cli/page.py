"""The commands whose outcome is looked at in a browser."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli import BREACHED
from robophm.cli.output import Horizon, horizon_of

Design = Annotated[Path, typer.Argument(help="the robot's design file", metavar="ROBOT.YAML")]


def serve(
    design: Design,
    host: Annotated[str, typer.Option(help="address to listen on; any but 127.0.0.1 needs --token")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="0 is any that is free")] = 8707,
    token: Annotated[
        str | None, typer.Option(help="secret that browsers must show once", envvar="ROBOPHM_TOKEN")
    ] = None,
    store: Annotated[Path | None, typer.Option(help="keep the robot's past in this SQLite file")] = None,
    journal: Annotated[Path | None, typer.Option(help="write every sample to the end of this journal")] = None,
    recordings: Annotated[
        list[Path] | None, typer.Option("--replay", help="recordings that can be watched as if they were live")
    ] = None,
    synthetic: Annotated[bool, typer.Option("--synthetic", help="offer the synthetic OTA as a source")] = False,
    start: Annotated[
        str | None, typer.Option(help="watch at once: ros1, ros2, recordings or synthetic", metavar="SOURCE")
    ] = None,
    speed: Annotated[float, typer.Option(help="of a recording, as a multiple of its own")] = 1.0,
) -> None:
    """The page: design a robot, bind its sensors and watch its health, in any browser."""
    from robophm.cli.serve import Wishes, run

    run(design, Wishes(host, port, token, store, journal, tuple(recordings or ()), synthetic, start, speed))


def report(
    design: Design,
    store: Annotated[Path | None, typer.Option("--store", help="the robot's past, as kept by replay")] = None,
    output: Annotated[
        Path | None, typer.Option(help="the page; health.html, or health.pdf", show_default=False)
    ] = None,
    horizon: Horizon = None,
    pdf: Annotated[bool, typer.Option("--pdf", help="as a PDF; needs robophm[pdf]")] = False,
    force: Annotated[bool, typer.Option("--force", help="also where that file exists")] = False,
) -> None:
    """Write a robot's health on one page that needs nothing else, not even JavaScript."""
    from robophm.cli.report import run

    path = output or Path("health.pdf" if pdf else "health.html")
    if run(design, store, path, horizon_of(horizon), pdf=pdf, force=force):
        raise typer.Exit(BREACHED)


PAGE_COMMANDS: tuple[Callable[..., None], ...] = (serve, report)
