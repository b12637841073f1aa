"""The service on a port, until it is told to stop."""

from __future__ import annotations

import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import uvicorn
from starlette.types import ASGIApp

from robophm.core.ending import ASKED_BY, LONGEST_END, ignore, leave
from robophm.core.errors import RobophmError
from robophm.core.rate_limited_log import limit_rate
from robophm.core.supervisor import Supervisor
from robophm.web.access.certificate import fingerprint, own_certificate, tls_context
from robophm.web.access.proxies import is_loopback
from robophm.web.app import create_app
from robophm.web.bounded_connections import BoundedConnection
from robophm.web.service import Service, Settings

AT_ONCE = 8
"""Connections that are taken before what was said over them is read: were it hundreds that come together, who speaks
right away would be let go of as silent."""

GRACE = 2
"""Seconds that requests which are under way have once the service is to end."""

LONGEST_COMPUTING = 4.0
"""Seconds after which the process ends whatever is still computed, once the robot's past is kept."""

SWITCH = 0.0005
"""Seconds after which a thread that computes gives way while the service ends: that of the end is one of many."""

QUEUE = 1024
"""Connections that may wait to be taken: whoever finds no place tries again a second later."""


def serve(settings: Settings, port: int, ready: Callable[[str, Service, Callable[[], None]], None]) -> None:
    """Serve until interrupted; ``ready`` is told the address, the service, and how to stop it.

    Port 0 is any that is free. Raises RobophmError where the address cannot be had, or others reach it and there are no
    users; else as ``create_app``.
    """
    app = create_app(settings)  # while it is made a signal ends the process at once: there is nothing to keep
    service: Service = app.state.service
    with heeding() as wish:
        try:
            certificate = _certificate(settings, service)

            def begun(address: str) -> None:
                service.fingerprint = fingerprint(certificate) if certificate else ""
                ready(address, service, wish.stop)

            place = Place(settings.host, port, certificate, settings.key, service.visitors.proxies.believed)
            serve_app(app, place, wish, begun, service.end_watching)
        finally:
            service.close()


@dataclass(frozen=True)
class Place:
    """The place at which a service listens, and how."""

    host: str
    port: int
    """Port to listen on; 0 is any that is free."""
    certificate: Path | None = None
    """Certificate for TLS, with its key unless that is in a file of its own; None: without TLS."""
    key: Path | None = None
    is_proxy: Callable[[str], bool] = lambda address: False
    """Whether at an address is a proxy, which has connections of many."""


def serve_app(
    app: ASGIApp, place: Place, wish: Wish, ready: Callable[[str], None], keep: Callable[[], None] = lambda: None
) -> None:
    """Serve any application until it is wished to stop, nobody holding connections for nothing.

    ``ready`` is told the address; ``keep`` keeps what must not be lost once the end has begun. Raises RobophmError
    where the address cannot be had, or a certificate is none.
    """
    limit_rate("uvicorn.error", "asyncio", "robophm")
    supervisor = Supervisor()
    with _listen(place.host, place.port) as listener:
        connection = type("Connection", (BoundedConnection,), {
            "tls": tls_context(place.certificate, place.key) if place.certificate else None,
            "is_proxy": staticmethod(place.is_proxy),
        })  # fmt: skip
        config = uvicorn.Config(
            app, log_level="warning", access_log=False, http=connection, ws="websockets-sansio",
            ws_max_size=1 << 20, ws_max_queue=32, timeout_keep_alive=15,
            timeout_graceful_shutdown=GRACE, server_header=False, proxy_headers=False, backlog=AT_ONCE,
        )  # fmt: skip
        wish.ends(server := _Server(config, supervisor), keep)
        if server.should_exit:
            return
        host = f"[{place.host}]" if ":" in place.host else place.host
        ready(f"{'https' if place.certificate else 'http'}://{host}:{listener.getsockname()[1]}/")
        supervisor.ready("serving")
        server.run(sockets=[listener])


def _certificate(settings: Settings, service: Service) -> Path | None:
    """The certificate of the service; one of its own where others reach it. Raises RobophmError."""
    if not is_loopback(settings.host) and not settings.proxies and not service.visitors.users:
        raise RobophmError(f"{settings.host}: others on the network would reach the design; expected a user first")
    if settings.certificate or settings.proxies or is_loopback(settings.host):
        return settings.certificate
    design = settings.design
    return own_certificate(design.with_name(f"{design.name}.pem"), settings.host)


class _Server(uvicorn.Server):
    """A server that ends in order when it is interrupted, however often: no signal is raised again."""

    def __init__(self, config: uvicorn.Config, supervisor: Supervisor) -> None:
        super().__init__(config)
        self._supervisor = supervisor

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to listen; as many may wait as before, not as few as are taken at once."""
        await super().startup(sockets)
        for one in sockets or ():
            one.listen(QUEUE)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Tell the supervisor that the end has begun, and end in order."""
        self._supervisor.ending()
        await super().shutdown(sockets)

    async def on_tick(self, counter: int) -> bool:
        """Tell the supervisor that requests are heeded, ten times a second at most; return whether to end."""
        self._supervisor.alive()
        return await super().on_tick(counter)

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Take no signals here: ``serve`` takes them before the server runs, and until everything is closed."""
        yield


class Wish:
    """The wish to stop, which may come before there is a server."""

    def __init__(self, *, of_process: bool) -> None:
        """``of_process``: whether it comes by signals, and the process ends with the server."""
        self._of_process = of_process
        self._asked: float | None = None
        self._number = 0  # of the signal by which it was
        self._server: _Server | None = None
        self._keep: Callable[[], None] = lambda: None
        self._over = threading.Event()

    def ends(self, server: _Server, keep: Callable[[], None]) -> None:
        """Let the wish end this server, at once where it has come; ``keep`` keeps what must not be lost."""
        self._server, self._keep = server, keep
        server.should_exit = self._asked is not None

    def stop(self, number: int = signal.SIGTERM, _frame: object = None) -> None:
        """Ask the server to stop in order, which takes seconds at most; a second time changes nothing of that."""
        if self._asked is None:
            self._asked, self._number = time.monotonic(), number
            if self._of_process:
                sys.setswitchinterval(SWITCH)
                threading.Thread(target=self._end_in_time, name="end in time", daemon=True).start()
            if self._server:
                self._server.should_exit = True

    def _end_in_time(self) -> None:
        """Keep what must not be lost while requests have their time; end the process where one of them takes too long.

        A thread that computes cannot be told to end, and Python waits for it. Nothing is left half-written by an end
        like this, as nothing is by a kill.
        """
        assert self._asked is not None
        keeping = threading.Thread(target=self._keep, name="keep the past", daemon=True)
        keeping.start()
        keeping.join(LONGEST_END)
        if keeping.is_alive():
            leave(128 + self._number, "error: ended before the past was kept")
        if not self._over.wait(max(0.0, self._asked + LONGEST_COMPUTING - time.monotonic())):
            leave(0, "warning: ended while requests were still computed")

    def is_over(self) -> None:
        """Say that all is closed: the process may end by itself, unless there are threads that it would wait for."""
        others = [one for one in threading.enumerate() if not one.daemon and one is not threading.current_thread()]
        if not others:
            self._over.set()


@contextmanager
def heeding() -> Iterator[Wish]:
    """Take SIGINT and SIGTERM as the wish to stop; then as nothing, for what is left to end is the process.

    Without it an exception would end the main thread while others compute, and Python may abort then.
    """
    in_main = threading.current_thread() is threading.main_thread()
    wish = Wish(of_process=in_main)
    if not in_main:
        yield wish
        return
    for number in ASKED_BY:
        signal.signal(number, wish.stop)
    try:
        yield wish
    finally:
        ignore()
        wish.is_over()


def _listen(host: str, port: int) -> socket.socket:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind, protocol)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(QUEUE)
    except OSError as error:
        raise RobophmError(f"{host}, port {port}: cannot be had: {error.strerror}") from None
    return listener
