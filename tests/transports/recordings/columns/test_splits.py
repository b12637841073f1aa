"""Small files that a recorder wrote one behind the other: what they give together is what each gives alone."""

from __future__ import annotations

import os
import random
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.opening import open_source
from robophm.transports.synthetic import SyntheticOta

FIELDS = ["/ota/battery.voltage", "/ota/odom.pose.pose.position.x", "/ota/mobility/temperature.temperature"]
LENGTH = 10 * SECOND
T0 = 1_709_553_600 * SECOND


def split(drive: Path, folder: Path, compression: str = "NONE") -> list[Path]:
    """The messages of a drive in files of ten seconds each, all topics in each as a recorder writes them."""
    from mcap.reader import make_reader
    from mcap.writer import CompressionType, Writer

    folder.mkdir()
    with drive.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert summary
        messages = list(reader.iter_messages())
    starts = sorted({message.log_time // LENGTH for _, _, message in messages})
    paths = []
    for start in starts:
        paths.append(folder / f"drive_{start - starts[0]:03}.mcap")
        with paths[-1].open("wb") as file:
            writer = Writer(file, compression=CompressionType[compression])
            writer.start(profile="ros2")
            ids = {}
            for channel in summary.channels.values():
                schema = summary.schemas[channel.schema_id]
                id_ = writer.register_schema(schema.name, schema.encoding, schema.data)
                ids[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, id_)
            for _, channel, message in messages:
                if message.log_time // LENGTH == start:
                    writer.add_message(ids[channel.id], message.log_time, message.data, message.publish_time)
            writer.finish()
    return paths


def stretches_of(recording: Any, digest: str) -> Iterator[tuple[str, Callable[[Any], None]]]:
    """The name of each file, and what writes its messages by a writer of rosbags; ``digest``: its word for that."""
    with recording as reader:
        messages = list(reader.messages())
        starts = sorted({time // LENGTH for _, time, _ in messages})

        def write(writer: Any, start: int) -> None:
            new = {
                one.id: writer.add_connection(one.topic, one.msgtype, msgdef=one.msgdef.data, **{digest: one.digest})
                for one in reader.connections
            }
            for connection, time, raw in messages:
                if time // LENGTH == start:
                    writer.write(new[connection.id], time, raw)

        for start in starts:
            yield f"drive_{start - starts[0]:03}", partial(write, start=start)


def bags(drive: Path, folder: Path, compression: str) -> list[Path]:
    from rosbags.rosbag1 import Reader, Writer

    folder.mkdir()
    paths = []
    for name, write in stretches_of(Reader(drive), "md5sum"):
        paths.append(folder / f"{name}.bag")
        writer = Writer(paths[-1])
        if compression != "NONE":
            writer.set_compression(Writer.CompressionFormat[compression])
        with writer:
            write(writer)
    return paths


def databases(drive: Path, folder: Path, compression: str) -> list[Path]:
    from rosbags.rosbag2 import Reader, StoragePlugin, Writer

    folder.mkdir()
    paths = []
    for name, write in stretches_of(Reader(drive), "rihs01"):
        with Writer(folder.parent / name, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
            write(writer)
        paths.append((folder.parent / name / f"{name}.db3").rename(folder / f"{name}.db3"))
    return paths


SPLITS = {"mcap": split, "bag": bags, "db3": databases}


@pytest.fixture(scope="module", params=["NONE.mcap", "ZSTD.mcap", "NONE.bag", "LZ4.bag", "NONE.db3"])
def drive(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Path]]:
    compression, _, suffix = request.param.partition(".")
    folder = tmp_path_factory.mktemp("drive")
    whole = SyntheticOta(seed=3, start=T0, duration=600 * SECOND).record(folder / f"drive.{suffix}")
    return whole, SPLITS[suffix](whole, folder / "parts", compression)


def gathered(
    paths: Path | Sequence[Path], start: int | None = None, end: int | None = None
) -> tuple[dict[str, Any], Counter[str]]:
    """All columns of a drive as bytes, and the notes."""
    columns = read_columns(paths, FIELDS, start, end, topics=["/ota/power/temperature"])
    parts: dict[str, list[bytes]] = {}
    for block in columns:
        for topic, part in block.items():
            parts.setdefault(topic, []).append(part.received.tobytes())
            for field, values in part.values.items():
                parts.setdefault(f"{topic}.{field}", []).append(values.tobytes())
    return {name: b"".join(some) for name, some in parts.items()}, columns.notes


def alone(paths: Sequence[Path]) -> tuple[dict[str, bytes], Counter[str]]:
    """The same of each file by itself, one after the other."""
    joined: dict[str, bytes] = {}
    notes: Counter[str] = Counter()
    for path in paths:
        found, said = gathered(path)
        notes += said
        for name, content in found.items():
            joined[name] = joined.get(name, b"") + content
    return joined, notes


def test_parts_give_what_the_whole_gives(drive: tuple[Path, list[Path]]) -> None:
    whole, parts = drive
    assert len(parts) == 60
    assert gathered(parts) == gathered(whole)
    with open_source(whole) as one, open_source(*parts) as many:
        assert many.topics() == one.topics()
        assert len(many.spans()) == 60
    times = np.frombuffer(gathered(whole)[0]["/ota/battery"], np.int64)
    start, end = int(times[37]), int(times[-44])
    assert gathered(parts, start, end) == gathered(whole, start, end)


def test_a_damaged_part_costs_what_it_costs_alone(drive: tuple[Path, list[Path]], tmp_path: Path) -> None:
    """A byte in the middle of each of three of them, and a third of another that is missing."""
    _, parts = drive
    here = []
    for number, part in enumerate(parts):
        content = bytearray(part.read_bytes())
        if number in (7, 8, 31):
            content[len(content) // 2] ^= 0x55
        here.append(tmp_path / part.name)
        here[-1].write_bytes(content[: len(content) * 2 // 3] if number == 40 else content)
    found, notes = gathered(here)
    expected, said = alone(here)
    assert found == expected
    assert notes == said
    assert any("drive_040" in note for note in notes)


def test_bags_that_define_what_they_hear_in_any_order(tmp_path: Path) -> None:
    """As ``rosbag record --split`` writes them: a connection when it is first heard of, and none that is not."""
    from rosbags.rosbag1 import Reader, Writer

    whole = SyntheticOta(seed=3, start=T0, duration=300 * SECOND).record(tmp_path / "drive.bag")
    chance, paths = random.Random(8), []
    with Reader(whole) as reader:
        messages = list(reader.messages())
    for start in sorted({time // LENGTH for _, time, _ in messages}):
        here = [one for one in messages if one[1] // LENGTH == start]
        topics = sorted({one.topic: one for one, _, _ in here}.values(), key=lambda one: one.topic)
        if len(paths) % 3:
            chance.shuffle(topics)
        paths.append(tmp_path / f"part_{start}.bag")
        with Writer(paths[-1]) as writer:
            known = {one.topic: writer.add_connection(one.topic, one.msgtype, msgdef=one.msgdef.data, md5sum=one.digest)
                     for one in topics}  # fmt: skip
            for one, time, raw in here:
                writer.write(known[one.topic], time, raw)
    for some in (paths, paths[::3], [*paths[:2], *paths[12:20]]):
        assert gathered(some) == alone(some)
    assert gathered(paths) == gathered(whole)


def test_a_part_that_was_changed_is_read_anew(drive: tuple[Path, list[Path]], tmp_path: Path) -> None:
    """What is kept of a file that was read once is of that state of it."""
    _, parts = drive
    here = [tmp_path / part.name for part in parts[:4]]
    for path, part in zip(here, parts, strict=False):
        path.write_bytes(part.read_bytes())
        os.utime(path, ns=(T0, T0))
    assert gathered(here) == gathered(parts[:4])
    assert gathered(here) == gathered(parts[:4])  # as kept
    content = bytearray(here[2].read_bytes())
    content[len(content) // 2] ^= 0x55
    here[2].write_bytes(content)
    assert gathered(here) == alone(here)
    here[1].write_bytes(parts[5].read_bytes())  # another content, and most likely another size
    found, _ = gathered(sorted(here))
    times = np.frombuffer(found["/ota/battery"], np.int64)
    assert (np.diff(times) > 0).all()
    assert times[-1] == np.frombuffer(gathered(parts[5])[0]["/ota/battery"], np.int64)[-1]


FEW = """
import resource, sys
from pathlib import Path
resource.setrlimit(resource.RLIMIT_NOFILE, (40, 40))
from robophm.transports.recordings.opening import open_source
with open_source(Path(sys.argv[1])) as source:
    print(sum(len(heard.times) for block in source.columns(["/ota/battery.voltage"], 0) for heard in block.values()))
    print(sum(topic.messages for topic in source.topics() if topic.topic == "/ota/battery"))
"""


def test_few_files_are_open_at_once(drive: tuple[Path, list[Path]]) -> None:
    _, parts = drive
    result = subprocess.run(
        [sys.executable, "-c", FEW, str(parts[0].parent)], capture_output=True, text=True, check=False, timeout=60
    )
    assert result.returncode == 0, result.stderr
    there, counted = result.stdout.split()
    assert there == counted == "600"


def test_parts_in_any_order_of_naming(drive: tuple[Path, list[Path]]) -> None:
    _, parts = drive
    assert gathered(parts[::-1]) == gathered(parts)
    with open_source(*parts[::-1]) as source:
        assert all(one[1] < two[0] for one, two in pairwise(source.spans()))
