"""``robophm serve``: the page about one robot, in any browser."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from robophm.cli.shared.options import GrowingStore
from robophm.cli.shared.output import console, may_write, warn
from robophm.cli.shared.stored_past import files_of
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import RobophmError

if TYPE_CHECKING:
    from robophm.web.service import Service

LACKING = "the page needs what `pip install 'robophm[web]'` installs"


@dataclass(frozen=True)
class Wishes:
    """The options of the service."""

    host: str
    port: int
    token: str | None
    store: str | None
    journal: Path | None
    recordings: Sequence[Path]
    synthetic: bool
    start: str | None
    speed: float


def command(
    design: Annotated[
        Path, typer.Argument(help="the robot's design file; one that is not there yet is drafted on the page")
    ] = Path("robot.yaml"),
    host: Annotated[str, typer.Option(help="address to listen on; any but 127.0.0.1 needs --token")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="0 is any that is free")] = 8707,
    token: Annotated[
        str | None, typer.Option(help="secret that browsers must show once", envvar="ROBOPHM_TOKEN")
    ] = None,
    store: GrowingStore = None,
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
    run(design, Wishes(host, port, token, store, journal, tuple(recordings or ()), synthetic, start, speed))


def run(design: Path, wishes: Wishes) -> None:
    """Serve the page until interrupted. Raises RobophmError."""
    if wishes.start is None:
        used = ("design", "host", "port", "token", "store", "journal", "recordings", "synthetic")
        refuse_unused("a page on which nothing is watched at once (--start)", used)
    from robophm.transports.recordings.files import recordings_in

    try:
        from robophm.web.service import Settings
        from robophm.web.serving import serve
    except ModuleNotFoundError as error:
        if error.name and error.name.partition(".")[0] in ("fastapi", "uvicorn", "starlette", "websockets"):
            raise RobophmError(f"{LACKING}: there is no {error.name}") from None
        raise
    may_write(wishes.journal, design, *files_of(wishes.store))
    for file in files_of(wishes.store):
        may_write(file, design)
    settings = Settings(
        design, wishes.store, wishes.journal, recordings_in(wishes.recordings), 1 if wishes.synthetic else None,
        wishes.host, wishes.token,
    )  # fmt: skip

    def ready(address: str, service: Service, stop: Callable[[], None]) -> None:
        if service.workspace.begun:
            warn(f"{design}: no such file; the page begins a new robot, and saving makes the file")
        if wishes.start:
            service.watch(wishes.start, wishes.speed)
        console().print(f"{design} is served at {address} until Ctrl+C", markup=False, soft_wrap=True)

    serve(settings, wishes.port, ready)
