"""ROS 2: the lifecycle node, which activates itself unless ``autostart:=false``."""

from typing import List

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterValue

TEXTS = {
    "robophm": "robophm", "namespace": "", "store": "", "journal": "", "record": "", "frame": "base_link", "via": "ros2",
    "robot": "", "robots": "", "speed": "", "fleet": "", "unit": "1/h",
}  # fmt: skip
SECONDS = {"period": "1.0", "every": "10.0"}
LISTS = ("tasks", "function", "notify")


def generate_launch_description():
    texts = {name: ParameterValue(LaunchConfiguration(name), value_type=str) for name in ("design", *TEXTS)}
    seconds = {name: ParameterValue(LaunchConfiguration(name), value_type=float) for name in SECONDS}
    lists = {name: ParameterValue(LaunchConfiguration(name), value_type=List[str]) for name in LISTS}
    return LaunchDescription([
        DeclareLaunchArgument("design", description="the robot's design, a robot.yaml"),
        *(DeclareLaunchArgument(name, default_value=value) for name, value in TEXTS.items()),
        *(DeclareLaunchArgument(name, default_value=value) for name, value in SECONDS.items()),
        *(DeclareLaunchArgument(name, default_value="['']", description="a list, ['/plan', '/odom']") for name in LISTS),
        DeclareLaunchArgument("reports", default_value="false", description="whether anybody may tell of parts"),
        DeclareLaunchArgument("autostart", default_value="true"),
        LifecycleNode(
            package="robophm_ros", executable="robophm_lifecycle", name="robophm", namespace="", output="screen",
            parameters=[{
                **texts, **seconds, **lists,
                "reports": ParameterValue(LaunchConfiguration("reports"), value_type=bool),
                "autostart": ParameterValue(LaunchConfiguration("autostart"), value_type=bool),
            }],
        ),
    ])  # fmt: skip
