"""Small files that are made to take all memory: each is read in a process of its own, whose memory is measured."""

from __future__ import annotations

import bz2
import shutil
import sqlite3
import struct
import subprocess
import sys
from contextlib import closing
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import lz4.frame
import pytest
import zstandard

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.packed import Unpacked
from robophm.transports.synthetic import SyntheticOta

MOST = 400 << 20
"""Bytes that a process may take, Python and its libraries included."""

GIGABYTE = 1 << 30
T0 = 1_709_553_600 * SECOND

READ = """
import sys
from pathlib import Path
from robophm.core.errors import RobophmError
from robophm.transports.recordings.opening import open_source
try:
    with open_source(sys.argv[1]) as source:
        topics = [topic for topic in source.topics() if topic.fields]
        signals = [f"{topic.topic}.{topic.fields[-1]}" for topic in topics if "[]" not in topic.fields[-1]]
        print(sum(1 for _ in source.samples(signals)))
        print(sum(len(heard.times) for block in source.columns(signals, 0) for heard in block.values()))
        print(*source.notes, sep="; ")
except RobophmError as error:
    print("refused:", error)
status = Path("/proc/self/status").read_text()
print(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM")))
"""

LOAD = """
import sys
from pathlib import Path
import robophm
from robophm.core.errors import RobophmError
try:
    robot = robophm.load(sys.argv[1])
    if sys.argv[2:]:
        from robophm.design.task_file import load_plan
        load_plan(sys.argv[2], robot)
except RobophmError as error:
    print("refused:", error)
status = Path("/proc/self/status").read_text()
print(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM")))
"""


class Outcome(NamedTuple):
    said: str
    memory: int


def outcome(script: str, *arguments: Path) -> Outcome:
    """What a process prints and takes that reads a file."""
    result = subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False
    )
    assert result.returncode == 0, result.stderr
    said, _, memory = result.stdout.strip().rpartition("\n")
    return Outcome(said, int(memory) * 1024)


@cache
def packed_zeros(compression: str) -> bytes:
    """A gigabyte of zeros, of which the frame does not say how many they are; of bz2, which is slow, half of it."""
    made: Any = {
        "zstd": lambda: zstandard.ZstdCompressor(write_content_size=False).compressobj(),
        "bz2": lambda: bz2.BZ2Compressor(1),
    }
    pieces = GIGABYTE >> (25 if compression == "bz2" else 24)
    if compression == "lz4":
        compressor = lz4.frame.LZ4FrameCompressor()
        head = compressor.begin()
        return b"".join([head, *(compressor.compress(bytes(1 << 24)) for _ in range(pieces)), compressor.flush()])
    compressor = made[compression]()
    return b"".join([*(compressor.compress(bytes(1 << 24)) for _ in range(pieces)), compressor.flush()])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("whole")
    drive = SyntheticOta(seed=3, start=T0, duration=30 * SECOND)
    return {suffix: drive.record(folder / f"drive{suffix}") for suffix in (".bag", ".db3", ".mcap")}


@pytest.mark.full
@pytest.mark.parametrize("says", [1000, GIGABYTE])
@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_a_chunk_of_mcap(compression: str, says: int, whole: dict[str, Path], tmp_path: Path) -> None:
    content = whole[".mcap"].read_bytes()
    zeros = packed_zeros(compression)
    name = compression.encode()
    body = struct.pack("<QQQII", T0, T0, says, 0, len(name)) + name + struct.pack("<Q", len(zeros)) + zeros
    head = 8 + 9 + struct.unpack_from("<Q", content, 9)[0]  # behind the magic and the header
    path = tmp_path / "bomb.mcap"
    path.write_bytes(content[:head] + struct.pack("<BQ", 6, len(body)) + body + content[head:])
    found = outcome(READ, path)
    assert found.memory < MOST
    assert "lost" in found.said
    assert found.said.split("\n")[0] == found.said.split("\n")[1] != "0"


@pytest.mark.full
@pytest.mark.parametrize(("compression", "says"), [("bz2", 1000), ("lz4", 1000), ("lz4", GIGABYTE)])
def test_a_chunk_of_a_bag(compression: str, says: int, whole: dict[str, Path], tmp_path: Path) -> None:
    content = whole[".bag"].read_bytes()
    zeros = packed_zeros(compression)
    fields = [b"op=\x05", b"compression=" + compression.encode(), b"size=" + struct.pack("<I", says)]
    header = b"".join(struct.pack("<I", len(field)) + field for field in fields)
    record = struct.pack("<I", len(header)) + header + struct.pack("<I", len(zeros)) + zeros
    begin = 13 + 4096
    path = tmp_path / "bomb.bag"
    path.write_bytes(content[:begin] + record + content[begin:])
    found = outcome(READ, path)
    assert found.memory < MOST
    assert "lost" in found.said
    assert found.said.split("\n")[0] == found.said.split("\n")[1] != "0"


def test_messages_of_a_database(whole: dict[str, Path], tmp_path: Path) -> None:
    folder = Path(shutil.copytree(whole[".db3"], tmp_path / "drive"))
    text = (folder / "metadata.yaml").read_text()
    (folder / "metadata.yaml").write_text(text.replace("compression_mode: ''", "compression_mode: MESSAGE"))
    pack = zstandard.ZstdCompressor().compress
    with closing(sqlite3.connect(folder / "drive.db3")) as database, database:
        database.create_function("pack", 1, pack)
        database.execute("UPDATE messages SET data = pack(data)")
        database.execute("UPDATE messages SET data = ? WHERE id IN (7, 30)", (packed_zeros("zstd"),))
    database.close()
    found = outcome(READ, folder)
    assert found.memory < MOST
    assert "a message lost" in found.said
    with open_source(whole[".db3"]) as sound:
        expected = sum(topic.messages for topic in sound.topics())
    with open_source(folder) as source:
        assert sum(topic.messages for topic in source.topics()) == expected
    assert int(found.said.split("\n")[0]) > 0


def test_a_file_that_would_fill_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """How large it becomes nothing says; half of the room there is stays free."""
    path = tmp_path / "drive.db3.zstd"
    path.write_bytes(packed_zeros("zstd"))
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage._replace(free=64 << 20))
    from collections import Counter

    with pytest.raises(SourceError, match=r"drive\.db3\.zstd: does not fit on the disk"):
        Unpacked(path, Counter())


ALIASES = {
    "values": "x: &a [1,1,1,1,1,1,1,1,1,1]\n"
    + "".join(f"x{n}: &a{n} [{','.join([f'*a{n - 1 or str()}'] * 10)}]\n" for n in range(1, 9)),
    "texts": "x: &a " + "x" * 300_000 + "\ny: [" + ",".join(["*a"] * 30_000) + "]\n",
    "names": "x: &a\n  ? " + "x" * 300_000 + "\n  : 1\ny: [" + ",".join(["*a"] * 30_000) + "]\n",
    "numbers": "x: &a " + "9" * 4_000 + "\ny: [" + ",".join(["*a"] * 100_000) + "]\n",
    "places": "functions:\n  f: "
    + "{series: [" * 46
    + "{parallel: &a ["
    + ",".join(["{a: 1}"] * 10_000)
    + "]},"
    + ",".join(["{parallel: *a}"] * 45)
    + "]}" * 46
    + "\n",
}


@pytest.mark.parametrize(
    "what",
    [pytest.param(what, marks=[pytest.mark.full] * (what in ("values", "numbers", "names"))) for what in ALIASES],
)
def test_aliases_of_a_design_and_of_tasks(what: str, tmp_path: Path) -> None:
    path, sound, tasks = (tmp_path / name for name in ("robot.yaml", "sound.yaml", "tasks.yaml"))
    path.write_text("schema_version: 1\nname: robot\n" + ALIASES[what])
    sound.write_text("schema_version: 1\nname: robot\ncomponents: {a: {rate: 1 FPMH}}\n")
    tasks.write_text("schema_version: 1\n" + ALIASES[what])
    for found in (outcome(LOAD, path), outcome(LOAD, sound, tasks)):
        assert found.said.startswith("refused: ")
        assert "unfolds to more than" in found.said
        assert "\n" not in found.said
        assert found.memory < MOST


def test_aliases_that_are_meant_are_taken(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    parts = "".join(f"  b{n}: *a\n" for n in range(2000))
    path.write_text(
        f"schema_version: 1\nname: robot\ncomponents:\n  a: &a {{rate: 1 FPMH, description: alike}}\n{parts}"
    )
    assert outcome(LOAD, path).said == ""


LITTLE = """
import resource, sys
from pathlib import Path
from robophm.transports.recordings.columns import read_columns
read_columns(sys.argv[2], ["/image.data[7]"]).close()  # what is imported and compiled at first is not the file's
status = Path("/proc/self/status").read_text()
taken = next(int(line.split()[1]) * 1024 for line in status.splitlines() if line.startswith("VmData"))
resource.setrlimit(resource.RLIMIT_DATA, (taken + (100 << 20),) * 2)
print(sum(len(block["/image"]) for block in read_columns(sys.argv[1], ["/image.data[7]", "/image.data[999999]"])))
"""


@pytest.mark.parametrize("compression", ["NONE", "ZSTD", "LZ4"])
def test_a_hundred_megabytes_are_enough_for_any_recording(compression: str, tmp_path: Path) -> None:
    """Beside the file, which is mapped: a hundred and fifty images of a megabyte, every one of them read to its end."""
    from mcap.writer import CompressionType, Writer

    paths = tmp_path / "images.mcap", tmp_path / "one.mcap"
    for path, count in zip(paths, (150, 1), strict=True):
        with path.open("wb") as file:
            writer = Writer(file, compression=CompressionType[compression])
            writer.start(profile="ros2")
            layout = "MultiArrayLayout layout\nuint8[] data\n" + "=" * 80 + "\nMSG: std_msgs/MultiArrayLayout\n"
            layout += "MultiArrayDimension[] dim\nuint32 data_offset\n" + "=" * 80
            layout += "\nMSG: std_msgs/MultiArrayDimension\nstring label\nuint32 size\nuint32 stride\n"
            schema = writer.register_schema("std_msgs/msg/UInt8MultiArray", "ros2msg", layout.encode())
            channel = writer.register_channel("/image", "cdr", schema)
            image = b"\0\1\0\0" + struct.pack("<III", 0, 0, 1_000_000) + bytes(range(250)) * 4000
            for number in range(count):
                writer.add_message(channel, T0 + number, image, T0 + number)
            writer.finish()
    result = subprocess.run(
        [sys.executable, "-c", LITTLE, *map(str, paths)], capture_output=True, text=True, timeout=120, check=False
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.split() == ["150"]
