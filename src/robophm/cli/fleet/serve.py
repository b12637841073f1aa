"""``robophm fleet serve``: the service that robots report to."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.output import console
from robophm.cli.shared.web_extra import check_key, web_extra

ENDS_BY_ITSELF = True


def command(
    store: FleetStorePath,
    host: Annotated[
        str, typer.Option(help="address to listen on; any other than 127.0.0.1 is served over TLS")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="port to listen on; 0: any free one")] = 8708,
    certificate: Annotated[
        Path | None,
        typer.Option(help="certificate for TLS, PEM; default: one is made where others can reach the service"),
    ] = None,
    key: Annotated[
        Path | None, typer.Option(help="private key of the certificate, if it is in a file of its own")
    ] = None,
    proxy: Annotated[
        list[str] | None,
        typer.Option(help="address of a reverse proxy that handles TLS for the service", metavar="ADDRESS"),
    ] = None,
    mqtt: Annotated[
        str | None,
        typer.Option(help="also take reports from a broker, mqtts://user@broker[/topic]", metavar="URL"),
    ] = None,
) -> None:
    """Collect the reports of robots, until interrupted."""
    check_key(key, certificate)
    with web_extra("a fleet's service"):
        from robophm.fleet.serving import FleetSettings, serve_fleet

    def ready(address: str, fingerprint: str, _: Callable[[], None]) -> None:
        out = console()
        out.print(f"Robots report to {address}robots/NAME until Ctrl+C", markup=False, soft_wrap=True)
        if mqtt:
            out.print(f"They report to {mqtt.rstrip('/')}/robots/NAME too", markup=False, emoji=False, soft_wrap=True)
        out.print(f"Its page is {address}", markup=False, soft_wrap=True)
        if fingerprint:
            said = f"Its certificate has the SHA-256 fingerprint {fingerprint}"
            out.print(said, markup=False, emoji=False, soft_wrap=True)

    serve_fleet(FleetSettings(store, host, port, certificate, key, tuple(proxy or ()), mqtt), ready)
