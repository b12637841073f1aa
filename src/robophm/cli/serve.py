"""``robophm serve``: the page about one robot, in any browser."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from robophm.cli.output import console, may_write, warn
from robophm.cli.unused import refuse_unused
from robophm.core.errors import RobophmError

if TYPE_CHECKING:
    from robophm.web.service import Service

LACKING = "the page needs what `pip install 'robophm[web]'` installs"


@dataclass(frozen=True)
class Wishes:
    """What the command line says."""

    host: str
    port: int
    token: str | None
    store: Path | None
    journal: Path | None
    recordings: Sequence[Path]
    synthetic: bool
    start: str | None
    speed: float


def run(design: Path, wishes: Wishes) -> None:
    """Serve until interrupted. Raises RobophmError."""
    if wishes.start is None:
        used = ("host", "port", "token", "store", "journal", "recordings", "synthetic")
        refuse_unused("a page on which nothing is watched at once (--start)", used)
    try:
        from robophm.web.service import Settings
        from robophm.web.serving import serve
    except ModuleNotFoundError as error:
        if error.name and error.name.partition(".")[0] in ("fastapi", "uvicorn", "starlette", "websockets"):
            raise RobophmError(f"{LACKING}: there is no {error.name}") from None
        raise
    may_write(wishes.journal, design, *([wishes.store] if wishes.store else []))
    may_write(wishes.store, design)
    settings = Settings(
        design, wishes.store, wishes.journal, files_of(wishes.recordings), 1 if wishes.synthetic else None,
        wishes.host, wishes.token,
    )  # fmt: skip

    def ready(address: str, service: Service, stop: Callable[[], None]) -> None:
        if service.workspace.begun:
            warn(f"{design}: no such file; the page begins a new robot, and saving makes the file")
        if wishes.start:
            started(service, wishes.start, wishes.speed)
        console().print(f"{design} is served at {address} until Ctrl+C", markup=False, soft_wrap=True)

    serve(settings, wishes.port, ready)


def started(service: Service, source: str, speed: float) -> None:
    """Begin monitoring at once. Raises RobophmError."""
    from robophm.web.sources import chosen

    choice = chosen(dict(service.sources), source)
    service.monitoring.start(service.prepared().robot, choice, speed, service.workspace.draft().state)


def files_of(paths: Sequence[Path]) -> tuple[Path, ...]:
    """Recordings, and those in folders, in the order of their names. Raises SourceError where there is none."""
    from robophm.transports.recordings.files import existing, parts_of

    found: list[Path] = []
    for path in paths:
        found += parts_of(existing(path)) if path.is_dir() else [existing(path)]
    return tuple(found)
