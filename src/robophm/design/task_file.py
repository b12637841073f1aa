"""Readers of task lists: tasks.yaml and tasks.csv of a robot."""

from __future__ import annotations

import csv
import io
import os
from collections import Counter
from collections.abc import Iterable
from itertools import count, groupby
from typing import Any

from robophm.core.argument_checks import instance
from robophm.core.argument_checks import path as given_path
from robophm.core.errors import DesignError, nearest
from robophm.core.yaml_values import Lines, located
from robophm.design.file import mapping, read, validated
from robophm.design.robot import Robot
from robophm.design.task import Plan

Row = tuple[int, dict[str, str]]
"""Line of a table, and its cells by column."""

_LEG = ("distance", "speed", "duration", "cycles", "starts")
_MOST_ROWS = 100_000


def load_plan(path: str | os.PathLike[str], robot: Robot) -> Plan:
    """Read a robot's tasks from a .yaml or .csv file. Raises DesignError with file, line and what was expected."""
    path = given_path(path, "list of tasks", DesignError)
    instance(robot, Robot, "robot", "a Robot, as of robophm.load", DesignError)
    text = read(path)
    return (
        plan_from_csv(text, robot, str(path)) if path.suffix.lower() == ".csv" else parse_plan(text, robot, str(path))
    )


def parse_plan(text: str, robot: Robot, name: str = "tasks") -> Plan:
    """Read a robot's tasks from YAML text; ``name`` is what errors call it. Raises DesignError."""
    from robophm.design.schema_task import TaskFile

    data, lines = mapping(text, name, "list of tasks")
    return _plan(data, lines, robot, name, TaskFile)


def plan_from_csv(text: str, robot: Robot, name: str = "tasks") -> Plan:
    """Read tasks from a table with a row for each leg: columns as keys of a leg, any other is a stress.

    Rows that name the same ``task`` one after another are its legs; one that names none is a task of its own.
    Raises DesignError.
    """
    return plan_of_rows(table_rows(text, name), robot, name)


def table_rows(text: str, name: str) -> list[Row]:
    """Return the rows of a table with their lines; empty cells are left out. Raises DesignError."""
    reader = csv.DictReader(io.StringIO(text, newline=""), strict=True)
    rows: list[Row] = []
    try:
        reader.fieldnames = header = [one.strip() for one in reader.fieldnames or ()]
        if doubled := [one for one, times in Counter(header).items() if times > 1 and one]:
            raise DesignError(f"{name}:1: column '{doubled[0]}' is there twice")
        for row in reader:
            if None in row or None in row.values():
                raise DesignError(f"{name}:{reader.line_num}: expected {len(header)} cells, as the header has")
            if len(rows) == _MOST_ROWS:
                raise DesignError(f"{name}:{reader.line_num}: more than {_MOST_ROWS:,} rows")
            rows.append((reader.line_num, {key: cell.strip() for key, cell in row.items() if cell.strip()}))
    except csv.Error as error:
        raise DesignError(f"{name}:{reader.reader.line_num}: is not a table: {error}") from None
    if not rows:
        raise DesignError(f"{name}:1: holds no tasks; expected a header and a row for each leg")
    return rows


def plan_of_rows(rows: Iterable[Row], robot: Robot, name: str) -> Plan:
    """Build a plan from rows of a table. Raises DesignError."""
    from robophm.design.schema_task import TaskFile

    known = {"task", "functions", *_LEG}
    known |= {one for mode in robot.modes for stress in mode.stresses for one in stress.model.numbers}
    tasks: list[Any] = []
    lines = Lines()
    lines |= {(): 1, ("tasks",): 1}
    own = count()
    for _, group in groupby(rows, key=lambda row: row[1].get("task", next(own))):
        legs: list[Any] = []
        title = ""
        for line, cells in group:
            if unknown := [key for key in cells if key.rpartition("/")[2] not in known]:
                raise DesignError(f"{name}:{line}: no column '{unknown[0]}'{nearest(unknown[0], known)}")
            task = ("tasks", str(len(tasks)))
            place = (*task, "legs", str(len(legs)))
            for above in (task, (*task, "legs")):
                lines.setdefault(above, line)
            lines |= {(*place, *step): line for step in ((), *((key,) for key in cells))}
            leg: dict[str, Any] = {key: cells[key] for key in _LEG if key in cells}
            title = cells.get("task", "")
            leg["functions"] = [one.strip() for one in cells.get("functions", "").split(";") if one.strip()]
            leg["stresses"] = {key: cell for key, cell in cells.items() if key not in (*_LEG, "task", "functions")}
            legs.append(leg)
        tasks.append({"name": title, "legs": legs})
    return _plan({"schema_version": 1, "tasks": tasks}, lines, robot, name, TaskFile)


def _plan(data: dict[str, Any], lines: Lines, robot: Robot, name: str, model: Any) -> Plan:
    from robophm.design.build_task import build_plan
    from robophm.design.located_error import LocatedError

    said = validated(model, data, name, lines)
    try:
        return build_plan(said, robot)
    except LocatedError as fault:
        raise DesignError(located(name, lines, fault.place, str(fault))) from None
