"""The fleet's service on a port, until it is told to stop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from robophm.fleet.app import create_app
from robophm.fleet.mqtt.connection import refuse_plain
from robophm.fleet.page.app import page_app
from robophm.fleet.store import FleetStore
from robophm.transports.mqtt import Address, address
from robophm.transports.mqtt.connection import paho
from robophm.web.access.certificate import fingerprint, own_certificate
from robophm.web.access.proxies import Proxies, is_loopback
from robophm.web.serving import Place, heeding, serve_app


@dataclass(frozen=True)
class FleetSettings:
    """The settings that the service was started with."""

    store: str | Path
    """The path of a SQLite file, or the address of a PostgreSQL database."""
    host: str = "127.0.0.1"
    port: int = 0
    certificate: Path | None = None
    """Certificate of the service, and its key where that is in no file of its own."""
    key: Path | None = None
    proxies: tuple[str, ...] = ()
    """Addresses of reverse proxies that end TLS before the service."""
    broker: str | None = None
    """Address of a broker of MQTT, and the topic above the robots', at which reports are taken too."""


def serve_fleet(settings: FleetSettings, ready: Callable[[str, str, Callable[[], None]], None]) -> None:
    """Serve until interrupted; ``ready`` is told the address, the certificate's fingerprint, and how to stop it.

    Where others reach it, and no proxy is before it, all goes over TLS, by a certificate of its own unless one is
    given. Raises RobophmError where store, address or certificate cannot be had, or the broker's address is none.
    """
    broker = broker_of(settings.broker) if settings.broker else None
    proxies = Proxies(settings.proxies)
    with heeding() as wish, FleetStore(settings.store, make=True) as store:
        of_database = "://" in str(settings.store)  # which has no folder
        beside = Path("robophm-fleet" if of_database else settings.store)
        certificate = settings.certificate
        if not (certificate or proxies or is_loopback(settings.host)):
            certificate = own_certificate(Path(f"{beside}.pem"), settings.host)

        def begun(address: str) -> None:
            ready(address, fingerprint(certificate) if certificate else "", wish.stop)

        place = Place(settings.host, settings.port, certificate, settings.key, proxies.believed)
        app = create_app(store, page_app(store, beside, settings.host, proxies), broker)
        serve_app(app, place, wish, begun)


def broker_of(text: str) -> Address:
    """Return the address of a broker. Raises RobophmError where it is none, tokens could be read, or paho is absent."""
    broker = address(text)
    paho()
    refuse_plain(broker)
    return broker
