"""Which plan a task was done by, and by a robot with which past."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.design.file import parse
from robophm.monitoring.task_history import judge_tasks
from robophm.transports.recordings.opening import open_source
from robophm.transports.tasks import DoneLeg, DoneTask, PlannedLeg, PlannedTask

START = 1_700_000_000
ROBOT = "{schema_version: 1, name: R, components: {a: {rate: 1e-3 /h}}, powered: {topic: /power, field: data}}"


@pytest.mark.parametrize("next_plan", [0, 50, 99])
def test_the_next_plan_may_come_while_a_task_is_under_way(next_plan: int, tmp_path: Path) -> None:
    """100 m in 100 s, planned at 0 s, and then 300 m in 300 s."""
    recording = tmp_path / "run.csv"
    recording.write_text("time,/power.data\n" + "".join(f"{START + i},1\n" for i in range(401)))
    plans = [(0, 100.0), (next_plan, 300.0)]
    done = [(0, 100, 100.0), (100, 400, 300.0)]
    told = [
        *(PlannedTask((START + at) * SECOND, "/r/plan", (PlannedLeg(metres, 1.0),)) for at, metres in plans),
        *(
            DoneTask(
                (START + begin) * SECOND, (START + end) * SECOND, "/r/done", (DoneLeg(metres, (end - begin) / 3600),)
            )
            for begin, end, metres in done
        ),
    ]
    with open_source(recording) as source:
        records, _ = judge_tasks(parse(ROBOT), source, told)
    found = [(one.planned.distance, one.done.distance) for one in records if one.planned and one.done]
    assert found == [(100.0, 100.0), (300.0, 300.0)]


def test_a_past_that_has_the_task_in_it_already_is_refused(tmp_path: Path) -> None:
    """A task of 10 min after 10 min: what a ledger of the whole hour says of it would be of another time."""
    recording = tmp_path / "run.csv"
    recording.write_text("time,/power.data\n" + "".join(f"{START + i},1\n" for i in range(3601)))
    told = [DoneTask((START + 600) * SECOND, (START + 1200) * SECOND, "/r/done", (DoneLeg(1.0, 1 / 6),))]
    robot = parse(ROBOT)
    with open_source(recording) as source:
        records, monitor = judge_tasks(robot, source, told)
        actual = records[0].actual
        assert actual is not None
        assert actual["sensor_based"].failure == pytest.approx(-math.expm1(-1e-3 / 6), rel=1e-12)
        lived = monitor.exposure.settled(monitor.ledger)
        with pytest.raises(SourceError, match="goes on for 3000 s beyond the first task's beginning"):
            judge_tasks(robot, source, told, ledger=lived)
