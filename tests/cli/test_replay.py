"""Replay from the command line: what is kept, and that bad inputs leave nothing behind."""

import json
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

from robophm.cli import BREACHED, INTERRUPTED, INVALID, OK
from robophm.core.signal import HOUR
from robophm.transports.synthetic import SyntheticOta


def edited(design, old, new):
    text = design.read_text()
    assert old in text
    design.write_text(text.replace(old, new))


def test_a_recording_is_counted_once(inside, design, recording, tmp_path):
    first = inside("replay", design, recording, "--store", "past.db", "--report", "page.html", "--json")
    assert (first.returncode, first.stderr) == (OK, "")
    health = json.loads(first.stdout)
    assert health["clocks"]["operating"] == pytest.approx(599 / 3600, rel=1e-3)
    assert (tmp_path / "page.html").read_text().startswith("<!doctype html>")
    again = inside("replay", design, recording, "--store", "past.db", "--json")
    assert again.stderr == "warning: this recording is already in past.db; it is not counted again\n"
    assert json.loads(again.stdout)["clocks"] == health["clocks"]
    predicted = json.loads(inside("predict", design, "--store", "past.db", "--json").stdout)
    assert predicted["clocks"] == health["clocks"]
    assert predicted["subjects"] == health["subjects"]


def test_the_table_says_what_the_document_says(inside, design, recording):
    shown = inside("replay", design, recording, "--unit", "FIT")
    assert (shown.returncode, shown.stderr) == (OK, "")
    assert shown.stdout.startswith("Health of OTA")
    assert "543,700 FIT" in shown.stdout  # nominal, Σ quantity · rate of the paper's table
    assert "Observed: " in shown.stdout
    assert "\x1b" not in shown.stdout


POWER = "/ota/power/temperature, field: temperature"
BAD = {
    "topic": (
        POWER,
        POWER.replace("power", "pover"),
        "the recording has no topic '/ota/pover/temperature'; did you mean",
    ),
    "field": (
        POWER,
        POWER.replace("field: temperature", "field: temprature"),
        "topic '/ota/power/temperature' (sensor_msgs/msg/Temperature) has no number 'temprature'; did you mean",
    ),
    "message": (
        POWER,
        "/ota/battery, field: voltage",
        "topic '/ota/battery' (sensor_msgs/msg/BatteryState): voltage is in 'V'; the design expects 'degC'",
    ),
}


@pytest.mark.parametrize(("old", "new", "says"), BAD.values(), ids=BAD.keys())
def test_a_recording_that_does_not_fit_the_design(inside, design, recording, tmp_path, old, new, says):
    edited(design, old, new)
    done = inside("replay", design, recording, "--store", "past.db", "--report", "page.html")
    assert (done.returncode, done.stdout) == (INVALID, "")
    assert done.stderr.startswith("error: ")
    assert says in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == [design]


def test_what_is_missing_may_be_skipped(run, design, recording):
    edited(design, "/ota/power/temperature", "/ota/pover/temperature")
    done = run("replay", design, recording, "--skip-missing")
    assert done.returncode == OK
    assert "stale /ota/pover/temperature.temperature" in done.stdout
    assert "rests on silence since the beginning of /ota/pover/temperature.temperature" in " ".join(done.stdout.split())


GARBAGE = {
    **{f"empty{suffix}": b"" for suffix in (".bag", ".mcap", ".db3", ".csv", ".journal")},
    **{
        f"garbage{suffix}": bytes(range(255, -1, -1)) * 10
        for suffix in (".bag", ".mcap", ".db3", ".csv", ".journal", ".txt")
    },
}


@pytest.mark.parametrize("name", [*GARBAGE, "missing.mcap", "folder", "/dev/null"])
def test_no_recording_at_all(inside, design, tmp_path, name):
    if name in GARBAGE:
        (tmp_path / name).write_bytes(GARBAGE[name])
    elif name == "folder":
        (tmp_path / name).mkdir()
    before = sorted(tmp_path.iterdir())
    done = inside("replay", design, name, "--store", "past.db", "--report", "page.html")
    assert (done.returncode, done.stdout) == (INVALID, "")
    assert done.stderr.startswith("error: ")
    assert len(done.stderr.splitlines()) == 1
    assert sorted(tmp_path.iterdir()) == before


def test_a_store_is_not_changed_by_a_bad_recording(inside, design, recording, tmp_path):
    inside("replay", design, recording, "--store", "past.db")
    before = (tmp_path / "past.db").read_bytes()
    (tmp_path / "bad.mcap").write_bytes(b"garbage")
    assert inside("replay", design, "bad.mcap", "--store", "past.db").returncode == INVALID
    assert (tmp_path / "past.db").read_bytes() == before


def test_a_store_that_is_none(inside, design, recording, tmp_path):
    (tmp_path / "text.db").write_text("hello " * 1000)
    with closing(sqlite3.connect(tmp_path / "other.db")) as other, other:
        other.execute("CREATE TABLE theirs (x)")
    other.close()
    for name, says in (
        ("text.db", "text.db: file is not a database"),
        ("other.db", "other.db: not a robophm store of version 4"),
        (".", "unable to open database file"),
        ("no/folder/past.db", "unable to open database file"),
    ):
        before = (tmp_path / name).read_bytes() if (tmp_path / name).is_file() else None
        done = inside("replay", design, recording, "--store", name, "--report", "page.html")
        assert (done.returncode, done.stdout) == (INVALID, "")
        assert says in done.stderr
        assert len(done.stderr.splitlines()) == 1
        assert before is None or (tmp_path / name).read_bytes() == before
    assert {path.name for path in tmp_path.iterdir()} == {"robot.yaml", "text.db", "other.db"}


@pytest.mark.parametrize("place", ["no/page.html", ".", "robot.yaml", "day.mcap", "past.db"])
def test_a_report_that_cannot_be_is_refused_before_anything_is_counted(inside, design, recording, tmp_path, place):
    shutil.copy(recording, tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    done = inside("replay", design, "day.mcap", "--store", "past.db", "--report", place)
    assert (done.returncode, done.stdout) == (INVALID, "")
    assert done.stderr.startswith(f"error: {place}: ")
    assert len(done.stderr.splitlines()) == 1
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_paths_with_blanks_letters_and_line_breaks(run, design, recording, tmp_path):
    folder = tmp_path / "my röbot 🤖"
    folder.mkdir()
    odd = folder / "a b\n'\".mcap"
    shutil.copy(recording, odd)
    design = Path(shutil.copy(design, folder / "[robot].yaml"))
    done = run("replay", design, odd, "--store", folder / "pa st.db", "--report", folder / "[b]päge.html")
    assert (done.returncode, done.stderr) == (OK, "")
    assert "[b]päge.html" in done.stdout.replace("\n", "")
    assert {path.suffix for path in folder.iterdir()} == {".mcap", ".yaml", ".db", ".good", ".html"}


def test_breached_and_still_kept(inside, design, recording, tmp_path):
    edited(design, "completion: 0.99", "hazard_rate: 1 FIT")
    done = inside("replay", design, recording, "--store", "past.db")
    assert done.returncode == BREACHED
    assert inside("predict", design, "--store", "past.db").returncode == BREACHED


SLOW = """
import signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)
import robophm.monitoring.replay as replaying
replaying.SAVE_EVERY = -1.0
follow = replaying.ReportHistory.follow
def slow(*arguments):
    print("tick", flush=True)
    time.sleep(0.2)
    return follow(*arguments)
replaying.ReportHistory.follow = slow
from robophm.cli import main
main()
"""


@pytest.mark.full
def test_an_interrupted_replay_goes_on_where_it_was(run, design, tmp_path):
    recording = SyntheticOta(seed=1, duration=2 * HOUR).record(tmp_path / "drive.mcap")
    words = ["replay", str(design), str(recording), "--store", "past.db", "--json"]
    with subprocess.Popen([sys.executable, "-c", SLOW, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, cwd=tmp_path) as child:  # fmt: skip
        for _ in range(4):
            assert child.stdout.readline() == "tick\n"
        child.send_signal(signal.SIGINT)
        rest, said = child.communicate(timeout=30)
    assert child.returncode == INTERRUPTED
    assert said == "interrupted\n"
    assert "{" not in rest
    with closing(sqlite3.connect(tmp_path / "past.db")) as store, store:
        assert store.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        position, complete = store.execute("SELECT position, complete FROM progress").fetchone()
    store.close()
    assert position > 0
    assert not complete
    resumed = run(*words)
    assert resumed.returncode == OK
    assert resumed.stdout == run("replay", design, recording, "--json").stdout


@pytest.fixture
def theirs(tmp_path):
    """Another package, installed: the store of the recipe, under the name of theirs."""
    recipe = (Path(__file__).parents[2] / "docs/guides/extending.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"stores/jsonl\.py\*\*\n\n```python\n(.*?)^```", recipe, re.MULTILINE | re.DOTALL)
    (tmp_path / "their_recipe.py").write_text(text)
    about = tmp_path / "their_recipe-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: their-recipe\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[robophm.stores]\ntheirs = their_recipe\n")
    with pytest.MonkeyPatch.context() as patched:
        patched.syspath_prepend(str(tmp_path))
        yield "theirs:past.txt"


def test_a_store_is_opened_by_its_kind_and_place(inside, design, recording, tmp_path, theirs):
    """With every command that makes a store, goes on from one, or looks after it."""
    store = ("--store", theirs)
    health = json.loads(inside("replay", design, recording, *store, "--json").stdout)
    assert (tmp_path / "past.txt").read_text().startswith('["OTA", ')
    again = json.loads(inside("replay", design, recording, *store, "--json").stdout)
    assert again["clocks"] == health["clocks"]
    assert json.loads(inside("predict", design, *store, "--json").stdout)["clocks"] == health["clocks"]
    served = inside("service", design, "Power/Battery Control Board/Thermistor", *store, "--replaced")
    assert served.returncode == OK, served.stderr
    assert inside("report", design, *store, "--to", "page.html").returncode == OK
    assert inside("learn", design, theirs).returncode == OK
    repaired = inside("store", "repair", design, *store)
    assert (repaired.returncode, "no clock jumped" in repaired.stdout) == (OK, True), repaired
    assert not (tmp_path / theirs).exists()


def test_what_is_no_store_is_said_before_anything_is_written(inside, design, tmp_path):
    assert (
        "page.html: is read or kept by this"
        in inside("report", design, "--store", "sqlite:page.html", "--to", "page.html").stderr
    )
    assert "expected the path of a store" in inside("predict", design, "--store", "").stderr
    assert inside("predict", design, "--store", f"sqlite:{design}").stderr.startswith(f"error: {design}: ")
    assert {path.name for path in tmp_path.iterdir()} == {"robot.yaml"}
