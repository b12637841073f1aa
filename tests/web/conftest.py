"""A service of a robot of one's own, in a thread, on a port of its own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest

from robophm.cli.app import app
from robophm.web import serving as serving_room
from robophm.web.service import Service, Settings
from robophm.web.serving import serve

ROOT = Path(__file__).parents[2]
OTA = ROOT / "examples" / "ota" / "robot.yaml"

SMALL = """\
# A courier, small enough to be worked out by hand.
schema_version: 1
name: courier
task: {distance: 360 m, speed: 0.1 m/s}   # one hour
acceleration: {model: q10, reference_temperature: 25 degC}
modules:
  drive:
    components:
      motor: {quantity: 2, rate: 8 FPMH}   # left and right
      encoder: {rate: 2 FPMH}
  see:
    diagram: {parallel: [lidar, camera]}
    components:
      lidar: {rate: 30 FPMH}
      camera: {rate: 90 FPMH}
"""


@dataclass
class Served:
    """A running service."""

    address: str
    """Ends with a stroke."""
    service: Service
    client: httpx.Client
    design: Path

    def get(self, address: str, /, **query: Any) -> Any:
        """The JSON of an answer that is none but 200."""
        answer = self.client.get(address, params=query)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def post(self, path: str, body: Any = None, status: int = 200) -> Any:
        """The same of a write; of another status where that is expected."""
        answer = self.client.post(path, json=body)
        assert answer.status_code == status, answer.text
        return answer.json()

    def edit(self, *operations: Any, status: int = 200) -> Any:
        """Edits of the newest revision."""
        revision = self.get("/api/design")["revision"]
        return self.post("/api/design/edits", {"revision": revision, "operations": list(operations)}, status)


@contextmanager
def serving(design: Path, port: int = 0, **settings: Any) -> Iterator[Served]:
    """A service in a thread, until left."""
    started = threading.Event()
    found: list[Any] = []

    def ready(address: str, service: Service, stop: Any) -> None:
        found.extend((address, service, stop))
        started.set()

    thread = threading.Thread(target=serve, args=(Settings(design, **settings), port, ready), daemon=True)
    thread.start()
    assert started.wait(30)
    address, service, stop = found
    transport = httpx.HTTPTransport(retries=5, verify=False)
    with httpx.Client(base_url=address, timeout=30, transport=transport) as client:
        try:
            yield Served(address, service, client, design)
        finally:
            stop()
            thread.join(timeout=30)


@pytest.fixture
def small(tmp_path: Path) -> Iterator[Served]:
    """The courier, served."""
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design, seed=1) as served:
        yield served


@pytest.fixture(scope="module")
def shared_small(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """The same, for tests that change nothing."""
    design = tmp_path_factory.mktemp("served") / "courier.yaml"
    design.write_text(SMALL)
    with serving(design, seed=1) as served:
        yield served


Printed = Callable[..., tuple[list[str], str]]


@pytest.fixture
def printed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Printed:
    """What ``robophm serve`` prints until it is ready, and what it warns of; then it ends."""
    real = serving_room.serve

    def until_ready(settings: Settings, port: int, ready: Callable[..., None]) -> None:
        def ended(address: str, service: Service, stop: Callable[[], None]) -> None:
            ready(address, service, stop)
            stop()

        real(settings, port, ended)

    def said(folder: Path, *words: str) -> tuple[list[str], str]:
        monkeypatch.setattr(serving_room, "serve", until_ready)
        monkeypatch.chdir(folder)
        app(["serve", *words, "--port", "0"], standalone_mode=False)
        out, warned = capsys.readouterr()
        return out.splitlines(), warned

    return said


def until(there: Callable[[], Any]) -> None:
    """Wait for what a service is asked for."""
    end = time.monotonic() + 60
    while not there():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.1)  # each time the service is asked, which takes its time too
