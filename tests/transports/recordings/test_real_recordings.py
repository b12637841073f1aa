"""Recordings that other projects made: every number in them as rosbags reads it, bit for bit, and all times of receipt.

``tests/data/real_recordings.csv`` names them by project, licence and path, with the digest of what was read. They are
kept beside the project, in ``shared/recordings/real``, each in a folder of the name of its project, and not in it.
"""

from __future__ import annotations

import csv
import hashlib
import subprocess
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import real_recordings

from robophm.transports.recordings.columns import read_columns
from robophm.transports.signals.message_type import numeric_fields

LIST = Path(__file__).parents[2] / "data/real_recordings.csv"

Rows = list[tuple[int, int | None]]
"""When each message was received, and the bits of its number; None where it has no such element."""


def listed() -> dict[str, list[dict[str, str]]]:
    """The files of each project."""
    found = defaultdict(list)
    with LIST.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            found[row["project"]].append(row)
    return found


def bits(value: float) -> int:
    """The bits of a number; of those that are NaN one is as good as another."""
    number = np.float64(np.nan if value != value else value)
    return int(number.view(np.int64))


def element(message: Any, field: str) -> float:
    """A field of a message of rosbags; raises IndexError where it has no such element."""
    for step in field.split("."):
        name, _, index = step.partition("[")
        message = getattr(message, name)
        if index:
            message = message[int(index.rstrip("]"))]
    return float(message)


def by_rosbags(path: Path) -> dict[str, Rows]:
    """All messages of each topic, and every number in those that rosbags decodes; of arrays the first."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    found: dict[str, Rows] = {}
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        fields: dict[str, list[str]] = {}
        for one in reader.connections:
            try:
                fields[one.topic] = [
                    field.replace("[]", "[0]") for field in numeric_fields(reader.typestore.fielddefs, one.msgtype)
                ]
            except KeyError:
                fields[one.topic] = []
            found |= {f"{one.topic}.{field}": [] for field in fields[one.topic]}
            found[one.topic] = []
        for connection, time, raw in reader.messages():
            found[connection.topic].append((time, None))
            if not fields[connection.topic]:
                continue
            message = reader.deserialize(raw, connection.msgtype)
            for field in fields[connection.topic]:
                try:
                    value = bits(element(message, field))
                except IndexError:
                    value = None
                found[f"{connection.topic}.{field}"].append((time, value))
    return found


def ours(path: Path, topics_and_signals: list[str]) -> dict[str, Rows]:
    found: dict[str, Rows] = {name: [] for name in topics_and_signals}
    signals = [name for name in topics_and_signals if "." in name]
    for block in read_columns(path, signals, topics=[name for name in topics_and_signals if "." not in name]):
        for topic, part in block.items():
            found[topic] += [(time, None) for time in part.received.tolist()]
            for field, values in part.values.items():
                absent = part.absent.get(field, np.zeros(len(part), np.bool_)).tolist()
                for time, value, gone in zip(part.received.tolist(), values.tolist(), absent, strict=True):
                    found[f"{topic}.{field}"].append((time, None if gone else bits(value)))
    return found


def in_order(rows: Rows) -> Rows:
    """The rows by time; those of one time, which two writers may give in either order, by their number."""
    return sorted(rows, key=lambda row: (row[0], row[1] is not None, row[1] or 0))


def compare(path: Path) -> int:
    """Compare all of a recording; return how many times and numbers were compared."""
    expected = by_rosbags(path)
    found = ours(path, sorted(expected)) if expected else {}
    for name, rows in expected.items():
        assert in_order(found[name]) == in_order(rows), f"{path}: {name}"
    return sum(map(len, expected.values()))


@pytest.fixture(scope="module")
def real(shared: Path) -> Path:
    folder = shared / "recordings/real"
    if not folder.is_dir():
        pytest.skip("shared/recordings/real is not there; tools/real_recordings.py lays it")
    return folder


@pytest.mark.parametrize("project", listed())
def test_every_number_is_as_rosbags_reads_it(project: str, real: Path) -> None:
    rows = listed()[project]
    compared = 0
    for row in rows:
        path = real / project.replace("/", "+") / row["path"]
        assert hashlib.sha256(path.read_bytes()).hexdigest() == row["sha256"], f"{path} is another file than was listed"
        compared += compare(path)
    assert compared == sum(int(row["compared"]) for row in rows)


@pytest.mark.parametrize("cloned", [True, False], ids=["there", "cloned"])
def test_recordings_are_laid_out_of_clones(tmp_path: Path, capsys: pytest.CaptureFixture[str], cloned: bool) -> None:
    """What is there as listed; what is another file is said, and not laid."""
    clone = tmp_path / ("clones/someone+robot" if cloned else "public/someone/robot")
    clone.mkdir(parents=True)
    content = {"drive.bag": b"#ROSBAG V2.0\n", "other.bag": b"another"}
    for name, some in content.items():
        (clone / name).write_bytes(some)
    git = ["git", "-C", str(clone), "-c", "user.name=R", "-c", "user.email=r@example.org"]
    for command in (["init", "-q"], ["add", "."], ["commit", "-qm", "Recordings"]):
        subprocess.run([*git, *command], check=True)
    digest = hashlib.sha256(content["drive.bag"]).hexdigest()
    listed = tmp_path / "list.csv"
    rows = [f"someone/robot,MIT,{name},{digest},0" for name in content]
    listed.write_text("\n".join(["project,licence,path,sha256,compared", *rows]))
    address = "" if cloned else (tmp_path / "public").as_uri()
    assert real_recordings.laid(tmp_path / "real", tmp_path / "clones", listed, address) == 1
    assert [path.name for path in (tmp_path / "real/someone+robot").iterdir()] == ["drive.bag"]
    assert "someone/robot: other.bag is not there, or another file" in capsys.readouterr().err


def test_sixty_recordings_of_twenty_projects_are_listed() -> None:
    projects = listed()
    assert len(projects) >= 20
    assert sum(map(len, projects.values())) >= 60
