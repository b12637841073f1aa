"""A recorded day, read and replayed, against bare decoding of the same topics by rosbags."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks import Line, agree, benchmark, race
from robophm.core.signal import split_signal
from robophm.design.file import load
from robophm.monitor import replay
from robophm.stores.memory import MemoryStore
from robophm.transports.source import open_source
from robophm.transports.synthetic import SyntheticOta

DESIGN = Path(__file__).parent.parent / "examples/ota/robot.yaml"


def decoded(path: Path, topics: set[str]) -> Iterator[tuple[str, object]]:
    """Topic and message, as rosbags alone gives them."""
    from rosbags.highlevel import AnyReader

    with AnyReader([path]) as reader:
        connections = [connection for connection in reader.connections if connection.topic in topics]
        for connection, _, raw in reader.messages(connections):
            yield connection.topic, reader.deserialize(raw, connection.msgtype)


def value(message: object, field: str) -> float:
    for step in field.split("."):
        message = getattr(message, step)
    return float(message)  # type: ignore[arg-type]


def day(suffix: str) -> Iterator[Line]:
    robot = load(DESIGN)
    signals = list(robot.signals)
    fields: dict[str, list[str]] = {}
    for signal in signals:
        topic, field = split_signal(signal)
        fields.setdefault(topic, []).append(field)
    drive = SyntheticOta(seed=1)
    with tempfile.TemporaryDirectory() as folder:
        path = drive.record(Path(folder) / f"day{suffix}")

        def read() -> int:
            with open_source(str(path)) as source:
                return sum(1 for _ in source.samples(signals))

        def bare() -> int:
            return sum(1 for _ in decoded(path, set(fields)))

        with open_source(str(path)) as source:
            ours = np.array([sample.value for sample in source.samples(signals)])
        messages = list(decoded(path, set(fields)))
        theirs = [value(message, field) for topic, message in messages for field in sorted(fields[topic])]
        agree(f"samples of {path.name}", ours, theirs, 0.0)
        count = len(messages)
        del messages
        driven = np.hypot(np.diff(drive.x), np.diff(drive.y)).sum() / 1000
        health = replay(robot, path, store=MemoryStore())
        agree(f"kilometres after {path.name}", health.clocks["kilometres"], driven, 1e-9)

        replayed, sampled, alone = race(
            lambda: replay(robot, path, store=MemoryStore()), read, bare, rounds=2, at_least=0.0
        )
    for work, took in (("replay", replayed), ("samples", sampled)):
        rate = f"{count / took / 1e3:.0f} k messages/s, {len(ours) / took / 1e3:.0f} k samples/s"
        yield Line(f"a day's {suffix}, {count:,} messages: {work}", took, alone, "rosbags, decoding", None, rate)


@benchmark
def mcap() -> Iterator[Line]:
    yield from day(".mcap")


@benchmark
def bag() -> Iterator[Line]:
    yield from day(".bag")
