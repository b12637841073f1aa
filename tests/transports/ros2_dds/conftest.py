"""Real peers of other make beside us, on loopback and in a domain of their own; each test ends what it starts."""

from __future__ import annotations

import fcntl
import hashlib
import queue
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from robophm.transports.signals.source import LiveSource

from ..listener import within

HERE = Path(__file__).parent
LOOPBACK = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General></Domain>'
    "</CycloneDDS>"
)
TEMPERATURE, FLOAT64 = "sensor_msgs::msg::dds_::Temperature_", "std_msgs::msg::dds_::Float64_"


def published(source: LiveSource, *topics: str) -> None:
    """Wait until a source knows that these are published."""
    within(10, lambda: {*topics} <= {info.topic for info in source.topics()})


class Peer:
    """A process that reads commands and says what it hears."""

    def __init__(self, *command: str) -> None:
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        self._lines: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        try:
            assert self.line() == "ready"
        except BaseException:
            self.close()
            raise

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._lines.put(line.rstrip("\n"))

    def line(self, seconds: float = 10) -> str:
        """What it says next."""
        return self._lines.get(timeout=seconds)

    def tell(self, *commands: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write("".join(f"{command}\n" for command in commands))
        self.process.stdin.flush()

    def ask(self, command: str, answer: str) -> None:
        self.tell(command)
        assert self.line() == answer

    def writer(self, topic: str, type_: str, how: str = "reliable volatile", name: str = "w") -> None:
        self.ask(f"writer {name} rt{topic} {type_} {how}", "made")

    def matched(self, count: int = 1, name: str = "w") -> None:
        self.ask(f"matched {name} {count}", "matched")

    def close(self) -> None:
        """Let it take leave: of who is killed, others know for 20 s that it publishes."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        with suppress(BrokenPipeError):
            self.process.stdin.close()
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self._reader.join(5)
        self.process.stdout.close()


@pytest.fixture(scope="session")
def domain() -> Iterator[int]:
    """A domain that no other tests of this machine use, and the environment of all that is started."""
    for number in range(20, 100):
        lock = socket.socket()
        try:
            lock.bind(("127.0.0.1", 7400 + 250 * number))  # a port of the domain that DDS, which is UDP, leaves free
        except OSError:
            lock.close()
            continue
        break
    with lock, pytest.MonkeyPatch.context() as patch:
        for name in ("ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "AMENT_PREFIX_PATH", "ROS_VERSION",
                     "ROS_DISTRO", "ROS_MASTER_URI"):  # fmt: skip
            patch.delenv(name, raising=False)
        patch.setenv("ROS_DOMAIN_ID", str(number))
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        patch.setenv("CYCLONEDDS_URI", LOOPBACK)
        yield number


@pytest.fixture(scope="session")
def _participant(domain: int, cyclonedds: None) -> Iterator[None]:
    """Keeps this process in the domain: a participant that is new waits for two seconds for others."""
    from robophm.transports.ros2_dds import Node

    with Node("/robophm_tests"):
        yield


@pytest.fixture
def live(_participant: None) -> Iterator[LiveSource]:
    from robophm.transports.ros2_dds import Ros2Dds

    with Ros2Dds() as source:
        yield source


@pytest.fixture(scope="session")
def _fastdds(fastdds: None, pytestconfig: pytest.Config) -> Path:
    """The peer, compiled once for its source; half a dozen seconds."""
    source = HERE / "fastdds_peer.cpp"
    cache = pytestconfig.cache
    assert cache is not None
    program = cache.mkdir("fastdds_peer") / hashlib.sha256(source.read_bytes()).hexdigest()[:16]
    with program.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not program.exists():
            made = program.with_suffix(".new")
            library = (
                "-lfastdds" if Path("/usr/include/fastdds/utils/IPLocator.hpp").exists() else "-lfastrtps"
            )  # 3, or 2
            command = ["g++", "-std=c++17", "-o", str(made), str(source), library, "-lfastcdr"]
            subprocess.run(command, check=True, timeout=300)
            made.rename(program)
    return program


@pytest.fixture
def start(_fastdds: Path, domain: int) -> Iterator[Callable[[], Peer]]:
    """Starts peers over Fast DDS."""
    peers: list[Peer] = []

    def make() -> Peer:
        peers.append(Peer(str(_fastdds), str(domain)))
        return peers[-1]

    yield make
    for peer in peers:
        peer.close()


@pytest.fixture
def peer(start: Callable[[], Peer]) -> Peer:
    """A peer over Fast DDS."""
    return start()


@pytest.fixture
def cyclone(_participant: None, domain: int) -> Iterator[Peer]:
    """A peer over Cyclone, with types written by hand."""
    peer = Peer(sys.executable, str(HERE / "cyclone_peer.py"), str(domain))
    yield peer
    peer.close()
