"""Nav2 and PX4 whose workspace is not here: what they say is heard all the same, or it is said why not."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.transports.ros2_dds import definition
from robophm.transports.ros2_dds.definition import known
from robophm.transports.ros2_dds.interfaces import PX4_RELEASE, releases
from robophm.transports.signals.installed_definitions import gathered
from robophm.transports.signals.source import LiveSource, WholeMessage
from robophm.transports.tasks import DoneTask, PlannedTask
from robophm.transports.tasks.listener import TaskTopics, topics_to_hear

from ..listener import Heard, within
from .conftest import Peer, published

SUCCEEDED, CANCELLED, ABORTED = 4, 5, 6  # action_msgs/GoalStatus
ACTION = "/navigate_to_pose/_action"
VEHICLE_STATUS = "RIHS01_828bddbb7d4c2aa6ad93757955f6893be1ec5d8f11885ec7715bcdd76b5226c9"
"""The hash that `ros2 topic info -v /fmu/out/vehicle_status` prints in PX4's guide (Zenoh, PX4 ROS 2 interface)."""


@pytest.fixture
def robot(_participant: None, domain: int) -> Iterator[Peer]:
    peer = Peer(sys.executable, str(Path(__file__).with_name("robot_peer.py")), str(domain))
    yield peer
    peer.close()


def test_five_goals_of_nav2_are_five_tasks_of_which_three_are_done(robot: Peer, live: LiveSource) -> None:
    published(live, f"{ACTION}/feedback", f"{ACTION}/status")
    listened = live.listen([], topics_to_hear())
    robot.matched()  # what is said before nobody hears
    tasks = TaskTopics()
    told: list[PlannedTask | DoneTask] = []
    for number, end in enumerate((SUCCEEDED, ABORTED, SUCCEEDED, CANCELLED, SUCCEEDED), 1):
        for command in (f"far {number} {10.0 * number}", f"far {number} {10.0 * number - 4}", f"ends {number} {end}"):
            robot.tell(command)
            heard = next(one for one in listened if isinstance(one, WholeMessage))
            if task := tasks.hear(heard.time, heard.topic, heard.message):
                told.append(task)
    assert [task.legs[0].distance for task in told if isinstance(task, PlannedTask)] == [10, 20, 30, 40, 50]
    ends = ["succeeded", "failed", "succeeded", "cancelled", "succeeded"]
    assert [task.outcome for task in told if isinstance(task, DoneTask)] == ends
    assert [task.goal for task in told[::2]] == [task.goal for task in told[1::2]]  # each ends by its own name


def test_px4_is_heard_by_the_version_in_its_topic(robot: Peer, live: LiveSource) -> None:
    published(live, "/fmu/out/battery_status_v1")
    names = ["voltage_v", "current_a", "voltage_cell_v[1]"]
    heard = Heard(live, *(f"/fmu/out/battery_status_v1.{name}" for name in names))

    def said() -> bool:
        robot.tell(
            "battery 15.75 12.5 3.9375,3.9453125"
        )  # again and again, as PX4 does: what is best effort may be lost
        return bool(heard.of("/fmu/out/battery_status_v1.voltage_v"))

    within(8, said)
    assert [{*heard.of(f"/fmu/out/battery_status_v1.{name}")} for name in names] == [{15.75}, {12.5}, {3.9453125}]


def test_releases_of_px4_that_differ_are_not_guessed(
    robot: Peer, live: LiveSource, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot.tell("old")
    published(live, "/fmu/out/battery_status")
    with pytest.raises(SourceError, match=r"releases 1\.14, 1\.15, 1\.16 of PX4 define 'px4_msgs/msg/BatteryStatus' "
                                          r"differently, .* expected PX4_RELEASE=1\.16"):  # fmt: skip
        live.samples(["/fmu/out/battery_status.voltage_v"])
    monkeypatch.setenv(PX4_RELEASE, "1.15")
    assert known("/fmu/out/battery_status", "px4_msgs/msg/BatteryStatus").origin == "px4_msgs of 1.15"
    monkeypatch.setenv(PX4_RELEASE, "9")
    with pytest.raises(SourceError, match=r"PX4_RELEASE is '9', of which no messages are known; expected one of 1\.14"):
        known("/fmu/out/battery_status", "px4_msgs/msg/BatteryStatus")


def test_the_hash_that_px4_prints_is_found() -> None:
    assert known("/fmu/out/vehicle_status", "px4_msgs/msg/VehicleStatus", VEHICLE_STATUS).origin == "px4_msgs of 1.16"


def test_a_type_in_a_type_of_an_action_is_a_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As in Nav2's NavigateThroughPoses since Kilted: rosidl takes it for one of the package's own messages."""
    share = tmp_path / "share" / "own_msgs"
    (share / "msg").mkdir(parents=True)
    (share / "action").mkdir()
    (share / "msg" / "Part.msg").write_text("float32 x\n")
    (share / "action" / "Go.action").write_text("---\n---\nPart[] parts\nPart one\nfloat32 far\n")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    found = known("/go/_action/feedback", "own_msgs/action/Go_FeedbackMessage")
    assert "own_msgs/msg/Part" in found.type.definitions


@pytest.mark.full
@pytest.mark.parametrize("package", ["control_msgs", "nav2_msgs", "px4_msgs"])
def test_every_definition_is_whole(package: str) -> None:
    """All types in it are there too, of the same release; a type that no release changed has one hash."""
    hashes: dict[tuple[str, str], set[str]] = {}
    for release, types in releases(package).items():
        for name, own in types.items():
            text = gathered(name, partial(definition._shipped, types))
            assert text is not None
            found = definition._compiled("/x", name, text, release)
            if not any("/" in line.split()[0] for line in own.text.splitlines()):
                hashes.setdefault((name, own.text), set()).add(found.hash)
    assert hashes
    assert all(len(same) == 1 for same in hashes.values())
