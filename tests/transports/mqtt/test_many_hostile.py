"""Thousands of hostile messages through a broker: nothing ends, and states and orders between them all count."""

from __future__ import annotations

import json
import math
import random
import threading
from typing import Any

from robophm.core.signal import Sample
from robophm.monitoring.live_tasks import JudgedTask, LiveTasks
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_watch import WearWatch
from robophm.transports.mqtt import Mqtt
from robophm.transports.signals.source import LiveSource, WholeMessage
from robophm.transports.tasks.orders import ORDER_TOPICS

from ...monitoring.designs import robot as designed
from ..hostile import FEW_AND_MANY, ODD, damaged, deep, endured
from .conftest import Broker, Robot
from .test_vda5050 import CHARGE, ROOT, header, state

STRANGE: list[Any] = [*ODD, math.inf, math.nan, 10**400, -(10**400), False, "ONLINE", [{"a": 1}], {"x": None}]
NAMES = ["state", "order", "connection", "a.b", "a b", "x" * 2000, "robot_task_list", "task_time", "move_base/status"]


def order(number: int, length: float) -> dict[str, Any]:
    """One released edge of this length [m]."""
    nodes = [{"nodeId": f"n{at}", "sequenceId": 2 * at, "released": True, "actions": [],
              "nodePosition": {"x": at, "y": 0.0, "mapId": "hall"}} for at in (0, 1)]  # fmt: skip
    edge = {"edgeId": "e", "sequenceId": 1, "released": True, "startNodeId": "n0", "endNodeId": "n1", "actions": [],
            "length": length, "maxSpeed": 1.0}  # fmt: skip
    return header(number) | {"orderId": f"order {number}", "orderUpdateId": 0, "nodes": nodes, "edges": [edge]}


def changed(message: Any, draw: random.Random) -> Any:
    """A message of which one thing, however deep in it, is another or is not there."""
    if not isinstance(message, dict | list) or not message or draw.random() < 0.1:
        return draw.choice(STRANGE)
    key = draw.choice(list(message) if isinstance(message, dict) else range(len(message)))
    copy = message.copy()
    if draw.random() < 0.1:
        del copy[key]
    else:
        copy[key] = changed(message[key], draw)
    return copy


class Watching(threading.Thread):
    """Takes what a source gives as ``robophm watch`` does: samples for the monitor, messages for tasks."""

    def __init__(self, source: LiveSource) -> None:
        super().__init__(daemon=True)
        place = {"topic": "/state", "field": CHARGE.partition(".")[2], "unit": "degC"}
        design = designed(components={"motor": {"rate": "0.01 /h", "acceleration": {"model": "q10"},
                                                "signals": {"temperature": place}}})  # fmt: skip
        self.monitor = Monitor(design)
        self.tasks = LiveTasks(self.monitor, WearWatch(design))
        self.monitor.on_tick = lambda _: self.tasks.remember()
        self.values: list[float] = []
        self.lengths: list[float | None] = []
        self.error: Exception | None = None
        self._items = source.listen([CHARGE, "/good.value"], ORDER_TOPICS)
        self.start()

    def run(self) -> None:
        try:
            for item in self._items:
                if isinstance(item, Sample):
                    self.monitor.observe(item)
                    self.values.append(item.value)
                elif isinstance(item, WholeMessage) and isinstance(judged := self.tasks.hear(item), JudgedTask):
                    self.lengths.append(judged.distance)
        except Exception as error:  # whatever it is, the test says it
            self.error = error


@FEW_AND_MANY
def test_states_and_orders_beside_hostile_messages_all_count(broker: Broker, many: int) -> None:
    robot = Robot(broker, ROOT)
    fine = [("/state", state(1, 0.5, agvPosition={"positionInitialized": True, "x": 1.0, "y": 2.0})),
            ("/order", order(1, 5.0)), ("/connection", header(1) | {"connectionState": "ONLINE"}),
            ("/state", {"goal_id": {"id": "a"}, "feedback": {"distance_remaining": 1.0}, "status": {"status": 1}}),
            ("/state", {"status_list": [{"goal_id": {"id": "a"}, "status": 3}]})]  # fmt: skip
    with Mqtt(broker.address(ROOT)) as source:
        watching = Watching(source)

        def hostile(draw: random.Random) -> None:
            topic, message = draw.choice(fine)
            text = json.dumps(changed(message, draw))
            raw = draw.choice([text, text, text, text, damaged(text, draw), deep(draw)]).encode()
            if draw.random() < 0.1:
                topic, raw = f"/{draw.choice(NAMES)}{draw.randrange(10**6)}", draw.choice([raw, draw.randbytes(50)])
            robot._client.publish(f"{ROOT}{topic}", raw)

        def good(number: int) -> None:
            robot.say("/good", {"value": 1e6 + number})
            robot.say("/state", state(number, 2e6 + number))
            robot.say("/order", order(1000 + number, 1000.0 + number))

        def heard(number: int) -> bool:
            assert watching.error is None, repr(watching.error)
            late = watching.values[-500:]
            return 1e6 + number in late and 2e6 + number in late and 1000.0 + number in watching.lengths[-500:]

        endured(many, hostile, good, heard)
        assert source.notes["unreadable message on /state"] > many // 100
        assert not [note for note in source.notes if note.startswith("internal error")]
        assert len(watching.tasks.notes) < 100
    robot.close()
