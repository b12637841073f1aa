"""Many robots replayed at once: each as alone, each recording once, whatever ends it; nobody's recording is guessed."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tests.fleet.conftest import wait_for
from typer.testing import CliRunner

import robophm
from robophm.cli.app import app
from robophm.core.errors import RobophmError
from robophm.fleet.recorded import recorded_robots
from robophm.parts import completed
from robophm.simulation.fleet import simulate
from robophm.stores.sqlite import SqliteStore

DESIGN = Path(__file__).parents[2] / "examples" / "fleet" / "robot.yaml"


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """The recordings of three robots, a folder each; the first has three, named against the order of their time."""
    folder = tmp_path_factory.mktemp("recorded")
    simulate(DESIGN, folder / "fleet", 3, 4, 7, library=completed)
    for path in (folder / "fleet" / "recordings").iterdir():
        (own := folder / "recordings" / path.stem).mkdir(parents=True)
        head, *rows = path.read_text().splitlines()
        parts = 3 if path.stem == "robot-1" else 1
        for at in range(parts):
            some = rows[at * len(rows) // parts : (at + 1) * len(rows) // parts]
            (own / f"{9 - at}.csv").write_text("\n".join([head, *some, ""]))
    return folder / "recordings"


def alone(recordings, folder):
    """The health and the ledger of each robot, replayed by itself."""
    found = {}
    for robot in sorted(recordings.iterdir()):
        with SqliteStore(folder / f"{robot.name}-alone.db") as store:
            health = robophm.replay(robophm.load(DESIGN), [*robot.iterdir()], store=store)
            found[robot.name] = json.loads(json.dumps(health.to_json())), store.ledger(store_identity())
    return found


def store_identity():
    return robophm.load(DESIGN).identity


def ledgers(stores):
    found = {}
    for path in sorted(stores.glob("*.db")):
        with SqliteStore(path) as store:
            found[path.stem] = store.ledger(store_identity())
    return found


def test_each_is_as_alone_and_what_is_no_recording_is_named(recordings, tmp_path):
    shutil.copytree(recordings, tmp_path / "recordings")
    (tmp_path / "recordings" / "lost").mkdir()
    (tmp_path / "recordings" / "lost" / "9.csv").write_text("no recording")
    expected = alone(recordings, tmp_path)
    said = asked(
        "fleet", "replay", DESIGN, tmp_path / "recordings", "--stores", tmp_path / "stores", "--jobs", 2, code=1
    )
    assert [one["robot"] for one in said] == ["lost", "robot-1", "robot-2", "robot-3"]
    assert said[0]["health"] is None
    assert "9.csv" in said[0]["error"]
    assert {one["robot"]: one["health"] for one in said[1:]} == {name: health for name, (health, _) in expected.items()}
    assert ledgers(tmp_path / "stores") == {name: ledger for name, (_, ledger) in expected.items()}


def asked(*words, code=0):
    done = CliRunner().invoke(app, [*map(str, words), "--json"])
    assert bool(done.exit_code) == bool(code), done.output
    return json.loads(done.stdout)["robots"]


@pytest.mark.full
def test_what_was_killed_goes_on_and_leaves_no_process_behind(recordings, tmp_path):
    words = ["fleet", "replay", str(DESIGN), str(recordings), "--stores", str(tmp_path / "stores"), "--jobs", "2"]
    with subprocess.Popen(
        [sys.executable, "-m", "robophm", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as child:
        wait_for(lambda: child.poll() is not None or [*(tmp_path / "stores").glob("*.db")])
        children = Path(f"/proc/{child.pid}/task/{child.pid}/children").read_text().split()
        assert children
        child.kill()
    wait_for(lambda: not any(Path(f"/proc/{pid}").exists() for pid in children))
    kept = {name: ledger for name, (_, ledger) in alone(recordings, tmp_path).items()}
    for again in range(2):  # what is done is not counted again
        asked(*words)
        assert ledgers(tmp_path / "stores") == kept, again


@pytest.mark.parametrize(
    ("there", "expected"),
    [
        (["r/designs/a.yaml", "r/recordings/a/1.csv", "r/recordings/b/1.csv"], "recordings/b: there is no b.yaml"),
        (["r/designs/a.yaml", "r/recordings/a/1.csv", "r/recordings/a.csv"], "is of 'a' too"),
        (["r/designs", "r/recordings/1.csv"], "whose recording it is is not known"),
        (["r/designs", "r/recordings/bag/metadata.yaml"], "whose recording it is is not known"),
        (["r/designs/a.yaml"], "expected a folder"),
        (["r/designs/a.yaml", "r/recordings/.hidden"], "is empty"),
    ],
)
def test_nobodys_recording_is_guessed(tmp_path, there, expected):
    for path in there:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).touch()
    with pytest.raises(RobophmError, match=expected):
        recorded_robots(tmp_path / "r" / "designs", tmp_path / "r" / "recordings")


def test_a_file_or_bag_named_as_a_design_is_that_robots(tmp_path):
    for path in ("designs/a.yaml", "designs/b.yml", "recordings/a.mcap", "recordings/b/metadata.yaml"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).touch()
    found = recorded_robots(tmp_path / "designs", tmp_path / "recordings")
    assert [(one.name, one.design.name, [path.name for path in one.recordings]) for one in found] == [
        ("a", "a.yaml", ["a.mcap"]),
        ("b", "b.yml", ["b"]),
    ]
