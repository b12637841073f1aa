"""URDFs: what is in the file is found, what moves and senses is named with what was assumed, all else is refused."""

import math
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from robophm.core.errors import DesignError
from robophm.design.draft import untouched
from robophm.design.file import parse
from robophm.design.importers.urdf import described_parts, import_urdf, read_urdf
from robophm.parts import part

DATA = Path(__file__).parents[3] / "data" / "robots"
LINKS = '<link name="base_link"/><link name="arm_link"/>'
JOINT = '<joint name="elbow" type="revolute"><parent link="base_link"/><child link="arm_link"/>{}</joint>'


def urdf(tmp_path, inside, outside=""):
    path = tmp_path / "robot.urdf"
    path.write_text(f'{outside}<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{inside}</robot>')
    return path


def entries(description, drive=None):
    return {one.path: one.entry for one in described_parts(description, drive)}


def test_the_turtlebot_has_two_wheels_a_caster_an_imu_and_a_lidar(shared):
    found = read_urdf(shared / "robots" / "burger.urdf")
    assert found.name == "turtlebot3_burger"
    assert [one.name for one in found.joints if one.moves] == ["wheel_left_joint", "wheel_right_joint"]
    parts = entries(found)
    assert parts["drive/wheel left tread"] == parts["drive/wheel right tread"] == "drive_wheel"
    assert parts["drive/caster back"] == "caster_wheel"
    assert (parts["sensing/imu"], parts["sensing/lidar"]) == ("imu", "lidar_2d_low_cost")
    assert {parts[f"drive/wheel {side} motor"] for side in ("left", "right")} == {"gearmotor_hobby"}


def test_what_moves_the_wheels_can_be_said(shared):
    parts = entries(read_urdf(shared / "robots" / "burger.urdf"), part("smart_servo"))
    assert {parts[f"drive/wheel {side} servo"] for side in ("left", "right")} == {"smart_servo"}
    assert not [path for path in parts if "motor" in path]


def test_a_mesh_named_after_a_servo_says_what_moves_the_joint(shared):
    found = read_urdf(shared / "robots" / "so101.urdf")
    parts = described_parts(found)
    assert {one.entry for one in parts} == {"smart_servo"}
    assert [one.joint for one in parts] == [
        "shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper",
    ]  # fmt: skip
    assert {one.effort for one in parts} == {10.0}
    assert not any(one.assumed for one in parts)
    assert all(joint.driven for joint in found.joints if joint.moves)  # by transmissions


def test_an_arm_of_unnamed_motors_says_so():
    found = read_urdf(DATA / "six_axis_arm.urdf")
    parts = described_parts(found)
    gears = [one for one in parts if one.name == "gear"]
    assert [one.effort for one in gears] == [150, 150, 150, 28, 28, 28]
    assert all("no motor or gear named" in one.assumed for one in gears)
    assert entries(found)["sensing/force torque sensor"] == "force_torque_sensor"
    assert found.plugins == ("arm_driver/PositionHardware",)
    assert all(joint.driven for joint in found.joints if joint.moves)


def test_a_quadrotor_has_four_rotors_and_what_its_tags_of_gazebo_name():
    found = read_urdf(DATA / "quadrotor.urdf")
    parts = list(entries(found).values())
    assert [parts.count(name) for name in ("drone_motor", "esc", "propeller")] == [4, 4, 4]
    assert {"imu", "gnss_receiver", "barometer", "magnetometer"} <= set(parts)
    assert all(joint.driven for joint in found.joints)  # by plugins


def test_frames_of_one_camera_are_one_camera_and_lidars_with_rings_are_3d(tmp_path):
    frames = ["camera_link", "camera_depth_frame", "camera_rgb_optical_frame"]
    chain = zip(["base_link", *frames], frames, strict=False)
    inside = '<link name="base_link"/><link name="top_lidar"/>' + "".join(f'<link name="{name}"/>' for name in frames)
    inside += "".join(
        f'<joint name="{child}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'
        for parent, child in chain
    )
    inside += (
        '<gazebo reference="top_lidar"><sensor name="points" type="gpu_lidar"><topic>/points</topic><ray><scan>'
        "<vertical><samples>16</samples></vertical></scan></ray></sensor></gazebo>"
    )
    assert entries(read_urdf(urdf(tmp_path, inside))) == {
        "sensing/camera": "depth_camera", "sensing/top lidar": "lidar_3d",
    }  # fmt: skip


def test_plain_arguments_are_put_in_and_programs_of_xacro_are_refused_with_the_way_out(tmp_path):
    plain = '<xacro:arg name="ns" default="a_"/><xacro:property name="p" value="$(arg ns)"/><link name="${p}base"/>'
    assert read_urdf(urdf(tmp_path, plain)).links[0].name == "a_base"
    for program in (
        '<xacro:include filename="x"/>',
        '<xacro:macro name="m"/>',
        '<link name="${2*r}"/>',
        "<xacro:arm/>",
    ):
        with pytest.raises(DesignError, match=r"robot.urdf:1: .*xacro.*`xacro robot.urdf > robot.urdf`"):
            read_urdf(urdf(tmp_path, LINKS + program))


@pytest.mark.parametrize(
    ("inside", "says"),
    [
        ("", "describes no link"),
        (LINKS + JOINT.format("").replace("revolute", "hinge"), "joint 'elbow' is 'hinge'; expected one of revolute"),
        (LINKS + JOINT.format("").replace("arm_link", "leg_link"), "joint 'elbow' has no child link 'leg_link'"),
        (LINKS + JOINT.format('<limit effort="strong"/>'), "<limit effort> 'strong' is no number"),
        ("<link/>", "<link> has no name"),
    ],
)
def test_faults_are_one_line_with_the_place(inside, says, tmp_path):
    with pytest.raises(DesignError, match=rf"robot.urdf:1: .*{says}") as refused:
        read_urdf(urdf(tmp_path, inside))
    assert "\n" not in str(refused.value)


def test_hostile_files_are_refused(tmp_path):
    bomb = '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
    with pytest.raises(DesignError, match="declares the entity"):
        read_urdf(urdf(tmp_path, "<link name='&b;'/>", bomb))
    with pytest.raises(DesignError, match="more than 10,000 of <link>"):
        read_urdf(urdf(tmp_path, "".join(f'<link name="l{i}"/>' for i in range(10_001))))
    with pytest.raises(DesignError, match="nested too deeply"):
        read_urdf(urdf(tmp_path, "<a>" * 200 + "</a>" * 200))


def test_a_loop_of_fixed_joints_ends(tmp_path):
    loop = "".join(
        f'<joint name="{a}" type="fixed"><parent link="{a}"/><child link="{b}"/></joint>'
        for a, b in (("imu_a", "imu_b"), ("imu_b", "imu_a"))
    )
    assert entries(read_urdf(urdf(tmp_path, '<link name="imu_a"/><link name="imu_b"/>' + loop)))


def test_limits_that_are_not_stated_are_not_known(tmp_path):
    (joint,) = read_urdf(urdf(tmp_path, LINKS + JOINT.format('<limit effort="0" velocity="1"/>'))).joints
    assert math.isnan(joint.effort)
    assert joint.velocity == 1


def test_the_draft_is_a_design_without_warnings_that_knows_what_nobody_touched(shared):
    for path in (shared / "robots" / "burger.urdf", DATA / "quadrotor.urdf", DATA / "six_axis_arm.urdf"):
        text = import_urdf(path)
        assert parse(text).warnings == ()
        modules = YAML(typ="safe").load(text)["modules"]
        parts = [one for module in modules.values() for one in module["components"].values()]
        assert all(map(untouched, parts))
        assert not untouched({**parts[0], "rate": "5 FIT"})
