"""Attacks on ``robophm serve``, each beside an owner who is logged in and asks all the time.

``python -m benchmarks.attacks [NAME ...] [--seconds 12] [--tls]`` (all of them take eight minutes): the service and the
attackers are processes of their own. The owner asks for the design ten times a second, in turns over one connection
that is kept and over a new one; what 99 of 100 answers took at most (p99) and the slowest are told, and the peak of the
service's memory as the kernel counts it. Attackers come from one address, from hundreds (other addresses of the
loopback network), and from the owner's own, as behind a router. Exits with 1 where the owner waited for more than a
second, or memory passed 512 MiB.
"""

from __future__ import annotations

import argparse
import asyncio
import http.client
import itertools
import json
import math
import re
import resource
import ssl
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit

import numpy as np

LONGEST, MOST_MEMORY = 1.0, 512.0
"""Seconds that the owner may wait, and MiB that the service may take."""

OWNER = "127.0.0.1"
FROM = {"one address": ["127.0.0.2"], "500 addresses": [f"127.1.{i // 250}.{i % 250 + 1}" for i in range(500)],
        "the owner's address": [OWNER]}  # fmt: skip
EXAMPLE = Path(__file__).parents[1] / "examples" / "ota" / "robot.yaml"


class Target(NamedTuple):
    """A service, and a token of somebody who may only look."""

    port: int
    certificate: str
    token: str
    addresses: tuple[str, ...]

    @asynccontextmanager
    async def connection(
        self, address: str, raw: bool = False
    ) -> AsyncIterator[tuple[asyncio.StreamReader, asyncio.StreamWriter]]:
        """A connection from an address; ``raw``: without shaking hands."""
        context = ssl.create_default_context(cafile=self.certificate) if self.certificate and not raw else None
        reader, writer = await asyncio.wait_for(
            asyncio.open_connection("127.0.0.1", self.port, ssl=context, local_addr=(address, 0), limit=1 << 16), 30
        )
        try:
            yield reader, writer
        finally:
            writer.transport.abort()

    def head(self, request: str, *headers: str, known: bool = False) -> bytes:
        """The head of a request but for its empty line, with the token where it is to be ``known``."""
        lines = [f"{request} HTTP/1.1", f"Host: 127.0.0.1:{self.port}", *headers]
        return "\r\n".join([*lines, *[f"Authorization: Bearer {self.token}"] * known, ""]).encode()


Attack = Callable[[Target, str], "asyncio.Future[None]"]
ATTACKS: dict[str, tuple[int, Callable[[Target, str], object]]] = {}
"""Each attack by its name: how many connections make it at once, and what each does, again and again."""


def attack(name: str, connections: int) -> Callable[[Callable[[Target, str], object]], Callable[[Target, str], object]]:
    """Enter an attack."""

    def entered(made: Callable[[Target, str], object]) -> Callable[[Target, str], object]:
        ATTACKS[name] = connections, made
        return made

    return entered


@attack("idle sockets", 1000)
async def idle(target: Target, address: str) -> None:
    async with target.connection(address, raw=True) as (reader, _):
        await reader.read(1)


@attack("slow headers", 1000)
async def slow_headers(target: Target, address: str) -> None:
    async with target.connection(address) as (_, writer):
        writer.write(target.head("GET /api/design", "X: a").rstrip())
        while not writer.transport.is_closing():
            writer.write(b"a")
            await asyncio.sleep(1)


@attack("half-sent bodies", 1000)
async def half_sent(target: Target, address: str) -> None:
    """Nearly all of a large body, by somebody who is let in, and then no more."""
    async with target.connection(address) as (reader, writer):
        writer.write(target.head("POST /api/tasks/predict", "Content-Length: 23000000", known=True) + b"\r\n")
        for _ in range(220):
            writer.write(b" " * 100_000)
            await writer.drain()
        await reader.read(1)


@attack("trickled bodies", 1000)
async def trickled(target: Target, address: str) -> None:
    async with target.connection(address) as (_, writer):
        writer.write(target.head("POST /api/tasks/predict", "Content-Length: 23000000", known=True) + b"\r\n")
        while not writer.transport.is_closing():
            writer.write(b" ")
            await asyncio.sleep(1)


@attack("bodies of 100 MB", 20)
async def stated(target: Target, address: str) -> None:
    await pour(target, address, "Content-Length: 100000000")


@attack("bodies of 100 MB, unstated", 20)
async def unstated(target: Target, address: str) -> None:
    await pour(target, address, "Transfer-Encoding: chunked")


async def pour(target: Target, address: str, length: str) -> None:
    async with target.connection(address) as (_, writer):
        writer.write(target.head("POST /api/tasks/predict", length, known=True) + b"\r\n")
        piece = (b"186a0\r\n" + b" " * 100_000 + b"\r\n") if "chunked" in length else b" " * 100_000
        for _ in range(1000):
            writer.write(piece)
            await writer.drain()


@attack("guesses", 20)
async def guesses(target: Target, address: str) -> None:
    """Each wrong, some hundred over one connection: 10,000 and more in all."""
    async with target.connection(address) as (reader, writer):
        body = b"name=anna&password=wrong"
        said = target.head("POST /login", f"Content-Length: {len(body)}") + b"\r\n" + body
        for _ in range(100):
            writer.write(said)
            await answer(reader)
            print(flush=True)


@attack("answers that nobody reads", 1000)
async def unread(target: Target, address: str) -> None:
    async with target.connection(address) as (_, writer):
        writer.transport.pause_reading()  # type: ignore[attr-defined]
        said = target.head("GET /login") + b"\r\n"
        while not writer.transport.is_closing():
            with suppress(TimeoutError):
                async with asyncio.timeout(1):
                    writer.write(said * 100)
                    await writer.drain()
            await asyncio.sleep(0.1)


@attack("WebSockets", 1000)
async def websockets(target: Target, address: str) -> None:
    """Live values, by somebody who is let in."""
    upgrade = (
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: " + "A" * 22 + "==",
    )
    async with target.connection(address) as (reader, writer):
        writer.write(target.head("GET /api/live", *upgrade, known=True) + b"\r\n")
        while await reader.read(65536):
            pass


async def answer(reader: asyncio.StreamReader) -> int:
    """The status of an answer that is read to its end."""
    head = await reader.readuntil(b"\r\n\r\n")
    length = re.search(rb"content-length: (\d+)", head)
    await reader.readexactly(int(length[1]) if length else 0)
    return int(head.split(b" ", 2)[1])


async def go_on(name: str, target: Target) -> None:
    """Attack until ended: a connection that is lost is made again a second later. What is over is a line of output."""
    connections, made = ATTACKS[name]

    async def again(number: int) -> None:
        await asyncio.sleep(number / connections)  # within the first second
        for turn in itertools.count():
            with suppress(OSError, TimeoutError, asyncio.IncompleteReadError, ssl.SSLError):
                await made(target, target.addresses[(number + turn) % len(target.addresses)])  # type: ignore[misc]
            print(flush=True)
            await asyncio.sleep(1)

    await asyncio.gather(*(again(number) for number in range(connections)))


class Owner(threading.Thread):
    """Asks for the design, in turns over a connection that is kept and over a new one, and takes the time."""

    def __init__(self, address: str, certificate: str, token: str) -> None:
        super().__init__(daemon=True)
        split = urlsplit(address)
        self._where = split.hostname or "", split.port
        self._context = ssl.create_default_context(cafile=certificate) if certificate else None
        self._token = token
        self._over = threading.Event()
        self.waited: list[float] = []
        self.refused: list[str] = []

    def run(self) -> None:
        kept = self._connection()
        for turn in itertools.count():
            if self._over.wait(0.1):
                return
            one = kept if turn % 2 else self._connection()
            begun = time.monotonic()
            try:
                try:
                    self._ask(one)
                except (http.client.RemoteDisconnected, ConnectionError):
                    if one is not kept:
                        raise
                    kept.close()  # as browsers do where a kept connection has been closed
                    self._ask(kept)
            except (OSError, http.client.HTTPException, ValueError) as error:
                self.refused.append(repr(error))
                one.close()
            self.waited.append(time.monotonic() - begun)
            if one is not kept:
                one.close()

    def stop(self) -> None:
        """End; an answer that is awaited is awaited to its end."""
        self._over.set()
        self.join(timeout=60)

    def _connection(self) -> http.client.HTTPConnection:
        if self._context:
            return http.client.HTTPSConnection(*self._where, timeout=30, context=self._context)
        return http.client.HTTPConnection(*self._where, timeout=30)

    def _ask(self, one: http.client.HTTPConnection) -> None:
        one.request("GET", "/api/design", headers={"Authorization": f"Bearer {self._token}"})
        answer = one.getresponse()
        answer.read()
        if answer.status != 200:
            raise ValueError(answer.status)


@contextmanager
def served(folder: Path, tls: bool) -> Iterator[tuple[str, int, str, dict[str, str]]]:
    """A service of the paper's robot with users: its address, process, certificate, and a token for each role."""
    design = folder / "robot.yaml"
    design.write_bytes(EXAMPLE.read_bytes())
    robophm = [sys.executable, "-m", "robophm"]
    tokens = {
        role: subprocess.run(
            [*robophm, "users", "add", str(design), role, "--role", role, "--token"],
            capture_output=True, text=True, check=True,
        ).stdout.strip() for role in ("viewer", "editor")
    }  # fmt: skip
    more: list[str] = []
    certificate = ""
    if tls:
        from robophm.web.access.certificate import own_certificate

        certificate = str(own_certificate(folder / "own.pem", "127.0.0.1"))
        more = ["--certificate", certificate]
    process = subprocess.Popen(
        [*robophm, "serve", str(design), "--port", "0", "--synthetic", "--start", "synthetic", *more],
        stdout=subprocess.PIPE, stderr=(folder / "stderr").open("wb"), text=True,
    )  # fmt: skip
    try:
        assert process.stdout
        found = re.search(r"https?://[^ ]+/", process.stdout.readline())
        assert found, (folder / "stderr").read_text()
        yield found[0], process.pid, certificate, tokens
    finally:
        process.terminate()
        process.wait(timeout=30)


def peak(pid: int) -> float:
    """The most memory that a process has had since this was asked last [MiB]."""
    found = re.search(r"VmHWM:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())
    Path(f"/proc/{pid}/clear_refs").write_text("5")
    return int(found[1]) / 1024 if found else float("nan")


class Outcome(NamedTuple):
    """What one attack came to."""

    name: str
    source: str
    asked: int
    refused: list[str]
    median: float
    p99: float
    slowest: float
    memory: float
    """[MiB]"""
    tries: int

    @property
    def holds(self) -> bool:
        """Whether the owner was served in time, in bounded memory."""
        return not self.refused and self.asked > 0 and self.slowest <= LONGEST and self.memory <= MOST_MEMORY


def tried(name: str, source: str, seconds: float, tls: bool) -> Outcome:
    """One attack on a service of its own."""
    with tempfile.TemporaryDirectory() as place, served(Path(place), tls) as (address, pid, certificate, tokens):
        owner = Owner(address, certificate, tokens["editor"])
        target = Target(urlsplit(address).port or 0, certificate, tokens["viewer"], tuple(FROM[source]))
        peak(pid)
        with subprocess.Popen(
            ["nice", sys.executable, "-m", "benchmarks.attacks", "--against", json.dumps(target), name],
            stdout=subprocess.PIPE, text=True,
        ) as attacking:  # fmt: skip
            owner.start()
            time.sleep(seconds)
            owner.stop()
            attacking.terminate()
            assert attacking.stdout
            tries = [*attacking.stdout]
        waited = np.array(owner.waited or [math.nan])
        return Outcome(name, source, len(owner.waited), owner.refused, *np.quantile(waited, (0.5, 0.99, 1)).tolist(),
                       peak(pid), len(tries))  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.attacks")
    parser.add_argument("names", nargs="*", metavar="NAME", help="an attack; default all: " + ", ".join(ATTACKS))
    parser.add_argument("--seconds", type=float, default=12.0, help="of each attack")
    parser.add_argument("--from", dest="source", choices=FROM, help="where from; default all in turns")
    parser.add_argument("--tls", action="store_true", help="over TLS")
    parser.add_argument("--against", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(8192, hard), hard))
    if asked.against:
        asyncio.run(go_on(asked.names[0], Target(*json.loads(asked.against))))
        return 0
    print(
        f"{'attack':<28}{'from':<22}{'asked':>6}{'refused':>9}{'median':>10}{'p99':>10}{'slowest':>10}{'memory':>10}{'tries':>8}"
    )
    all_hold = True
    for name in asked.names or ATTACKS:
        for source in [asked.source] if asked.source else FROM:
            one = tried(name, source, asked.seconds, asked.tls)
            waited = "".join(f"{1000 * time:>7.0f} ms" for time in (one.median, one.p99, one.slowest))
            print(
                f"{name:<28}{source:<22}{one.asked:>6}{len(one.refused):>9}{waited}{one.memory:>6.0f} MiB"
                f"{one.tries:>8}{'' if one.holds else '  fails'}{'  ' + one.refused[0] if one.refused else ''}",
                flush=True,
            )
            all_hold = all_hold and one.holds
    return 0 if all_hold else 1


if __name__ == "__main__":
    sys.exit(main())
