"""Memory that was freed is given back."""

from __future__ import annotations

import platform
import subprocess
import sys

import pytest

# half of what is there is freed, every other piece: none of it is at an end, where it would be given back by itself
SHRINKS = """
from robophm.core.freed_memory import give_back
def anonymous():
    lines = open("/proc/self/smaps_rollup").read().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("Anonymous"))
pieces = [bytearray(100_000) for _ in range(1000)]
full = anonymous()
del pieces[1:999:2]
kept = anonymous()
give_back()
print(full, kept, anonymous())
"""


@pytest.mark.skipif(sys.platform != "linux", reason="asks the system of Linux")
def test_what_is_free_between_what_is_used_goes_back() -> None:
    done = subprocess.run([sys.executable, "-c", SHRINKS], capture_output=True, text=True, check=True)
    full, kept, left = map(int, done.stdout.split())
    assert kept > full - 10_000, "else nothing needs to be given back"
    assert left < full - 40_000


# of which size blocks are mapped by themselves, before and after one of eight megabytes was freed
MAPPED = """
import ctypes, sys
from robophm.core.freed_memory import map_large_blocks
class Said(ctypes.Structure):
    _fields_ = [(name, ctypes.c_size_t) for name in "arena ordblks smblks mapped".split() + [f"_{i}" for i in range(6)]]
said = ctypes.CDLL(None).mallinfo2
said.restype = Said
def is_mapped(size):
    before = said().mapped
    block = bytearray(size)
    return said().mapped - before
if sys.argv[1:]:
    map_large_blocks()
print(is_mapped(8_000_000), is_mapped(4_000_000), is_mapped(500_000))
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="asks glibc")
def test_large_blocks_go_on_to_be_mapped_after_one_was_freed() -> None:
    for words, expected in (([], "1 0 0"), (["bounded"], "1 1 0")):
        done = subprocess.run([sys.executable, "-c", MAPPED, *words], capture_output=True, text=True, check=True)
        assert done.stdout.split() == expected.split(), words
