from __future__ import annotations

import csv
import gc
import importlib.util
import os
import signal
import subprocess
import sys
import textwrap
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

# Busy machines are slow: there is no deadline.
settings.register_profile("robophm", derandomize=True, database=None, deadline=None)
settings.load_profile("robophm")

NO_SHARED = "no shared/ folder beside the project"
NO_ROSCORE = "no roscore and rospy (sudo sh tools/ros-peers installs them)"
NO_FASTDDS = "no Fast DDS with its headers, or no g++ (sudo sh tools/ros-peers installs them)"
NO_MOSQUITTO = "no Mosquitto, or no paho-mqtt (sudo sh tools/ros-peers installs the broker)"
PEERS = Path(__file__).parents[1] / "tools" / "ros-peers"
NO_CYCLONEDDS = "no cyclonedds wheel for this Python or machine"
NO_ZENOH = "no eclipse-zenoh (pip install robophm[zenoh])"
NO_RCLPY = "no rclpy (with ROS 2's setup sourced, it is there)"
NO_BROWSER = "no chromium, no playwright, or the page is not built (sudo sh tools/browser; python hatch_build.py)"
ANSWER = "published answer"
"""The property by which a test says which published answer it has compared."""


@pytest.fixture(scope="session")
def shared() -> Path:
    """The shared/ folder beside the project; tests that need it are skipped without it, but fail under CI."""
    folder = Path(__file__).resolve().parents[2] / "shared"
    if not folder.is_dir():
        (pytest.fail if os.environ.get("CI") == "true" else pytest.skip)(NO_SHARED)
    return folder


@pytest.fixture(scope="session")
def measured_wear(shared: Path) -> Callable[[str], dict[str, tuple[Any, Any]]]:
    """Real wear by the name of its file in shared/degradation: times and values of each unit, in order of time."""

    def read(name: str) -> dict[str, tuple[Any, Any]]:
        with (shared / "degradation" / f"{name}.csv").open(newline="") as file:
            rows = [(row["unit"], float(row["time"]), float(row["value"])) for row in csv.DictReader(file)]
        units = {unit: sorted(row[1:] for row in rows if row[0] == unit) for unit in dict.fromkeys(r[0] for r in rows)}
        return {unit: tuple(np.array(column) for column in zip(*said, strict=True)) for unit, said in units.items()}

    return read


@pytest.fixture(scope="session")
def roscore() -> str:
    """Where Debian's roscore is; tests that talk to it are skipped unless all that they need of ROS 1 is there."""
    if absent := missing("ros1"):
        pytest.skip(f"{NO_ROSCORE}; missing: {absent}")
    return "/usr/bin/roscore"


@pytest.fixture(scope="session")
def fastdds() -> None:
    """Tests that talk to Fast DDS are skipped without it."""
    if absent := missing("ros2"):
        pytest.skip(f"{NO_FASTDDS}; missing: {absent}")


def missing(peer: str) -> str:
    """The packages of Debian that tests beside this peer need, and that are not there."""
    listed = subprocess.run(["sh", str(PEERS), "missing", peer], capture_output=True, text=True, check=True, timeout=60)
    return " ".join(listed.stdout.split())


@pytest.fixture(scope="session")
def cyclonedds() -> None:
    """Tests of the transport over DDS are skipped without the wheel, which some machines have none of."""
    if importlib.util.find_spec("cyclonedds") is None:
        pytest.skip(NO_CYCLONEDDS)


@pytest.fixture(scope="session")
def write_messages() -> Callable[..., Path]:
    """Write (topic, type, receipt [ns], message as keyword arguments of its class) as ROS 2 MCAP."""

    def write(path: Path, messages: Iterable[tuple[str, str, int, Callable[[Any], object]]]) -> Path:
        from mcap.writer import Writer
        from rosbags.typesys import Stores, get_typestore

        store = get_typestore(Stores.ROS2_HUMBLE)
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start(profile="ros2")
            channels: dict[str, int] = {}
            for topic, type_, receipt, make in messages:
                if topic not in channels:
                    definition = store.generate_msgdef(type_, 2)[0].encode()
                    schema = writer.register_schema(type_, "ros2msg", definition)
                    channels[topic] = writer.register_channel(topic, "cdr", schema)
                raw = bytes(store.serialize_cdr(make(store.types), type_))
                writer.add_message(channels[topic], receipt, raw, receipt)
            writer.finish()
        return path

    return write


@pytest.fixture
def answer(record_property: Callable[[str, object], None]) -> Callable[..., None]:
    """Say that a test compares a published answer: of which kind of part, of which file, and whether it is disputed."""

    def say(kind: str, file: str, *, disputed: bool = False) -> None:
        record_property(ANSWER, {"kind": kind, "file": file, "disputed": disputed})

    return say


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol() -> Generator[None, object, object]:
    """What a command that ran inside the process left of how signals are taken is not left to the next test."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        return (yield)
    finally:
        for number, heeded in before.items():
            signal.signal(number, heeded)


def pytest_collection_finish() -> None:
    """All that collecting made stays until the end: it is not looked through for garbage again and again."""
    gc.freeze()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many tests what is absent has cost, and which published answers were compared."""
    reasons = [str(report.longrepr) for report in terminalreporter.stats.get("skipped", [])]
    for absent in (NO_SHARED, NO_ROSCORE, NO_FASTDDS, NO_MOSQUITTO, NO_CYCLONEDDS, NO_ZENOH, NO_RCLPY, NO_BROWSER):
        if skipped := sum(absent in reason for reason in reasons):
            terminalreporter.write_line(f"{skipped} tests skipped: {absent}", yellow=True)
    answers = [
        {**said, "failed": outcome == "failed"}
        for outcome in ("passed", "failed")
        for report in terminalreporter.stats.get(outcome, [])
        for name, said in getattr(report, "user_properties", ())
        if name == ANSWER
    ]
    if answers:
        width = terminalreporter.config.get_terminal_writer().fullwidth
        for line in coverage(answers):
            terminalreporter.write_line(textwrap.fill(line, width, subsequent_indent="    ", break_on_hyphens=False))


def coverage(answers: list[dict[str, Any]]) -> list[str]:
    """The kinds of parts by how many answers of each were compared, and those of which there are none."""
    from robophm.hazard.handbooks import handbook_models

    files = Counter(said["file"] for said in answers)
    kinds = Counter(said["kind"] for said in answers)
    disputed = Counter(said["kind"] for said in answers if said["disputed"])
    counts = ", ".join(f"{number} of {file}" for file, number in files.items())
    failed = sum(said["failed"] for said in answers)
    lines = [f"published answers compared: {counts}; {disputed.total()} of them disputed, {failed} failed"]
    handbooks = {kind.partition(".")[0]: None for kind in handbook_models() if not kind.startswith("general.")}
    for handbook in handbooks:
        parts = [kind for kind in handbook_models() if kind.startswith(f"{handbook}.")]
        some = [
            f"{kind.partition('.')[2]} {kinds[kind]}" + (f" ({disputed[kind]} disputed)" if disputed[kind] else "")
            for kind in sorted(parts, key=lambda kind: -kinds[kind])
            if kinds[kind]
        ]
        none = [kind.partition(".")[2] for kind in parts if not kinds[kind]]
        lines += [f"  {handbook}: {', '.join(some)}", f"    none: {', '.join(none)}"]
    return lines


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of sixteen megabytes."""
    place = tmp_path / "disk"
    place.mkdir()
    asked = ["mount", "-t", "tmpfs", "-o", "size=16m", "robophm-test", str(place)]
    if sys.platform != "linux" or os.geteuid() or subprocess.run(asked, capture_output=True, check=False).returncode:
        pytest.skip("needs root, to mount a small file system")
    try:
        yield place
    finally:
        subprocess.run(["umount", str(place)], check=True)
