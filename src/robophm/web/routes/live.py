"""Monitoring: start, stop, health now, topics, and live values over one WebSocket."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress
from typing import Annotated

from fastapi import APIRouter, Query, WebSocket
from pydantic import Field
from starlette.websockets import WebSocketDisconnect, WebSocketState

from robophm.core.signal import SECOND, signal_name, split_signal
from robophm.core.units import conversion
from robophm.core.waiting_time import LONGEST
from robophm.design.robot import Robot
from robophm.health.report import HealthReport
from robophm.health.why import Explanation
from robophm.monitoring.stress_since import with_since
from robophm.transports.signals.message_units import field_unit
from robophm.web.access.roles import needs
from robophm.web.health import Freshness, Health, health_of
from robophm.web.routes.design import REFUSED
from robophm.web.service import Served, Service
from robophm.web.shapes import Shape
from robophm.web.sources import chosen
from robophm.web.streaming import PERIOD, Viewer

router = APIRouter(tags=["live"])


class SourceChoice(Shape):
    """A source of samples that can be chosen."""

    name: str
    label: str
    paced: bool


class MonitoringState(Shape):
    """Whether the robot is watched."""

    state: str
    source: str
    error: str
    sources: list[SourceChoice]


class StartAsked(Shape):
    """Watch the robot of the design as it is now."""

    source: Annotated[str, Field(max_length=100)]
    speed: Annotated[float, Field(gt=0, le=10_000)] = 1.0
    """Speed in multiples of the recording's own."""


class Topic(Shape):
    """A topic that a source offers."""

    topic: str
    type: str
    messages: int
    rate: float | None
    """Messages per second [1/s]."""
    fields: list[TopicField]


class TopicField(Shape):
    """A number in the messages of a topic."""

    field: str
    unit: str | None
    """Unit as well-known messages have it."""
    last: float | None


class Topics(Shape):
    """All topics that a source offers."""

    source: str
    topics: list[Topic]


class SeriesNames(Shape):
    """Names of series, to watch over the WebSocket."""

    names: list[str]


class SensorTest(Shape):
    """A binding to be tried."""

    topic: Annotated[str, Field(max_length=300)]
    field: Annotated[str, Field(max_length=300)]
    unit: Annotated[str, Field(max_length=60)] = ""
    """Unit of the field."""
    wanted: Annotated[str, Field(max_length=60)] = ""
    """Unit that the model's input has."""


class SensorTested(Shape):
    """The value that a tried binding heard last."""

    signal: str
    raw: float | None
    value: float | None
    """Value in the unit of the input."""
    age: float | None
    words: str


@router.get("/api/monitoring")
def get_monitoring(service: Served) -> MonitoringState:
    """Whether the robot is watched, and by what it could be."""
    run = service.monitoring.run
    return MonitoringState(
        state=service.monitoring.state,
        source=run.source if run else "",
        error=run.error if run else "",
        sources=[SourceChoice(name=one.name, label=one.label, paced=one.paced) for one in service.sources.values()],
    )


@router.post("/api/monitoring/start", responses=REFUSED)
@needs("operator")
def start(asked: StartAsked, service: Served) -> MonitoringState:
    """Begin to watch; it goes on without any browser, until it is stopped."""
    service.watch(asked.source, asked.speed)
    return get_monitoring(service)


@router.post("/api/monitoring/stop")
@needs("operator")
def stop(service: Served) -> MonitoringState:
    """Stop watching the robot."""
    service.monitoring.stop()
    return get_monitoring(service)


@router.get("/api/health", responses=REFUSED)
def get_health(
    service: Served, horizon: Annotated[float, Query(gt=0, le=LONGEST)] | None = None
) -> Health:  # fmt: skip
    """The robot's health now: as watched, else as it is by design and what a store has of its past.

    What will fail it is looked for within a ``horizon`` [h of calendar time], else within the median remaining life.
    """
    run = service.monitoring.run
    changed = False
    if run:
        draft = service.workspace.draft()
        checked = service.workspace.checked.of(draft.text)
        changed = checked.robot is None or checked.robot.design_hash != run.robot.design_hash
    if run and run.report:
        sensors = freshness(run.robot, service)
        with service.monitoring.alarm_log(run.robot) as log:
            alarms = log.alarms(open_only=True)
        return health_of(
            run.report, run.lives, run, why=told_since(run.why, run.lives, service), design_changed=changed,
            sensors=sensors, horizon=horizon, alarms=alarms,
        )  # fmt: skip
    prepared = service.prepared()
    report, why = prepared.health(*service.past(prepared))
    sensors = freshness(prepared.robot, service)
    with service.monitoring.alarm_log(prepared.robot) as log:
        alarms = log.alarms(open_only=True)
    return health_of(
        report, report, run, why=told_since(why, report, service), design_changed=changed, sensors=sensors,
        horizon=horizon, alarms=alarms,
    )  # fmt: skip


def told_since(why: Explanation | None, report: HealthReport | None, service: Service) -> Explanation | None:
    """Return why a robot's health is as the report says, with since when, as its history tells."""
    if why is None or report is None or not any(part.stresses for part in why.parts):
        return why
    known = service.told
    if known and known[0] is why:  # which is made anew at each look, and asked for each second
        return known[1]
    with service.monitoring.history() as store:
        told = with_since(why, store.history(report.design.identity) if store else None, report.time)
        if store:
            service.told = why, told
    return told


def freshness(robot: Robot, service: Service) -> list[Freshness]:
    """Return the silence of each bound signal before the newest sample [s]."""
    run = service.monitoring.run
    heard = service.monitoring.board.last(robot.signals) if run else {}
    newest = run.ledger.newest / SECOND if run and run.ledger and run.ledger.newest is not None else None
    silent = run.report.stale if run and run.report else frozenset()
    found = []
    for signal, unit in robot.signals.items():
        time, value = heard.get(signal, (None, None))
        if time is None and run and (last := run.heard.get(signal)) is not None:
            time = last / SECOND
        age = max(newest - time, 0.0) if time is not None and newest is not None else None
        most = robot.max_ages.get(signal)
        stale = run is not None and (age is None or signal in silent)
        found.append(Freshness(signal=signal, unit=unit, value=value if value == value else None, age=age,
                               max_age=None if most is None else most / SECOND, stale=stale))  # fmt: skip
    return found


@router.get("/api/topics", responses=REFUSED)
def get_topics(service: Served, source: str) -> Topics:
    """The topics that a source offers: types, rates, fields, and the last values of bound signals."""
    choice = chosen(dict(service.sources), source)
    with choice.open(1.0) as opened:
        infos = opened.topics()
    board, found = service.monitoring.board, []
    for info in infos:
        fields = []
        for field in info.fields:
            try:
                last = board.last([signal_name(info.topic, field)])
            except Exception:
                last = {}
            value = next((value for _, value in last.values()), None)
            fields.append(
                TopicField(field=field, unit=field_unit(info.type, field), last=value if value == value else None)
            )
        found.append(Topic(topic=info.topic, type=info.type, messages=info.messages, rate=info.rate, fields=fields))
    return Topics(source=choice.label, topics=found)


@router.post("/api/sensors/test", responses=REFUSED)
@needs("viewer")
def test_sensor(asked: SensorTest, service: Served) -> SensorTested:
    """Try a binding: the value that it would have heard last."""
    signal = signal_name(asked.topic, asked.field)
    split_signal(signal)
    scale, offset = conversion(asked.unit, asked.wanted) if asked.unit or asked.wanted else (1.0, 0.0)
    heard = service.monitoring.board.last([signal])
    if signal not in heard:
        words = "not heard: monitoring does not listen to it yet" if service.monitoring.state == "running" else (
            "not heard: monitoring does not run")  # fmt: skip
        return SensorTested(signal=signal, raw=None, value=None, age=None, words=words)
    time, raw = heard[signal]
    run = service.monitoring.run
    newest = run.ledger.newest if run and run.ledger else None
    age = max(newest / SECOND - time, 0.0) if newest is not None else None
    if raw != raw:
        return SensorTested(signal=signal, raw=None, value=None, age=age, words="says that it has no value")
    value = scale * raw + offset
    return SensorTested(signal=signal, raw=raw, value=value, age=age, words=f"{value:.6g} {asked.wanted}".strip())


@router.get("/api/series")
def get_series(service: Served) -> SeriesNames:
    """The names of all series that have been recorded since monitoring began."""
    return SeriesNames(names=service.monitoring.board.names())


Topic.model_rebuild()
Topics.model_rebuild()


@router.websocket("/api/live")
async def live(socket: WebSocket) -> None:
    """Live values: a client says what it watches, frames come ten times a second while there is something new."""
    service: Service = socket.app.state.service
    await socket.accept()
    viewer = Viewer(service)
    hearing = asyncio.create_task(_hear(socket, viewer))
    try:
        while not hearing.done():
            if (frame := viewer.frame()) is not None:
                await socket.send_bytes(frame)
            await asyncio.wait([hearing], timeout=PERIOD)
    except (WebSocketDisconnect, RuntimeError):
        pass
    finally:
        hearing.cancel()
        if socket.application_state is not WebSocketState.DISCONNECTED:
            with suppress(RuntimeError, WebSocketDisconnect):  # the browser was faster
                await socket.close(1000)


async def _hear(socket: WebSocket, viewer: Viewer) -> None:
    """Hear the client until it leaves, or says what nobody understands."""
    while True:
        try:
            text = await socket.receive_text()
        except (WebSocketDisconnect, KeyError, RuntimeError):
            return
        try:
            viewer.hear(json.loads(text))
        except (ValueError, TypeError, KeyError, RecursionError):
            await socket.close(1003, "not understood; expected a JSON object with 'watch' or 'history'")
            return
