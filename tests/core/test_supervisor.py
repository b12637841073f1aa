"""What a supervisor is told, heard on a socket as systemd has one; and the units that are for it."""

from __future__ import annotations

import shutil
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from robophm.core.supervisor import Supervisor

UNITS = sorted((Path(__file__).parents[2] / "systemd").glob("*.service"))

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs sockets of Unix")


def test_it_is_told_on_its_socket(tmp_path: Path) -> None:
    place = str(tmp_path / "notify")
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as there:
        there.bind(place)
        there.settimeout(10)
        one = Supervisor({"NOTIFY_SOCKET": place, "WATCHDOG_USEC": "60000000"})
        assert one.every == 30.0
        one.ready("watching")
        one.alive()
        for _ in range(1000):
            one.alive()  # not again before the half of a minute is over
        one.ending()
        assert [there.recv(1000) for _ in range(3)] == [b"READY=1\nSTATUS=watching", b"WATCHDOG=1", b"STOPPING=1"]
        there.setblocking(False)
        with pytest.raises(BlockingIOError):
            there.recv(1000)


@pytest.mark.parametrize("environment", [{}, {"NOTIFY_SOCKET": "/nowhere/at/all"}, {"WATCHDOG_USEC": "often"}])
def test_where_nobody_listens_nothing_happens(environment: dict[str, str]) -> None:
    one = Supervisor(environment)
    one.ready("watching")
    one.alive()
    one.ending()
    assert one.every is None


@pytest.mark.parametrize("unit", UNITS, ids=lambda path: path.stem)
def test_the_units_are_as_systemd_wants_them(unit: Path, tmp_path: Path) -> None:
    text = unit.read_text()
    for line in ("Type=notify", "WatchdogSec=60", "Restart=always", "TimeoutStopSec=10"):
        assert f"\n{line}\n" in text
    command = next(line for line in text.splitlines() if line.startswith("ExecStart=")).split()
    told = subprocess.run([sys.executable, "-m", "robophm", command[1], "--help"], capture_output=True, text=True,
                          timeout=60, check=True).stdout  # fmt: skip
    assert [word for word in command if word.startswith("--") and word not in told] == []
    if not (verify := shutil.which("systemd-analyze")):
        pytest.skip("no systemd-analyze")
    there = tmp_path / unit.name
    there.write_text(text.replace("/opt/robophm/bin/robophm", "/bin/true"))
    done = subprocess.run([verify, "verify", str(there)], capture_output=True, text=True, timeout=60, check=False)
    assert unit.name not in done.stderr, done.stderr
