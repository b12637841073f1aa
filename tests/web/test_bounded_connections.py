"""Whoever holds connections for nothing keeps nobody out."""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest

from robophm.web import bounded_connections

from ..transports.listener import within
from .conftest import SMALL, Served, serving


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as one:
        yield one


def connected(served: Served, stack: ExitStack, said: bytes) -> socket.socket:
    host, port = served.address.split("//")[1].rstrip("/").split(":")
    one = stack.enter_context(socket.create_connection((host, int(port)), timeout=30))
    one.sendall(said.replace(b"HOST", f"{host}:{port}".encode()))
    return one


def is_over(one: socket.socket, within: float = 0.2) -> bool:
    one.settimeout(within)
    try:
        while one.recv(65536):
            pass
    except TimeoutError:
        return False
    except OSError:
        pass
    return True


HELD = {
    "nothing said": b"",
    "half a header": b"GET /api/design HTTP/1.1\r\nHost: HOST\r\nX: ",
    "half a body": b"POST /api/monitoring/start HTTP/1.1\r\nHost: HOST\r\nContent-Type: application/json\r\n"
    b"Content-Length: 100\r\n\r\n{",
    "idle after an answer": b"GET /healthz HTTP/1.1\r\nHost: HOST\r\n\r\n",
}


@pytest.mark.parametrize("said", HELD.values(), ids=HELD)
def test_hundreds_that_say_no_more_keep_nobody_out(served: Served, said: bytes) -> None:
    with ExitStack() as stack:
        held = []
        for number in range(300):
            with suppress(OSError):  # those that came first were let go of
                held.append(connected(served, stack, said))
            if number % 50 == 49:
                begun = time.monotonic()
                assert served.client.get("/api/design").status_code == 200
                assert time.monotonic() - begun < 10  # on a machine that does much else; alone it takes milliseconds
        within(20, lambda: sum(not is_over(one, 0.001) for one in held) <= bounded_connections.MOST_WAITING)
        assert served.get("/healthz") == {"ok": True, "wrong": []}
        assert is_over(held[0])


def test_slow_headers_have_their_time(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded_connections, "HEADERS_WITHIN", 0.5)
    with ExitStack() as stack:
        slow = connected(served, stack, b"GET /api/design HTTP/1.1\r\nHost: HOST\r\nX: ")
        with suppress(OSError):
            for _ in range(1000):
                slow.sendall(b"a")
                if is_over(slow):
                    return
    pytest.fail("it could go on for ever")


def test_a_body_that_stops_has_its_time_and_one_that_goes_on_has_more(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bounded_connections, "BODY_WITHIN", 2.0)
    head = b"POST /api/new/files?name=a.csv HTTP/1.1\r\nHost: HOST\r\nContent-Length: 1000\r\n\r\n"
    with ExitStack() as stack:
        stopped, going = connected(served, stack, head), connected(served, stack, head)
        while not is_over(stopped):
            going.sendall(b"1")
        assert not is_over(going)
