"""``robophm watch``: the health of a robot that runs."""

from __future__ import annotations

import gc
import os
import signal
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.live import Live

from robophm.cli import BREACHED
from robophm.cli.shared.fleet import Fleet, fleet_address, sender
from robophm.cli.shared.health_output import print_report
from robophm.cli.shared.live_table import LiveTable, SeveralTable
from robophm.cli.shared.options import Design, GrowingStore, Json, Notify, Unit, Via
from robophm.cli.shared.output import console, may_write, print_json, warn
from robophm.cli.shared.ros_words import Words
from robophm.cli.shared.running_parameters import running_parameters
from robophm.cli.shared.several_robots import file_of_robot, side_by_side
from robophm.cli.shared.stored_past import files_of
from robophm.cli.shared.task_words import stated_speed
from robophm.cli.shared.unused import refuse_unused
from robophm.cli.shared.watch_output import Lines, OnTerminal
from robophm.core.ending import ASKED_BY, ignore, leave_in_time
from robophm.core.errors import RobophmError, SourceError
from robophm.core.signal import split_signal
from robophm.core.supervisor import Supervisor
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.health.report import HealthReport
from robophm.monitoring.alarm_watch import AlarmWatch
from robophm.monitoring.live_loop import watch
from robophm.monitoring.look_ahead import SHARE
from robophm.monitoring.notices import Notices
from robophm.monitoring.recording_sessions import missing_signals
from robophm.monitoring.service_notes import note_service
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.stores import open_store
from robophm.stores.alarm_log import AlarmsInMemory
from robophm.stores.one_of_several import BETWEEN
from robophm.stores.store import Store
from robophm.transports.health_topics import (
    HealthRecording,
    HealthTopics,
    Outlet,
    ParameterServices,
    PartReports,
    TaskService,
)
from robophm.transports.health_topics.sink import COMPLETION_NODE
from robophm.transports.live.one_robot import OneRobot, namespace_of
from robophm.transports.live.ros_names import Remapped, RosNames, names_of
from robophm.transports.live.shared_source import robots_of
from robophm.transports.recordings.journal import Journal
from robophm.transports.running_robot import Live as RunningRobot
from robophm.transports.running_robot import open_live
from robophm.transports.signals.report_sink import ReportSink
from robophm.transports.signals.source import LiveSource
from robophm.transports.tasks.listener import topics_to_hear

ENDS_BY_ITSELF = True

QUICK_END = 2.5
"""The most seconds in which what was heard is taken once it is to end; what still waits then is let go of."""


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
    robots: str | None = None
    """Namespaces of several robots that are watched at once, as a list with commas, or a pattern, ``amr_*``."""
    names: RosNames = field(default_factory=RosNames)
    """Meanings of names of topics, and the name of the node that listens."""


def _only(asked: Watched) -> None:
    """Refuse what is not used for what is asked."""
    used = ["via", "store", "notify", "period", "every", "publish", "tasks", "speed", "function", "reports", "words",
            "journal", "record", "fleet"]  # fmt: skip
    if asked.robots:
        used += ["robots"]
        refuse_unused("several robots at once, each with a past and a namespace of its own", [*used, "frame", "unit"])
    used += ["namespace", "robot"]
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
    words: Words = None,
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
    robots: Annotated[
        str | None, typer.Option(help="watch several with this design at once: 'amr_*', or amr_1,amr_2")
    ] = None,
    namespace: Annotated[
        str | None, typer.Option(help="namespace of the published topics; default: that of --robot, else of ROS")
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
    names = names_of(words or (), os.environ.get("ROS_NAMESPACE", ""))
    os.environ.update(names.environment)
    root = namespace or (namespace_of(robot) if robot else names.namespace)
    asked = Watched(
        via, store, journal, period, every, root, publish, frame, tuple(tasks or ()), speed, tuple(function or ()),
        tuple(notify or ()), unit, as_json, reports, fleet, record, robot, robots, names,
    )  # fmt: skip
    if run(design, asked):
        raise typer.Exit(BREACHED)


@contextmanager
def _ended_by_signals(source: LiveSource) -> Iterator[None]:
    """Take SIGINT and SIGTERM as the wish to end: what was heard is taken yet, and a second time not even that.

    Nobody waits for ever: the second comes by itself, and the process ends in any case. That a source was closed so
    before it was listened to is no error.
    """
    asked, closed = threading.Event(), threading.Event()

    def close() -> None:
        closed.set()
        source.close()

    letting_go = threading.Timer(QUICK_END, close)
    letting_go.daemon = True

    def stop(number: int, _frame: object) -> None:
        if asked.is_set():
            close()
            return
        asked.set()
        letting_go.start()
        leave_in_time(number)
        source.stop()

    with ExitStack() as stack:
        for number in ASKED_BY:  # heeded until all is let go of; then there is nothing to end
            signal.signal(number, stop)
        stack.callback(ignore)
        try:
            yield
        except SourceError:
            if not closed.is_set():
                raise
            warn("ended before the robot was watched")
        finally:
            letting_go.cancel()


def run(design: Path, asked: Watched) -> bool:
    """Listen until SIGINT or SIGTERM; return whether a threshold is breached at the end."""
    _only(asked)
    may_write(asked.journal, design, *files_of(asked.store))
    may_write(asked.record, design, *files_of(asked.store), *([asked.journal] if asked.journal else []))
    robot = load(design)
    for name in asked.functions:
        robot.diagram_of(name)  # which must be there
    stated_speed(asked.speed)
    for warning in robot.warnings:
        warn(warning)
    with Notices(asked.notify) as notices, ExitStack() as stack:
        opened = open_live(
            asked.via, period=asked.period, node=asked.names.whole_node, parameters=asked.names.parameters
        )
        source = stack.enter_context(Remapped(opened.source, asked.names))
        gc.collect()
        gc.freeze()  # what is there now stays: not to be looked through again and again while the robot runs
        stack.enter_context(_ended_by_signals(source))
        print(opened.said, file=sys.stderr)
        out = console()
        to_terminal = out.is_terminal and not asked.as_json
        with Live(console=out, auto_refresh=False) if to_terminal else nullcontext() as live:
            watching = _Watching(robot, opened, asked, notices, Supervisor(), out, live)
            ended = _watch_several(watching, source) if asked.robots else [watching.one(source, asked.robot)]
        watching.supervisor.ending()
        notices.close()
        for health, notes in ended:
            _say_at_end(health, notes, asked)
        for what, count in sorted(notices.notes.items()):
            warn(f"{what} ({count} times)")
        return any(health.breaches for health, _ in ended)


End = tuple[HealthReport, Mapping[str, int]]
"""The health of a robot at the end, and what was noted while it was watched."""


@dataclass
class _Watching:
    """What is the same for all robots that one process watches."""

    robot: Robot
    opened: RunningRobot
    asked: Watched
    notices: Notices
    supervisor: Supervisor
    out: Console
    live: Live | None
    several: SeveralTable = field(default_factory=SeveralTable)
    robots: int = 1

    def one(self, source: LiveSource, name: str | None, whose: str = "") -> End:
        """Watch one robot until its source ends: the only one, or that of this name, told of by the name ``whose``."""
        asked, robot = self.asked, self.robot
        if name:
            robot = replace(robot, path=namespace_of(name)[1:].replace("/", "_"))
            source = OneRobot(source, name)
        own = robot.name if whose else None
        fleet = fleet_address(asked.fleet, asked.store, own) if asked.fleet else None
        with ExitStack() as stack:
            _say_what_is_missing(robot, source, asked.names)
            kept = stack.enter_context(open_store(asked.store)) if asked.store else None
            sends = (
                stack.enter_context(sender(asked.store, robot.identity, fleet, own)) if asked.store and fleet else None
            )
            written = stack.enter_context(Journal(asked.journal, robot.signals)) if asked.journal else None
            topics, assessor = _to_ros(robot, self.opened, asked)
            sinks: list[ReportSink] = [stack.enter_context(topics)] if topics else []
            if asked.record:
                recording = HealthRecording(asked.record)
                recorded = HealthTopics(robot, recording, namespace=asked.namespace, frame=asked.frame)
                sinks.append(stack.enter_context(recorded))
            sinks.append(self._shown(whose))
            monitor = watch(
                robot, source, store=kept, journal=written, period=asked.period, sinks=sinks,
                task_topics=topics_to_hear(asked.tasks, "" if name else asked.namespace, source.task_topics),
                speed=stated_speed(asked.speed), functions=asked.functions, on_clock=warn,
                on_start=lambda _: self.supervisor.ready("watching"), on_tick=self.supervisor.alive,
                alarms=_alarms(robot, kept, sinks, self.notices), assessor=assessor, for_fleet=fleet is not None,
                share=SHARE / self.robots,
            )  # fmt: skip
            if sends:
                sends.close()
            return monitor.report(alarms=True), source.notes

    def _shown(self, whose: str) -> ReportSink:
        if self.live:
            return OnTerminal(self.live, self.several if whose else LiveTable(), whose)
        asked = self.asked
        return Lines(self.out, every=asked.every, unit=asked.unit, as_json=asked.as_json, whose=whose)


def _watch_several(watching: _Watching, source: LiveSource) -> list[End]:
    """Watch robots of one design side by side, the topics of each below its namespace, its past its own."""
    asked, pattern = watching.asked, watching.asked.robots or ""

    def one(name: str, heard: LiveSource, robots: int) -> End:
        store = f"{asked.store}{BETWEEN}{name}" if asked.store else None
        journal, record = file_of_robot(asked.journal, name), file_of_robot(asked.record, name)
        own = replace(asked, namespace=namespace_of(name), store=store, journal=journal, record=record)
        return replace(watching, asked=own, robots=robots).one(heard, name, name)

    def further() -> LiveSource:
        return Remapped(open_live(asked.via, period=asked.period).source, asked.names)

    names = robots_of(source, pattern)
    if asked.store:
        open_store(asked.store).close()  # made by one alone
    return side_by_side(source, pattern, names, one, further)


def _to_ros(robot: Robot, opened: RunningRobot, asked: Watched) -> tuple[HealthTopics | None, TaskAssessor | None]:
    """Publish health and serve those who ask, as far as that is wanted and can be; what cannot be is warned of."""
    if asked.reports and not opened.server:
        warn(f"reports of parts are not taken: {opened.source.place} has no services")
    if not asked.publish:
        return None, None
    if not opened.publisher:
        warn(f"health is not published: {opened.source.place} takes no messages of ROS")
        return None, None
    outlet = Outlet(opened.generation, opened.node, opened.publisher, opened.server, whole=asked.names.of)
    topics = HealthTopics(robot, outlet, namespace=asked.namespace, frame=asked.frame)
    assessor = TaskAssessor(robot)
    tasks = TaskService(outlet, assessor, asked.namespace)
    unserved = [tasks.unknown]
    if opened.has_parameters:
        node = f"{asked.namespace.rstrip('/')}/{COMPLETION_NODE}"
        unserved.append(ParameterServices(outlet, node, running_parameters(topics, assessor, tasks)).unknown)
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


def _say_what_is_missing(robot: Robot, source: LiveSource, names: RosNames) -> None:
    """Warn of signals of the design that nobody publishes yet."""
    published = {info.topic: (info.type, info.fields) for info in source.topics()}
    relative = {topic for signal in robot.signals if not (topic := split_signal(signal)[0]).startswith("/")}
    published |= {topic: published[whole] for topic in relative if (whole := names.of(topic)) in published}
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
    whose = f"{health.robot}: " if asked.robots else ""
    for what, count in sorted(notes.items()):
        warn(f"{whose}{what} ({count} times)")


def _alarms(robot: Robot, store: Store | None, sinks: Sequence[ReportSink], notices: Notices) -> AlarmWatch:
    """The alarms of the robot, told to all who are to know of them."""
    log = store.alarm_log(robot.identity) if store else AlarmsInMemory()
    return AlarmWatch(robot, log, [*(sink.alarmed for sink in sinks), notices.of(robot.name)])
