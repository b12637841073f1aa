"""The service on a port, until it is told to stop."""

from __future__ import annotations

import signal
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import uvicorn

from robophm.core.errors import RobophmError
from robophm.web.app import create_app
from robophm.web.guard import is_loopback
from robophm.web.service import Service, Settings


def serve(settings: Settings, port: int, ready: Callable[[str, Service, Callable[[], None]], None]) -> None:
    """Serve until interrupted; ``ready`` is told the address, the service, and how to stop it.

    Port 0 is any that is free. Raises RobophmError where the address cannot be had, or others reach it and there is no
    token; else as ``create_app``.
    """
    if not is_loopback(settings.host) and not settings.token:
        raise RobophmError(
            f"{settings.host}: others on the network would reach the design; expected a secret token too"
        )
    with (
        _heeding() as wish
    ):  # from before there are threads: one that still computes when the process ends may abort it
        app = create_app(settings)
        service: Service = app.state.service
        try:
            with _listen(settings.host, port) as listener:
                config = uvicorn.Config(
                    app, log_level="warning", access_log=False, ws="websockets-sansio", ws_max_size=1 << 20,
                    ws_max_queue=32, limit_concurrency=200, timeout_keep_alive=15, timeout_graceful_shutdown=2,
                    server_header=False,
                )  # fmt: skip
                wish.ends(server := _Server(config))
                host = f"[{settings.host}]" if ":" in settings.host else settings.host
                query = f"?token={settings.token}" if settings.token else ""
                ready(f"http://{host}:{listener.getsockname()[1]}/{query}", service, wish.stop)
                server.run(sockets=[listener])
        finally:
            service.close()


class _Server(uvicorn.Server):
    """A server that ends in order when it is interrupted, however often: no signal is raised again."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Take no signals here: ``serve`` takes them before the server runs, and until everything is closed."""
        yield


class _Wish:
    """The wish to stop, which may come before there is a server."""

    def __init__(self) -> None:
        self._asked = False
        self._server: _Server | None = None

    def ends(self, server: _Server) -> None:
        """Let the wish end this server, at once where it has come."""
        self._server = server
        server.should_exit = server.should_exit or self._asked

    def stop(self, *_signal: object) -> None:
        """Ask the server to stop in order, which takes seconds at most; a second time changes nothing of that."""
        self._asked = True
        if self._server:
            self._server.should_exit = True


@contextmanager
def _heeding() -> Iterator[_Wish]:
    """Take SIGINT and SIGTERM as the wish to stop; then as nothing, for what is left to end is the process."""
    wish = _Wish()
    if threading.current_thread() is not threading.main_thread():
        yield wish
        return
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, wish.stop)
    try:
        yield wish
    finally:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)


def _listen(host: str, port: int) -> socket.socket:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind, protocol)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(128)
    except OSError as error:
        raise RobophmError(f"{host}, port {port}: cannot be had: {error.strerror}") from None
    return listener
