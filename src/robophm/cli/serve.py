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
    design: Annotated[Path, typer.Argument(help="the robot's design file; a new one is drafted on the page")] = Path(
        "robot.yaml"
    ),
    host: Annotated[str, typer.Option(help="address to listen on; any other than 127.0.0.1 needs users")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="port to listen on; 0: any free one")] = 8707,
    store: GrowingStore = None,
    no_store: Annotated[
        bool, typer.Option("--no-store", help="do not keep the robot's past; default: kept beside the design")
    ] = False,
    journal: Annotated[Path | None, typer.Option(help="append every sample to this journal")] = None,
    recordings: Annotated[
        list[Path] | None,
        typer.Option("--replay", help="recordings that can be played on the page as if they were live"),
    ] = None,
    synthetic: Annotated[bool, typer.Option("--synthetic", help="offer the synthetic robot as a source")] = False,
    start: Annotated[
        str | None, typer.Option(help="start to watch at once: ros1, ros2, recordings or synthetic", metavar="SOURCE")
    ] = None,
    speed: Annotated[float, typer.Option(help="speed at which a recording is played, as a multiple of its own")] = 1.0,
    notify: Notify = None,
    fleet: Fleet = None,
    certificate: Annotated[
        Path | None, typer.Option(help="certificate for TLS, PEM; default: one is made where others can reach the page")
    ] = None,
    key: Annotated[
        Path | None, typer.Option(help="private key of the certificate, if it is in a file of its own")
    ] = None,
    proxy: Annotated[
        list[str] | None,
        typer.Option(help="address of a reverse proxy that logs users in, and is trusted", metavar="ADDRESS"),
    ] = None,
    embed: Annotated[
        list[str] | None,
        typer.Option(
            help="allow pages of this origin to embed the wall, /wall, e.g. http://10.0.0.5:3000; may be repeated",
            metavar="ORIGIN",
        ),
    ] = None,
) -> None:
    """Serve the web page: design a robot, bind its sensors and watch its health."""
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
