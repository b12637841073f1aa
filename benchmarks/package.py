"""What a user waits for before anything is computed: imports and a first command, in fresh interpreters."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from statistics import median

from benchmarks import DisagreementError, Line, benchmark
from benchmarks.transports import DESIGN

ROUNDS = 21


def imported(statement: str) -> float:
    """Seconds that a statement takes in a new interpreter, its start not counted."""
    code = f"import time; t = time.perf_counter(); {statement}; print(time.perf_counter() - t)"
    return float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)


def command(*arguments: str) -> float:
    """Seconds of a whole ``robophm`` command, the interpreter's start included."""
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", "from robophm.cli import main; main()", *arguments], capture_output=True, text=True
    )
    took = time.perf_counter() - start
    if done.returncode != 0:
        raise DisagreementError(f"robophm {' '.join(arguments)} exits with {done.returncode}: {done.stderr}")
    return took


@benchmark
def imports() -> Iterator[Line]:
    statements = ("import numpy", "import robophm", "import robophm; robophm.load")
    times: dict[str, list[float]] = {statement: [] for statement in statements}
    for statement in statements:
        imported(statement)  # the disk's cache, and the byte code
    for _ in range(ROUNDS):
        for statement in statements:
            times[statement].append(imported(statement))
    numpy, *ours = (median(times[statement]) for statement in statements)
    for statement, took in zip(statements[1:], ours, strict=True):
        yield Line(statement, took, numpy, "import numpy", 2.0)


@benchmark
def check() -> Iterator[Line]:
    command("check", str(DESIGN))
    yield Line("robophm check examples/ota/robot.yaml", min(command("check", str(DESIGN)) for _ in range(5)))
