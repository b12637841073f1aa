"""``robophm task`` of a recording: what was predicted of its tasks, and how they went."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from itertools import chain
from typing import Any

from robophm.cli.shared.output import console, print_json, print_table, progress_console, table, warn
from robophm.cli.shared.progress import progress
from robophm.core.errors import SourceError
from robophm.core.signal import HOUR, SECOND
from robophm.design.importers.legacy.figures import UNIT_MODES, LegacyTask, UnitMode, legacy_task
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Task
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion
from robophm.health.outlooks import View
from robophm.health.report import VIEWS, task_to_json
from robophm.health.unknown_rates import MARKS, PartsOfUnknownRate, marked
from robophm.monitoring.task_history import TaskRecord, judge_tasks
from robophm.report.words import duration_text, number_text, odds_text, percent_text
from robophm.transports.recordings.recording import Recording
from robophm.transports.tasks import TEXT_TOPICS, PlannedTask, driven_task, tasks_of
from robophm.transports.tasks.listener import PATH, TEXT, tells_of_tasks, topics_of


def run(
    robot: Robot, ledger: Ledger | None, source: Recording, topics: Sequence[str], *,
    speed: float | None, functions: Sequence[str], knowledge: Knowledge,
    skip_missing: bool, legacy: bool, as_json: bool,
) -> bool:  # fmt: skip
    """Predicted and actual of the tasks that a recording tells of; whether one is less likely than the design wants."""
    types = {info.topic: info.type for info in source.topics()}
    driven = [topic for topic in topics if _says_where(topic, types)]
    listened = [topic for topic in topics if topic not in driven]
    told = list(tasks_of(source, listened or None)) if listened or not topics else []
    unread = dict(source.notes)
    told += [driven_task(source, topic) for topic in driven]
    if not told and unread:
        raise SourceError(f"the recording tells of no task that can be read: {min(unread)}")
    if not told:
        raise SourceError(
            f"the recording tells of no task; expected topics named {', '.join(TEXT_TOPICS)}, or --topic with a path "
            "or with where the robot was"
        )
    told.sort(key=lambda one: one.time if isinstance(one, PlannedTask) else one.end)
    spans = [(info.first, info.last) for info in source.topics()]
    with progress(progress_console(), spans, "replaying") as tick:
        records, _ = judge_tasks(
            robot, source, told, speed=speed, functions=functions, knowledge=knowledge, ledger=ledger,
            skip_missing=skip_missing, on_tick=tick,
        )  # fmt: skip
    for what, count in sorted(unread.items()):
        warn(f"{what} ({count} times)")
    for what in sorted(source.lost()):
        if not any(said in what for said in unread):
            warn(f"lost: {what}")
    begin = min(info.first for info in source.topics() if info.first is not None)
    old = [_legacy(robot, one, begin) if legacy else {} for one in records]
    if as_json:
        print_json({"robot": robot.name, "tasks": [_record_json(*both) for both in zip(records, old, strict=True)]})
    else:
        _print_records(robot, records)
        if legacy:
            _print_legacy(robot, records, old)
    wanted = robot.thresholds.completion
    asked = [one.predicted["sensor_based"].probability for one in records if one.predicted]
    return wanted is not None and any(probability < wanted for probability in asked)


def _says_where(topic: str, types: Mapping[str, str]) -> bool:
    """Whether it is asked for what was driven, not for what is told of tasks."""
    meant = [each for each in topics_of([topic]) if each in types]
    return types.get(topic) not in (TEXT, PATH) and not any(tells_of_tasks(each, types[each]) for each in meant)


def _legacy(robot: Robot, record: TaskRecord, begin: int) -> dict[UnitMode, LegacyTask]:
    """What the 2020 tool says, its window opened as the recording begins, in both of its unit modes."""
    start = record.arrived if record.arrived is not None else record.start or begin
    planned, done = ([(leg.distance, leg.duration * 3600) for leg in task.legs] if task else None
                     for task in (record.planned or record.done, record.done))  # fmt: skip
    if planned is None:
        return {}
    uptime = max(start - begin, 0) / HOUR
    return {unit: legacy_task(robot, planned, uptime, unit=unit, driven=done) for unit in UNIT_MODES}


def _print_legacy(robot: Robot, records: Sequence[TaskRecord], old: Sequence[Mapping[UnitMode, LegacyTask]]) -> None:
    rows = []
    for record, found in zip(records, old, strict=True):
        for unit, one in found.items():
            actual = percent_text(one.actual) if record.done else "–"
            rows.append((_when(record), unit, percent_text(one.reliability), percent_text(one.predicted), actual))
    columns = ("arrived (UTC)", "unit mode", "R before", "predicted PoTC", "actual PoTC")
    title = f"The same by the 2020 tool: R of {robot.name} to the power of the last leg's distance"
    print_table(console(), table(title, columns, rows, figures=(2, 3, 4)))


def _when(record: TaskRecord) -> str:
    at = record.arrived if record.arrived is not None else record.start
    return datetime.fromtimestamp((at or 0) / SECOND, UTC).strftime("%Y-%m-%d %H:%M:%S")


def _record_json(record: TaskRecord, old: Mapping[UnitMode, LegacyTask]) -> dict[str, Any]:
    figures = {
        name: {view: asdict(one) for view, one in found.items()} if found else None
        for name, found in (("predicted", record.predicted), ("actual", record.actual))
    }
    tasks = {
        name: task_to_json(task) if task else None
        for name, task in (("planned", record.planned), ("done", record.done))
    }
    more: dict[str, Any] = {"legacy": {unit: asdict(one) for unit, one in old.items()}} if old else {}
    more |= {"unknown": asdict(record.unknown)} if record.unknown else {}
    return {"arrived": record.arrived, "start": record.start, "end": record.end, **tasks, **figures, **more}


def _print_records(robot: Robot, records: Sequence[TaskRecord]) -> None:
    def way(task: Task | None) -> tuple[str, str]:
        return (f"{number_text(task.distance)} m", duration_text(task.duration)) if task else ("–", "–")

    def failure(found: Mapping[View, Completion] | None, view: View, left_out: PartsOfUnknownRate | None) -> str:
        if not found:
            return "–"
        mark = MARKS[left_out.failing] if left_out else ""
        said = odds_text(found[view].failure).removeprefix("fails ") or percent_text(found[view].failure)
        return marked(mark, said)

    rows = []
    for one in records:
        figures = (failure(found, view, one.unknown) for found in (one.predicted, one.actual) for view in VIEWS)
        rows.append((_when(one), *way(one.planned), *way(one.done), *figures))
    columns = [
        "arrived (UTC)",
        "planned",
        "time",
        "done",
        "time",
        "predicted nominal",
        "sensor",
        "actual nominal",
        "sensor",
    ]
    out = console()
    print_table(out, table(f"Tasks of {robot.name}: how often they fail", columns, rows, figures=range(1, 9)))
    for words in dict.fromkeys(one.unknown.of_tasks for one in records if one.unknown):
        out.print(words, style="yellow", markup=False, soft_wrap=True)
    done = [one.done for one in records if one.done]
    if done:
        whole = Task(tuple(chain.from_iterable(one.legs for one in done)))
        out.print(f"Done: {len(done)} tasks, {number_text(whole.distance)} m in {duration_text(whole.duration)}")
