"""Pictures of 2.8 MB that are sent best effort, into a buffer that is too small for one: what is lost is told."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from .conftest import HERE, LOOPBACK, Peer

SMALL = LOOPBACK.replace(
    "</General>", '</General><Internal><SocketReceiveBufferSize min="default" max="64 kB"/></Internal>'
)
LISTENER = """
import json, sys, threading
from robophm.core.signal import Sample
from robophm.transports.ros2_dds import Ros2Dds
with Ros2Dds() as source:
    while "/image" not in {info.topic for info in source.topics()}:
        pass
    heard, gaps = [], []
    def listen():
        for one in source.listen(["/image.height"], []):
            if isinstance(one, Sample):
                heard.append(one) if one.signal != "clock" else None
            elif hasattr(one, "why"):
                gaps.append([one.topic, one.why])
    thread = threading.Thread(target=listen)
    thread.start()
    print("ready", flush=True)
    sys.stdin.readline()
    for _ in range(100):  # until a round of its clock has told of it
        if gaps:
            break
        thread.join(0.1)
    source.stop()
    thread.join()
    print(json.dumps([len(heard), gaps, dict(source.notes)]))
"""
SENT = 20


@pytest.mark.full
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the kernel's count is Linux's")
def test_packets_that_are_dropped_are_told(domain: int, cyclonedds: None) -> None:
    peer = Peer(sys.executable, str(HERE / "image_peer.py"), str(domain))
    listener = subprocess.Popen(
        [sys.executable, "-c", LISTENER], env=os.environ | {"CYCLONEDDS_URI": SMALL}, text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    )  # fmt: skip
    try:
        assert listener.stdout is not None
        assert listener.stdout.readline() == "ready\n"
        peer.tell(f"images {SENT}")
        assert peer.line(60) == "sent"
        said, _ = listener.communicate("\n", timeout=60)
    finally:
        listener.kill()
        peer.close()
    heard, gaps, notes = json.loads(said)
    assert heard < SENT
    assert notes["packets dropped, some may be lost on /image"] > 0
    assert ["/image", "packets dropped, some may be lost"] in gaps
