"""The C++ library mcap as a peer, where its headers are: the folder that holds ``mcap/reader.hpp``, in MCAP_INCLUDE.

Its headers are no package of Python's nor, as a rule, of the system; they need liblz4-dev and libzstd-dev.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

SOURCE = Path(__file__).with_name("mcap_scalar.cpp")

Read = Callable[[Path], tuple[int, float]]
"""Count and sum of the scalars of a file."""


@contextmanager
def mcap_cpp(topic: str, folder: Path) -> Iterator[Read | str]:
    """A process that reads one file after the other, built in this folder; or why there is none."""
    include = os.environ.get("MCAP_INCLUDE", "")
    compiler = shutil.which(os.environ.get("CXX", "c++")) or shutil.which("g++") or shutil.which("clang++")
    if not (Path(include) / "mcap/reader.hpp").is_file():
        yield "not built here: MCAP_INCLUDE names no folder with mcap/reader.hpp"
        return
    if not compiler:
        yield "not built here: no C++ compiler"
        return
    program = folder / "mcap_scalar"
    command = [compiler, "-std=c++17", "-O3", "-DNDEBUG", f"-I{include}", str(SOURCE), "-o", str(program)]
    built = subprocess.run([*command, "-llz4", "-lzstd"], capture_output=True, text=True, check=False)
    if built.returncode:
        yield f"not built here: {built.stderr.strip().splitlines()[0]}"
        return
    with subprocess.Popen([program, topic], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:

        def read(path: Path) -> tuple[int, float]:
            assert process.stdin
            assert process.stdout
            process.stdin.write(f"{path}\n")
            process.stdin.flush()
            count, total = process.stdout.readline().split()
            return int(count), float(total)

        yield read
