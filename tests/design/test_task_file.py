"""Task lists: what they may say, and one line with file, line and place for whatever is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from robophm.design.file import parse
from robophm.design.task import Leg, Task
from robophm.design.task_file import load_plan

from .task_files import DESIGN, FINE, HEAD, ROBOT, table, yaml


def test_a_list_may_fill_its_period() -> None:
    """Three of 0.05 h are more than 0.15 h, in the last digit of their sum."""
    plan = yaml(HEAD + "every: 9 min\ntasks:\n" + "  - {duration: 3 min}\n" * 3)
    assert plan.every is not None
    assert sum(task.duration for task in plan.tasks) > plan.every


def test_everything_that_a_task_list_may_say() -> None:
    plan = yaml("""schema_version: 1
every: 0.5 day
tasks:
  - name: fetch the crate
    legs:
      - {distance: 0.25 km, speed: 0.5 m/s, functions: [drive]}
      - {duration: 5 min, functions: [lift, drive], cycles: 40, starts: 1,
         stresses: {load: 0.8, Power/temperature: 318.15 K}}
  - {distance: 250 m, duration: 10 min}
  - {speed: 3.6 km/h, duration: 2 h}
knowledge:
  failed: ["Wheel[2]"]
  working: [Power, "Wheel[1]"]
""")
    fetch, drive, slow = plan.tasks
    assert fetch.name == "fetch the crate"
    first, second = fetch.legs
    assert (first.distance, first.functions, first.cycles) == (250.0, ("drive",), None)
    assert first.duration == pytest.approx(500 / 3600, rel=1e-15)
    assert (second.duration, second.distance) == (pytest.approx(1 / 12, rel=1e-15), 0.0)
    assert (second.functions, second.cycles, second.starts) == (("lift", "drive"), 40.0, 1.0)
    assert second.stresses == {"load": 0.8, "Power/temperature": pytest.approx(45.0)}
    assert (drive.duration, drive.distance) == (pytest.approx(1 / 6), 250.0)
    assert drive.legs == (Leg(drive.duration, 250.0),)
    assert (slow.duration, slow.distance) == (2.0, pytest.approx(7200.0))
    assert slow.legs == (Leg(2.0, slow.distance),)
    assert plan.every == 12.0
    assert plan.knowledge.failed == {"Wheel[2]"}
    assert plan.knowledge.working == {"Power/Battery", "Power/Fuse", "Wheel[1]"}


def test_a_table_says_the_same() -> None:
    text = """task, distance ,speed,duration,cycles,starts,functions,load,Power/temperature
fetch the crate,0.25 km,0.5 m/s,,,,drive,,
fetch the crate,,,5 min,40,1,lift;drive,0.8,45 degC
,250 m,,10 min,,,,,
,,3.6 km/h,2 h,,,,,
"""
    plan = table(text)
    same = yaml("""schema_version: 1
tasks:
  - name: fetch the crate
    legs:
      - {distance: 250 m, speed: 0.5 m/s, functions: [drive]}
      - {duration: 5 min, functions: [lift, drive], cycles: 40, starts: 1,
         stresses: {load: 0.8, Power/temperature: 45 degC}}
  - {distance: 250 m, duration: 10 min}
  - {speed: 3.6 km/h, duration: 2 h}
""")
    assert plan == same
    assert table(text.replace("\n", "\r\n")) == plan
    assert table(text.replace("\n", "\r")) == plan
    assert table(text + "\n\n") == plan


def test_rows_of_one_task_stand_one_after_another() -> None:
    plan = table("task,duration\na,1 h\na,2 h\nb,1 h\na,3 h\n,1 h\n,1 h\n")
    assert [(task.name, [leg.duration for leg in task.legs]) for task in plan.tasks] == [
        ("a", [1, 2]), ("b", [1]), ("a", [3]), ("", [1]), ("", [1])
    ]  # fmt: skip


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_files_with_marks_and_other_line_ends(tmp_path: Path, mark: bytes, ending: str) -> None:
    for name, text in (
        ("tasks.yaml", FINE),
        ("t.yml", FINE),
        ("t.csv", "duration\n1 h\n"),
        ("t.CSV", "duration\n1 h\n"),
    ):
        (tmp_path / name).write_bytes(mark + text.replace("\n", ending).encode())
        assert load_plan(tmp_path / name, ROBOT).tasks == (Task((Leg(1.0),)),)


def test_empty_columns_are_none() -> None:
    assert table("duration,,,pressure\n1 h,,,\n").tasks == (Task((Leg(1.0),)),)


def test_a_design_has_one_task_with_legs() -> None:
    task = parse(
        DESIGN + "task: {name: x, legs: [{duration: 1 h}, {distance: 1 km, duration: 2 h, functions: [drive]}]}\n"
    ).task
    assert task == Task((Leg(1.0), Leg(2.0, 1000.0, functions=("drive",))), "x")
    assert (task.duration, task.distance) == (3.0, 1000.0)
