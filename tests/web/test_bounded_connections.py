"""Whoever holds connections for nothing keeps nobody out."""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed, InvalidMessage
from websockets.sync.client import connect

from robophm.web import bounded_connections

from ..transports.listener import within
from .conftest import SMALL, Served, serving


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as one:
        yield one


def connected(
    served: Served, stack: ExitStack, said: bytes, address: str = "127.0.0.1", buffer: int | None = None
) -> socket.socket:
    """A connection from an address of this machine, over which something was said."""
    host, port = served.address.split("//")[1].rstrip("/").split(":")
    one = stack.enter_context(socket.socket())
    one.settimeout(30)
    if buffer:
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
    one.bind((address, 0))
    one.connect((host, int(port)))
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


@pytest.mark.full
@pytest.mark.parametrize("said", HELD.values(), ids=HELD)
def test_many_that_say_no_more_keep_nobody_out_at_their_own_address(served: Served, said: bytes) -> None:
    with ExitStack() as stack:
        held = []
        for number in range(150):
            with suppress(OSError):  # those that came first were let go of
                held.append(connected(served, stack, said))
            if number % 50 == 49:
                begun = time.monotonic()
                assert served.client.get("/api/design", headers={"connection": "close"}).status_code == 200
                assert time.monotonic() - begun < 10  # on a machine that does much else; alone it takes milliseconds
        within(20, lambda: sum(not is_over(one, 0.001) for one in held) <= bounded_connections.MOST_OF_ADDRESS)
        assert served.get("/healthz") == {"ok": True, "wrong": []}
        assert is_over(held[0])


@pytest.mark.skipif(sys.platform != "linux", reason="needs the addresses 127.0.0.2 and so on")
def test_those_of_one_address_let_go_of_none_of_another(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded_connections, "MOST_OF_ADDRESS", 5)
    with ExitStack() as stack:
        first = connected(served, stack, b"")
        held = [connected(served, stack, b"", "127.0.0.2") for _ in range(20)]
        within(20, lambda: [is_over(one, 0.001) for one in held] == [True] * 15 + [False] * 5)
        assert not is_over(first)


@pytest.mark.skipif(sys.platform != "linux", reason="needs the addresses 127.0.0.2 and so on")
def test_of_all_addresses_the_one_that_was_silent_for_longest_goes(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bounded_connections, "MOST", 8)
    with ExitStack() as stack:
        held = [connected(served, stack, b"", f"127.0.0.{number}") for number in range(2, 22)]
        within(20, lambda: [is_over(one, 0.001) for one in held] == [True] * 12 + [False] * 8)
        assert served.get("/healthz") == {"ok": True, "wrong": []}


def test_live_values_leave_connections_for_requests(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded_connections, "MOST_LIVE", 3)
    url = served.address.replace("http", "ws") + "api/live"
    with ExitStack() as stack:
        live = [stack.enter_context(connect(url)) for _ in range(3)]
        with pytest.raises((OSError, ConnectionClosed, InvalidMessage)), connect(url) as refused:
            refused.recv(timeout=20)
        assert served.get("/healthz") == {"ok": True, "wrong": []}
        assert all(one.recv(timeout=20) for one in live)


def test_of_requests_that_come_together_the_first_is_answered(served: Served) -> None:
    """Else a connection could be busy for ever, and let go of only after those that wait."""
    with ExitStack() as stack:
        one = connected(served, stack, b"GET /healthz HTTP/1.1\r\nHost: HOST\r\n\r\n" * 100)
        said = b""
        with suppress(ConnectionError):
            while more := one.recv(65536):
                said += more
        assert said.count(b"HTTP/1.1 200") <= 1


def test_an_answer_that_nobody_takes_has_its_time_and_one_that_is_taken_slowly_has_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bounded_connections, "ANSWER_WITHIN", 2.0)
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL + f"# {'said at length ' * 60}\n" * 10_000)  # more than the kernel keeps
    asked = b"GET /api/design/text HTTP/1.1\r\nHost: HOST\r\n\r\n"
    with serving(design) as served, ExitStack() as stack:
        stopped, slow = (connected(served, stack, asked, buffer=10_000) for _ in range(2))

        def is_lost() -> bool:
            assert slow.recv(10_000)
            try:
                stopped.send(b"GET")
            except OSError:
                return True
            return False

        within(60, is_lost)
        assert slow.recv(10_000)


def test_of_bodies_that_do_not_come_only_so_much_is_held(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounded_connections, "MOST_HELD", 1_000_000)
    head = b"POST /api/design/check HTTP/1.1\r\nHost: HOST\r\nContent-Length: 2000000\r\n\r\n"
    with ExitStack() as stack:
        small = connected(served, stack, head + bytes(50_000))
        large = [connected(served, stack, head + bytes(400_000)) for _ in range(3)]
        within(20, lambda: any(is_over(one, 0.001) for one in large))
        assert sum(is_over(one) for one in large) == 1
        assert not is_over(small)


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
