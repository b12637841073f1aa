"""Others of its kind, named in the design, teach every face what they teach when they are given in Python."""

import json

import numpy as np
import pytest

from robophm.core.errors import DataError, DesignError
from robophm.core.signal import SECOND, Sample
from robophm.design.file import load, parse, rewrite
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.teachers import teachers_of
from robophm.learning.wear.worn_mode import WearOptions, worn_mode_of_table
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.monitoring.seen_wear import seen_wear
from robophm.monitoring.wear_from_recordings import wear_history, worn_in, worn_modes
from robophm.monitoring.wear_watch import WearWatch
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.journal import Journal

DESIGN = """
schema_version: 1
name: cart
components:
  motor: {rate: 20 FPMH, wear: {topic: /motor, field: current, every: 240 s, threshold: 6, teachers: motors.csv}}
"""
START = 1_700_000_040 * SECOND
TASK = "schema_version: 1\ntasks: [{duration: 1 h}]\n"
UNITS = [
    Unit(hours := np.arange(0, end + 0.2, 0.1), 3.8 + 2.2 * hours / end) for end in (1.6, 2.0, 2.4)
]  # fmt: skip


@pytest.fixture
def design(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(DESIGN)
    rows = [f"{k},{t},{y}\n" for k, unit in enumerate(UNITS) for t, y in zip(unit.times, unit.values, strict=True)]
    (tmp_path / "motors.csv").write_text("unit,time [h],value\n" + "".join(rows))
    return path


@pytest.fixture
def journal(tmp_path):
    """Three quarters of an hour in which the current rises by a third of what it may."""
    rng, path = np.random.default_rng(4), tmp_path / "run.journal"
    with Journal(path, ["/motor.current"]) as kept:
        for i in range(0, 2700, 5):
            kept.write(Sample(START + i * SECOND, "/motor.current", 3.8 + i / 3600 + 0.1 * rng.standard_normal()))
    return path


def test_every_face_is_taught_alike(design, journal, tmp_path, inside):
    robot = load(design)
    history = wear_history(robot, journal, worn_modes(robot))
    ledger = history.monitor.exposure.settled(history.monitor.ledger)
    (expected,) = seen_wear(robot, ledger, {"motor": UNITS})
    (alone,) = seen_wear(robot, ledger, {})
    assert expected.late - expected.early < 0.7 * (alone.late - alone.early)
    life = expected.early, expected.median, expected.late
    assert worn_in(history, worn_modes(robot), WearOptions(changes=False))[0][0].wear.remaining == life
    with SqliteStore(tmp_path / "store.db") as store:
        seen = [
            *replay(robot, journal, store=store).wear,
            *WearWatch(robot).renewed(ledger),
            *history.monitor.report().wear,
        ]
    assert [(one.early, one.median, one.late) for one in seen] == [life] * 3
    (tmp_path / "tasks.yaml").write_text(TASK)
    said = json.loads(inside("task", design, "tasks.yaml", "--store", "store.db", "--json").stdout)
    assert said["wear"][0]["median"] == expected.median


def test_a_table_of_readings_is_taught_by_the_same(design, tmp_path):
    (tmp_path / "mine.csv").write_text("time [h],value\n" + "".join(f"{k / 10},{3.8 + k / 10}\n" for k in range(8)))
    robot = load(design)
    by_design = worn_mode_of_table(robot, tmp_path / "mine.csv", "motor")
    assert by_design.wear.remaining == worn_mode_of_table(robot, tmp_path / "mine.csv", "motor",
                                                          fleet=tmp_path / "motors.csv").wear.remaining  # fmt: skip
    assert by_design.wear.weights["others from here"] > 0


def test_a_table_that_is_missing_or_none_is_refused_with_its_place(design, tmp_path, inside):
    assert inside("check", design).returncode == 0
    (tmp_path / "motors.csv").write_text("unit,time [h],value\na,1,x\n")
    assert "motors.csv:2: value: 'x' is no number" in inside("check", design).stderr
    (tmp_path / "motors.csv").unlink()
    missing = inside("check", design)
    assert missing.returncode == 3
    assert "its teachers" in missing.stderr
    with pytest.raises(DataError, match="'motor': its teachers"):
        Monitor(load(design)).report()
    with pytest.raises(DesignError, match="teachers"):  # only beside the design
        parse(DESIGN.replace("motors.csv", "../motors.csv"))


def test_a_table_that_changed_is_read_anew_also_beside_a_design_under_edit(design, tmp_path):
    assert len(teachers_of(load(design))["motor"]) == len(UNITS)
    with (tmp_path / "motors.csv").open("a") as table:
        table.write("more,0,3.8\nmore,3,6.1\n")
    robot = rewrite(design, DESIGN.replace("20 FPMH", "30 FPMH"))
    assert len(teachers_of(robot)["motor"]) == len(UNITS) + 1
