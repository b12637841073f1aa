"""``robophm serve``: the page about one robot, in any browser."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from robophm.cli.shared.fleet import Fleet, fleet_address, sender
from robophm.cli.shared.options import GrowingStore, Notify
from robophm.cli.shared.output import console, may_write, warn
from robophm.cli.shared.stored_past import files_of
from robophm.cli.shared.unused import refuse_unused
from robophm.cli.shared.web_extra import check_key, web_extra
from robophm.core.errors import RobophmError
from robophm.stores import open_store, place_of

if TYPE_CHECKING:
    from robophm.web.service import Service

ENDS_BY_ITSELF = True


@dataclass(frozen=True)
class Wishes:
    """The options of the service."""

    host: str
    port: int
    store: str | None
    journal: Path | None
    recordings: Sequence[Path]
    synthetic: bool
    start: str | None
    speed: float
    no_store: bool = False
    notify: Sequence[str] = ()
    """Addresses that are told of alarms."""
    certificate: Path | None = None
    key: Path | None = None
    proxies: Sequence[str] = ()
    """Addresses of reverse proxies that are believed when they say who asks."""
    embed: Sequence[str] = ()
    """Origins of pages inside which the wall may be shown."""
    fleet: str | None = None
    """The address at which a fleet takes the robot's reports."""


def command(
    design: Annotated[
        Path, typer.Argument(help="the robot's design file; one that is not there yet is drafted on the page")
    ] = Path("robot.yaml"),
    host: Annotated[str, typer.Option(help="address to listen on; any but 127.0.0.1 needs users")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="0 is any that is free")] = 8707,
    store: GrowingStore = None,
    no_store: Annotated[
        bool, typer.Option("--no-store", help="keep the robot's past nowhere; else beside the design")
    ] = False,
    journal: Annotated[Path | None, typer.Option(help="write every sample to the end of this journal")] = None,
    recordings: Annotated[
        list[Path] | None, typer.Option("--replay", help="recordings that can be watched as if they were live")
    ] = None,
    synthetic: Annotated[bool, typer.Option("--synthetic", help="offer the synthetic OTA as a source")] = False,
    start: Annotated[
        str | None, typer.Option(help="watch at once: ros1, ros2, recordings or synthetic", metavar="SOURCE")
    ] = None,
    speed: Annotated[float, typer.Option(help="of a recording, as a multiple of its own")] = 1.0,
    notify: Notify = None,
    fleet: Fleet = None,
    certificate: Annotated[
        Path | None, typer.Option(help="certificate for TLS, in PEM; else one is made where others reach the page")
    ] = None,
    key: Annotated[Path | None, typer.Option(help="its key, where that is in no file with it")] = None,
    proxy: Annotated[
        list[str] | None,
        typer.Option(help="address of a reverse proxy that logs people in, and is believed", metavar="ADDRESS"),
    ] = None,
    embed: Annotated[
        list[str] | None,
        typer.Option(
            help="show the wall, /wall, inside pages of this origin, e.g. http://10.0.0.5:3000; several",
            metavar="ORIGIN",
        ),
    ] = None,
) -> None:
    """The page: design a robot, bind its sensors and watch its health, in any browser."""
    proxies, origins = tuple(proxy or ()), tuple(embed or ())
    run(design, Wishes(host, port, store, journal, tuple(recordings or ()), synthetic, start, speed, no_store,
                       tuple(notify or ()), certificate, key, proxies, origins, fleet))  # fmt: skip


def own_store(design: Path) -> str | None:
    """The store of a robot that is asked for none: beside its design; None, with a warning, where it cannot be there.

    Raises StoreError where a store is there that is of another version.
    """
    path = design.with_name(f"{design.name}.past")
    there = path if path.exists() else path.parent
    if path.is_dir() or not os.access(there, os.W_OK):
        warn(f"{path}: cannot be written; the robot's past is kept only until this ends, or with --store elsewhere")
        return None
    if path.exists():
        open_store(path).close()
    return str(path)


def run(design: Path, wishes: Wishes) -> None:
    """Serve the page until interrupted. Raises RobophmError."""
    if wishes.start is None:
        used = ("design", "host", "port", "store", "no_store", "journal", "recordings", "synthetic", "notify",
                "certificate", "key", "proxy", "embed", "fleet")  # fmt: skip
        refuse_unused("a page on which nothing is watched at once (--start)", used)
    from robophm.transports.recordings.files import recordings_in

    with web_extra("the page"):
        from robophm.web.service import Settings
        from robophm.web.serving import serve
    if wishes.store and wishes.no_store:
        raise RobophmError("--store and --no-store: expected one of them")
    if os.environ.get("ROBOPHM_TOKEN"):
        raise RobophmError("ROBOPHM_TOKEN is not used any more; expected `robophm users add --token`, and it unset")
    check_key(wishes.key, wishes.certificate)
    may_write(wishes.journal, design, *files_of(wishes.store))
    for file in files_of(wishes.store):
        may_write(file, design)
    own = None if wishes.no_store or wishes.store else own_store(design)
    settings = Settings(
        design, wishes.store or own, wishes.journal, recordings_in(wishes.recordings), 1 if wishes.synthetic else None,
        wishes.host, tuple(wishes.proxies), wishes.certificate, wishes.key, own_store=own is not None,
        notify=tuple(wishes.notify), embed=tuple(wishes.embed), for_fleet=wishes.fleet is not None,
    )  # fmt: skip
    fleet = fleet_address(wishes.fleet, wishes.store or own) if wishes.fleet else None
    sends = ExitStack()

    def ready(address: str, service: Service, stop: Callable[[], None]) -> None:
        if not service.workspace.lasting:
            warn(f"{design.parent}: cannot be written; edits cannot be saved, and are kept only until this ends")
        if service.workspace.begun:
            warn(f"{design}: no such file; the page begins a new robot, and saving makes the file")
        if fleet:
            sends.enter_context(sender(wishes.store or own or "", service.prepared().robot.identity, fleet))
        if wishes.start:
            service.keep_watching(wishes.start, wishes.speed)
        console().print(f"{design} is served at {address} until Ctrl+C", markup=False, soft_wrap=True)
        if service.fingerprint:
            said = f"Its certificate has the SHA-256 fingerprint {service.fingerprint}"
            console().print(said, markup=False, emoji=False, soft_wrap=True)
        if service.visitors.known_alone:
            console().print("Whoever opens it has to log in", markup=False, soft_wrap=True)
        where = f"in {place_of(settings.store)}" if settings.store else "only until then"
        console().print(f"The robot's past is kept {where}", markup=False, soft_wrap=True)

    with sends:
        serve(settings, wishes.port, ready)
