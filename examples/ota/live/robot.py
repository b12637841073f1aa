"""The simulated OTA as a node: drives to /ota/goal, and says where it is, how warm its modules are, and its battery."""

from __future__ import annotations

import math
import signal
import threading
import time

from drive import Ota
from ros import Ros, header

from robophm.transports.signals.source import WholeMessage

RATE = 20
"""Messages a second."""


def main() -> None:
    """Until SIGTERM or SIGINT."""
    ota, over = Ota(), threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: over.set())
    with Ros("/ota_simulation") as ros:
        odometry = ros.publisher("/ota/odom", "nav_msgs/msg/Odometry")
        battery = ros.publisher("/ota/battery", "sensor_msgs/msg/BatteryState")
        warm = {
            module: ros.publisher(f"/ota/{module}/temperature", "sensor_msgs/msg/Temperature") for module in ota.warm
        }
        goals = ros.listen((), ["/ota/goal"])

        def hear() -> None:
            for heard in goals:
                if isinstance(heard, WholeMessage) and heard.message is not None:
                    pose, twist = heard.message.pose.pose, heard.message.twist.twist
                    ota.goal, ota.cruise = (pose.position.x, pose.position.y), twist.linear.x

        threading.Thread(target=hear, daemon=True).start()
        begun, steps = time.monotonic(), 0
        while not over.is_set():
            ota.advance(1 / RATE)
            steps += 1
            (x, y), (forward, turn), heading = ota.place, ota.speed, ota.heading
            odometry({
                "header": header("odom"),
                "child_frame_id": "base_link",
                "pose": {"pose": {
                    "position": {"x": x, "y": y},
                    "orientation": {"z": math.sin(heading / 2), "w": math.cos(heading / 2)},
                }},
                "twist": {"twist": {"linear": {"x": forward}, "angular": {"z": turn}}},
            })  # fmt: skip
            battery({"header": header("battery"), "voltage": ota.voltage, "current": -ota.current, "present": True})
            for module, say in warm.items():
                say({"header": header(module), "temperature": ota.temperature(module)})
            over.wait(max(0.0, begun + steps / RATE - time.monotonic()))


if __name__ == "__main__":
    main()
