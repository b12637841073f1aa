from __future__ import annotations

import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from .disk import left
from .power_cuts import tally
from .recorded_writes import record
from .subjects import Subject, subjects

pytestmark = pytest.mark.skipif(not shutil.which("strace"), reason="no strace (sudo sh tools/ros-peers installs it)")

WRITER = """
import os
from pathlib import Path
folder = Path(__file__).parent / "work"
with (folder / "a").open("r+b", buffering=0) as stream:
    stream.write(b"A" * 600)
    os.fsync(stream.fileno())
    stream.seek(600)
    stream.write(b"B" * 600)
    stream.truncate(900)
(folder / "new").write_bytes(b"N")
(folder / "new").rename(folder / "a")
(folder / "b").unlink()
"""


def test_what_a_process_does_is_recorded_and_what_was_synced_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside what its own lines say: they are few enough to be worked out by hand."""
    folder = tmp_path / "work"
    folder.mkdir()
    (folder / "a").write_bytes(b"a" * 700)
    (folder / "b").write_bytes(b"b")
    (tmp_path / "writer.py").write_text(WRITER)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    recorded = record(["writer"], folder, tmp_path / "log")
    end = len(recorded.deeds)
    assert left(recorded, end, "all", random.Random(0)) == {"a": b"N"}
    assert left(recorded, end, "synced", random.Random(0)) == {"a": b"A" * 600 + b"a" * 100, "b": b"b"}
    states = [left(recorded, end, fate, random.Random(seed)) for fate in ("some", "torn") for seed in range(50)]
    assert all(one["a"] in (b"", b"\0", b"N") or one["a"].startswith(b"A" * 600) for one in states)
    assert {len(one["a"]) for one in states} >= {0, 1, 700, 900}
    assert any(b"B" * 88 in one["a"] and b"\0" not in one["a"] for one in states)


@pytest.mark.parametrize("subject", subjects()[:2], ids=lambda one: one.name)
def test_nothing_is_lost_or_counted_twice_when_power_is_cut(subject: Subject) -> None:
    counts, wrong = tally(subject, 8)
    assert not wrong
    assert counts.total() == 8


@pytest.mark.full
def test_a_thousand_kills_and_a_thousand_cuts_of_power() -> None:
    done = subprocess.run([sys.executable, "-m", "tests.integrity"], capture_output=True, text=True, check=False)
    print(done.stdout)
    assert done.returncode == 0, done.stderr
