"""What a supervisor asks and is told: whether the service lives, is ready, and ends when it is told to."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.monitoring import live_loop
from robophm.web import service as of_service

from ..transports.listener import within
from .conftest import OTA, SMALL, serving


def test_healthy_to_whoever_asks_and_telling_nothing(tmp_path: Path) -> None:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as served:
        served.service.visitors.users.add_token("anna", "editor")
        for path in ("/healthz", "/readyz"):
            answer = served.client.get(path)
            assert (answer.status_code, answer.json()) == (200, {"ok": True, "wrong": []})
        assert served.client.get("/api/design").status_code == 401
        assert served.client.post("/healthz").status_code == 405


def test_what_fails_is_loud_and_is_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A source that is gone for a while, as a broker is."""
    design = tmp_path / "robot.yaml"
    design.write_bytes(OTA.read_bytes())
    monkeypatch.setattr(of_service, "RETRIED_EVERY", 0.05)
    with serving(design, seed=1) as served:
        service, choice = served.service, served.service.sources["synthetic"]
        gone = True

        class Sources(dict):  # type: ignore[type-arg]
            pass

        def opened(speed: float):  # type: ignore[no-untyped-def]
            source = choice.open(speed)
            if gone:
                source.samples = lambda signals: (_ for _ in ()).throw(SourceError("the broker is gone"))
            return source

        broken = Sources({"synthetic": choice.__class__(**{**vars(choice), "open": opened})})
        monkeypatch.setattr(type(service), "sources", property(lambda _: broken))
        service.keep_watching("synthetic", 1000.0)
        within(20, lambda: service.monitoring.state == "failed")
        for path in ("/healthz", "/readyz"):
            answer = served.client.get(path)
            assert answer.status_code in (200, 503)  # it may be tried again at this moment
        within(20, lambda: served.client.get("/healthz").json() == {"ok": False, "wrong": ["monitoring has failed"]})
        assert served.client.get("/readyz").status_code == 503
        gone = False
        within(30, lambda: served.client.get("/readyz").status_code == 200)
        assert served.client.get("/healthz").json() == {"ok": True, "wrong": []}
        service.monitoring.stop()
        assert served.client.get("/readyz").status_code == 200  # a person has stopped it


@pytest.mark.full
@pytest.mark.skipif(os.name == "nt", reason="needs signals")
def test_it_ends_soon_after_sigterm_and_its_supervisor_knows(tmp_path: Path) -> None:
    design = tmp_path / "robot.yaml"
    design.write_bytes(OTA.read_bytes())
    words = ["serve", str(design), "--port", "0", "--synthetic", "--start", "synthetic", "--speed", "1000"]
    place = str(tmp_path / "notify")
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as there:
        there.bind(place)
        there.settimeout(60)
        told = os.environ | {"NOTIFY_SOCKET": place, "WATCHDOG_USEC": "400000"}
        with subprocess.Popen(
            [sys.executable, "-m", "robophm", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=told
        ) as child:
            assert there.recv(1000) == b"READY=1\nSTATUS=serving"
            assert [there.recv(1000) for _ in range(2)] == [b"WATCHDOG=1"] * 2
            child.send_signal(signal.SIGTERM)
            begun = time.monotonic()
            child.wait(timeout=60)
            took = time.monotonic() - begun
            assert child.returncode == 0
        said = b""
        while said != b"STOPPING=1":
            said = there.recv(1000)
    assert took < 30  # on a machine that does much else; alone it is below two seconds


def test_a_disk_that_is_full_is_said_while_it_is(
    small_disk: Path,
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(live_loop, "SAVE_EVERY", 0.2)
    design = tmp_path / "robot.yaml"
    design.write_bytes(OTA.read_bytes())
    store, journal, ballast = small_disk / "past.db", small_disk / "run.journal", small_disk / "ballast"

    def told() -> list[str]:
        answer = served.client.get("/readyz")
        wrong: list[str] = answer.json()["wrong"]
        assert answer.status_code == (503 if wrong else 200)
        return wrong

    with serving(design, seed=1, store=str(store), journal=journal) as served:
        served.service.keep_watching("synthetic", 2000.0)
        within(30, lambda: journal.exists() and journal.stat().st_size > 10_000)
        with ballast.open("wb", buffering=0) as stream, suppress(OSError):
            while True:
                stream.write(bytes(4096))
        within(60, lambda: told() == ["the past cannot be kept"])
        assert served.client.get("/healthz").status_code == 200, "it is not to be started again for that"
        within(20, lambda: any("not saved, tried" in line for line in served.client.get("/api/health").json()["notes"]))
        metrics = served.client.get("/metrics").text
        assert "robophm_past_kept 0" in metrics
        assert "robophm_incidents_total 0" not in metrics
        ballast.unlink()
        within(60, lambda: told() == [])
        assert "robophm_past_kept 1" in served.client.get("/metrics").text
    assert "disk is full" in caplog.text
