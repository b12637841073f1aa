"""The case study live: OTA drives in MuJoCo, an executive gives it tasks, ``robophm watch`` listens, another reads.

Over real ROS 1 where there is a roscore (the reader is rostopic), else, or where ``2`` is said, over DDS as ROS 2
speaks it (the reader is the cyclonedds wheel alone). All on loopback. Ends by itself when the tasks are done.
"""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from server import TASKS, serve

HERE = Path(__file__).parent
PATIENCE = 180.0
"""Seconds that all may take."""

LOOPBACK = """<CycloneDDS><Domain id="77"><General><AllowMulticast>false</AllowMulticast>
<Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""
"""Loopback and nothing else, in the words of Cyclone DDS: the reader knows nothing of ROS."""


def main() -> int:
    """0 where every task was predicted, done and judged."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        server = stack.enter_context(serve(TASKS))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        stack.callback(server.shutdown)
        environment, reader = _ros(stack, folder)

        def start(*command: str) -> subprocess.Popen[str]:
            process = subprocess.Popen(
                command, cwd=HERE, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
            )
            stack.callback(_end, process)
            return process

        start(sys.executable, "robot.py")
        design = str(HERE.parent / "robot.yaml")
        files = ["--store", str(folder / "ota.db"), "--journal", str(folder / "ota.journal")]
        watcher = start(sys.executable, "-m", "robophm", "watch", design, "--every", "5", *files)
        told: list[str] = []
        threading.Thread(target=_copy, args=(watcher, "watch", told), daemon=True).start()
        _until(lambda: any("λ" in line for line in told))
        if reader:
            threading.Thread(target=_copy, args=(start(*reader), "reader", []), daemon=True).start()
        executive = start(sys.executable, "executive.py", f"http://127.0.0.1:{server.server_port}")
        threading.Thread(target=_copy, args=(executive, "executive", []), daemon=True).start()
        done = _until(lambda: executive.poll() is not None or sum("task done" in line for line in told) == len(TASKS))
        watcher.send_signal(2)
        watcher.wait(30)
        arrived = sum("task arrived" in line for line in told)
    print(f"{arrived} tasks predicted, {sum('task done' in line for line in told)} of {len(TASKS)} done and judged")
    return 0 if done and arrived == sum("task done" in line for line in told) == len(TASKS) else 1


def _ros(stack: ExitStack, folder: Path) -> tuple[dict[str, str], list[str]]:
    """The environment of all processes, and the reader."""
    environment = dict(os.environ)
    roscore = shutil.which("roscore", path="/usr/bin:/opt/ros/noetic/bin")
    if roscore and sys.argv[1:] != ["2"]:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        environment |= {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1", "ROS_HOME": str(folder)}
        system = environment | {"PATH": f"{Path(roscore).parent}:/usr/bin:/bin"}
        master = subprocess.Popen([roscore, "-p", str(port)], env=system, stdout=subprocess.DEVNULL)
        stack.callback(_end, master)
        _until(lambda: _listens(port))
        print(f"ROS 1, master on port {port}; the reader is rostopic")
        return environment, ["env", f"PATH={system['PATH']}", "rostopic", "echo", "-n", "1", "/diagnostics/status[0]"]
    environment.pop("ROS_MASTER_URI", None)
    print("ROS 2 over DDS; the reader is a plain reader of DDS")
    environment |= {"ROS_VERSION": "2", "ROS_LOCALHOST_ONLY": "1", "ROS_DOMAIN_ID": "77", "CYCLONEDDS_URI": LOOPBACK}
    return environment, [sys.executable, "reader.py"]


def _listens(port: int) -> bool:
    with socket.socket() as one:
        return one.connect_ex(("127.0.0.1", port)) == 0


def _copy(process: subprocess.Popen[str], name: str, kept: list[str]) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        kept.append(line)
        print(f"{name:>9} | {line}", end="", flush=True)


def _until(so: Callable[[], object]) -> bool:
    deadline = time.monotonic() + PATIENCE
    while not so():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.1)
    return True


def _end(process: subprocess.Popen[str]) -> None:
    process.terminate()
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


if __name__ == "__main__":
    sys.exit(main())
