"""Task lists that are none are refused in one line: the file, the line, the place, what was expected."""

from __future__ import annotations

import os
import re
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import DesignError
from robophm.core.yaml_values import MAX_BYTES
from robophm.design.file import parse
from robophm.design.task import LONGEST_TASK, Plan
from robophm.design.task_file import load_plan, parse_plan

from .task_files import BARE, DESIGN, FINE, HEAD, ROBOT, table, yaml


def leg(text: str) -> str:
    """A second task on line 4."""
    return f"{FINE}  - {{{text}}}\n"


def stress(text: str) -> str:
    return leg(f"duration: 1 h, stresses: {{{text}}}")


def knows(text: str) -> str:
    return f"{FINE}knowledge:\n  {text}\n"


# name: (the list, the line of the fault, what the error says after it)
FAULTS = {
    "no version": ("tasks: [{duration: 1 h}]\n", 1, "schema_version: not stated; expected 1"),
    "another version": ("tasks: []\nschema_version: 2\n", 2, "schema_version: 2; expected 1"),
    "no tasks": (HEAD, 1, "needs 'tasks'"),
    "empty list": (HEAD + "tasks: []\n", 2, "tasks: is empty; expected at least one"),
    "tasks as mapping": (HEAD + "tasks: {a: 1}\n", 2, "tasks: expected a valid list"),
    "unknown key": (FINE + "evry: 1 h\n", 4, "evry: unknown key 'evry'; did you mean 'every'?"),
    "misspelt tasks": (HEAD + "taks: []\n", 2, "taks: unknown key 'taks'; did you mean 'tasks'?"),
    "unknown key of a leg": (
        leg("duratoin: 1 h"),
        4,
        "tasks/1/duratoin: unknown key 'duratoin'; did you mean 'duration'?",
    ),
    "unknown key of a leg among legs": (
        FINE + "  - legs:\n      - {duration: 1 h}\n      - {sped: 1 m/s}\n",
        6,
        "tasks/1/legs/1/sped: unknown key 'sped'; did you mean 'speed'?",
    ),
    "unknown key of a task": (
        FINE + "  - legs: [{duration: 1 h}]\n    naem: x\n",
        5,
        "tasks/1/naem: unknown key 'naem'; did you mean 'name'?",
    ),
    "legs and a leg": (
        leg("legs: [{duration: 1 h}], duration: 1 h"),
        4,
        "tasks/1/duration: unknown key 'duration'; known: legs, name",
    ),
    "no legs": (leg("legs: []"), 4, "tasks/1/legs: is empty; expected at least one"),
    "task of nothing": (FINE + "  -\n", 4, "tasks/1: expected keys with values, not None"),
    "task as text": (FINE + "  - drive\n", 4, "tasks/1: expected keys with values, not 'drive'"),
    "zero speed": (
        leg("distance: 5 m, speed: 0 m/s"),
        4,
        "tasks/1: expected a distance with a speed above zero, or a du",
    ),
    "vanishing speed": (
        leg("distance: 5 m, speed: 1e-320 m/s"),
        4,
        "tasks/1: 5 m at 9.99989e-321 m/s is not a finite d",
    ),
    "distance alone": (leg("distance: 5 m"), 4, "tasks/1: expected a distance with a speed above zero, or a duration"),
    "speed alone": (leg("speed: 5 m/s"), 4, "tasks/1: expected a distance with a speed above zero, or a duration"),
    "empty leg": (leg(""), 4, "tasks/1: expected a distance with a speed above zero, or a duration"),
    "all three": (
        leg("distance: 5 m, speed: 1 m/s, duration: 5 s"),
        4,
        "tasks/1: distance, speed and duration are given",
    ),
    "negative distance": (
        leg("distance: -5 m, speed: 1 m/s"),
        4,
        "tasks/1/distance: -5 m is too small; expected at least 0 m",
    ),
    "negative duration": (leg("duration: -5 s"), 4, "tasks/1/duration: -5 s is too small; expected at least 0 h"),
    "not a number": (leg("duration: .nan"), 4, "tasks/1/duration: nan is not a finite number"),
    "nan in words": (leg("duration: nan h"), 4, "tasks/1/duration: 'nan h' is not a number with a unit"),
    "infinite": (leg("duration: .inf"), 4, "tasks/1/duration: inf is not a finite number"),
    "overflowing": (leg("duration: 1e999 h"), 4, "tasks/1/duration: 1e999 is not a finite number"),
    "overflowing distance": (
        leg("distance: 1e999 m, speed: 1 m/s"),
        4,
        "tasks/1/distance: 1e999 is not a finite number",
    ),
    "wrong unit": (leg("duration: 5 m"), 4, "tasks/1/duration: unit 'm' does not measure what 'h' does"),
    "unknown unit": (leg("duration: 5 bananas"), 4, "tasks/1/duration: unknown unit 'bananas'"),
    "too long": (leg("duration: 1000001 h"), 4, f"tasks/1: 0 m in 1e+06 h; expected at most {LONGEST_TASK:g} h"),
    "too far": (leg("distance: 1e13 m, duration: 1 h"), 4, "tasks/1: 1e+13 m in 1 h; expected at most"),
    "legs too long": (
        FINE + "  - legs: [{duration: 7e5 h}, {duration: 7e5 h}]\n",
        4,
        "tasks/1/legs: take 1.4e+06 h in all; expected at most",
    ),
    "tasks too long": (FINE + "  - {duration: 1e6 h}\n", 2, "tasks: take 1e+06 h in all; expected at most 1e+06 h"),
    "negative cycles": (
        leg("duration: 1 h, cycles: -1"),
        4,
        "tasks/1/cycles: expected greater than or equal to 0, not -1",
    ),
    "nan cycles": (leg("duration: 1 h, cycles: .nan"), 4, "tasks/1/cycles: expected a finite number, not nan"),
    "endless cycles": (leg("duration: 1 h, starts: 1e999"), 4, "tasks/1/starts: expected a finite number, not inf"),
    "too many cycles": (leg("duration: 1 h, cycles: 1e16"), 4, "tasks/1/cycles: 1e+16 cycles; expected at most 1e+15"),
    "cycles true": (leg("duration: 1 h, cycles: true"), 4, "tasks/1/cycles: expected a number, not True"),
    "unknown function": (
        leg("duration: 1 h, functions: [lift, driv]"),
        4,
        "tasks/1/functions/1: no function 'driv'; did you mean 'drive'?",
    ),
    "function as text": (
        leg("duration: 1 h, functions: drive"),
        4,
        "tasks/1/functions: expected a valid list, not 'drive'",
    ),
    "function of nothing": (
        leg("duration: 1 h, functions: ['']"),
        4,
        "tasks/1/functions/0: String should have at least 1",
    ),
    "stress nobody takes": (
        stress("pressure: 3 bar"),
        4,
        "tasks/1/stresses/pressure: no part takes a stress 'pressure'; known: ",
    ),
    "misspelt stress": (
        stress("temperture: 3 degC"),
        4,
        "no part takes a stress 'temperture'; did you mean 'temperature'?",
    ),
    "stress not taken there": (
        stress("Power/load: 1"),
        4,
        "tasks/1/stresses/Power/load: no part below 'Power' takes a stress 'load'; known: Arm",
    ),
    "stress of an unknown part": (
        stress("Powr/temperature: 20 degC"),
        4,
        "no part below 'Powr' takes a stress 'temperature'; did you mean 'Power'?",
    ),
    "stress from the root": (
        stress("/temperature: 20 degC"),
        4,
        "no part below '' takes a stress 'temperature'; known: ",
    ),
    "stress without unit": (
        stress("temperature: 3"),
        4,
        "tasks/1/stresses/temperature: '3' has no unit; expected e.g. '3 degC'",
    ),
    "stress of another unit": (stress("temperature: 3 V"), 4, "unit 'V' does not measure what 'degC' does"),
    "stress out of range": (stress("temperature: 501 degC"), 4, "501 degC of Power/Battery is outside -100 … 500 degC"),
    "nan stress": (stress("load: .nan"), 4, "tasks/1/stresses/load: nan is not a finite number"),
    "overflowing stress": (stress("load: '1e999'"), 4, "tasks/1/stresses/load: 1e999 is not a finite number"),
    "unknown knowledge": (knows("fialed: [Arm]"), 5, "knowledge/fialed: unknown key 'fialed'; did you mean 'failed'?"),
    "unknown part": (
        knows("failed: [Arm,\n    Amr]"),
        6,
        "knowledge/failed/1: unknown part 'Amr'; did you mean 'Arm'?",
    ),
    "part that is not alone": (
        knows("failed: [Wheel]"),
        5,
        "knowledge/failed/0: 'Wheel' is 3 parts; expected Wheel[1] … [3]",
    ),
    "member that is not there": (
        knows("failed: ['Wheel[4]']"),
        5,
        "knowledge/failed/0: unknown part 'Wheel[4]'; known: Arm, Power/Battery, Power/Fuse, Wheel, Wheel[1]",
    ),
    "module that failed": (knows("failed: [Power]"), 5, "knowledge/failed/0: "),
    "contradiction": (
        knows("failed: [Arm]\n  working: [Arm]"),
        6,
        "knowledge/working: Arm is said to have failed and to work; expected either",
    ),
    "contradiction by a member": (
        knows("failed: ['Wheel[1]']\n  working: [Wheel]"),
        6,
        "knowledge/working: Wheel[1] is said to have failed",
    ),
    "contradiction by a module": (
        knows("failed: [Power/Fuse]\n  working: [Power]"),
        6,
        "knowledge/working: Power/Fuse is said to have failed",
    ),
    "begun anew too soon": (FINE + "every: 59 min\n", 4, "every: 0.983333 h is shorter than the tasks, which take 1 h"),
    "begun anew at once": (
        HEAD + "tasks: [{duration: 0 h}]\nevery: 0 h\n",
        3,
        "every: 0 h; expected above zero and at most",
    ),
    "begun anew never": (FINE + "every: 1e300 h\n", 4, "every: 1e+300 h; expected above zero and at most 1e+06 h"),
    "begun anew in words": (FINE + "every: day\n", 4, "every: 'day' is not a number with a unit"),
    "duplicate key": (leg("duration: 1 h, duration: 2 h"), 4, "tasks/1: duplicate name 'duration'"),
    "tag": (
        leg("duration: !!python/object/apply:os.system ['touch ran']"),
        4,
        "tasks/1/duration: tag 'tag:yaml.org,2002:python",
    ),
    "local tag": (leg("duration: !include ran"), 4, "tasks/1/duration: tag '!include' is not taken"),
    "code": (
        leg("duration: \"__import__('os').system('touch ran') h\""),
        4,
        "__import__('os').system('touch ran') h' is not a number",
    ),
    "arithmetic": (leg("duration: 9**9**9**9 h"), 4, "tasks/1/duration: '**9**9**9 h' is not a unit"),
    "not closed": (HEAD + "tasks: [{duration: 1 h}\n", 3, "is not YAML: expected ',' or ']'"),
    "two documents": (FINE + "---\n" + FINE, 4, "is not YAML: but found another document"),
    "itself inside": (HEAD + "tasks: &t [*t]\n", 2, "is nested too deeply; expected at most 100 levels"),
    "names with line breaks": (knows('failed: ["Ar\\nm"]'), 5, "knowledge/failed/0: unknown part 'Ar m'"),
}


def refused(read: Any, text: str, start: str) -> None:
    with pytest.raises(DesignError) as raised:
        read(text)
    said = str(raised.value)
    assert said.startswith(start)
    assert "\n" not in said
    assert len(said) < 1100


@pytest.fixture(autouse=True)
def nothing_is_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(os, "system", None)
    yield
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_of_a_task_file(fault: str) -> None:
    text, line, message = FAULTS[fault]
    with pytest.raises(DesignError) as raised:
        yaml(text)
    assert re.fullmatch(rf"tasks\.yaml:{line}: .*", str(raised.value))
    assert message in str(raised.value)


@pytest.mark.parametrize("text", ["", "\n", "5", "[]", "- duration: 1 h", "# nothing\n"])
def test_what_is_no_task_list(text: str) -> None:
    refused(yaml, text, "tasks.yaml: holds no list of tasks; expected a mapping that starts with 'schema_version: 1'")


@pytest.mark.full
def test_what_would_take_for_ever() -> None:
    letters = "abcdefghij"
    bomb = HEAD + "a: &a [1,1,1,1,1,1,1,1,1,1]\n"
    for one, other in pairwise(letters):
        bomb += f"{other}: &{other} [{','.join([f'*{one}'] * 10)}]\n"
    start = time.process_time()
    refused(yaml, bomb + "tasks: *j\n", "tasks.yaml:2: unfolds to more than 300,000 values")
    refused(
        yaml,
        HEAD + "tasks: " + "[" * 3000 + "]" * 3000,
        "tasks.yaml: is nested too deeply; expected at most 100 levels",
    )
    refused(yaml, HEAD + "tasks: " + "[" * 120 + "]" * 120, "tasks.yaml:2: is nested too deeply")
    refused(table, "duration\n" + "0 h\n" * 100_001, "tasks.csv:100002: more than 100,000 rows")
    refused(
        table,
        ",".join(f"c{i}" for i in range(200_000)) + "\nx\n",
        "tasks.csv:2: expected 200000 cells, as the header has",
    )
    assert time.process_time() - start < 20


@pytest.mark.parametrize("name", ["tasks.yaml", "tasks.csv"])
def test_files_that_cannot_be_read(tmp_path: Path, name: str) -> None:
    def load(path: Path) -> Plan:
        return load_plan(path, ROBOT)

    refused(load, tmp_path / name, f"{tmp_path / name}: no such file")  # type: ignore[arg-type]
    path = tmp_path / name
    with path.open("wb") as stream:
        stream.truncate(100_000_000)  # takes no room on disk
    refused(load, path, f"{path}: is more than {MAX_BYTES / 1e6:.0f} MB")  # type: ignore[arg-type]
    path.write_bytes(b"duration\n\xff\xfe h\n")
    refused(load, path, f"{path}: is not UTF-8 text (byte 9)")  # type: ignore[arg-type]
    path.unlink()
    path.mkdir()
    refused(load, path, f"{path}: cannot be read: Is a directory")  # type: ignore[arg-type]


def test_zero_bytes_are_no_text() -> None:
    refused(yaml, FINE + "\0", "tasks.yaml: is not YAML: unacceptable character #x0000")
    refused(table, "duration\n1 \0h\n", "tasks.csv:2: tasks/0/legs/0/duration: ")
    refused(table, "dura\0tion\n1 h\n", "tasks.csv:2: no column 'dura tion'; did you mean 'duration'?")


# name: (the table, the line of the fault, what the error says after it)
TABLES = {
    "empty": ("", 1, "holds no tasks; expected a header and a row for each leg"),
    "blank": ("\n\n", 1, "holds no tasks"),
    "header alone": ("task,duration\n", 1, "holds no tasks"),
    "duplicate column": ("duration,cycles,duration\n1 h,2,3 h\n", 1, "column 'duration' is there twice"),
    "duplicate column by space": ("duration, duration\n1 h,2 h\n", 1, "column 'duration' is there twice"),
    "too few cells": ("duration,cycles\n1 h,1\n1 h\n", 3, "expected 2 cells, as the header has"),
    "too many cells": ("duration,cycles\n1 h,1,1\n", 2, "expected 2 cells, as the header has"),
    "misspelt column": ("duratoin\n1 h\n", 2, "no column 'duratoin'; did you mean 'duration'?"),
    "column without name": ("duration,\n1 h,x\n", 2, "no column ''"),
    "other separator": ("duration;cycles\n1 h;3\n", 2, "no column 'duration;cycles'; did you mean 'duration'?"),
    "open quote": ('duration\n"1 h\n', 2, "is not a table: unexpected end of data"),
    "stray quote": ('duration,cycles\n"1 h"x,2\n', 2, "is not a table: ',' expected after '\"'"),
    "endless cell": ("duration\n" + "x" * 200_000 + "\n", 2, "is not a table: field larger than field limit"),
    "empty row": (
        "task,duration\na,1 h\n,\n",
        3,
        "tasks/1/legs/0: expected a distance with a speed above zero, or a du",
    ),
    "zero speed": (
        "distance,speed\n5 m,1 m/s\n5 m,0 m/s\n",
        3,
        "tasks/1/legs/0: expected a distance with a speed above",
    ),
    "negative": (
        "task,duration\na,1 h\na,-5 h\n",
        3,
        "tasks/0/legs/1/duration: -5 h is too small; expected at least 0 h",
    ),
    "words": ("duration\n1 h\nlong\n", 3, "tasks/1/legs/0/duration: 'long' is not a number with a unit"),
    "nan": ("duration\nnan h\n", 2, "tasks/0/legs/0/duration: 'nan h' is not a number with a unit"),
    "overflowing": ("duration\n1e999 h\n", 2, "tasks/0/legs/0/duration: 1e999 is not a finite number"),
    "cycles": (
        "duration,cycles\n1 h,1\n1 h,-3\n",
        3,
        "tasks/1/legs/0/cycles: expected greater than or equal to 0, not '-3'",
    ),
    "nan cycles": ("duration,cycles\n1 h,nan\n", 2, "tasks/0/legs/0/cycles: expected a finite number, not 'nan'"),
    "function": (
        "duration,functions\n1 h,lift\n1 h,lift;driv\n",
        3,
        "functions/1: no function 'driv'; did you mean 'drive'?",
    ),
    "stress": ("duration,pressure\n1 h,\n1 h,3 bar\n", 3, "no column 'pressure'; known: "),
    "stress not there": ("duration,Power/load\n1 h,3\n", 2, "no part below 'Power' takes a stress 'load'; known: Arm"),
    "stress out of range": (
        "duration,temperature\n1 h,3000 degC\n",
        2,
        "tasks/0/legs/0/stresses/temperature: 3000 degC of",
    ),
    "stress without unit": ("duration,temperature\n1 h,30\n", 2, "stresses/temperature: '30' has no unit"),
    "legs too long": ("task,duration\na,1 h\nb,7e5 h\nb,7e5 h\n", 3, "tasks/1/legs: take 1.4e+06 h in all"),
    "tasks too long": ("duration\n7e5 h\n7e5 h\n", 1, "tasks: take 1.4e+06 h in all"),
    "formula": ("duration\n=cmd|'/c calc'!A0\n", 2, "tasks/0/legs/0/duration: '=cmd|'/c calc'!A0' is not a number"),
    "after a cell of two lines": (
        'task,duration\n"a\nb",1 h\nc,x\n',
        4,
        "tasks/1/legs/0/duration: 'x' is not a number",
    ),
    "name of two lines": ('"dura\ntion"\n1 h\n', 3, "no column 'dura tion'; did you mean 'duration'?"),
}


@pytest.mark.parametrize("fault", TABLES)
def test_faults_of_a_table(fault: str) -> None:
    text, line, message = TABLES[fault]
    with pytest.raises(DesignError) as raised:
        table(text)
    assert re.fullmatch(rf"tasks\.csv:{line}: .*", str(raised.value))
    assert message in str(raised.value)


def test_a_design_without_functions_says_so() -> None:
    text = HEAD + "tasks: [{duration: 1 h, functions: [drive]}]\n"
    refused(
        lambda text: parse_plan(text, BARE),
        text,
        "tasks:2: tasks/0/functions/0: no function 'drive'; the design names none",
    )


# name: (the task of a design, what the error says)
OF_A_DESIGN = {
    "unknown key": ("{duratoin: 1 h}", "task/duratoin: unknown key 'duratoin'; did you mean 'duration'?"),
    "unknown key of a task": (
        "{legs: [{duration: 1 h}], naem: x}",
        "task/naem: unknown key 'naem'; did you mean 'name'?",
    ),
    "unknown key of a leg": ("{legs: [{sped: 1 h}]}", "task/legs/0/sped: unknown key 'sped'; did you mean 'speed'?"),
    "unknown function": (
        "{duration: 1 h, functions: [lfit]}",
        "task/functions/0: no function 'lfit'; did you mean 'lift'?",
    ),
    "zero speed": ("{distance: 1 m, speed: 0 m/s}", "task: expected a distance with a speed above zero, or a duration"),
    "stress": (
        "{duration: 1 h, stresses: {laod: 1}}",
        "task/stresses/laod: no part takes a stress 'laod'; did you mean 'load'?",
    ),
    "too long": ("{legs: [{duration: 6e5 h}, {duration: 6e5 h}]}", "task/legs: take 1.2e+06 h in all"),
    "list": ("[1]", "task: expected keys with values, not [1]"),
}


@pytest.mark.parametrize("fault", OF_A_DESIGN)
def test_faults_of_the_task_of_a_design(fault: str) -> None:
    task, message = OF_A_DESIGN[fault]
    refused(lambda text: parse(text, "robot.yaml"), f"{DESIGN}task: {task}\n", f"robot.yaml:10: {message}")
