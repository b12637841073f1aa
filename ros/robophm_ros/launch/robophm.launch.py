"""ROS 2: the lifecycle node, which activates itself unless ``autostart:=false``."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode
from launch_ros.parameter_descriptions import ParameterValue

TEXTS = {"robophm": "robophm", "namespace": "", "store": "", "journal": "", "frame": "base_link"}


def generate_launch_description():
    texts = {name: ParameterValue(LaunchConfiguration(name), value_type=str) for name in ("design", *TEXTS)}
    return LaunchDescription([
        DeclareLaunchArgument("design", description="the robot's design, a robot.yaml"),
        *(DeclareLaunchArgument(name, default_value=value) for name, value in TEXTS.items()),
        DeclareLaunchArgument("period", default_value="1.0"),
        DeclareLaunchArgument("reports", default_value="false", description="whether anybody may tell of parts"),
        DeclareLaunchArgument("autostart", default_value="true"),
        LifecycleNode(
            package="robophm_ros", executable="robophm_lifecycle", name="robophm", namespace="", output="screen",
            parameters=[{
                **texts,
                "period": ParameterValue(LaunchConfiguration("period"), value_type=float),
                "reports": ParameterValue(LaunchConfiguration("reports"), value_type=bool),
                "autostart": ParameterValue(LaunchConfiguration("autostart"), value_type=bool),
            }],
        ),
    ])  # fmt: skip
