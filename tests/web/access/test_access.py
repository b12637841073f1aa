"""Only who may gets in, in the role that they have, and what they change is logged."""

from __future__ import annotations

import hashlib
import os
import re
import ssl
import stat
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import schemathesis
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from robophm.core.errors import RobophmError, StoreError
from robophm.stores.sqlite import SqliteStore
from robophm.web import guard
from robophm.web.access import users as of_users
from robophm.web.access.changes import MOST_VALUES, Change, ChangeLog
from robophm.web.access.file import AccessFile, access_path
from robophm.web.access.guesses import AT_ONCE, EVERY, Guesses
from robophm.web.access.proxies import Proxies
from robophm.web.access.roles import ROLES, may, role_of
from robophm.web.access.users import Users
from robophm.web.app import api, routers

from ...transports.listener import within
from ..conftest import SMALL, Served, serving
from ..test_openapi import STARTS, examples, schema

PASSWORD = "a long pass phrase"
ROUTES = [route for router in routers() for route in router.routes]


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design, seed=1) as one:
        yield one


@pytest.fixture(scope="module")
def with_users(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, dict[str, str]]]:
    """A service whose users are a token of each role, and anna."""
    design = tmp_path_factory.mktemp("users") / "courier.yaml"
    design.write_text(SMALL)
    with serving(design, seed=1) as one:
        found = {role: one.service.visitors.users.add_token(f"program {role}", role) for role in ROLES}
        one.service.visitors.users.add_person("anna", "operator", PASSWORD)
        yield one, found


def log_in(served: Served, password: str = PASSWORD, **headers: str) -> httpx.Response:
    return served.client.post("login", data={"name": "anna", "password": password}, headers=headers)


@pytest.mark.parametrize("path", ["/", "/api/design", "/metrics", "/api/nothing", "/assets/x.js", "/api/access"])
@pytest.mark.parametrize("headers", [{}, {"authorization": "Bearer wrong"}, {"authorization": "Basic x"},
                                     {"cookie": "robophm=wrong"}, {"x-forwarded-user": "anna"},
                                     {"x-forwarded-user": "a", "x-forwarded-groups": "robophm-editor"}])  # fmt: skip
def test_nobody_who_is_not_known_is_told_anything(
    with_users: tuple[Served, dict[str, str]], path: str, headers: dict[str, str]
) -> None:
    served, _ = with_users
    with httpx.Client(base_url=served.address) as client:
        answer = client.get(path, headers=headers)
        assert (answer.status_code, answer.json()["place"]) == (401, [])
        page = client.get(path, headers={**headers, "accept": "text/html"})
        assert page.status_code == 401
        assert ('name="password"' in page.text) == (not path.startswith("/api/"))
        assert "courier" not in page.text + answer.text


EXECUTED = ("/login", "/logout", "/api/monitoring/stop", "/api/new/files")
"""Addresses that do what they are for whatever the body is, so that only those who may not are tried."""


@pytest.mark.parametrize("role", [*ROLES, "nobody"])
def test_each_role_may_do_what_it_may_and_nothing_else(with_users: tuple[Served, dict[str, str]], role: str) -> None:
    """All routes by all roles: with bodies that nobody understands, so that what may be done is refused for that."""
    served, tokens = with_users
    headers = {"authorization": f"Bearer {tokens[role]}"} if role in tokens else {}
    refused = 0
    for route in ROUTES:
        for method in getattr(route, "methods", None) or ():
            path = re.sub(r"\{\w+\}", "1", route.path)  # type: ignore[attr-defined]
            allowed = path in guard.OPEN_TO_ALL or (role in tokens and may(role, role_of(route)))  # type: ignore[arg-type]
            if allowed and path.startswith(EXECUTED):
                continue
            answer = served.client.request(method, path, headers=headers, content=b"{" if method != "GET" else None)
            expected = {True: (), False: (403,) if role in tokens else (401,)}[allowed]
            assert answer.status_code in expected if expected else answer.status_code not in (401, 403), (method, path)
            refused += not allowed
    assert refused >= {"viewer": 15, "operator": 10, "editor": 0, "nobody": 60}[role]


ROLE_OF = {(path, method.upper()): one["x-role"] for path, methods in api().openapi()["paths"].items()
           for method, one in methods.items()}  # fmt: skip
"""The role that each operation of the OpenAPI document needs."""


@pytest.mark.full
@schema.exclude(path=list(STARTS)).parametrize()
@examples(20)
def test_each_role_may_ask_what_it_may_and_nothing_else(
    case: schemathesis.Case, with_users: tuple[Served, dict[str, str]]
) -> None:
    """Requests that the document allows, each by everybody: only who may is answered, no other changes anything."""
    served, tokens = with_users
    needed = ROLE_OF[case.operation.path, case.method.upper()]
    anna = {"authorization": f"Bearer {tokens['editor']}"}
    before = served.client.get("/api/access/changes", headers=anna).json()
    for role in ("nobody", *(role for role in ROLES if not may(role, needed))):
        headers = {"authorization": f"Bearer {tokens[role]}"} if role in tokens else {}
        answer = case.call(base_url=served.address.rstrip("/"), headers=headers, timeout=60)
        if case.operation.path in guard.OPEN_TO_ALL:
            assert answer.status_code in (200, 405, 503)
        else:
            assert answer.status_code in ((403, 413, 421) if role in tokens else (401, 413, 421)), role
    assert served.client.get("/api/access/changes", headers=anna).json() == before
    for role in (role for role in ROLES if may(role, needed)):
        headers = {"authorization": f"Bearer {tokens[role]}"}
        answer = case.call(base_url=served.address.rstrip("/"), headers=headers, timeout=60)
        assert answer.status_code not in (401, 403), role


def test_a_person_logs_in_and_out(with_users: tuple[Served, dict[str, str]]) -> None:
    served, _ = with_users
    with httpx.Client(base_url=served.address) as client:
        answer = client.post("login", data={"name": "anna", "password": PASSWORD})
        assert (answer.status_code, answer.headers["location"]) == (303, "./")
        cookie = answer.headers["set-cookie"]
        port = served.address.rstrip("/").rpartition(":")[2]
        assert cookie.startswith(f"robophm-{port}=")
        assert {"HttpOnly", "SameSite=Strict", "Path=/"} <= {part.strip() for part in cookie.split(";")}
        assert client.get("api/access").json() == {"name": "anna", "role": "operator", "session": True}
        assert client.get("api/access/changes").status_code == 403
        said = {"cookie": cookie.partition(";")[0]}
        assert client.post("logout", headers={"origin": "http://evil.example"}).status_code == 403
        assert client.post("logout").status_code == 303
    assert httpx.get(f"{served.address}api/access", headers=said).status_code == 401


def test_guesses_have_their_number_and_do_not_lock_out_who_is_in(served: Served) -> None:
    served.service.visitors.users.add_person("anna", "editor", PASSWORD)
    assert log_in(served).status_code == 303
    with httpx.Client(base_url=served.address) as guessing:
        found = [guessing.post("login", data={"name": "anna", "password": f"wrong {i}"}) for i in range(AT_ONCE + 3)]
        right = guessing.post("login", data={"name": "anna", "password": PASSWORD})
    assert [one.status_code for one in found] == [401] * AT_ONCE + [429] * 3
    assert (right.status_code, 0 < int(right.headers["retry-after"]) <= EVERY) == (429, True)
    assert served.get("/api/access")["name"] == "anna"


def test_an_address_that_guesses_waits_alone_and_not_for_ever() -> None:
    now = [0.0]
    guesses = Guesses(lambda: now[0])
    for _ in range(AT_ONCE):
        assert guesses.wait("10.0.0.1") == 0
        guesses.wrong("10.0.0.1")
    assert (guesses.wait("10.0.0.1"), guesses.wait("10.0.0.2")) == (EVERY, 0)
    now[0] = EVERY
    assert guesses.wait("10.0.0.1") == 0
    guesses.wrong("10.0.0.1")
    assert guesses.wait("10.0.0.1") == EVERY
    for i in range(AT_ONCE):
        guesses.wrong(f"2001:db8::{i}")
    assert guesses.wait("2001:db8::ffff") == EVERY  # one customer has a whole /64
    assert guesses.wait("2001:db8:0:1::1") == 0
    guesses.right("10.0.0.1")
    assert guesses.wait("10.0.0.1") == 0


def test_only_digests_are_kept_and_only_the_owner_reads_them(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml.access"
    file = AccessFile(path)
    users = Users(file)
    token = users.add_token("grafana", "viewer")
    users.add_person("anna", "editor", PASSWORD)
    session = users.log_in("anna", PASSWORD)
    assert session
    assert len(token) >= 43  # 256 bits
    file.close()
    kept = b"".join(one.read_bytes() for one in tmp_path.iterdir())
    assert b"grafana" in kept
    for secret in (token, PASSWORD, session):
        assert secret.encode() not in kept
    assert {stat.S_IMODE(one.stat().st_mode) for one in tmp_path.iterdir()} == {0o600}


def test_a_name_that_nobody_has_costs_what_a_wrong_password_does(monkeypatch: pytest.MonkeyPatch) -> None:
    users = Users(AccessFile(None))
    users.add_person("anna", "editor", PASSWORD)
    asked: list[dict[str, int]] = []
    scrypt = hashlib.scrypt

    def counted(password: bytes, *, salt: bytes, **cost: int) -> bytes:
        asked.append(cost)
        return scrypt(password, salt=salt, **cost)

    monkeypatch.setattr(hashlib, "scrypt", counted)
    for name in ("anna", "nobody"):
        assert users.log_in(name, "wrong") is None
    of_anna, of_nobody = asked
    assert of_anna == of_nobody
    assert 128 * of_anna["n"] * of_anna["r"] == 16 << 20  # bytes, by RFC 7914


def test_users(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    users = Users(AccessFile(None))
    assert not users
    users.add_person("anna", "viewer", PASSWORD)
    first = users.log_in("anna", PASSWORD)
    assert first
    assert users.of_session(first)
    assert users.log_in("anna", PASSWORD + "!") is users.log_in("nobody", PASSWORD) is None
    users.add_person("anna", "editor", PASSWORD)
    assert users.of_session(first) is None, "another password ends sessions"
    token = users.add_token("grafana", "viewer", days=1)
    assert users.of_token(token)
    assert users.log_in("grafana", token) is None
    second = users.log_in("anna", PASSWORD)
    assert second
    now = of_users.time.time()
    monkeypatch.setattr(of_users.time, "time", lambda: now + 86401)
    assert users.of_token(token) is None
    assert users.of_session(second)
    monkeypatch.setattr(of_users.time, "time", lambda: now + of_users.SESSION + 1)
    assert users.of_session(second) is None
    for name, role, password in (("", "viewer", PASSWORD), ("a", "editr", PASSWORD), ("a", "viewer", "short"),
                                 ("a\nb", "viewer", PASSWORD), ("a", "viewer", "x" * 2000)):  # fmt: skip
        with pytest.raises(RobophmError):
            users.add_person(name, role, password)
    users.remove("anna")
    with pytest.raises(RobophmError, match="did you mean 'grafana'"):
        users.remove("grafan")
    (tmp_path / "no.access").write_text("no database at all")
    with pytest.raises(StoreError):
        AccessFile(tmp_path / "no.access")


def test_live_values_end_with_the_session(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "LOOKED_AT_AGAIN", 0.0)
    url = served.address.replace("http", "ws") + "api/live"
    token = served.service.visitors.users.add_token("wall", "viewer")
    with pytest.raises((InvalidStatus, ConnectionClosed)), connect(url) as refused:
        refused.recv(timeout=5)
    with connect(url, additional_headers={"authorization": f"Bearer {token}"}) as socket:
        assert socket.recv(timeout=30)
        served.service.visitors.users.add_token("another", "viewer")
        served.service.visitors.users.remove("wall")
        with pytest.raises(ConnectionClosed) as closed:
            [socket.recv(timeout=30) for _ in range(100)]
        assert closed.value.rcvd
        assert closed.value.rcvd.code == 4401


def test_the_log_says_who_changed_which_rate_from_what_to_what(served: Served) -> None:
    token = served.service.visitors.users.add_token("eve", "editor")
    served.client.headers["authorization"] = f"Bearer {token}"
    place = ["modules", "see", "components", "lidar", "rate"]
    served.edit({"op": "put", "path": place, "value": "31 FPMH"})
    served.edit({"op": "put", "path": ["modules", "none"], "value": 1}, {"op": "delete", "path": ["x"]}, status=422)
    revision = served.get("/api/design")["revision"]
    served.post("/api/design/undo", {"revision": revision})
    undone, done = served.get("/api/access/changes")["changes"]
    assert done["values"] == [{"place": "/".join(place), "before": '"30 FPMH"', "after": '"31 FPMH"'}]
    assert (done["who"], done["role"], done["address"]) == ("eve", "editor", "127.0.0.1")
    assert (done["what"], undone["what"]) == ("POST /api/design/edits", "POST /api/design/undo")
    assert undone["values"] == [{"place": "/".join(place), "before": '"31 FPMH"', "after": '"30 FPMH"'}]
    served.post("/api/design/save", {"revision": revision + 1})
    served.design.write_text(SMALL.replace("8 FPMH", "9 FPMH"))

    def outside() -> bool:
        newest = served.get("/api/access/changes?most=1")["changes"][0]
        return (newest["who"], newest["address"]) == ("", "") and '"9 FPMH"' in str(newest["values"])

    within(30, outside)
    done_ = subprocess.run([sys.executable, "-m", "robophm", "audit", str(served.design)], capture_output=True,
                           text=True, check=True)  # fmt: skip
    assert 'modules/see/components/lidar/rate: "30 FPMH" → "31 FPMH"' in done_.stdout
    assert "eve (editor) from 127.0.0.1: POST /api/design/edits" in done_.stdout


def test_who_acknowledges_is_whoever_is_logged_in(tmp_path: Path) -> None:
    design, past = tmp_path / "courier.yaml", tmp_path / "past.db"
    design.write_text(SMALL)
    alarm = dict.fromkeys(("what", "path", "cause", "doubt", "ended_by", "acknowledged_by"), "")
    alarm |= {"severity": "warn", "begin": 1, "end": None, "acknowledged_at": None}
    with SqliteStore(past) as store:
        store.save("courier", {"n": 1})
        store.alarm_log("courier").keep([{**alarm, "what": "hot"}, {**alarm, "what": "cold"}])
    with serving(design, store=str(past)) as served:
        assert "a name" in served.post("/api/alarms/acknowledge", {"number": 1, "by": " "}, 422)["message"]
        served.post("/api/alarms/acknowledge", {"number": 1, "by": "Bob"})
        token = served.service.visitors.users.add_token("anna", "operator")
        served.client.headers["authorization"] = f"Bearer {token}"
        served.post("/api/alarms/acknowledge", {"number": 2, "by": "Bob"})
        found = {one["what"]: one["acknowledged_by"] for one in served.get("/api/alarms")["alarms"]}
    assert found == {"hot": "Bob", "cold": "anna"}


def test_the_log_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robophm.web.access.changes.MOST_KEPT", 10)
    log = ChangeLog(AccessFile(None))
    change = Change("a", "editor", "::1", "POST")
    change.design_changed({str(i): 0 for i in range(MOST_VALUES + 7)}, {"x": "y" * 10_000})
    assert (len(change.values), change.more) == (MOST_VALUES, 8)
    for i in range(25):
        log.add(Change(str(i), "editor", "", ""))
    log.add(change)
    assert [one.who for one in log.latest(100)] == ["a", *map(str, range(24, 15, -1))]
    assert max(len(value[2] or "") for value in log.latest(1)[0].values) <= 200


def test_a_proxy_that_is_believed_says_who_asks(tmp_path: Path) -> None:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    groups = {"x-forwarded-user": "eve", "x-forwarded-groups": "all, robophm-viewer,robophm-operator"}
    with serving(design, proxies=("127.0.0.1",)) as served:
        headers = {**groups, "host": "robot.example", "x-forwarded-for": "6.6.6.6, 10.1.2.3"}
        assert served.client.get("/api/access", headers=headers).json()["role"] == "operator"
        assert served.client.get("/api/access", headers={"x-forwarded-user": "eve"}).status_code == 401
        assert served.client.get("/api/access").status_code == 401
    proxies = Proxies(["10.0.0.0/8", "::1"])
    with pytest.raises(RobophmError, match="expected an address"):
        Proxies(["proxy.example"])
    headers = httpx.Headers({"x-forwarded-for": "6.6.6.6, 192.0.2.7, 10.0.0.9"})
    headers.getlist = headers.get_list  # type: ignore[attr-defined]
    assert proxies.address_of("10.0.0.1", headers) == "192.0.2.7"  # type: ignore[arg-type]
    assert proxies.address_of("192.0.2.9", headers) == "192.0.2.9"  # type: ignore[arg-type]


def test_over_tls(tmp_path: Path) -> None:
    """A certificate of one's own is checked by the client as that of an authority, its fingerprint by openssl."""
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    Users(AccessFile(access_path(design))).add_person("anna", "viewer", PASSWORD)
    with serving(design, host="0.0.0.0") as served:
        pem = tmp_path / "courier.yaml.pem"
        assert stat.S_IMODE(pem.stat().st_mode) == 0o600
        assert served.address.startswith("https://0.0.0.0:")
        context = ssl.create_default_context(cafile=str(pem))
        with httpx.Client(base_url=served.address.replace("0.0.0.0", "127.0.0.1"), verify=context) as client:
            answer = client.post("login", data={"name": "anna", "password": PASSWORD})
            assert "Secure" in [part.strip() for part in answer.headers["set-cookie"].split(";")]
            assert client.get("api/design").json()["name"] == "courier"
        told = subprocess.run(["openssl", "x509", "-in", str(pem), "-noout", "-fingerprint", "-sha256"],
                              capture_output=True, text=True, check=True).stdout  # fmt: skip
        assert served.service.fingerprint == told.strip().partition("=")[2]
        der = ssl.PEM_cert_to_DER_cert(
            ssl.get_server_certificate(("127.0.0.1", int(served.address.split(":")[2][:-1])))
        )
        assert hashlib.sha256(der).hexdigest() == served.service.fingerprint.replace(":", "").lower()


def robophm(*words: str, said: str = "", **more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "robophm", *words], input=said, capture_output=True, text=True,
                          timeout=90, check=False, env={**os.environ, **more})  # fmt: skip


@pytest.mark.full
def test_commands(tmp_path: Path) -> None:
    design = str(tmp_path / "courier.yaml")
    Path(design).write_text(SMALL)
    refused = robophm("serve", design, "--host", "0.0.0.0", "--port", "0")
    assert refused.returncode == 3
    assert refused.stderr.startswith("error: 0.0.0.0: others on the network would reach the design; expected a user")
    old = robophm("serve", design, ROBOPHM_TOKEN="a secret of sixteen")
    assert (old.returncode, "robophm users add --token" in old.stderr) == (3, True)
    assert robophm("users", "add", design, "anna", "--role", "editor", said="short\n").returncode == 3
    assert robophm("users", "add", design, "anna", "--role", "editor", said=f"{PASSWORD}\n").returncode == 0
    token = robophm("users", "add", design, "grafana", "--role", "viewer", "--token", "--days", "30").stdout.strip()
    assert Users(AccessFile(access_path(Path(design)))).of_token(token)
    listed = robophm("users", "list", design).stdout
    assert (token in listed, "anna" in listed, "grafana" in listed) == (False, True, True)
    assert robophm("users", "remove", design, "grafana").returncode == 0
    assert "anna" in robophm("users", "remove", design, "ana").stderr
