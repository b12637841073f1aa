"""Which signal an input follows: by the words of part and signal, each with its values, and none by a guess."""

import pytest

from robophm.design.file import parse
from robophm.drafting.bindings import proposals
from robophm.drafting.seen import Seen, SeenSignal, SeenTopic

LEFT = "/diagnostics", "status[left motor].values[Temperature].value"


def robot(components, more="usage: {kilometres: 1 km/h, cycles: 10 cycle/h}"):
    return parse(f"schema_version: 1\nname: r\n{more}\ncomponents: {{{components}}}")


def seen(*signals, topics=()):
    return Seen((), tuple(topics), signals)


def warm(topic, field="temperature", low=20.0, high=30.0, samples=10):
    return SeenSignal(topic, field, "temperature", "degC", low, high, samples)


def effort(name, low=-2.0, high=3.0):
    return SeenSignal("/joint_states", f"effort[{name}]", "load", "N*m", low, high, 100)


def bound(robot, seen, efforts=None):
    return {f"{one.part}: {one.input}": one.signals[0] for one in proposals(robot, seen, efforts)[0]}


def test_left_is_left_and_right_right():
    wheels = robot("left motor: {part: bldc_motor}, right motor: {part: bldc_motor}")
    both = seen(warm(*LEFT), warm("/diagnostics", LEFT[1].replace("left", "right")))
    assert bound(wheels, both) == {
        "left motor: temperature": f"{LEFT[0]}.{LEFT[1]}",
        "right motor: temperature": f"{LEFT[0]}.{LEFT[1].replace('left', 'right')}",
    }
    assert bound(wheels, seen(warm(*LEFT))) == {"left motor: temperature": f"{LEFT[0]}.{LEFT[1]}"}


def test_a_temperature_of_the_battery_is_no_temperature_of_the_computer():
    found = bound(robot("battery: {part: battery_li_ion}, computer: {part: mini_pc}"), seen(warm("/battery_state")))
    assert found == {"battery: temperature": "/battery_state.temperature"}


def test_of_two_that_fit_alike_none_is_bound_and_both_are_said():
    found, notes = proposals(
        robot("computer: {part: mini_pc}"), seen(warm("/cpu_a/temperature"), warm("/cpu_b/temperature"))
    )
    assert found == []
    assert notes == [
        "computer: temperature: /cpu_a/temperature.temperature and /cpu_b/temperature.temperature "
        "fit alike; none is bound"
    ]


@pytest.mark.parametrize(
    "dead",
    [
        warm("/battery_state", samples=0),
        warm("/battery_state", low=0.0, high=0.0),  # a driver that does not measure it
        warm("/battery_state", low=-273.0, high=20.0),
    ],
)
def test_what_says_nothing_is_not_bound(dead):
    assert bound(robot("battery: {part: battery_li_ion}"), seen(dead)) == {}


def test_a_load_needs_the_joints_limit_and_is_rated_by_a_share_of_it():
    gears = robot("elbow gear: {part: strain_wave_gear}, wrist 1 gear: {part: strain_wave_gear}, "
                  "wrist 2 gear: {part: strain_wave_gear}")  # fmt: skip
    joints = seen(effort("elbow_joint"), effort("wrist_1_joint"), effort("wrist_2_joint"))
    found, notes = proposals(gears, joints, {"elbow_joint": 100.0, "wrist_2_joint": 28.0})
    assert [(one.part, one.signals[0], one.binding["rated"]) for one in found] == [
        ("elbow gear", "/joint_states.effort[elbow_joint]", 50.0),
        ("wrist 2 gear", "/joint_states.effort[wrist_2_joint]", 14.0),
    ]
    assert "100" in found[0].assumed
    assert len(notes) == 1
    assert "wrist 1 gear: load: /joint_states.effort[wrist_1_joint] has -2 … 3 N*m" in notes[0]


def test_what_is_bound_already_is_left_alone():
    said = "battery: {part: battery_li_ion, signals: {temperature: {topic: /mine, field: t}}}"
    assert bound(robot(said), seen(warm("/battery_state"))) == {}


def test_kilometres_come_from_the_plainest_odometry_and_cycles_from_the_joint():
    topics = [SeenTopic(name, "nav_msgs/Odometry", 10.0) for name in ("/odometry/filtered", "/odom")]
    swings = SeenSignal("/joint_states", "position[gripper_joint]", "position", "", 0.0, 0.8, 100)
    found, _ = proposals(
        robot("gripper: {part: gripper_electric}, wheel: {part: drive_wheel}"), seen(swings, topics=topics)
    )
    assert {one.place: dict(one.binding) for one in found} == {
        ("clocks", "kilometres"): {"topic": "/odom", "position": ["pose.pose.position.x", "pose.pose.position.y"]},
        ("components", "gripper", "clocks", "cycles"): {
            "topic": "/joint_states", "edge": "position[gripper_joint]", "threshold": 0.4,
        },
    }  # fmt: skip


def test_any_names_end_in_proposals_that_a_design_can_have():
    """Names as they come from outside: long, odd, of digits."""
    odd = [warm("/a", f"status[{name}].values[Temperature].value") for name in ("x" * 500, "7", "ü: ß", "cpu/1", " ")]
    found, _ = proposals(robot("computer: {part: mini_pc}"), seen(*odd))
    assert len(found) <= 1
