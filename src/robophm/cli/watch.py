"""``robophm watch``: the health of a robot that runs."""

from __future__ import annotations

import signal
import time
from collections.abc import Sequence
from contextlib import ExitStack, nullcontext
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from rich.live import Live

from robophm.cli.live_table import LiveTable
from robophm.cli.output import console, may_write, print_json, print_report, warn
from robophm.cli.task_request import known_functions, stated_speed
from robophm.core.signal import split_signal
from robophm.design.file import load
from robophm.drives import lacking
from robophm.health.report import HealthReport
from robophm.report.words import rate_text
from robophm.stores.sqlite import SqliteStore
from robophm.transports.health_topics import HealthTopics, Outlet
from robophm.transports.journal import Journal
from robophm.transports.ros1 import Node, Publisher, Ros1
from robophm.transports.tasks.listener import ACTIONS, topics_of
from robophm.transports.tasks.texts import TEXT_TOPICS
from robophm.watching import watch


@dataclass(frozen=True)
class Watched:
    """What was asked for."""

    store: Path | None
    journal: Path | None
    period: float
    """[s]"""
    every: float
    """[s]"""
    namespace: str
    publish: bool
    frame: str
    tasks: Sequence[str]
    """Topics and actions that tell of tasks; those that are known by their names unless given."""
    speed: str | None
    functions: Sequence[str]
    unit: str
    as_json: bool


def run(design: Path, asked: Watched) -> bool:
    """Listen until SIGINT or SIGTERM; whether a threshold is breached at the end."""
    may_write(asked.journal, design, *([asked.store] if asked.store else []))
    robot = load(design)
    known_functions(robot, asked.functions)
    speed = stated_speed(asked.speed)
    for warning in robot.warnings:
        warn(warning)
    with ExitStack() as stack:
        source = stack.enter_context(Ros1(period=asked.period))
        published = {info.topic: (info.type, info.fields) for info in source.topics()}
        for name, words in lacking(robot, published).items():
            topic, _ = split_signal(name)
            warn(
                words.replace("the recording has no topic", "nobody publishes yet") if topic not in published else words
            )
        kept = stack.enter_context(SqliteStore(asked.store)) if asked.store else None
        written = stack.enter_context(Journal(asked.journal, robot.signals)) if asked.journal else None
        sinks = []
        if asked.publish:
            outlet = Outlet(1, Node, Publisher)
            topics = stack.enter_context(HealthTopics(robot, outlet, namespace=asked.namespace, frame=asked.frame))
            sinks.append(topics)
            if topics.left_out:
                warn(f"{topics.left_out} parts have no topic of their own: there are too many")

        def stop(number: int, frame: FrameType | None) -> None:
            source.close()

        for number in (signal.SIGINT, signal.SIGTERM):
            stack.callback(signal.signal, number, signal.signal(number, stop))
        out, table, said = console(), LiveTable(), time.monotonic()
        to_terminal = out.is_terminal and not asked.as_json
        with Live(console=out, auto_refresh=False) if to_terminal else nullcontext() as live:

            def look(report: HealthReport) -> None:
                nonlocal said
                if live:
                    if table.due():
                        live.update(table.draw(report), refresh=True)
                elif time.monotonic() - said >= asked.every:
                    said = time.monotonic()
                    if asked.as_json:
                        print_json(report.to_json())
                    else:
                        rate = rate_text(report.system.sensor_based.hazard_rate, asked.unit)
                        out.print(f"{report.clocks['operating']:.3f} h  λ {rate}", markup=False)

            monitor = watch(
                robot, source, store=kept, journal=written, period=asked.period, sinks=sinks,
                task_topics=_task_topics(asked), speed=speed, functions=asked.functions, on_report=look,
            )  # fmt: skip
        health = monitor.report()
        if asked.as_json:
            print_json(health.to_json())
        else:
            print_report(health, asked.unit)
        for what, count in sorted(source.notes.items()):
            warn(f"{what} ({count} times)")
    return bool(health.breaches)


def _task_topics(asked: Watched) -> list[str]:
    """As named; else the 2020 tool's and those of actions of navigation, in the namespace and outside it."""
    if asked.tasks:
        return topics_of(asked.tasks)
    roots = dict.fromkeys(("", asked.namespace.rstrip("/")))
    texts = [f"{root}/{name}" for root in roots for name in TEXT_TOPICS]
    return texts + topics_of(f"{root}{name}" for root in roots for name in ACTIONS)
