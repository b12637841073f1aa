"""A drive in files of a minute against the same in one file: what a replay takes of the processor, by format.

``python -m benchmarks.splits [HOURS] [format …]``: the synthetic robot's drive of so many hours, 4 by default, as
``.mcap``, ``.bag`` and ``.db3``, the latter two written by rosbags. Ledgers are compared first. By the processor's time
of the process, so that other work on the machine counts as little as may be; best of nine rounds, in turns.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from benchmarks import DisagreementError, seconds
from benchmarks.transports import DESIGN, SECOND, split
from robophm.design.file import load
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.transports.recordings.columns import kept
from robophm.transports.synthetic import SyntheticOta

FORMATS = (".mcap", ".bag", ".db3")
ROUNDS = 9
MINUTE = 60 * SECOND


@contextmanager
def writer_of(path: Path) -> Iterator[Any]:
    """A recording of this format, by rosbags."""
    from rosbags.rosbag1 import Writer as BagWriter
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Rosbag2Writer

    folder = path.with_suffix(".folder")
    bag = path.suffix == ".bag"
    writer: Any = BagWriter(path) if bag else Rosbag2Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3)
    with writer:
        yield writer
    if not bag:  # the file alone, loose
        (file,) = folder.glob("*.db3")
        file.rename(path)
        (folder / "metadata.yaml").unlink()
        folder.rmdir()


def rewritten(whole: Path, folder: Path, suffix: str) -> Path:
    """The same messages in files of a minute, and in one beside the folder."""
    from rosbags.highlevel import AnyReader

    folder.mkdir()
    with AnyReader([whole]) as reader:
        rows = list(reader.messages())
        for path, some in parts_of(rows, folder, suffix):
            with writer_of(path) as writer:
                heard = rows if suffix == ".db3" else some  # rosbag writes a connection when it first hears of it
                topics = dict.fromkeys((one.topic, one.msgtype) for one, _, _ in heard)
                known = {
                    topic: writer.add_connection(topic, type_, typestore=reader.typestore) for topic, type_ in topics
                }
                for one, at, raw in some:
                    writer.write(known[one.topic], at, raw)
    return folder


def parts_of(rows: list[Any], folder: Path, suffix: str) -> Iterator[tuple[Path, list[Any]]]:
    """All in one file, and each minute in its own."""
    yield folder.with_suffix(suffix), rows
    minutes: dict[int, list[Any]] = {}
    for row in rows:
        minutes.setdefault(row[1] // MINUTE, []).append(row)
    for minute, some in minutes.items():
        yield folder / f"day_{minute}{suffix}", some


def taken(robot: Any, path: Path) -> tuple[float, Any]:
    """Processor's time [s] of a replay, and its ledger."""
    kept.forget()
    store, begun = MemoryStore(), time.process_time()
    replay(robot, path, store=store)
    return time.process_time() - begun, store.ledger(robot.name)


def main() -> int:
    hours = int(sys.argv[1]) if len(sys.argv) > 1 else 4
    robot = load(DESIGN)
    print("| work | of the processor | in one file | ratio |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        for suffix in sys.argv[2:] or FORMATS:
            drive = SyntheticOta(seed=1, working_hours=(0, hours))
            place = Path(name) / suffix[1:]
            place.mkdir()
            whole = drive.record(place / ("day.bag" if suffix == ".bag" else "day.mcap"))
            folder = place / "files"
            loose = split(whole, folder) if suffix == ".mcap" else rewritten(whole, folder, suffix)
            one = whole if suffix == ".mcap" else folder.with_suffix(suffix)
            os.sync()
            time.sleep(3)  # of files that were just written nothing is kept
            if taken(robot, loose)[1] != taken(robot, one)[1]:
                raise DisagreementError(f"the ledger of {suffix} files")
            rounds = [(taken(robot, loose)[0], taken(robot, one)[0]) for _ in range(ROUNDS)]
            many, alone = (min(times) for times in zip(*rounds, strict=True))
            label = f"{hours} h in {len(list(folder.iterdir()))} {suffix} files, loose: replay"
            print(f"| {label} | {seconds(many)} | {seconds(alone)} | {many / alone:.2f} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
