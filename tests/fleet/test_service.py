"""The service over HTTP: who may write what, what is refused in which words, and that nothing else is disturbed."""

from __future__ import annotations

import http.client
import json
import os
import ssl
import subprocess
import sys
import threading
import time
import zlib

import pytest
from tests.fleet.conftest import serving, wait_for
from tests.fleet.made_reports import BEGIN, MINUTE, report

from robophm.core.errors import StoreError
from robophm.fleet import app as routes
from robophm.fleet.payload import packed
from robophm.fleet.questions import present, refused_of_nobody, reports, status
from robophm.fleet.robot_history import history
from robophm.stores.outbox import Batch, Present, Waiting
from robophm.stores.outbox import report_values as values

EPOCH = "e" * 16


def payload(robot, *numbers, state=None, sent=None, time_of=lambda one: BEGIN + one * MINUTE):
    rows = tuple(Waiting(one, EPOCH, one, time_of(one), 0, values(report(one))) for one in numbers)
    return packed(robot, time.time_ns() if sent is None else sent, Batch(rows, 0, state))


def post(fleet, path, body, token=None, headers=()):
    """The status and the JSON of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", fleet.port, timeout=60)
    said = dict(headers) | ({"Authorization": f"Bearer {token}"} if token else {})
    connection.request("POST", path, body, said)
    answer = connection.getresponse()
    found = answer.status, json.loads(answer.read())
    connection.close()
    return found


@pytest.fixture
def token(store):
    return store.add_token("r")


def test_reports_are_answered_once_they_are_kept(fleet, store, token):
    state = Present(EPOCH, 4, '{"hours": 1.5}', report(2))
    told = post(fleet, "/robots/r/reports", payload("r", 1, 2, state=state), token)
    assert told == (200, {"committed": {"epoch": EPOCH, "seq": 2}, "new": 2, "repeated": 0})
    assert [one.seq for one in reports(store)] == [1, 2]
    assert present(store, "r") == ('{"hours": 1.5}', report(2))
    assert post(fleet, "/robots/r/reports", payload("r", 1, 2, 3, state=state), token)[1] == {
        "committed": {"epoch": EPOCH, "seq": 3}, "new": 1, "repeated": 2,
    }  # fmt: skip


def test_who_may_not_is_refused_and_counted_and_nothing_else_is_disturbed(fleet, store, token):
    other = store.add_token("a b")
    good = payload("r", 1)
    for path, body, sent, code, words in (
        ("/robots/r/reports", good, None, 401, "expected a robot's token"),
        ("/robots/r/reports", good, "robophm_wrong", 401, "expected a robot's token"),
        ("/robots/r/reports", good, other, 403, "of 'a b', which may not write for 'r'"),
        ("/robots/a%20b/reports", good, token, 403, "of 'r', which may not write for 'a b'"),
        ("/robots/r/reports", payload("a b", 1), token, 403, "is of robot 'a b'; the token is of 'r'"),
        ("/robots/r/reports", b"no payload", token, 422, "cannot be read"),
        ("/robots/r/reports", zlib.compress(b'{"version": 9}'), token, 422, "version 9"),
        ("/robots/r/reports", good + b"x" * 1_000_000, token, 413, "larger than 1 MB"),
        ("/elsewhere", good, token, 404, "expected /robots/NAME/reports"),
    ):
        status_code, said = post(fleet, path, body, sent)
        assert (status_code, words in said["message"]) == (code, True), said
    assert [*reports(store)] == []
    assert post(fleet, "/robots/r/reports", good, token)[0] == 200
    assert post(fleet, "/robots/a%20b/reports", payload("a b", 1), other)[0] == 200
    wait_for(lambda: sum(sum(one.refused.values()) for one in status(store)) == 6)
    assert refused_of_nobody(store) == {"no token, or a wrong one": 2}
    assert {one.robot: one.refused for one in status(store)} == {
        "r": {
            "larger than 1 MB": 1, "malformed payload": 2, "payload of another robot": 1,
            "writing for another robot": 1,
        },
        "a b": {"writing for another robot": 1},
    }  # fmt: skip
    assert {(one.robot, one.seq) for one in reports(store)} == {("r", 1), ("a b", 1)}


def test_100_mb_are_not_read(fleet, store, token):
    """Neither where the length is said nor where it comes in chunks, and others are answered meanwhile."""

    def flood():
        connection = http.client.HTTPConnection("127.0.0.1", fleet.port, timeout=60)
        piece = b"x" * 100_000
        try:
            connection.request("POST", "/robots/r/reports", (piece for _ in range(1000)),
                               {"Authorization": f"Bearer {token}"}, encode_chunked=True)  # fmt: skip
            found.append(connection.getresponse().status)
        except OSError:  # the service has closed what it will not read
            found.append(413)
        finally:
            connection.close()

    found: list[int] = []
    thread = threading.Thread(target=flood)
    thread.start()
    assert post(fleet, "/robots/r/reports", payload("r", 1), token)[0] == 200
    thread.join(60)
    assert found == [413]
    said = post(fleet, "/robots/r/reports", b"", token, {"Content-Length": "100000000"})
    assert said[0] == 413
    wait_for(lambda: status(store)[0].refused == {"larger than 1 MB": 2})
    assert post(fleet, "/robots/r/reports", payload("r", 2), token)[0] == 200


def test_a_full_disk_is_said_and_the_robot_tries_again(fleet, store, token, monkeypatch):
    def fails(self, payload):
        raise StoreError("database or disk is full")

    with monkeypatch.context() as patched:
        patched.setattr(routes.FleetStore, "commit", fails)
        code, said = post(fleet, "/robots/r/reports", payload("r", 1), token)
    assert (code, said["message"]) == (503, "nothing of it is kept: database or disk is full")
    assert post(fleet, "/robots/r/reports", payload("r", 1), token)[0] == 200


def test_a_poisoned_clock_is_named_and_orders_nothing(fleet, store, token):
    """A clock of 2038, then one of 1980: numbers order, and what is of a time to come is left out of the history."""
    ahead, behind = (2**31 - 1) * 10**9, 315_532_800 * 10**9
    post(fleet, "/robots/r/reports", payload("r", 1), token)
    post(fleet, "/robots/r/reports", payload("r", 2, sent=ahead, time_of=lambda _: ahead), token)
    (one,) = status(store)
    assert one.clock_ahead > 11 * 365 * 86400
    post(fleet, "/robots/r/reports", payload("r", 3, sent=behind, time_of=lambda _: behind), token)
    (one,) = status(store)
    assert (one.time, one.reports) == (behind, 3)
    assert one.clock_ahead < -40 * 365 * 86400
    found = history(store, "r", None, None, 100)
    assert found.series.times.tolist() == [behind, BEGIN + MINUTE]
    assert found.ahead == 1
    post(fleet, "/robots/r/reports", payload("r", 4), token)
    assert abs(status(store)[0].clock_ahead) < 60


def test_the_service_says_that_it_is_there(fleet):
    connection = http.client.HTTPConnection("127.0.0.1", fleet.port, timeout=60)
    connection.request("GET", "/healthz")
    assert connection.getresponse().read() == b"ok\n"
    connection.close()


def test_others_reach_it_over_tls_alone(tmp_path):
    with serving(tmp_path / "fleet.db", host="0.0.0.0") as fleet:
        assert fleet.address.startswith("https://")
        text = (tmp_path / "fleet.db.pem").read_text()
        (tmp_path / "fleet.pem").write_text(text[text.index("-----BEGIN CERTIFICATE-----") :])
        context = ssl.create_default_context(cafile=str(tmp_path / "fleet.pem"))
        connection = http.client.HTTPSConnection("127.0.0.1", fleet.port, context=context, timeout=60)
        connection.request("GET", "/healthz")
        assert connection.getresponse().status == 200
        connection.close()
        strict = http.client.HTTPSConnection("127.0.0.1", fleet.port, context=ssl.create_default_context(), timeout=60)
        with pytest.raises(ssl.SSLCertVerificationError):
            strict.request("GET", "/healthz")
        strict.close()
        code = (
            "import os, ssl, http.client; "
            "s = ssl.create_default_context(); "
            "c = http.client.HTTPSConnection('127.0.0.1', int(os.environ['PORT']), context=s); "
            "c.request('GET', '/healthz'); print(c.getresponse().status)"
        )
        env = {**os.environ, "SSL_CERT_FILE": str(tmp_path / "fleet.pem"), "PORT": str(fleet.port)}
        said = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True)
        assert said.stdout == "200\n"
