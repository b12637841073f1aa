"""``robophm serve`` ends in order however often it is asked to: Ctrl+C again and again, while it ends too."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress

import pytest

from .conftest import OTA

EVERY = (0.001, 0.005, 0.02, 0.1)
"""Seconds between two times that it is asked."""


def interrupted(design, after, every):
    """How a service that watches ends, asked from so many seconds after it began."""
    words = ["serve", str(design), "--port", "0", "--synthetic", "--start", "synthetic", "--speed", "1000",
             "--store", str(design.with_suffix(".db"))]  # fmt: skip
    with subprocess.Popen(
        [sys.executable, "-m", "robophm", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as child:
        assert "is served at" in child.stdout.readline()
        time.sleep(after)
        until = time.monotonic() + 60
        while child.poll() is None and time.monotonic() < until:
            with suppress(ProcessLookupError):
                child.send_signal(signal.SIGINT)
            time.sleep(every)
        child.kill()
        return child.returncode, child.stderr.read()


@pytest.mark.skipif(os.name == "nt", reason="needs signals")
@pytest.mark.parametrize("times", [1, pytest.param(20, marks=pytest.mark.full)])
@pytest.mark.full
def test_ctrl_c_again_and_again_is_no_failure(tmp_path, times):
    design = tmp_path / "robot.yaml"
    design.write_bytes(OTA.read_bytes())
    for number in range(4 * times):
        assert interrupted(design, 0.1 * (number % 7), EVERY[number % 4]) == (0, "")


EARLY = """
import sys, time
from robophm.cli import main
from robophm.web import serving
made = serving.create_app
def slowly(settings):
    app = made(settings)  # its threads run from here on
    print("made", flush=True)
    time.sleep(1)
    return app
serving.create_app = slowly
sys.argv = ["robophm", "serve", "robot.yaml", "--port", "0"]
main()
"""


@pytest.mark.skipif(os.name == "nt", reason="needs signals")
def test_ctrl_c_before_it_serves_ends_it_in_order_too(tmp_path):
    (tmp_path / "robot.yaml").write_bytes(OTA.read_bytes())
    with subprocess.Popen(
        [sys.executable, "-c", EARLY], cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as child:
        assert child.stdout.readline() == "made\n"
        child.send_signal(signal.SIGINT)
        assert child.wait(60) == 0
        assert child.stderr.read() == ""


@pytest.mark.skipif(os.name == "nt", reason="needs signals")
def test_without_a_design_a_new_robot_of_this_folder_is_served(tmp_path):
    with subprocess.Popen(
        [sys.executable, "-m", "robophm", "serve", "--port", "0"], cwd=tmp_path, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    ) as child:  # fmt: skip
        assert child.stdout.readline().startswith("robot.yaml is served at http://127.0.0.1:")
        child.send_signal(signal.SIGINT)
        assert child.wait(60) == 0
        assert "the page begins a new robot" in child.stderr.read()
    assert not (tmp_path / "robot.yaml").exists()
