"""Nobody from elsewhere, and nothing too large."""

import socket

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from robophm.web.bounded_bodies import MOST_BYTES, MOST_OF_DESIGN

from .conftest import SMALL, serving


def raw(served, head):
    """What is answered to a request as it stands, which a client would tidy up."""
    host, port = served.address.split("//")[1].rstrip("/").split(":")
    with socket.create_connection((host, int(port)), timeout=10) as connection:
        connection.sendall(f"{head}Host: {host}:{port}\r\nConnection: close\r\n\r\n".encode())
        return b"".join(iter(lambda: connection.recv(65536), b""))


@pytest.fixture(scope="module")
def guarded(tmp_path_factory):
    design = tmp_path_factory.mktemp("guarded") / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as served:
        served.service.visitors.users.add_person("anna", "editor", "a long pass phrase")
        yield served


def test_a_page_from_elsewhere_may_not_write(shared_small):
    client, body = shared_small.client, {"revision": 1}
    for headers in ({"origin": "http://evil.example"}, {"origin": "null"}, {"sec-fetch-site": "cross-site"},
                    {"origin": shared_small.address.replace("127.0.0.1", "localhost").rstrip("/")}):  # fmt: skip
        assert client.post("/api/design/undo", json=body, headers=headers).status_code == 403
    own = {"origin": shared_small.address.rstrip("/"), "sec-fetch-site": "same-origin"}
    assert client.post("/api/design/undo", json=body, headers=own).status_code == 200


def test_a_name_that_somebody_else_points_here_is_refused(shared_small):
    for host in ("evil.example", "127.0.0.1.evil.example", "", "[::ffff:1.2.3.4]:80"):
        assert shared_small.client.get("/api/design", headers={"host": host}).status_code in (400, 421)
    assert shared_small.client.get("/api/design", headers={"host": "localhost:1"}).status_code == 200


def test_a_websocket_from_elsewhere_is_refused(shared_small, guarded):
    url = shared_small.address.replace("http", "ws") + "api/live"
    with pytest.raises((InvalidStatus, ConnectionClosed)), connect(url, origin="http://evil.example") as socket_:
        socket_.recv(timeout=5)
    with connect(url, origin=shared_small.address.rstrip("/")) as socket_:
        assert socket_.recv(timeout=5)
    url = guarded.address.replace("http", "ws") + "api/live"
    with pytest.raises((InvalidStatus, ConnectionClosed)), connect(url) as socket_:
        socket_.recv(timeout=5)


def test_what_is_too_large_is_refused_before_it_is_read(shared_small):
    said = raw(shared_small, f"POST /api/design/undo HTTP/1.1\r\nContent-Length: {MOST_BYTES + 1}\r\n")
    assert said.split(b" ", 2)[1] == b"413"

    def endless():
        for _ in range(MOST_OF_DESIGN // 1_000_000 + 2):
            yield b" " * 1_000_000

    answer = shared_small.client.post("/api/imports/legacy", content=endless())
    assert answer.status_code == 413
    assert shared_small.get("/api/design")["revision"]


def test_malformed_bodies_are_refused_in_words(shared_small):
    for body in (b"", b"{", b"[]", b'{"revision": "x"}', b"\xff\xfe", b"[" * 100_000, b'{"revision": 1e999}'):
        answer = shared_small.client.post(
            "/api/design/undo", content=body, headers={"content-type": "application/json"}
        )
        assert answer.status_code == 422, body[:20]
        assert answer.json()["message"]


@pytest.mark.parametrize("value", ["[" + "[]," * 100_000 + "1]", "[" * 60 + "]" * 60, '{"a":' * 60 + "1" + "}" * 60])
def test_a_value_beyond_the_bounds_is_not_put_into_the_design(shared_small, value):
    """Seven million lists kept everybody waiting for a minute; deep ones left a design that nobody could read."""
    before = shared_small.get("/api/design")
    body = f'{{"revision":{before["revision"]},"operations":[{{"op":"put","path":["x"],"value":{value}}}]}}'
    answer = shared_small.client.post("/api/design/edits", content=body, headers={"content-type": "application/json"})
    assert answer.status_code == 422
    assert answer.json()["message"].endswith("value: expected at most 100,000 values, nested at most 50 deep")
    assert shared_small.get("/api/design")["revision"] == before["revision"]


OUT = (
    "/../../etc/passwd",
    "/assets/../../../etc/passwd",
    "/%2e%2e/%2e%2e/etc/passwd",
    "/assets/%2e%2e%2f%2e%2e%2fetc/passwd",
    "//etc/passwd",
    "/..%5c..%5cetc/passwd",
)


@pytest.mark.parametrize("path", OUT)
def test_no_path_leads_out(shared_small, path):
    said = raw(shared_small, f"GET {path} HTTP/1.1\r\n")
    assert b"root:" not in said
    assert said.split(b" ", 2)[1] in (b"404", b"405", b"400")


def test_what_is_answered_loads_nothing_from_elsewhere(shared_small):
    for path in ("/", "/api/design", "/metrics", "/api/nothing"):
        headers = shared_small.client.get(path).headers
        assert headers["content-security-policy"].startswith("default-src 'self'")
        assert headers["x-content-type-options"] == "nosniff"
    report = shared_small.client.get("/api/report")
    assert report.headers["content-security-policy"].startswith("default-src 'none'")
    assert "<script" not in report.text


def test_a_fault_of_ours_shows_no_traceback(small, monkeypatch):
    monkeypatch.setattr(small.service.workspace, "draft", lambda: 1 / 0)
    answer = small.client.get("/api/design/text")
    assert answer.status_code == 500
    assert answer.json() == {"message": "a fault within robophm; its log says where", "place": []}
