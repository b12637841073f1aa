"""Ten robots of one design in one process of ``robophm watch --robots``, beside one robot in one, over real ROS 1.

``python -m benchmarks.live_robots [SECONDS] [ROBOTS]`` starts a master and a rospy node that speaks for all robots,
20 messages a second on each of 5 topics of each, and says what the watcher takes of a processor and of memory.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.page_live import taken

TOPICS = 5
RATE = 20
"""Messages a second on each topic."""
SETTLE = 20.0
"""Seconds until nothing is set up any more."""

DESIGN = (
    "schema_version: 1\nname: AMR\ntask: {duration: 2 h}\ncomponents:\n"
    + "\n".join(
        f"  motor {k}: {{rate: 1e-5 /h, acceleration: {{model: q10, reference_temperature: 25 degC}}, "
        f"signals: {{temperature: {{topic: /motor_{k}, field: temperature, unit: degC, range: [0, 90]}}}}}}"
        for k in range(TOPICS)
    )
    + "\n"
)
TALK = f"""
import sys, rospy
from std_msgs.msg import Header
from sensor_msgs.msg import Temperature
rospy.init_node("robots")
out = [rospy.Publisher("/amr_%d/motor_%d" % (n, k), Temperature, queue_size=50)
       for n in range(int(sys.argv[1])) for k in range({TOPICS})]
rate = rospy.Rate({RATE})
while not rospy.is_shutdown():
    for one in out:
        one.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=40.0))
    rate.sleep()
"""


def measured(robots: int, seconds: float) -> tuple[float, float]:
    """Return the share of a processor, and the memory [MB], that a watcher of so many robots takes."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    environment = {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1"}
    ros = {"PATH": "/usr/bin:/bin", "HOME": "/tmp", **environment}
    started = [subprocess.Popen(["/usr/bin/rosmaster", "--core", "-p", str(port)], env=ros, stdout=subprocess.DEVNULL)]
    try:
        time.sleep(2)
        started.append(subprocess.Popen(["/usr/bin/python3", "-c", TALK, str(robots)], env=ros))
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "robot.yaml").write_text(DESIGN)
            words = ["--robots", ",".join(f"amr_{n}" for n in range(robots)), "--store", "past.db", "--via", "ros1"]
            watcher = subprocess.Popen(
                [sys.executable, "-m", "robophm", "watch", "robot.yaml", *words], cwd=folder,
                env=os.environ | environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            )  # fmt: skip
            started.append(watcher)
            time.sleep(SETTLE)
            before = taken({watcher.pid})
            time.sleep(seconds)
            took = (taken({watcher.pid}) - before) / seconds
            memory = int((Path("/proc") / str(watcher.pid) / "statm").read_text().split()[1])
            watcher.send_signal(signal.SIGINT)
            watcher.wait(60)
    finally:
        for process in reversed(started):
            process.kill()
            process.wait()
    return took, memory * os.sysconf("SC_PAGE_SIZE") / 1e6


if __name__ == "__main__":
    span = float(sys.argv[1]) if len(sys.argv) > 1 else 30.0
    for many in (1, int(sys.argv[2]) if len(sys.argv) > 2 else 10):
        share, memory = measured(many, span)
        print(
            f"{many} robots, {many * TOPICS * RATE} messages/s: {share:.1%} of a processor, {memory:.0f} MB", flush=True
        )
