"""A robot that tells its state by VDA 5050: what is heard of it, and what its silence is taken for."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

import robophm
from robophm.core.signal import SECOND
from robophm.stores import open_store
from robophm.transports.mqtt import Mqtt

from ..drafted import drafted_of_a_robot_that_runs
from ..listener import Heard, within
from .conftest import Broker, Robot

ROOT = "uagv/v2/MAKER/00.1"  # a serial number may have dots (VDA 5050 2.1, Topic levels)
CHARGE, LEFT = (
    "/state.batteryState.batteryCharge",
    "/state.information[temperatures].infoReferences[left].referenceValue",
)


def header(number: int, ago: float = 0.0) -> dict[str, Any]:
    """As printed in the specification: 2017-04-15T11:40:03.123Z."""
    at = datetime.now(UTC) - timedelta(seconds=ago)
    stamp = at.strftime("%Y-%m-%dT%H:%M:%S.") + f"{at.microsecond // 1000:03d}Z"
    return {
        "headerId": number, "timestamp": stamp, "version": "2.1.0", "manufacturer": "MAKER", "serialNumber": "00.1",
    }  # fmt: skip


def state(number: int, charge: float, ago: float = 0.0, **more: Any) -> dict[str, Any]:
    """The fields of a state that VDA 5050 2.1 requires (its JSON schema), and some of those that may be left out."""
    references = [{"referenceKey": "right", "referenceValue": "39"}, {"referenceKey": "left", "referenceValue": "41.5"}]
    return header(number, ago) | {
        "orderId": "", "orderUpdateId": 0, "lastNodeId": "n1", "lastNodeSequenceId": 0, "nodeStates": [],
        "edgeStates": [], "driving": True, "actionStates": [],
        "batteryState": {"batteryCharge": charge, "charging": False}, "operatingMode": "AUTOMATIC", "errors": [],
        "safetyState": {"eStop": "NONE", "fieldViolation": False},
        "information": [{"infoType": "temperatures", "infoLevel": "INFO", "infoReferences": references}],
    } | more  # fmt: skip


@pytest.fixture
def robot(broker: Broker) -> Iterator[Robot]:
    robot = Robot(broker, ROOT)
    yield robot
    robot.say("/connection", b"", retain=True)  # the broker keeps nothing for the next test
    robot.say("/state", b"", retain=True)
    robot.close()


@pytest.fixture
def source(broker: Broker, robot: Robot) -> Iterator[Mqtt]:
    with Mqtt(broker.address(ROOT)) as source:
        yield source


def test_a_state_is_numbers_with_the_time_that_it_states(source: Mqtt, robot: Robot) -> None:
    names = [CHARGE, LEFT, "/state.driving", "/state.velocity.vx", "/state.errors[motorHot].errorLevel"]
    heard = Heard(source, *names)
    robot.say("/state", first := state(1, 80.5, ago=5))
    robot.say("/state", state(2, 80.25, velocity={"vx": 0.5, "vy": 0, "omega": 0}))
    within(5, lambda: heard.of(CHARGE) == [80.5, 80.25])
    assert heard.of("/state.driving") == [1.0, 1.0]
    assert heard.of(LEFT) == [41.5, 41.5]
    assert heard.of("/state.velocity.vx") == [0.5]  # optional: no zero before it was there
    stated = next(sample.time for sample in heard.samples if sample.signal == CHARGE)
    assert stated == round(datetime.fromisoformat(first["timestamp"]).timestamp() * 1000) * 1_000_000
    (info,) = [info for info in source.topics() if info.topic == "/state"]
    assert (info.type, info.messages) == ("vda5050/state", 2)
    assert {"batteryState.batteryCharge", "safetyState.fieldViolation"} <= set(info.fields)
    assert source.notes["no element for /state.velocity.vx"] == 1


def test_what_is_missing_of_a_topic_is_counted_by_its_header(source: Mqtt, robot: Robot) -> None:
    heard = Heard(source, CHARGE)
    for number in (7, 8, 11, 1, 2):  # two are lost; then the robot is started anew
        robot.say("/state", state(number, float(number)))
    within(5, lambda: len(heard.of(CHARGE)) == 5)
    assert source.notes["sequence gap on /state"] == 2


def test_what_the_broker_kept_for_long_is_no_sample(broker: Broker, robot: Robot) -> None:
    robot.say("/state", state(1, 99.0, ago=3600), retain=True)
    with Mqtt(broker.address(ROOT)) as source:
        heard = Heard(source, CHARGE)
        within(5, lambda: source.notes["kept by the broker for long, not taken: /state"] == 1)
        robot.say("/state", state(2, 98.0))
        within(5, lambda: heard.of(CHARGE) == [98.0])


def test_a_last_will_is_told_and_no_value_outlives_it(source: Mqtt, broker: Broker) -> None:
    heard = Heard(source, CHARGE)
    leaving = Robot(broker, ROOT, will=header(0, 3600) | {"connectionState": "CONNECTIONBROKEN"})
    leaving.say("/connection", header(1) | {"connectionState": "ONLINE"}, retain=True)
    leaving.say("/state", state(1, 80.0))
    within(5, lambda: heard.of(CHARGE) == [80.0])
    leaving.vanish()
    said = "the robot is not connected: /connection says CONNECTIONBROKEN"
    within(20, lambda: source.notes[said] == 1)
    clocks = len(heard.of("clock"))
    within(5, lambda: len(heard.of("clock")) >= clocks + 2)  # time goes on in its silence
    assert heard.of(CHARGE) == [80.0]
    assert source.notes["connection lost on /state"] == 1
    with Mqtt(broker.address(ROOT)) as late:  # who comes then is told too
        within(5, lambda: late.notes.copy()[said] == 1)


DESIGN = """
schema_version: 1
name: AMR
signals:
  temperature: {topic: /state, unit: degC, max_age: 2 s, range: [-40, 125],
                field: 'information[temperatures].infoReferences[left].referenceValue'}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 31.5 degC}}}
thresholds: {signals: {'/state.information[temperatures].infoReferences[left].referenceValue': {above: 40 degC}}}
"""


def _speak(robot: Robot, over: threading.Event) -> None:
    number = 0
    while not over.wait(0.1):
        number += 1
        robot.say("/state", state(number, 80.0))


def test_an_order_is_judged_when_it_arrives_and_when_it_is_done(broker: Broker, robot: Robot, tmp_path: Path) -> None:
    """5 m at 0.5 m/s and 6 m at a metre a second, 16 s, at 0.01 /h; it is lived at up to twice that rate."""
    (tmp_path / "robot.yaml").write_text(DESIGN.partition("thresholds")[0])
    for which in ("predicted", "actual"):
        robot.hear(f"{ROOT}/phm/task_{which}")
    robot.hear(f"{ROOT}/phm_hazard_rate")
    words = ["watch", "robot.yaml", "--via", broker.address(ROOT), "--period", "0.5", "--every", "0.5"]
    words += ["--speed", "1 m/s"]
    process = subprocess.Popen([sys.executable, "-m", "robophm", *words], cwd=tmp_path, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)  # fmt: skip
    over, said = threading.Event(), {"orderId": "", "nodeStates": []}

    def speak() -> None:
        number = 0
        while not over.wait(0.1):
            number += 1
            robot.say("/state", state(number, 80.0, **said))

    def judged(which: str) -> list[dict[str, Any]]:
        return [json.loads(raw) for topic, raw in list(robot.heard) if topic == f"{ROOT}/phm/task_{which}"]

    def ticks() -> int:
        return sum(topic.endswith("/phm_hazard_rate") for topic, _ in list(robot.heard))

    speaking = threading.Thread(target=speak)
    speaking.start()
    try:
        assert process.stderr is not None
        assert process.stderr.readline().startswith("listening to MQTT")
        nodes = [{"nodeId": f"n{k}", "sequenceId": 2 * k, "released": True, "actions": []} for k in range(3)]
        edges = [{"edgeId": f"e{k}", "sequenceId": 2 * k + 1, "released": True, "startNodeId": f"n{k}", "actions": [],
                  "endNodeId": f"n{k + 1}", "length": length} | more
                 for k, (length, more) in enumerate([(5.0, {"maxSpeed": 0.5}), (6.0, {})])]  # fmt: skip
        order = header(1) | {"orderId": "bring", "orderUpdateId": 0, "nodes": nodes, "edges": edges}

        def planned() -> bool:
            robot.say("/order", order)  # again, until somebody listens; it plans nothing twice
            return bool(judged("predicted"))

        within(60, planned)
        predicted = judged("predicted")[0]
        assert (predicted["topic"], predicted["distance"]) == ("/order", 11)
        assert predicted["duration"] * 3600 == pytest.approx(16, rel=1e-12)
        assert predicted["failure_nominal"] == pytest.approx(-math.expm1(-0.01 * 16 / 3600), rel=1e-9)
        within(60, lambda: ticks() > 5)
        said |= {"orderId": "bring", "nodeStates": nodes[1:]}  # of a robot of which something is known
        begun = ticks()
        within(60, lambda: ticks() > begun + 3)
        said |= {"nodeStates": []}
        within(60, lambda: bool(judged("actual")))
        (actual,) = judged("actual")
        assert (actual["topic"], actual["distance"]) == ("/state", 11)
        assert actual["duration"] * 3600 > 0.5
        assert 1 < actual["failure_sensor_based"] / actual["failure_nominal"] < 2 + 1e-6
    finally:
        over.set()
        process.send_signal(signal.SIGINT)
        _, warned = process.communicate(timeout=50)
        speaking.join()
    assert process.returncode == 0, warned


def _statuses(robot: Robot, name: str) -> list[dict[str, Any]]:
    """What /diagnostics said so far of this name."""
    said = [json.loads(raw) for topic, raw in list(robot.heard) if topic == f"{ROOT}/diagnostics"]
    return [status for one in said for status in one["status"] if status["name"].endswith(f": {name}")]


def _listening(robot: Robot) -> list[dict[str, Any]]:
    """What health's own status on /diagnostics said so far of what was lost or silent."""
    return _statuses(robot, "listening")


def _said(robot: Robot, name: str) -> str:
    """What /diagnostics said last of the robot."""
    return "; ".join(one["message"] for one in _statuses(robot, name)[-1:])


def _rates(robot: Robot) -> list[float]:
    """The sensor-based hazard rates that were published."""
    told = [json.loads(raw) for topic, raw in list(robot.heard) if topic.endswith("/phm_hazard_rate")]
    return [one["system_sensor_based_value"] for one in told]


def test_watch_ages_by_what_it_says_and_tells_its_health(broker: Broker, robot: Robot, tmp_path: Path) -> None:
    """At 41.5 °C, ten over the reference, q10 = 2 doubles the rate."""
    (tmp_path / "robot.yaml").write_text(DESIGN)
    robot.hear(f"{ROOT}/phm_hazard_rate")
    robot.hear(f"{ROOT}/diagnostics")
    words = ["watch", "robot.yaml", "--via", broker.address(ROOT), "--period", "0.5", "--every", "0.5", "--json"]
    words += ["--store", "past.db"]
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", *words], cwd=tmp_path, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, env=os.environ,
    )  # fmt: skip
    try:
        assert process.stderr is not None
        assert process.stderr.readline() == f"listening to MQTT (mqtt): {broker.address(ROOT)}, as asked\n"
        assert process.stdout is not None
        lines, alarms = (json.loads(line) for line in process.stdout), list[dict[str, Any]]()
        robots = (one["subjects"][0] for one in lines if "alarm" not in one or alarms.append(one["alarm"]))
        over, speaking = threading.Event(), threading.Thread(target=lambda: _speak(robot, over))
        speaking.start()
        assert any(one["sensor_based"]["hazard_rate"] == pytest.approx(0.02, rel=1e-9) for one in robots)
        over.set()
        speaking.join()
        assert f"warning: silent: {LEFT}\n" in process.stderr  # at once, not at the end
        silent = next(one for one in robots if one["silence"])  # as hot as it was, not as cool as it was designed
        assert silent["sensor_based"]["hazard_rate"] == pytest.approx(0.02, rel=1e-9)
        assert silent["silence"].endswith(f" of {LEFT}")
        within(5, lambda: f"stale {LEFT}" in _said(robot, "AMR"))
        # the alarm on 41.5 °C began while it was heard, goes on in its silence, and nobody knows whether it does
        within(5, lambda: "; whether it goes on is not known" in _said(robot, f"alarm: {LEFT} above (error)"))
        assert _statuses(robot, f"alarm: {LEFT} above (error)")[0]["message"] == f"{LEFT}: 41.5 °C is above 40 °C"
        count = len(_rates(robot))
        within(5, lambda: len(_rates(robot)) > count + 1)
        assert _rates(robot)[-1] == pytest.approx(0.02, rel=1e-6)
        within(5, lambda: any(told["level"] == 1 and LEFT in told["message"] for told in _listening(robot)))
        within(5, lambda: any(topic.endswith("/phm_hazard_rate") for topic, _ in list(robot.heard)))
        told = next(json.loads(raw) for topic, raw in robot.heard if topic.endswith("/phm_hazard_rate"))
        assert told["stamp"]["sec"] == pytest.approx(time.time_ns() / SECOND, abs=60)
        served = robophm.service(str(tmp_path / "robot.yaml"), "motor", tmp_path / "past.db", replaced=True, by="Ada",
                                 wait=30)  # fmt: skip
        assert [(one.kind, one.by) for one in served] == [("replaced", "Ada")]
        assert process.poll() is None  # and it watches on
    finally:
        process.send_signal(signal.SIGINT)
        _, warned = process.communicate(timeout=50)
    assert process.returncode == 0, warned
    assert [(one["what"], one["doubt"] != "") for one in alarms][:2] == [
        (f"{LEFT} above (error)", False), (f"{LEFT} above (error)", True),
    ]  # fmt: skip
    with open_store(tmp_path / "past.db") as store:
        (kept,) = [one for one in store.alarm_log("AMR").alarms(open_only=True) if one["severity"] == "error"]
    assert (kept["begin"], kept["cause"]) == (alarms[0]["begin"], alarms[0]["cause"])


@pytest.mark.full
def test_a_design_is_drafted_of_what_the_broker_has(
    broker: Broker, robot: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A temperature by its name; JSON has no types, and so no part is told of."""
    over = threading.Event()

    def speak() -> None:
        while not over.wait(0.05):
            robot.say("/motor", {"temperature": 35.0})

    speaker = threading.Thread(target=speak)
    speaker.start()
    try:
        drafted_of_a_robot_that_runs(broker.address(ROOT), tmp_path, monkeypatch, capsys)
    finally:
        over.set()
        speaker.join()
