"""Orders of VDA 5050 and states that tell of them: planned when they are released, done when nothing is left.

The order is the one that the specification prints in its figure of an order with base and horizon, with lengths added;
fields are those that its JSON schemas require.
"""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from robophm.core.signal import HOUR, SECOND
from robophm.transports.mqtt.json_message import parsed
from robophm.transports.tasks import DoneLeg, DoneTask, PlannedLeg, PlannedTask, TaskTopics

T0 = 1_790_000_000 * SECOND
WAY = [(0.0, 0.0), (3.0, 4.0), (3.0, 10.0), (11.0, 10.0)]


def node(number: int, *, released: bool = True, place: bool = True) -> dict[str, Any]:
    x, y = WAY[number]
    position = {"nodePosition": {"x": x, "y": y, "mapId": "hall"}} if place else {}
    return {"nodeId": f"n{number}", "sequenceId": 2 * number, "released": released, "actions": [], **position}


def edge(number: int, *, released: bool = True, **more: Any) -> dict[str, Any]:
    return {
        "edgeId": f"e{number}", "sequenceId": 2 * number + 1, "released": released, "startNodeId": f"n{number}",
        "endNodeId": f"n{number + 1}", "actions": [], **more,
    }  # fmt: skip


def order(nodes: list[dict[str, Any]], edges: list[dict[str, Any]], update: int = 0) -> dict[str, Any]:
    return {"headerId": 1, "orderId": "bring", "orderUpdateId": update, "nodes": nodes, "edges": edges}


def state(left: int, place: int = 0, name: str = "bring", **more: Any) -> dict[str, Any]:
    nodes = [{"nodeId": f"n{k}", "sequenceId": 2 * k, "released": True} for k in range(left)]
    x, y = WAY[place]
    at = {"x": x, "y": y, "theta": 0.0, "mapId": "hall", "positionInitialized": True}
    return {
        "headerId": 1, "orderId": name, "orderUpdateId": 0, "lastNodeId": "n0", "lastNodeSequenceId": 0,
        "nodeStates": nodes, "edgeStates": [], "agvPosition": at, "actionStates": [], "driving": left > 0, **more,
    }  # fmt: skip


def told(*messages: dict[str, Any]) -> tuple[list[Any], dict[str, int]]:
    """What a listener makes of messages, one every ten seconds, as they come from a broker."""
    topics = TaskTopics()
    found = []
    for number, message in enumerate(messages):
        topic = "/order" if "nodes" in message else "/state"
        found.append(topics.hear(T0 + 10 * number * SECOND, topic, parsed(json.dumps(message).encode())))
    return [one for one in found if one], dict(topics.notes)


BASE = order(
    [node(0), node(1), node(2), node(3, released=False)], [edge(0, maxSpeed=0.5), edge(1), edge(2, released=False)]
)


def test_what_is_released_is_planned_and_done_when_nothing_is_left() -> None:
    """5 m by 3, 4, 5 and 6 m straight on; the horizon is no promise."""
    tasks, notes = told(BASE, state(3), state(1, 1), state(0, 2), state(0, 2))
    assert tasks == [
        PlannedTask(T0, "/order", (PlannedLeg(5.0, 0.5), PlannedLeg(6.0, None))),
        DoneTask(T0 + 10 * SECOND, T0 + 30 * SECOND, "/state", (DoneLeg(11.0, 20 * SECOND / HOUR),)),
    ]
    assert notes == {}


def test_an_update_plans_what_it_releases_and_a_stated_length_wins_over_the_straight_way() -> None:
    more = order([node(2), node(3)], [edge(2, length=9.5)], update=1)
    tasks, _ = told(BASE, state(3), more, state(1, 2), state(0, 3))
    assert [one.legs for one in tasks if isinstance(one, PlannedTask)][1] == (PlannedLeg(9.5, None),)
    assert tasks[-1].legs == (DoneLeg(20.5, 30 * SECOND / HOUR),)


def test_without_the_order_the_way_is_from_position_to_position() -> None:
    tasks, notes = told(state(3), state(1, 1), state(0, 2))
    assert tasks == [DoneTask(T0, T0 + 20 * SECOND, "/state", (DoneLeg(11.0, 20 * SECOND / HOUR),))]
    assert notes == {}


def test_it_is_not_done_before_its_actions_are() -> None:
    lifting, lifted = ({"actionStates": [{"actionId": "a", "actionStatus": one}]} for one in ("RUNNING", "FINISHED"))
    tasks, _ = told(BASE, state(3), state(0, 2, **lifting), state(0, 2, **lifted))
    assert tasks[-1].end == T0 + 30 * SECOND


@pytest.mark.parametrize(
    "action",
    [{"actionId": "a", "actionStatus": "FAILED"},
     {"actionId": "c", "actionType": "cancelOrder", "actionStatus": "FINISHED"}],
)  # fmt: skip
def test_what_failed_or_was_cancelled_is_not_done(action: dict[str, str]) -> None:
    tasks, notes = told(BASE, state(3), state(0, 1, actionStates=[action]))
    assert len(tasks) == 1
    assert notes == {"an order that ended without success": 1}


def test_another_order_before_the_end_and_an_order_without_lengths_are_said() -> None:
    _, notes = told(BASE, state(3), state(2, name="other"))
    assert notes == {"an order without an end": 1}
    tasks, notes = told(order([node(0, place=False), node(1, place=False)], [edge(0)]), state(1), state(0, 1))
    assert [one.legs for one in tasks] == [(DoneLeg(5.0, 10 * SECOND / HOUR),)]  # by its positions
    assert notes == {"/order: an order that says neither the length of its edges nor where its nodes are": 1}


LARGE = 10**400
"""A number of JSON that is too large for a float."""


@pytest.mark.parametrize(
    "message",
    [{"orderId": "x", "nodes": 3}, {"orderId": "x", "nodes": [{}], "edges": []},
     {"orderId": "x", "nodeStates": None, "edgeStates": []}, {"orderId": "x", "nodeStates": [1], "edgeStates": [],
                                                              "agvPosition": {"x": "a"}, "actionStates": []},
     order([node(0), node(1)], [edge(0, length=LARGE)]), order([node(0), node(1)], [edge(0, maxSpeed=LARGE)]),
     order([node(0), node(1)], [edge(0) | {"sequenceId": math.inf}]),
     state(1) | {"agvPosition": {"positionInitialized": True, "x": LARGE, "y": 0}},
     {"feedback": 1}, {"status_list": 1}, {"status_list": [{}]}, {"result": 1, "status": 2},
     {"goal": {"target_pose": {"pose": {"position": {"x": "a", "y": 1}}}}}],
)  # fmt: skip
def test_what_is_no_order_is_counted(message: dict[str, Any]) -> None:
    tasks, notes = told(message)
    assert tasks == []
    assert list(notes.values()) == [1]


def test_a_robot_without_an_order_tells_of_none() -> None:
    assert told(state(0, name=""), state(0, name="old")) == ([], {})
