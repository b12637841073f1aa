"""A fleet whose robots, network, service, database and broker are killed at random, beside each robot's own store.

Robots, service, a PostgreSQL and a Mosquitto are processes of their own, ended at once; without a broker the network
between robots and service is a proxy that cuts connections before, within and after what they carry, so that answers
are lost of what was committed.
"""

from __future__ import annotations

import multiprocessing
import random
import socket
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, closing, suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

from tests.fleet.conftest import DEADLINE, wait_for
from tests.fleet.made_reports import report
from tests.fleet.postgresql_server import Server
from tests.transports.mqtt.conftest import Broker

from robophm.fleet.address import FleetAddress
from robophm.fleet.mqtt import listener
from robophm.fleet.questions import present, reports, status
from robophm.fleet.sender import Sender
from robophm.fleet.serving import FleetSettings, serve_fleet
from robophm.fleet.store import FleetStore
from robophm.stores.sqlite import SqliteStore

PROCESSES = multiprocessing.get_context("forkserver")
"""How processes are begun: from one that has imported all that they need, so each takes milliseconds."""
PROCESSES.set_forkserver_preload(["tests.fleet.killed"])


WAITS = {"look_every": 0.01, "first_wait": 0.01}
"""Seconds that a robot waits, here less than it does."""


def serve(path: str, port: int, broker: str | None, ready: Connection) -> None:
    """The service, in a process of its own."""
    listener.FIRST_WAIT = listener.LONGEST_WAIT = 0.02
    serve_fleet(FleetSettings(path, port=port, broker=broker), lambda *_: ready.send(True))


def watch(path: Path, address: str, token: str, most: int, ready: Connection) -> None:
    """A robot that goes on with its past until it has made so many reports, in a process of its own."""
    with SqliteStore(path) as store:
        store.outboxes.of("courier").begin()
        kept = store.ledger("courier") or {"reports": 0, "hours": 0.0}
        ready.send(True)
        with Sender(path, "courier", FleetAddress.of(address), token, lambda _: None, **WAITS, patience=0.5):
            while kept["reports"] < most:
                kept = {"reports": kept["reports"] + 1, "hours": kept["hours"] + 0.1}
                store.save("courier", kept, reports=[report(kept["reports"])])
                time.sleep(0.004)


class KilledBroker(Broker):
    """A Mosquitto without a memory on disk, which is killed as a database is."""

    kill = Broker.stop

    def begin(self) -> None:
        """Start it where it was."""
        assert self.start()


class CutNetwork:
    """A way to a port that cuts connections at random, on either side of an answer."""

    def __init__(self, port: int, chance: random.Random) -> None:
        self._to, self._chance = port, chance
        self.cut = True
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.port = self._socket.getsockname()[1]
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self) -> None:
        with suppress(OSError):
            while True:
                threading.Thread(target=self._carry, args=(self._socket.accept()[0],), daemon=True).start()

    def _carry(self, robot: socket.socket) -> None:
        """One request there and its answer back, each to the end, in part or not at all."""
        with closing(robot), suppress(OSError):
            there, back = (self._chance.choice([1, 1, 1, 0.5, 0]) if self.cut else 1 for _ in range(2))
            with socket.create_connection(("127.0.0.1", self._to), timeout=5) as service:
                robot.settimeout(5)
                self._pass(robot, service, there)
                if there == 1:
                    self._pass(service, robot, back)

    def _pass(self, one: socket.socket, other: socket.socket, part: float) -> None:
        """What one says until it is whole, as far as it is let through."""
        said = b""
        while not _is_whole(said) and (more := one.recv(65536)):
            said += more
        other.sendall(said[: int(len(said) * part)])

    def close(self) -> None:
        self._socket.close()


def _is_whole(said: bytes) -> bool:
    """Whether all of one message of HTTP is there."""
    head, end, body = said.partition(b"\r\n\r\n")
    lengths = [int(line.split(b":")[1]) for line in head.lower().split(b"\r\n") if line.startswith(b"content-length:")]
    return bool(end) and len(body) >= sum(lengths)


def _begun(target: Callable[..., None], *words: object) -> BaseProcess:
    here, there = PROCESSES.Pipe(duplex=False)
    child = PROCESSES.Process(target=target, args=(*words, there), daemon=True)
    child.start()
    there.close()
    with here:
        assert here.poll(DEADLINE)
        here.recv()
    return child


def _end(child: BaseProcess) -> None:
    child.kill()
    child.join(DEADLINE)
    child.close()


def course(
    folder: Path, seed: int, *, robots: int = 2, most: int = 150, kills: int = 4, database: Server | None = None,
    broker: KilledBroker | None = None,
) -> dict[str, int]:  # fmt: skip
    """Run one course of kills and cuts, then let all of it come to its end, and compare.

    With a ``database``, whose tables are empty, the fleet's store is there; else it is a SQLite file. With a ``broker``
    all goes over it; else over HTTP.

    Raises AssertionError where a report of a robot is lost or counted twice, or a ledger is not the robot's own, letter
    by letter. Returns how much of what happened.
    """
    chance, path = random.Random(seed), database.address if database else str(folder / "fleet.db")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with FleetStore(path, make=True) as store:
        tokens = {f"r{at}": store.add_token(f"r{at}") for at in range(robots)}
    stores = {name: folder / f"{name}.db" for name in tokens}
    with ExitStack() as stack:
        network = CutNetwork(port, chance)
        stack.callback(network.close)
        way = broker.address() if broker else f"http://127.0.0.1:{network.port}"
        running: dict[str, BaseProcess] = {}
        stack.callback(lambda: [_end(one) for one in running.values()])

        def begin(name: str) -> None:
            if name == "service":
                running[name] = _begun(serve, path, port, way if broker else None)
            else:
                running[name] = _begun(watch, stores[name], f"{way}/robots/{name}", tokens[name], most)

        for name in ("service", *tokens):
            begin(name)
        for _ in range(kills):
            time.sleep(chance.uniform(0.0, 0.25))
            some = chance.sample([*running], chance.randint(1, len(running)))
            wholes = [one for one in (database, broker) if one and chance.random() < 0.5]
            for name in some:
                _end(running[name])
            for whole in wholes:
                whole.kill()
                whole.begin()
            for name in some:
                begin(name)
        network.cut = False
        for name in tokens:
            running[name].join(DEADLINE)
        for name, token in tokens.items():  # what still waits: a robot that begins again
            address = FleetAddress.of(f"{way}/robots/{name}")
            with SqliteStore(stores[name]) as own:
                outbox = own.outboxes.of("courier")
                with Sender(stores[name], "courier", address, token, lambda _: None, **WAITS, patience=5.0):
                    wait_for(lambda outbox=outbox: outbox.count() == 0)
    return _compared(path, stores, most)


def _compared(path: str, stores: dict[str, Path], most: int) -> dict[str, int]:
    """Compare what the fleet has with what each robot's own store has."""
    found = {"reports": 0, "epochs": 0}
    with FleetStore(path) as fleet:
        said = {one.robot: one for one in status(fleet)}
        for name, place in stores.items():
            with SqliteStore(place) as own:
                times = own.history("courier").figures().times.tolist()
                ledger = own._base.execute("SELECT state FROM ledger").fetchone()[0]
            there = [*reports(fleet, name)]
            assert len(times) == most
            assert [one.time for one in there] == times, "lost, twice or in another order"
            assert (said[name].reports, said[name].missing, said[name].thinned) == (most, 0, 0)
            assert said[name].refused == {}
            kept = present(fleet, name)
            assert kept is not None
            assert kept[0].encode() == ledger.encode(), "another ledger than the robot's own"
            found["reports"] += len(there)
            found["epochs"] += len({one.epoch for one in there})
    return found
