"""``robophm serve`` ends in order however often it is asked to: Ctrl+C again and again, while it ends too."""

import http.client
import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import closing, suppress

import pytest

from robophm.stores import open_store
from robophm.transports.recordings.journal import JournalRecording

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
def test_ctrl_c_before_it_serves_ends_it_at_once(tmp_path):
    (tmp_path / "robot.yaml").write_bytes(OTA.read_bytes())
    with subprocess.Popen(
        [sys.executable, "-c", EARLY], cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as child:
        assert child.stdout.readline() == "made\n"
        child.send_signal(signal.SIGINT)
        assert child.wait(60) == 130
        assert child.stderr.read() == "interrupted\n"


def test_without_a_design_a_new_robot_of_this_folder_is_served(tmp_path, printed):
    lines, warned = printed(tmp_path)
    assert lines[0].startswith("robot.yaml is served at http://127.0.0.1:")
    assert "the page begins a new robot" in warned
    assert not (tmp_path / "robot.yaml").exists()


FOR_EVER = """
import sys, threading
from robophm.cli import main
from robophm.web.routes import supervision
@supervision.router.get("/for-ever")
def for_ever():
    print("asked", flush=True)
    threading.Event().wait()
sys.argv = ["robophm", "serve", *sys.argv[1:]]
main()
"""


def asked(port, method, path, body=None):
    """Ask in a thread of its own; a list that gets the status of the answer, or None where there is none."""
    found = []

    def ask():
        try:
            with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=120)) as connection:
                connection.request(method, path, body, {"Content-Type": "application/json"})
                answer = connection.getresponse()
                found.append(answer.status)
                answer.read()
        except (OSError, http.client.HTTPException):
            found.append(None)

    thread = threading.Thread(target=ask, daemon=True)
    thread.start()
    return thread, found


def started(folder, *words):
    """A service of a folder with a robot that it watches, and its port."""
    (folder / "robot.yaml").write_bytes(OTA.read_bytes())
    more = ["robot.yaml", "--port", "0", "--synthetic", "--start", "synthetic", "--speed", "1000",
            "--store", "past.db", "--journal", "run.journal"]  # fmt: skip
    child = subprocess.Popen(
        [sys.executable, *words, *more], cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    return child, int(child.stdout.readline().partition("127.0.0.1:")[2].partition("/")[0])


@pytest.mark.skipif(os.name == "nt", reason="needs signals")
@pytest.mark.full
def test_sigterm_ends_it_though_a_request_never_does(tmp_path):
    child, port = started(tmp_path, "-c", FOR_EVER)
    with child:
        threads = [asked(port, "GET", "/for-ever") for _ in range(3)]
        while child.stdout.readline() != "asked\n":
            pass
        while (tmp_path / "run.journal").stat().st_size < 10_000:
            time.sleep(0.01)
        child.send_signal(signal.SIGTERM)
        assert child.wait(60) == 0  # alone after four seconds; before, never
        said = child.stderr.read()
        assert "ended while requests were still computed" in said
        assert "Traceback" not in said
    for thread, found in threads:
        thread.join(60)
        assert found[0] in (None, 503)
    journal = JournalRecording(tmp_path / "run.journal")
    *_, last = journal.samples(journal.signals)
    with open_store(tmp_path / "past.db") as store:
        assert store.ledger(store.robots()[0])["newest"] == last.time, "all that was heard was kept"


@pytest.mark.full
@pytest.mark.skipif(os.name == "nt", reason="needs signals")
def test_sigterm_ends_it_within_seconds_when_much_is_asked_of_it(tmp_path):
    """Texts of 100,000 parts, and curves and importances by the dozen: over a minute of computing, alone."""
    text = "schema_version: 1\nname: R\ncomponents:\n" + "".join(f"  p{i}: {{rate: 1e-9 /h}}\n" for i in range(100_000))
    child, port = started(tmp_path, "-m", "robophm", "serve")
    with child:
        threads = [asked(port, "POST", "/api/design/check", json.dumps({"text": text})) for _ in range(3)]
        threads += [asked(port, "GET", "/api/analysis/importance") for _ in range(20)]
        threads += [asked(port, "GET", f"/api/analysis/curves?points=1000&horizon={i}000") for i in range(1, 60)]
        while not any(found for _, found in threads):
            time.sleep(0.01)
        child.send_signal(signal.SIGTERM)
        begun = time.monotonic()
        assert child.wait(60) == 0
        print(f"ended after {time.monotonic() - begun:.1f} s")
    for thread, _ in threads:
        thread.join(60)
