"""A file is written whole or not at all."""

import os
import stat
import subprocess
import sys

import pytest

from robophm.core.files import write_atomically


def test_writes_text_and_bytes(tmp_path):
    path = tmp_path / "ü 🤖.txt"
    write_atomically(path, "λ\n")
    assert path.read_bytes() == b"\xce\xbb\n"
    write_atomically(path, b"\x00")
    assert path.read_bytes() == b"\x00"
    assert list(tmp_path.iterdir()) == [path]


def test_modes_are_kept_and_new_files_follow_the_umask(tmp_path):
    path = tmp_path / "x"
    before = os.umask(0o027)
    try:
        write_atomically(path, "1")
    finally:
        os.umask(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    path.chmod(0o604)
    write_atomically(path, "2")
    assert stat.S_IMODE(path.stat().st_mode) == 0o604


def test_a_link_stays_a_link(tmp_path):
    target, link = tmp_path / "real", tmp_path / "link"
    target.write_text("old")
    link.symlink_to(target)
    write_atomically(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def test_a_device_is_written_to_and_not_replaced(tmp_path):
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    with subprocess.Popen(["cat", str(fifo)], stdout=subprocess.PIPE) as reader:
        write_atomically(fifo, "through")
        assert reader.communicate(timeout=10)[0] == b"through"
    assert stat.S_ISFIFO(fifo.stat().st_mode)


def test_the_longest_name_that_the_file_system_takes(tmp_path):
    write_atomically(tmp_path / ("x" * 255), "1")
    with pytest.raises(OSError, match="too long"):
        write_atomically(tmp_path / ("x" * 256), "1")
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize("place", [".", "no/such/folder/file"])
def test_what_cannot_be_written_leaves_nothing_behind(tmp_path, place):
    with pytest.raises(OSError):
        write_atomically(tmp_path / place, "1")
    assert list(tmp_path.iterdir()) == []


FULL = """
import resource, sys
from pathlib import Path
from robophm.core.files import write_atomically
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
try:
    write_atomically(Path(sys.argv[1]), "x" * 5000)
except OSError as error:
    print(error.strerror)
"""


def test_a_full_disk_leaves_the_file_as_it_was(tmp_path):
    path = tmp_path / "file"
    path.write_text("old")
    run = subprocess.run([sys.executable, "-c", FULL, str(path)], capture_output=True, text=True, check=True)
    assert run.stdout == "File too large\n"
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]
