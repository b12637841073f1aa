"""``robophm watch``: the health of a robot that runs."""

from __future__ import annotations

import gc
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer
from rich.console import Console
from rich.live import Live

from robophm.cli import BREACHED, OK
from robophm.cli.shared.fleet import Fleet, fleet_address, sender
from robophm.cli.shared.health_output import print_report
from robophm.cli.shared.live_table import LiveTable
from robophm.cli.shared.options import Design, GrowingStore, Json, Notify, Unit, Via
from robophm.cli.shared.output import console, may_write, print_json, warn
from robophm.cli.shared.stored_past import files_of
from robophm.cli.shared.task_words import stated_speed
from robophm.cli.shared.unused import refuse_unused
from robophm.core.counted_notes import FreshNotes
from robophm.core.errors import RobophmError, SourceError
from robophm.core.json_values import plain
from robophm.core.supervisor import Supervisor
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.health.alarms import Alarm
from robophm.health.report import HealthReport
from robophm.health.unknown_rates import marked, marks
from robophm.monitoring.alarm_watch import AlarmWatch
from robophm.monitoring.live_loop import watch
from robophm.monitoring.notices import Notices
from robophm.monitoring.recording_sessions import missing_signals
from robophm.monitoring.service_notes import note_service
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.report.alarms import alarm_text
from robophm.report.wear import ranked
from robophm.report.words import duration_text, number_text, probability_text, rate_text
from robophm.stores import open_store
from robophm.stores.alarm_log import AlarmsInMemory
from robophm.stores.store import Store
from robophm.transports.health_topics import HealthRecording, HealthTopics, Outlet, PartReports, TaskService
from robophm.transports.live.one_robot import OneRobot, namespace_of
from robophm.transports.recordings.journal import Journal
from robophm.transports.running_robot import Live as RunningRobot
from robophm.transports.running_robot import open_live
from robophm.transports.signals.report_sink import JudgedTask, ReportSink
from robophm.transports.signals.source import LiveSource
from robophm.transports.tasks.listener import topics_to_hear

QUICK_END = 3.0
"""The most seconds in which what was heard is taken after SIGTERM; what still waits then is let go of."""


@dataclass(frozen=True)
class Watched:
    """The options of a watch."""

    via: str
    """The way the robot is heard: auto, ros1, ros2, dds, rclpy or the address of an MQTT broker."""
    store: str | None
    journal: Path | None
    period: float
    """Step of integration, and time between two reports [s]."""
    every: float
    """Time between two lines, off a terminal [s]."""
    namespace: str
    publish: bool
    frame: str
    tasks: Sequence[str]
    """Topics and actions that tell of tasks; those that are known by their names unless given."""
    speed: str | None
    functions: Sequence[str]
    notify: Sequence[str]
    """Addresses that are told of alarms."""
    unit: str
    as_json: bool
    reports: bool = False
    """Whether the robot may tell of its parts that they failed or were served."""
    fleet: str | None = None
    """The address at which a fleet takes the robot's reports."""
    record: Path | None = None
    """A new MCAP file that takes health as it is published."""
    robot: str | None = None
    """The namespace below which one of several robots speaks, ``amr_7``, and its name."""


def _only(asked: Watched) -> None:
    """Refuse what is not used for what is asked."""
    used = ["via", "store", "notify", "journal", "period", "every", "publish", "namespace", "tasks", "speed"]
    used += ["function", "reports", "fleet", "record", "robot"]
    if asked.as_json:
        refuse_unused("JSON, in 1/h", [*used, "frame"])
    if not asked.publish and not asked.record:
        refuse_unused("a robot whose health is not published", [*used, "unit"])
    if asked.reports and not asked.publish:
        raise RobophmError("reports of parts are taken where health is published; expected no --no-publish")
    if asked.reports and not asked.store:
        raise RobophmError("reports of parts go into the robot's past; expected --store with --reports")


def command(
    design: Design,
    via: Via = "auto",
    store: GrowingStore = None,
    journal: Annotated[Path | None, typer.Option(help="append every sample to this journal")] = None,
    period: Annotated[
        float, typer.Option(min=0.1, max=3600, help="seconds between two reports, and of each step of integration")
    ] = 1.0,
    every: Annotated[
        float, typer.Option(min=0.1, help="seconds between two lines of output, where it is not a terminal")
    ] = 10.0,
    publish: Annotated[bool, typer.Option(help="publish health as topics")] = True,
    robot: Annotated[
        str | None, typer.Option(help="namespace of the robot, where several robots have this design")
    ] = None,
    namespace: Annotated[
        str | None, typer.Option(help="namespace of the published topics; default: that of --robot, else /")
    ] = None,
    frame: Annotated[str, typer.Option(help="frame of the markers for RViz")] = "base_link",
    tasks: Annotated[
        list[str] | None, typer.Option(help="topic or action that announces tasks; default: those known by name")
    ] = None,
    speed: Annotated[
        str | None,
        typer.Option(help="speed for planned legs that state none, e.g. '0.3 m/s'; default: that of the design's task"),
    ] = None,
    function: Annotated[
        list[str] | None, typer.Option(help="function that tasks need; default: the whole robot")
    ] = None,
    notify: Notify = None,
    reports: Annotated[
        bool, typer.Option("--reports", help="let anybody on ROS report that parts failed or were serviced")
    ] = False,
    fleet: Fleet = None,
    record: Annotated[Path | None, typer.Option(help="also write the published health to a new MCAP file")] = None,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """Watch a running robot over ROS or MQTT, and publish its health, until interrupted."""
    root = namespace or (namespace_of(robot) if robot else "/")
    asked = Watched(
        via, store, journal, period, every, root, publish, frame, tuple(tasks or ()), speed, tuple(function or ()),
        tuple(notify or ()), unit, as_json, reports, fleet, record, robot,
    )  # fmt: skip
    if run(design, asked):
        raise typer.Exit(BREACHED)


@contextmanager
def _ended_by_signals() -> Iterator[list[Callable[[], None]]]:
    """Take SIGINT and SIGTERM as the wish to end what the list says, until all is let go of: a second time the next.

    Who supervises does not want to wait either: after SIGTERM the second comes by itself. That a source was closed so
    before it was listened to is no error.
    """
    ends: list[Callable[[], None]] = []
    closed = threading.Event()

    def last() -> None:
        closed.set()
        ends[-1]()

    letting_go = threading.Timer(QUICK_END, last)
    letting_go.daemon = True

    def stop(number: int, frame: FrameType | None) -> None:
        if not ends:
            raise KeyboardInterrupt if number == signal.SIGINT else SystemExit(OK)
        (ends.pop(0) if len(ends) > 1 else last)()
        if number == signal.SIGTERM and not letting_go.is_alive() and not letting_go.finished.is_set():
            letting_go.start()

    with ExitStack() as stack:
        for number in (signal.SIGINT, signal.SIGTERM):  # heeded until all is let go of; then there is nothing to end
            signal.signal(number, stop)
            stack.callback(signal.signal, number, signal.SIG_IGN)
        stack.callback(letting_go.cancel)
        try:
            yield ends
        except SourceError:
            if not closed.is_set():
                raise
            warn("ended before the robot was watched")


def run(design: Path, asked: Watched) -> bool:
    """Listen until SIGINT or SIGTERM; return whether a threshold is breached at the end."""
    _only(asked)
    may_write(asked.journal, design, *files_of(asked.store))
    may_write(asked.record, design, *files_of(asked.store), *([asked.journal] if asked.journal else []))
    robot = load(design)
    if asked.robot:
        robot = replace(robot, path=namespace_of(asked.robot)[1:].replace("/", "_"))
    for name in asked.functions:
        robot.diagram_of(name)  # which must be there
    speed = stated_speed(asked.speed)
    fleet = fleet_address(asked.fleet, asked.store) if asked.fleet else None
    for warning in robot.warnings:
        warn(warning)
    supervisor = Supervisor()
    health: HealthReport | None = None
    with Notices(asked.notify) as notices, ExitStack() as stack:
        ends = stack.enter_context(_ended_by_signals())
        opened = open_live(asked.via, period=asked.period)
        source = stack.enter_context(opened.source)
        if asked.robot:
            source = OneRobot(source, asked.robot)
        ends += [source.stop, source.close]
        print(opened.said, file=sys.stderr)
        _say_what_is_missing(robot, source)
        kept = stack.enter_context(open_store(asked.store)) if asked.store else None
        sends = stack.enter_context(sender(asked.store, robot.identity, fleet)) if asked.store and fleet else None
        written = stack.enter_context(Journal(asked.journal, robot.signals)) if asked.journal else None
        topics, assessor = _to_ros(robot, opened, asked)
        sinks = [stack.enter_context(topics)] if topics else []
        if asked.record:
            recording = HealthRecording(asked.record)
            recorded = HealthTopics(robot, recording, namespace=asked.namespace, frame=asked.frame)
            sinks.append(stack.enter_context(recorded))

        out = console()
        to_terminal = out.is_terminal and not asked.as_json
        with Live(console=out, auto_refresh=False) if to_terminal else nullcontext() as live:
            shown = _OnTerminal(live) if live else _Lines(out, asked)
            gc.collect()
            gc.freeze()  # what is there now stays: not to be looked through again and again while the robot runs
            monitor = watch(
                robot, source, store=kept, journal=written, period=asked.period, sinks=[*sinks, shown],
                task_topics=topics_to_hear(asked.tasks, "" if asked.robot else asked.namespace, source.task_topics),
                speed=speed, functions=asked.functions, on_clock=warn, on_start=lambda _: supervisor.ready("watching"),
                on_tick=supervisor.alive, alarms=_alarms(robot, kept, [*sinks, shown], notices),
                assessor=assessor, for_fleet=fleet is not None,
            )  # fmt: skip
        supervisor.ending()
        notices.close()
        if sends:
            sends.close()
        health = monitor.report(alarms=True)
        _say_at_end(health, source.notes + notices.notes, asked)
    return bool(health and health.breaches)


def _to_ros(robot: Robot, opened: RunningRobot, asked: Watched) -> tuple[HealthTopics | None, TaskAssessor | None]:
    """Publish health and serve those who ask, as far as that is wanted and can be; what cannot be is warned of."""
    if asked.reports and not opened.server:
        warn(f"reports of parts are not taken: {opened.source.place} has no services")
    if not asked.publish:
        return None, None
    if not opened.publisher:
        warn(f"health is not published: {opened.source.place} takes no messages of ROS")
        return None, None
    outlet = Outlet(opened.generation, opened.node, opened.publisher, opened.server)
    topics = HealthTopics(robot, outlet, namespace=asked.namespace, frame=asked.frame)
    assessor = TaskAssessor(robot)
    unserved = [TaskService(outlet, assessor, asked.namespace).unknown]
    if asked.reports and opened.server:
        note = partial(note_service, asked.store or "", robot)
        unserved.append(PartReports(outlet, robot, lambda said, key: note(said, key=key), asked.namespace).unknown)
    for words in filter(None, unserved):
        warn(f"not served: {words}")
    if topics.left_out:
        warn(f"{topics.left_out} parts have no topic of their own: there are too many")
    for words in topics.unknown.values():
        warn(f"not published: {words}")
    return topics, assessor


def _say_what_is_missing(robot: Robot, source: LiveSource) -> None:
    """Warn of signals of the design that nobody publishes yet."""
    published = {info.topic: (info.type, info.fields) for info in source.topics()}
    if not published:
        warn(f"nothing is published yet at {source.place}")
        for hint in source.hidden_by():
            warn(hint, "hint")
    lacks = missing_signals(robot, published)
    not_yet = "nobody publishes yet" if source.announced else "nothing was heard yet on"
    for words in dict.fromkeys(lacks.values()):
        warn(words.replace("the recording has no topic", not_yet))


def _say_at_end(health: HealthReport, notes: Mapping[str, int], asked: Watched) -> None:
    if asked.as_json:
        print_json(health.to_json(), one_of_many=True)
    else:
        print_report(health, asked.unit)
    for what, count in sorted(notes.items()):
        warn(f"{what} ({count} times)")


def _alarms(robot: Robot, store: Store | None, sinks: Sequence[ReportSink], notices: Notices) -> AlarmWatch:
    """The alarms of the robot, told to all who are to know of them."""
    log = store.alarm_log(robot.identity) if store else AlarmsInMemory()
    return AlarmWatch(robot, log, [*(sink.alarmed for sink in sinks), notices.of(robot.name)])


SHOWN = ("foretold", "reached", "not followed")
"""States of wear that a line tells of, of the part that comes first."""


class _OnTerminal(ReportSink):
    """A table that stays where it is, and the tasks and notes above it."""

    def __init__(self, live: Live) -> None:
        self._live, self._table = live, LiveTable()
        self._fresh = FreshNotes()

    def noted(self, notes: Mapping[str, int]) -> None:
        for line in self._fresh.lines(notes):
            self._live.console.print(f"warning: {line}", markup=False)

    def publish(self, report: HealthReport) -> None:
        if self._table.due():
            self._live.update(self._table.draw(report), refresh=True)

    def alarmed(self, changed: Sequence[Alarm], going_on: Sequence[Alarm]) -> None:
        for one in changed:
            self._live.console.print(alarm_text(one), markup=False)

    def judged(self, task: JudgedTask) -> None:
        self._live.console.print(_task_text(task), markup=False)


class _Lines(ReportSink):
    """A line now and then, or a line of JSON."""

    def __init__(self, out: Console, asked: Watched) -> None:
        self._out, self._asked, self._said = out, asked, time.monotonic()
        self._fresh = FreshNotes()

    def noted(self, notes: Mapping[str, int]) -> None:
        for line in self._fresh.lines(notes):
            warn(line)

    def publish(self, report: HealthReport) -> None:
        if time.monotonic() - self._said < self._asked.every:
            return
        self._said = time.monotonic()
        if self._asked.as_json:
            print_json(report.to_json(), one_of_many=True)
        else:
            rate = rate_text(report.system.sensor_based.hazard_rate, self._asked.unit)
            rate = marked(marks(report.system.unknown)[0], rate)
            told = f"  ({', '.join(report.system.marks)})" if report.system.marks else ""
            worn = [f"  {one.mode} {one.says}" for one in ranked(report.wear)[:1] if one.state in SHOWN]
            self._out.print(
                f"{report.clocks['operating']:.3f} h  λ {rate}{told}{''.join(worn)}", markup=False, soft_wrap=True
            )

    def alarmed(self, changed: Sequence[Alarm], going_on: Sequence[Alarm]) -> None:
        for one in changed:
            if self._asked.as_json:
                print_json({"alarm": one.to_json()}, one_of_many=True)
            else:
                self._out.print(alarm_text(one), markup=False, soft_wrap=True)

    def judged(self, task: JudgedTask) -> None:
        if self._asked.as_json:
            print_json({"task": plain(asdict(task))}, one_of_many=True)
        else:
            self._out.print(_task_text(task), markup=False)


def _task_text(task: JudgedTask) -> str:
    what = {"succeeded": "done"}.get(task.outcome, task.outcome) if task.done else "arrived"
    chance = task.completion["sensor_based"]
    length = f"{number_text(task.distance)} m in {duration_text(task.duration)}"
    said = probability_text(chance.probability, chance.failure)
    if left_out := task.unknown:
        said = f"{left_out.said_ahead(said)} ({left_out.left_out})"
    done = "completed" if task.outcome == "succeeded" else "to be got through"
    return f"task {what} on {task.topic}: {length}, {done} with {said}"
