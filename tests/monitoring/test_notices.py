"""Notices of alarms, taken by a real web server and a real mail server on loopback; what fails delays nobody."""

from __future__ import annotations

import email
import email.policy
import json
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest

from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.health.alarms import Alarm
from robophm.monitoring import notices
from robophm.monitoring.notices import Notices

BEGIN = 1_700_000_000 * SECOND
HOT = Alarm("/t.c above (error)", "/t.c", "error", BEGIN, "/t.c: 50 °C is above 40 °C")
OVER = Alarm(
    HOT.what, HOT.path, "error", BEGIN, HOT.cause, end=BEGIN + 60 * SECOND, ended_by="/t.c: 30 °C is not above"
)


def until(true: Callable[[], bool]) -> None:
    end = time.monotonic() + 60
    while not true() and time.monotonic() < end:
        time.sleep(0.005)
    assert true()


@contextmanager
def webhook(*answers: int) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """A web server that gives these answers one after the other, then 200; and what was posted to it."""
    left, heard = list(answers), list[dict[str, Any]]()

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            heard.append(json.loads(self.rfile.read(int(self.headers["content-length"]))))
            self.send_response(left.pop(0) if left else 200)
            self.send_header("location", "/elsewhere")
            self.end_headers()

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/hook?key=secret", heard
        server.shutdown()
        thread.join()


def test_a_webhook_is_told_as_alertmanager_tells_it() -> None:
    with webhook() as (address, heard), Notices([address]) as told:
        told.of("R")([HOT], [HOT])
        told.of("R")([OVER], [])
        until(lambda: len(heard) == 2)
    first, last = heard
    # the fields of version 4, as Alertmanager's documentation prints them
    assert set(first) == {
        "version", "groupKey", "truncatedAlerts", "status", "receiver", "groupLabels", "commonLabels",
        "commonAnnotations", "externalURL", "alerts",
    }  # fmt: skip
    assert (first["version"], first["status"], last["status"]) == ("4", "firing", "resolved")
    (alert,) = first["alerts"]
    assert set(alert) == {"status", "labels", "annotations", "startsAt", "endsAt", "generatorURL", "fingerprint"}
    assert alert["labels"] == {"alertname": HOT.what, "robot": "R", "path": "/t.c", "severity": "critical"}
    assert (alert["startsAt"], alert["endsAt"]) == ("2023-11-14T22:13:20.000000Z", "0001-01-01T00:00:00Z")
    assert alert["annotations"]["summary"] == "[R] error: /t.c: 50 °C is above 40 °C"
    assert last["alerts"][0]["endsAt"] == "2023-11-14T22:14:20.000000Z"
    assert last["alerts"][0]["fingerprint"] == alert["fingerprint"]


def test_what_fails_is_tried_again_so_often_and_no_more() -> None:
    with webhook(500, 503) as (address, heard), Notices([address], first_wait=0.001) as told:
        told.of("R")([HOT], [])
        until(lambda: len(heard) == 3)
    assert not told.notes
    with webhook(*[500] * 99) as (address, heard):
        with Notices([address], first_wait=0.001) as told:
            told.of("R")([HOT, OVER], [])
            until(lambda: sum(told.notes.values()) == 2)
        assert len(heard) == 2 * notices.TIMES
        (note,) = told.notes
        assert (
            note == f"a notice to {address.partition('/hook')[0]} was not taken: HTTP Error 500: Internal Server Error"
        )
    for answer in (404, 302):  # which a second time would be no better; nobody is followed elsewhere
        with webhook(answer) as (address, heard):
            with Notices([address], first_wait=60) as told:
                told.of("R")([HOT], [])
                until(lambda: told.notes.total() == 1)
            assert len(heard) == 1


def test_a_server_that_never_answers_delays_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notices, "MOST_WAITING", 3)
    monkeypatch.setattr(notices, "LONGEST_END", 0.05)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        told = Notices([f"http://127.0.0.1:{silent.getsockname()[1]}/"])
        told.of("R")([HOT], [])
        connected, _ = silent.accept()
        begun = time.thread_time()
        told.of("R")([OVER] * 10, [])
        told.close()
        assert time.thread_time() - begun < 0.5
        assert told.notes.total() == 7
        connected.close()


@contextmanager
def mailbox() -> Iterator[tuple[str, list[Any]]]:
    """A mail server, and the envelopes that it took."""
    controller = pytest.importorskip("aiosmtpd.controller", reason="no mail server for tests: pip install aiosmtpd")
    taken: list[Any] = []

    class Keeping:
        async def handle_DATA(self, server: object, session: object, envelope: Any) -> str:
            taken.append(envelope)
            return "451 later" if len(taken) == 1 else "250 OK"

    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    server = controller.Controller(Keeping(), hostname="127.0.0.1", port=port)
    server.start()
    try:
        yield f"smtp://127.0.0.1:{port}", taken
    finally:
        server.stop()


def test_a_mail_is_sent_and_again_where_the_server_says_later() -> None:
    with mailbox() as (address, taken):
        addresses = [f"{address}/?from=robot@example.org&to=team@example.org&to=ada@example.org"]
        with Notices(addresses, first_wait=0.001) as told:
            told.of("R")([HOT], [HOT])
            until(lambda: len(taken) == 2)
        assert not told.notes
    envelope = taken[1]
    assert (envelope.mail_from, envelope.rcpt_tos) == ("robot@example.org", ["team@example.org", "ada@example.org"])
    letter = email.message_from_bytes(envelope.content, policy=email.policy.default)
    assert letter["subject"] == "[R] error: /t.c: 50 °C is above 40 °C"
    assert "It began Tue, 14 Nov 2023 22:13:20 +0000." in letter.get_content()


@pytest.mark.parametrize(
    "address", ["ftp://host/", "http:///hook", "smtp://host", "smtp://host/?to=a@b", "http://host:x/", "nonsense"]
)
def test_an_address_that_is_none_is_refused_in_one_line(address: str) -> None:
    with pytest.raises(RobophmError) as caught:
        Notices([address])
    assert "expected http://host/path" in str(caught.value)
