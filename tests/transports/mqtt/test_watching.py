"""``robophm watch`` beside a real broker: it ends when it is told to, while it starts and under a flood of messages."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.journal import JournalRecording

from ..listener import within
from .conftest import LOOPBACK, Broker

DESIGN = """
schema_version: 1
name: R
signals: {temperature: {topic: /motor, field: temperature, unit: degC, max_age: 10 s, range: [-40, 125]}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""

pytestmark = pytest.mark.skipif(os.name == "nt", reason="needs signals")


def start(broker: Broker, folder: Path) -> subprocess.Popen[str]:
    """A watch that looks for its source, which takes a second."""
    (folder / "robot.yaml").write_text(DESIGN)
    words = ["--via", broker.address(), "--store", "past.db", "--journal", "run.journal", "--no-publish"]
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", *words],
        cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert process.stderr
    assert process.stderr.readline().startswith("listening to MQTT")
    return process


@pytest.mark.full
def test_ctrl_c_twice_while_it_starts_is_an_end_and_no_error(broker: Broker, tmp_path: Path) -> None:
    with start(broker, tmp_path) as process:
        for _ in range(2):
            process.send_signal(signal.SIGINT)
            time.sleep(0.05)  # two signals at once are one
        said, warned = process.communicate(timeout=60)
        assert (process.returncode, said) == (0, "")
        assert warned.splitlines()[-1] == "warning: ended before the robot was watched"


def flood(port: int, over: threading.Event) -> None:
    """Publish without ever waiting (QoS 0), by the bytes that the protocol states."""
    with socket.create_connection((LOOPBACK, port), 10) as broker:
        broker.sendall(b"\x10\x0e\x00\x04MQTT\x04\x02\x00\x00\x00\x02me")
        assert broker.recv(4) == b"\x20\x02\x00\x00"
        message = b"\x00\x05motor" + b'{"temperature": 35}'
        some = (b"\x30" + bytes([len(message)]) + message) * 1000
        while not over.is_set():
            broker.sendall(some)


@pytest.mark.full
def test_sigterm_ends_it_within_seconds_under_a_flood_and_what_was_taken_is_kept(
    broker: Broker, tmp_path: Path
) -> None:
    """More messages than it can take."""
    journal, over = tmp_path / "run.journal", threading.Event()
    with start(broker, tmp_path) as process:
        flooding = threading.Thread(target=flood, args=(broker.port, over))
        flooding.start()
        try:
            within(20, lambda: journal.exists() and journal.stat().st_size > 200_000)
            process.send_signal(signal.SIGTERM)
            begun = time.monotonic()
            _, warned = process.communicate(timeout=60)
            print(f"ended after {time.monotonic() - begun:.1f} s")
        finally:
            process.kill()
            over.set()
            flooding.join()
        assert process.returncode == 0, warned
    assert "Traceback" not in warned
    recording = JournalRecording(journal)
    *_, last = recording.samples(recording.signals)
    with SqliteStore(tmp_path / "past.db") as store:
        ledger = store.ledger("R")
    assert ledger
    assert ledger["newest"] == last.time, "all that was taken is in the ledger"
