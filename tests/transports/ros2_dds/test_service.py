"""A robot that asks before it goes, over DDS: asked as rmw_cyclonedds asks, by types written by hand."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from robophm.design.file import parse
from robophm.health.ledger import Ledger
from robophm.monitoring.service_notes import note_service
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.stores.sqlite import SqliteStore
from robophm.transports.health_topics import Outlet, PartReports, TaskService

from ..listener import within
from .conftest import Peer

DESIGN = """
schema_version: 1
name: R
thresholds: {completion: 0.9}
components: {motor: {rate: 0.04 /h}, wheel: {rate: 0.06 /h}}
"""
NODE = "/phm_robot_task_completion_node"


@pytest.fixture
def client(_participant: None, domain: int) -> Iterator[Peer]:
    peer = Peer(sys.executable, str(Path(__file__).with_name("client_peer.py")), str(domain))
    yield peer
    peer.close()


@pytest.fixture
def outlet(_participant: None) -> Iterator[Outlet]:
    from robophm.transports.ros2_dds import Node, Publisher, Service

    outlet = Outlet(2, Node, Publisher, Service)
    TaskService(outlet, TaskAssessor(parse(DESIGN)))
    yield outlet
    outlet.close()


def there(client: Peer) -> str:
    """Whether the services are there that assess tasks and that take reports of failures."""
    client.tell("there")
    return client.line()


def test_a_task_is_judged_as_by_hand_while_the_service_is_there(outlet: Outlet, client: Peer) -> None:
    """Six minutes a leg at 0.1 failures an hour: ten keep 0.9048, eleven do not."""
    within(10, lambda: there(client) == "yes no")
    for number in (10, 11):
        client.tell(f"ask 36 0.1 {number} 0")
        said = json.loads(client.line())
        assert said["completion_nominal"] == pytest.approx(math.exp(-0.01 * number), rel=1e-14)
        assert said["failure_sensor_based"] == pytest.approx(-math.expm1(-0.01 * number), rel=1e-13)
        assert (said["go"], said["longest_prefix"], said["limit"]) == (number == 10, 10, 0.9)
        assert (said["deciding"], said["refused"], said["left_out"]) == (["wheel", "motor"], "", "")
    client.tell("ask 36 0 1 0")
    said = json.loads(client.line())
    assert said["refused"] == "legs/0: expected a distance with a speed above zero, or a duration"
    assert (said["go"], math.isnan(said["completion_nominal"])) == (False, True)
    outlet.close()
    within(10, lambda: there(client) == "no no")


def test_a_failure_that_the_robot_tells_of_is_in_its_past(outlet: Outlet, client: Peer, tmp_path: Path) -> None:
    robot = parse(DESIGN)
    with SqliteStore(tmp_path / "past.db") as store:
        store.save(robot.identity, Ledger.new(robot).to_json())
        PartReports(outlet, robot, lambda said, key: note_service(store.path, robot, said, key=key))
        within(10, lambda: there(client) == "yes yes")
        said = []
        for part in ("motor", "motr", "motor"):
            client.tell(f"fail {part}")
            said.append(json.loads(client.line()))
        assert (said[0]["noted"], said[0]["modes"], said[0]["refused"]) == (True, ["motor"], "")
        assert (said[1]["noted"], said[1]["refused"]) == (False, "no part 'motr'; did you mean 'motor'?")
        assert said[2]["refused"] == "'motor' has failed already; expected that it is replaced or repaired first"
        assert [one.said for one in store.history(robot.identity).events()] == ["motor failed, told by robot"]


def test_who_cannot_be_answered_is_noted(outlet: Outlet, client: Peer) -> None:
    """A client of Fast DDS tells no identity of its own, and says elsewhere who asks."""
    client.tell("strange")
    words = f"{NODE}: /phm/assess_task cannot answer clients of another RMW than Cyclone's over DDS; rclpy can"
    within(10, lambda: outlet.notes.get(words) == 1)


def test_tools_find_the_service_at_its_node(outlet: Outlet, cyclone: Peer) -> None:
    """ros2 service list goes by what a participant tells of its nodes' readers and writers."""

    def told() -> list[str]:
        cyclone.tell("graph")
        return [line for line in iter(cyclone.line, "end") if NODE[1:] in line]

    ends = f"/ {NODE[1:]} reads rq/phm/assess_taskRequest writes rr/phm/assess_taskReply"
    within(10, lambda: told() == [ends])
