"""The robot's side: what its outbox has comes to the fleet, whatever is in the way, and nobody waits for it."""

from __future__ import annotations

import socket
import threading
import time
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest
from tests.fleet.conftest import DEADLINE, saved, serving, wait_for

from robophm.fleet import payload as payloads
from robophm.fleet.address import FleetAddress
from robophm.fleet.questions import present, reports, status
from robophm.fleet.sender import Sender
from robophm.stores.sqlite import SqliteStore


@pytest.fixture
def robot(tmp_path):
    with SqliteStore(tmp_path / "robot.db") as opened:
        yield opened


def ledger_of(store):
    """The ledger as the store has it, letter by letter."""
    return store._base.execute("SELECT state FROM ledger").fetchone()[0]


@contextmanager
def sending(robot, address, token, told=None):
    said = told if told is not None else []
    with Sender(robot.path, "courier", address, token, said.append, look_every=0.02, first_wait=0.02) as sender:
        yield sender


@contextmanager
def answering(body: bytes, status_code: int = 200, headers=()):
    """A server that answers everything with the same, and keeps who asked."""
    asked = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            self.rfile.read(int(self.headers["content-length"]))
            asked.append(self.path)
            self.send_response(status_code)
            for name, value in (*headers, ("Content-Length", str(len(body)))):
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)

        do_GET = do_POST  # noqa: N815

        def log_message(self, *_):
            pass

    with HTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True)
        thread.start()
        try:
            yield FleetAddress.of(f"http://127.0.0.1:{server.server_port}/robots/r"), asked
        finally:
            server.shutdown()
            thread.join(DEADLINE)


def test_reports_come_while_they_are_made_and_the_ledger_is_the_robots_own(fleet, store, robot):
    token = store.add_token("r")
    with sending(robot, fleet.of("r"), token):
        saved(robot, range(5))
        wait_for(lambda: len([*reports(store)]) == 5)
        saved(robot, range(5, 8), begin=False)
        wait_for(lambda: len([*reports(store)]) == 8)
    robot.save("courier", {"hours": 99.5})  # a last save without a report: sent when it ends, or begins again
    with sending(robot, fleet.of("r"), token):
        pass
    assert present(store, "r")[0] == ledger_of(robot)
    assert robot.outboxes.of("courier").count() == 0
    assert [one.seq for one in reports(store)] == [*range(1, 9)]
    assert status(store)[0].missing == 0


def test_weeks_offline_are_made_up_for_in_order(fleet, store, robot, monkeypatch):
    saved(robot, range(1200), each=300)
    saved(robot, range(1200, 1250), each=50)  # watching began again
    token = store.add_token("r")
    with sending(robot, fleet.of("r"), token):
        wait_for(lambda: robot.outboxes.of("courier").count() == 0)
    found = [*reports(store)]
    assert [(one.epoch, one.seq) for one in found] == [
        *((1, n) for n in range(1, 1201)),
        *((2, n) for n in range(1, 51)),
    ]
    assert present(store, "r")[0] == ledger_of(robot)
    assert status(store)[0].refused == {}


def test_a_fleet_that_is_not_there_is_said_once_and_found_when_it_comes(tmp_path, robot):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    told: list[str] = []
    saved(robot, range(3))
    with serving(tmp_path / "fleet.db", port=port) as fleet:
        address = fleet.of("r")
    with sending(robot, address, "robophm_none", told):
        wait_for(lambda: told)
        assert "is not reached: [Errno 111] Connection refused; what is not sent waits in the store" in told[0]
        with serving(tmp_path / "fleet.db", port=port):
            wait_for(lambda: any("refuses reports (401): expected a robot's token" in one for one in told))
            assert robot.outboxes.of("courier").count() == 3
            assert len(told) == len(set(told))


def test_what_another_program_answers_is_not_taken_for_a_commit(robot):
    saved(robot, range(2))
    for body in (b"thank you", b"{}", b'{"committed": {"epoch": "0", "seq": 2}}', b'{"committed": 7}', b"[" * 9000):
        told: list[str] = []
        with answering(body) as (address, asked), sending(robot, address, "t", told):
            wait_for(lambda asked=asked: len(asked) > 1)
        assert robot.outboxes.of("courier").count() == 2
        assert told


def test_nobody_is_followed_elsewhere(fleet, robot):
    saved(robot, range(2))
    elsewhere = [("Location", f"{fleet.address}robots/r/reports")]
    told: list[str] = []
    for code in (301, 302, 307, 308):
        with answering(b"", code, elsewhere) as (address, asked), sending(robot, address, "t", told):
            wait_for(lambda asked=asked: len(asked) > 1)
        assert f"refuses reports ({code})" in told[-1]
    with serving(fleet.path) as other, sending(robot, other.of("r"), "t", told):
        wait_for(lambda: "401" in told[-1])
    assert robot.outboxes.of("courier").count() == 2


def test_a_ledger_that_is_too_large_is_said_and_reports_are_sent(fleet, store, robot, monkeypatch):
    monkeypatch.setattr(payloads, "MOST_TEXT", 3000)
    token, told = store.add_token("r"), []
    robot.outboxes.of("courier").begin()
    saved(robot, range(3), begin=False, note="x" * 4000)
    with sending(robot, fleet.of("r"), token, told):
        wait_for(lambda: len([*reports(store)]) == 3)
    assert any("ledger and report are too large to be sent" in one for one in told)
    assert present(store, "r") is None


def test_who_watches_never_waits_for_a_fleet_that_says_nothing(robot):
    """Saves while the fleet has taken a connection and never answers; and the end waits seconds at most."""
    with socket.create_server(("127.0.0.1", 0)) as deaf:
        address = FleetAddress.of(f"http://127.0.0.1:{deaf.getsockname()[1]}/robots/r")
        saved(robot, range(1))
        sender = Sender(robot.path, "courier", address, "t", lambda _: None, look_every=0.02)
        connection, _ = deaf.accept()
        with connection:
            assert connection.recv(4) == b"POST"
            saved(robot, range(1, 50), begin=False)
            assert robot.outboxes.of("courier").count() == 50
            begun = time.monotonic()
            sender._ending.set()
            sender._thread.join(0.1)
            assert sender._thread.is_alive()
            assert time.monotonic() - begun < DEADLINE
    sender._thread.join(DEADLINE)
    assert not sender._thread.is_alive()


def test_a_store_that_cannot_be_opened_is_said(tmp_path):
    (tmp_path / "text.db").write_text("no store " * 500)
    told: list[str] = []
    address = FleetAddress.of("http://127.0.0.1:9/robots/r")
    with Sender(tmp_path / "text.db", "courier", address, "t", told.append):
        wait_for(lambda: told)
    assert "expected a robophm store" in told[0]
