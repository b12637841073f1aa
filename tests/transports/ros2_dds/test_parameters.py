"""Parameters of a watch that runs, changed as ros2 param changes them: by a client of Cyclone DDS, types by hand."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from queue import Empty
from types import SimpleNamespace
from typing import Any

import pytest

from robophm.design.file import parse
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.transports.health_topics import Outlet, Parameter, ParameterServices, TaskService

from ..listener import within
from .conftest import FLOAT64, Peer

NODE = "/phm_robot_task_completion_node"
DESIGN = "schema_version: 1\nname: R\nthresholds: {completion: 0.9}\ncomponents: {motor: {rate: 0.1 /h}}\n"
INTEGER, DOUBLE = 2, 3  # rcl_interfaces/ParameterType


@pytest.fixture
def client(_participant: None, domain: int) -> Iterator[Peer]:
    peer = Peer(sys.executable, str(Path(__file__).with_name("parameter_peer.py")), str(domain), NODE)
    yield peer
    peer.close()


def asked(client: Peer, command: str) -> Any:
    client.tell(command)
    return json.loads(client.line())


def there(client: Peer) -> bool:
    client.tell("there")
    return client.line() == "yes"


@pytest.mark.usefixtures("_participant")
def test_listed_described_changed_and_refused_in_words(client: Peer) -> None:
    from robophm.transports.ros2_dds import Node, Publisher, Service

    kept = {"limit": 0.9, "draws": 500.0}
    outlet = Outlet(2, Node, Publisher, Service)
    numbers = [
        Parameter(name, f"about {name}", 0.0, high, lambda name=name: kept[name],
                  lambda value, name=name: kept.update({name: value}), whole=whole)
        for name, high, whole in (("limit", 1.0, False), ("draws", 1000.0, True))
    ]  # fmt: skip
    try:
        assert not ParameterServices(outlet, NODE, numbers).unknown
        within(10, lambda: there(client))
        assert asked(client, "list") == {"result": {"names": ["draws", "limit"], "prefixes": []}}
        limit, none, draws = asked(client, "get limit speed draws")["values"]
        assert (limit["type"], limit["double_value"]) == (DOUBLE, 0.9)
        assert (draws["type"], draws["integer_value"], none["type"]) == (INTEGER, 500, 0)
        assert asked(client, "types draws limit speed") == {"types": [INTEGER, DOUBLE, 0]}
        limit, draws = asked(client, "describe limit draws")["descriptors"]
        assert limit["floating_point_range"] == [{"from_value": 0.0, "to_value": 1.0, "step": 0.0}]
        assert (draws["description"], draws["integer_range"][0]["to_value"]) == ("about draws", 1000)
        said = asked(
            client, 'set limit=0.5 draws=1.5 limt=0.5 limit=2 limit="high" draws=true draws=7 limit=NaN limit=1'
        )
        assert [(one["successful"], one["reason"]) for one in said["results"]] == [
            (True, ""), (False, "draws 1.5: expected a whole number of at least 0 and at most 1000"),
            (False, "no parameter 'limt'; did you mean 'limit'?"),
            (False, "limit 2: expected a number of at least 0 and at most 1"),
            (False, "limit is a text; expected a number"), (False, "draws is a truth value; expected a number"),
            (True, ""), (False, "limit nan: expected a number of at least 0 and at most 1"), (True, ""),
        ]  # fmt: skip
        assert kept == {"limit": 1.0, "draws": 7.0}
        assert not asked(client, "together limit=0.25 draws=-1")["result"]["successful"]
        assert kept == {"limit": 1.0, "draws": 7.0}
        assert asked(client, "together limit=0.25 draws=9")["result"]["successful"]
        assert kept == {"limit": 0.25, "draws": 9.0}
    finally:
        outlet.close()


@pytest.mark.full
def test_a_watch_takes_its_limit_and_how_often_it_publishes(
    peer: Peer, client: Peer, cyclonedds: None, tmp_path: Path
) -> None:
    """Of ten reports a second none is published any more once one in an hour is enough."""
    (tmp_path / "robot.yaml").write_text(DESIGN)
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--via", "dds", "--json", "--period", "0.1"],
        cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        within(50, lambda: there(client))
        assert asked(client, "list")["result"]["names"] == ["draws", "limit", "publish_every"]
        assert asked(client, "get limit")["values"][0]["double_value"] == 0.9
        peer.ask(f"reader r rt/phm/hazard_rate {FLOAT64} reliable latched", "made")
        assert peer.line(10) == peer.line(10)  # one after the other
        assert (
            asked(client, "set publish_every=3600.0 limit=0.99")["results"] == [{"successful": True, "reason": ""}] * 2
        )
        assert asked(client, "get limit")["values"][0]["double_value"] == 0.99
        with suppress(Empty):  # what had been published before
            for _ in range(5):
                peer.line(1)
        with pytest.raises(Empty):
            peer.line(1)
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=50)
    assert process.returncode == 0


def test_the_limit_decides_where_nobody_states_one() -> None:
    """An hour at 0.1 failures an hour is survived with exp(−0.1) = 0.905."""
    assessor = TaskAssessor(parse(DESIGN))
    service = TaskService(Outlet(2, lambda name: None, lambda *_: None), assessor)
    leg = SimpleNamespace(distance=0.0, speed=0.0, duration=1.0, functions=[], stresses=[], stress_values=[])
    request = SimpleNamespace(legs=[leg], limit=0.0, draws=0)
    said = service.answer(request)
    assert (said["go"], said["limit"]) == (True, 0.9)
    assessor.limit = 0.91
    said = service.answer(request)
    assert (said["go"], said["limit"]) == (False, 0.91)
    request.limit = 0.5
    assert service.answer(request)["go"]
