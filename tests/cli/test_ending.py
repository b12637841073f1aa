"""What serves or watches ends within five seconds of SIGINT and SIGTERM, at whatever moment, and says no traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

OTA = Path(__file__).parents[2] / "examples" / "ota" / "robot.yaml"
COMMANDS = {
    "serve": ("serve", "robot.yaml", "--port", "0", "--synthetic", "--start", "synthetic", "--speed", "1000"),
    "watch": ("watch", "robot.yaml", "--via", "dds", "--store", "past.db", "--journal", "run.journal"),
    "fleet": ("fleet", "serve", "--store", "fleet.db", "--port", "0"),
}
LONGEST = 5.0

pytestmark = pytest.mark.skipif(os.name == "nt", reason="needs signals")

HEEDED = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # whoever runs the tests may have it ignored
"""
ASKED_WHILE = """
import os, sys
from robophm.cli import main
number, module, *sys.argv[1:] = sys.argv[1:]
class Asking:
    def find_spec(self, name, *_):
        if name == module:
            os.kill(os.getpid(), int(number))
sys.meta_path.insert(0, Asking())
main()
"""


@pytest.mark.parametrize(
    ("command", "number", "module"),
    [
        ("serve", signal.SIGINT, "typer"),
        ("serve", signal.SIGTERM, "uvicorn"),
        ("watch", signal.SIGINT, "rich.table"),  # whose own error was once made of it
        ("fleet", signal.SIGTERM, "robophm.fleet.serving"),
    ],
)
def test_while_it_is_imported(tmp_path: Path, command: str, number: signal.Signals, module: str) -> None:
    (tmp_path / "robot.yaml").write_bytes(OTA.read_bytes())
    words = [sys.executable, "-c", HEEDED + ASKED_WHILE, str(int(number)), module, *COMMANDS[command]]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (128 + number, "", "interrupted\n")


def test_what_is_ignored_from_the_start_is_while_it_is_imported(tmp_path: Path) -> None:
    """As SIGINT by a shell of what it starts in the background."""
    (tmp_path / "robot.yaml").write_bytes(OTA.read_bytes())
    ignoring = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n" + ASKED_WHILE
    words = [sys.executable, "-c", ignoring, str(int(signal.SIGINT)), "typer", "check", "robot.yaml"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr


FOR_EVER = """
import sys, time
from robophm.cli import main
from robophm.web import serving
def never(settings):
    print("began", flush=True)
    time.sleep(600)
serving.create_app = never
main()
"""


@pytest.mark.full
def test_though_it_never_gets_so_far_as_to_serve(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_bytes(OTA.read_bytes())
    words = [sys.executable, "-c", FOR_EVER, *COMMANDS["serve"]]
    with subprocess.Popen(words, cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as child:
        assert child.stdout
        assert child.stdout.readline() == "began\n"
        asked = time.monotonic()
        child.send_signal(signal.SIGINT)
        _, said = child.communicate(timeout=60)
        assert time.monotonic() - asked < LONGEST
        assert (child.returncode, said) == (130, "interrupted\n")


def ended(command: str, after: float, number: signal.Signals) -> tuple[int, float, str]:
    """How a command ends that is asked so many seconds after it was started: code, seconds, what it said."""
    with tempfile.TemporaryDirectory() as folder, (Path(folder) / "said").open("w+") as said:
        (Path(folder) / "robot.yaml").write_bytes(OTA.read_bytes())
        child = subprocess.Popen(
            [sys.executable, "-m", "robophm", *COMMANDS[command]], cwd=folder, stdout=said, stderr=said
        )
        time.sleep(after)
        asked = time.monotonic()
        child.send_signal(number)
        try:
            child.wait(60)
        finally:
            child.kill()
        took = time.monotonic() - asked
        said.seek(0)
        return child.returncode, took, said.read()


@pytest.mark.full
@pytest.mark.parametrize("command", COMMANDS)
def test_every_twentieth_of_a_second(command: str) -> None:
    """But for the first three tenths, in which Python itself begins, and ends as it does."""
    moments = [(step / 20, number) for step in range(6, 101) for number in (signal.SIGINT, signal.SIGTERM)]
    with ThreadPoolExecutor(2) as two:
        found = list(two.map(lambda moment: (moment, *ended(command, *moment)), moments))
    wrong = [
        one for one in found
        if one[1] not in (0, 128 + one[0][1]) or one[2] > LONGEST or "Traceback" in one[3] or "error" in one[3]
    ]  # fmt: skip
    assert wrong == []
    assert {one[1] for one in found} == {0, 130, 143}, "some while it began, some while it worked"
