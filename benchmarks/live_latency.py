"""From a sensor's value that is published to the hazard rate that has it, through ``robophm watch`` over real ROS 1.

``python -m benchmarks.live_latency [TIMES]``: the temperature jumps at random moments, and the time is taken until the
first message on /phm_hazard_rate that shows it. Everything in between is other processes.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from benchmarks.live_load import master

PERIOD = 0.5
"""Seconds between two reports."""

ROOT = Path(__file__).parents[1]
DESIGN = ROOT / "examples" / "ota" / "robot.yaml"


def measure(times: int) -> list[float]:
    """Seconds of so many jumps."""
    from robophm.transports.ros1 import Node, Publisher, Ros1

    with Node("/sensor") as node, Publisher(node, "/ota/power/temperature", "sensor_msgs/Temperature") as sensor:
        types, state = sensor.types, {"value": 25.0}
        over, saying = threading.Event(), threading.Lock()

        def say() -> None:
            with saying:
                seconds, nanoseconds = divmod(time.time_ns(), 1_000_000_000)
                stamp = types["builtin_interfaces/msg/Time"](seconds, nanoseconds)
                header = types["std_msgs/msg/Header"](seq=0, stamp=stamp, frame_id="")
                sensor.publish(types["sensor_msgs/msg/Temperature"](header, state["value"], 0.0))

        def keep_saying() -> None:
            while not over.wait(0.1):
                say()

        command = [sys.executable, "-m", "robophm", "watch", str(DESIGN), "--period", str(PERIOD)]
        watcher = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        found = []
        try:
            with Ros1() as source:
                while not any(info.topic == "/phm_hazard_rate" for info in source.topics()):
                    time.sleep(0.2)
                threading.Thread(target=keep_saying, daemon=True).start()
                rates: list[tuple[float, float]] = []

                def hear() -> None:
                    for sample in source.samples(["/phm_hazard_rate.system_sensor_based_value"]):
                        if sample.signal != "clock":
                            rates.append((time.monotonic(), sample.value))

                threading.Thread(target=hear, daemon=True).start()
                while len(rates) < 10:
                    time.sleep(0.1)
                for _ in range(times):
                    time.sleep(random.uniform(2.5, 3.5) * PERIOD)
                    state["value"] = 60.0 - state["value"]
                    before, begun = rates[-1][1], time.monotonic()
                    say()
                    while not (
                        later := [at for at, rate in rates[-4:] if abs(rate / before - 1) > 0.05 and at > begun]
                    ):
                        time.sleep(0.002)
                    found.append(later[0] - begun)
        finally:
            over.set()
            watcher.send_signal(signal.SIGINT)
            watcher.wait(20)
        return found


if __name__ == "__main__":
    with master() as ros, tempfile.TemporaryDirectory():
        os.environ.update(ros)
        took = sorted(measure(int(sys.argv[1]) if sys.argv[1:] else 200))
        p50, p99 = took[len(took) // 2], took[min(len(took) - 1, int(len(took) * 0.99))]
        print(f"{len(took)} jumps, period {PERIOD} s: p50 {p50 * 1000:.0f} ms, p99 {p99 * 1000:.0f} ms, "
              f"worst {took[-1] * 1000:.0f} ms; goal for p99 {1000 * PERIOD + 20:.0f} ms")  # fmt: skip
