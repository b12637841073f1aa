"""What a supervisor is told, heard on a socket as systemd has one; and the units that are for it."""

from __future__ import annotations

import re
import shlex
import shutil
import socket
import subprocess
import sys
from itertools import takewhile
from pathlib import Path

import pytest

from robophm.core.supervisor import Supervisor

UNITS = sorted((Path(__file__).parents[2] / "systemd").iterdir())

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


@pytest.mark.parametrize("unit", UNITS, ids=lambda path: path.name)
def test_the_units_are_as_systemd_wants_them(unit: Path, tmp_path: Path) -> None:
    text = unit.read_text()
    if "\nType=notify\n" in text:
        for line in ("WatchdogSec=60", "Restart=always", "TimeoutStopSec=10"):
            assert f"\n{line}\n" in text
    for command in commands_of(text):
        named = list(takewhile(lambda word: not word.startswith("-") and "." not in word and "$" not in word, command))
        told = subprocess.run([sys.executable, "-m", "robophm", *named, "--help"], capture_output=True, text=True,
                              timeout=60, check=True).stdout  # fmt: skip
        assert [word for word in command if word.startswith("--") and word not in told] == []
    if not (verify := shutil.which("systemd-analyze")):
        pytest.skip("no systemd-analyze")
    there = tmp_path / unit.name
    for one in UNITS:  # a timer wants its service
        (tmp_path / one.name).write_text(one.read_text().replace("/opt/robophm/bin/robophm", "/bin/true"))
    done = subprocess.run([verify, "verify", str(there)], capture_output=True, text=True, timeout=60, check=False)
    assert unit.name not in done.stderr, done.stderr


def commands_of(unit: str) -> list[list[str]]:
    """The commands of robophm that a unit runs, without the program itself."""
    found = re.findall(r"/opt/robophm/bin/robophm ([^;|\n]*)", unit.replace("\\\n", " "))
    return [shlex.split(one) for one in found]


def test_what_is_done_each_night_goes_on_past_what_fails(tmp_path: Path) -> None:
    """As systemd runs it: a design of which nobody has reported is told of, the next is not left out, nor the days."""
    unit = next(one for one in UNITS if one.name == "robophm-fleet-nightly.service").read_text()
    script = re.search(r"ExecStart=/bin/sh -c '(.*)'", unit.replace("\\\n", " "))
    assert script
    program = f"{shlex.quote(sys.executable)} -m robophm"
    (tmp_path / "designs").mkdir()
    for name in ("one", "other"):
        design = f"schema_version: 1\nname: {name}\ncomponents: {{motor: {{rate: 1 FPMH}}}}\n"
        (tmp_path / "designs" / f"{name}.yaml").write_text(design)
    token = ["robophm", "fleet", "token", "r1", "--store", "fleet.db"]
    subprocess.run([sys.executable, "-m", *token], cwd=tmp_path, capture_output=True, timeout=60, check=True)
    done = subprocess.run(
        ["/bin/sh", "-c", script[1].replace("$$", "$").replace("/opt/robophm/bin/robophm", program)],
        cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    for name in ("one", "other"):
        assert f"no robot of {name} has sent a ledger" in done.stderr
    assert "history, no new day" in done.stdout
    assert done.returncode == 1
