"""Thousands of hostile requests and WebSocket frames, of nobody and of each role: the owner is served all the time."""

from __future__ import annotations

import json
import random
import socket
import struct
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import quote_from_bytes

import httpx
import pytest
from websockets.sync.client import connect

from robophm.web.access.roles import ROLES
from robophm.web.guard import OPEN_TO_ALL

from ..transports.hostile import FEW_AND_MANY, LONGEST, ODD, damaged, deep, endured
from ..transports.listener import PATIENCE, within
from .conftest import SMALL, Served, serving
from .test_openapi import DOCUMENT, STARTS

PROMPT = 1.0
"""Seconds within which the owner is to be served."""

DESCRIBED = json.loads(DOCUMENT.read_text(encoding="utf-8"))
OPERATIONS = [
    (method.upper(), path, said)
    for path, methods in DESCRIBED["paths"].items() if path not in STARTS
    for method, said in methods.items()
]  # fmt: skip
SLOW = "/api/report.pdf"
"""What takes seconds of the processor at first: not among the few."""

ODD_WORDS = [
    b"", b"nan", b"-inf", b"1e308", b"9" * 5000, b"\0", b"\xff\xfe", b"../../etc/passwd", b"x" * 3000, b"\r\nA: b",
]  # fmt: skip
ODD_LINES = [
    b"Content-Length: -1", b"Content-Length: 5, 6", b"Content-Length: 99999999999", b"Transfer-Encoding: chunked",
    b"Transfer-Encoding: gzip, chunked", b"Expect: 100-continue", b"Host: evil.example", b"Host: [::",
    b"Cookie: robophm-", b"X: " + b"y" * 70_000, b"X: y\r\n" * 200 + b"X: y", b"X\0: y", b": y",
    b"Origin: http://evil.example", b"Range: bytes=9-1", b"Upgrade: h2c\r\nConnection: Upgrade",
    b"Accept-Encoding: " + b"gzip;q=9," * 500, b"Content-Type: multipart/form-data", b"If-Modified-Since: never",
    b"Authorization: Bearer " + b"\xff" * 500, b"X-Forwarded-For: \xff, ::1",
]  # fmt: skip


def made(schema: dict[str, Any], draw: random.Random, depth: int = 0) -> Any:
    """A value of a schema, or something odd in its place."""
    if draw.random() < 0.15 or depth > 6:
        return draw.choice(ODD)
    if "$ref" in schema:
        return made(DESCRIBED["components"]["schemas"][schema["$ref"].rpartition("/")[2]], draw, depth)
    if choices := schema.get("anyOf") or schema.get("oneOf"):
        return made(draw.choice(choices), draw, depth + 1)
    if "enum" in schema or "const" in schema:
        return draw.choice(schema.get("enum") or [schema["const"]])
    match schema.get("type"):
        case "object":
            fields = schema.get("properties", {"a": {}})
            return {name: made(one, draw, depth + 1) for name, one in fields.items() if draw.random() < 0.9}
        case "array":
            return [made(schema.get("items", {}), draw, depth + 1) for _ in range(draw.randrange(4))]
        case "integer" | "number":
            return draw.choice([0, 1, 2, -1, 0.5, 1e300, 10**30])
        case "string":
            return draw.choice(["motor", "drive", "courier", "1 h", "", "\ud800", "a: [&a *a]", "x" * 2000, "=1+1"])
        case "boolean":
            return draw.random() < 0.5
    return draw.choice(ODD)


def request(draw: random.Random, host: bytes, token: str | None, operations: list[Any]) -> tuple[bytes, str, bool]:
    """A request as its route describes it but for what is odd, its path, and whether its headers are fine."""
    method, path, said = draw.choice(operations)
    for name in ("name", "number"):
        path = path.replace(
            f"{{{name}}}", draw.choice(["1", "ota", "x", quote_from_bytes(draw.choice(ODD_WORDS)[:300])])
        )
    asked = [
        one["name"].encode() + b"=" + quote_from_bytes(draw.choice([b"1", b"motor", *ODD_WORDS])).encode()
        for one in said.get("parameters", ()) if one["in"] == "query" and draw.random() < 0.8
    ]  # fmt: skip
    content = said.get("requestBody", {}).get("content", {})
    body = b""
    if "application/json" in content or draw.random() < 0.1:
        schema = content.get("application/json", {}).get("schema", {})
        text = json.dumps(made(schema, draw)) if draw.random() < 0.8 else deep(draw)
        body = text.encode()
    lines = [
        b"Host: " + host,
        b"Content-Type: application/json",
        b"Content-Length: %d" % len(body),
        b"Connection: close",
    ]
    if token:
        lines.append(f"Authorization: Bearer {token}".encode())
    if odd_line := draw.random() < 0.2:
        lines.append(draw.choice(ODD_LINES))
    target = path.encode() + (b"?" + b"&".join(asked) if asked else b"")
    return b"%s %s HTTP/1.1\r\n%s\r\n\r\n%s" % (method.encode(), target, b"\r\n".join(lines), body), path, not odd_line


def frame(draw: random.Random) -> bytes:
    """A frame of a WebSocket with a wish that is odd, or of any kind, or with a length that lies."""
    text = json.dumps(draw.choice([*ODD, {"watch": draw.choice(ODD)}, {"history": draw.choice(ODD), "id": 1},
                                   {"watch": ["a"] * 500, "seconds": draw.choice(ODD)}])).encode()  # fmt: skip
    payload = draw.choice([text, text, damaged(text, draw), draw.randbytes(draw.randrange(100)), deep(draw).encode()])
    first, mask = draw.choice([0x81, 0x81, 0x81, draw.randrange(256)]), draw.randbytes(4)
    length = draw.choice([len(payload)] * 5 + [2**40, 2**63, 2**31])
    size = bytes([0x80 | length]) if length < 126 else (
        b"\xfe" + struct.pack(">H", length) if length < 1 << 16 else b"\xff" + struct.pack(">Q", length))  # fmt: skip
    return bytes([first]) + size + mask + bytes(byte ^ mask[at % 4] for at, byte in enumerate(payload[:200_000]))


class Attacker:
    """Asks over a connection of its own each time, as nobody or in some role."""

    def __init__(self, served: Served, tokens: dict[str, str], *, also_slow: bool) -> None:
        self.operations = [one for one in OPERATIONS if also_slow or one[1] != SLOW]
        self.host = served.address.split("//")[1].rstrip("/")
        self.tokens: list[tuple[str, str | None]] = [*tokens.items(), ("nobody", None)]
        self.statuses: Counter[int] = Counter()

    def hostile(self, draw: random.Random) -> None:
        role, token = draw.choice(self.tokens)
        raw, path, whole = request(draw, self.host.encode(), token, self.operations)
        kind = draw.random()
        if kind < 0.15:
            self._frames(draw, token)
        elif kind < 0.4:
            self._said(damaged(raw, draw), ended=True)
        elif kind < 0.45:
            self._said(draw.randbytes(draw.randrange(300)), ended=True)
        else:
            status = self._said(raw, ended=not whole)
            if whole and role == "nobody" and path not in OPEN_TO_ALL:
                assert status in (401, 413, 421), raw[:1000]

    def _said(self, raw: bytes, *, ended: bool) -> int:
        found = b""
        with self._connection() as one:
            one.sendall(raw)
            if ended:
                with suppress(OSError):  # refused already
                    one.shutdown(socket.SHUT_WR)
            found = one.recv(65536)
        status = int(found[9:12]) if found.startswith(b"HTTP/1.1 ") else 0
        self.statuses[status] += 1
        assert status != 500, raw[:2000]
        return status

    def _frames(self, draw: random.Random, token: str | None) -> None:
        key = b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
        who = f"Authorization: Bearer {token}\r\n".encode() if token else b""
        upgrade = b"Host: %s\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n%s%s\r\n" % (self.host.encode(), key, who)
        begins = b"GET /api/live HTTP/1.1\r\n" + upgrade
        if draw.random() < 0.3:
            self._said(damaged(begins, draw), ended=True)
            return
        with self._connection() as one:
            one.sendall(begins)
            assert (b" 101 " in one.recv(65536)) == bool(token)
            for _ in range(draw.randrange(5)):
                one.sendall(frame(draw))
        self.statuses[101] += 1

    @contextmanager
    def _connection(self) -> Iterator[socket.socket]:
        name, port = self.host.split(":")
        with suppress(ConnectionError, BrokenPipeError), socket.create_connection((name, int(port))) as one:
            one.settimeout(LONGEST * PATIENCE)
            yield one


def test_who_leaves_in_the_middle_of_a_file_is_no_fault_of_ours(
    small: Served, caplog: pytest.LogCaptureFixture
) -> None:
    host, port = small.address.split("//")[1].rstrip("/").split(":")
    head = f"POST /api/new/files?name=a.csv HTTP/1.1\r\nHost: {host}:{port}\r\nContent-Length: 1000\r\n\r\n"
    folder = small.design.parent
    with socket.create_connection((host, int(port))) as one:
        one.sendall(head.encode() + b"time,")
        within(5, lambda: list(folder.rglob("a.csv")))
    within(5, lambda: not list(folder.rglob("a.csv")))
    assert small.get("/healthz")["ok"]
    assert not [one for one in caplog.records if one.levelname == "ERROR"], caplog.text


@FEW_AND_MANY
def test_the_owner_is_served_beside_hostile_requests(
    tmp_path: Path, many: int, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "courier.yaml").write_text(SMALL)
    with serving(tmp_path / "courier.yaml", seed=1) as served:
        tokens = {role: served.service.visitors.users.add_token(f"program {role}", role) for role in ROLES}
        owner = {"authorization": f"Bearer {tokens['editor']}"}
        attacker = Attacker(served, tokens, also_slow=many > 1000)
        url = served.address.replace("http", "ws") + "api/live"
        with httpx.Client(base_url=served.address, headers=owner, timeout=LONGEST * PATIENCE) as client, connect(
            url, additional_headers=owner
        ) as live:  # fmt: skip

            def good(number: int) -> None:
                wish = {"history": "figure", "id": number, "from": 0, "to": 1, "pixels": 10}
                live.send(json.dumps(wish))
                assert client.get("api/design").status_code == 200

            def is_heard(number: int) -> bool:
                said = live.recv(timeout=LONGEST * PATIENCE)
                assert isinstance(said, bytes)
                return json.loads(said[4 : 4 + int.from_bytes(said[:4], "little")]).get("id") == number

            found = endured(many, attacker.hostile, good, is_heard)
        print(dict(attacker.statuses))
    assert found.longest < PROMPT * PATIENCE
    assert attacker.statuses[200] > many // 50
    assert attacker.statuses[422] > many // 50
    ours = [one for one in caplog.records if one.name.startswith("robophm") or "ASGI" in one.getMessage()]
    assert not [one for one in ours if one.levelname == "ERROR"], caplog.text[:3000]
