"""Memory that was freed is given back."""

from __future__ import annotations

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
