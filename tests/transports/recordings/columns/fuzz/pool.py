"""Processes that read damaged files, each with a limit of memory and of time; one that dies is a finding."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import resource
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import NamedTuple

from . import log_judge
from .judge import compare, judge, peers_of, read
from .logs import LogSeed
from .mutate import mutant, stock
from .seeds import MEMORY

TIME, MOST_TIME = 5, 60
"""Seconds that a file may take: of the processor's time, and with waiting for the processor."""

SPACE = 512 << 20
"""Bytes of address space that reading a file may take beyond what the process has when it begins."""

PEERS_EVERY = 8
"""Of so many files one is given to slow peers too."""


_PEERS = ", peers begun"


class Result(NamedTuple):
    """What became of one file."""

    format: str
    number: int
    outcome: str
    """As a verdict's; or 'fault'."""
    fault: str = ""
    seconds: float = 0.0
    peers: tuple[tuple[str, str], ...] = ()
    memory: int = 0
    """Bytes that the process has had at most so far, all in all."""


def peak() -> int:
    """Bytes of memory that this process has had at most; ru_maxrss begins with what the process had that started it."""
    status = Path("/proc/self/status").read_text(encoding="ascii", errors="replace")
    return next(int(line.split()[1]) * 1024 for line in status.splitlines() if line.startswith("VmHWM"))


def forget_peak() -> None:
    """Have the peak begin anew: what the peers took for an earlier file is not ours (proc(5), clear_refs)."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def examine(format_: str, number: int, seed: int, folder: Path) -> Iterator[Result]:
    """First that it is begun with, then what became of it; where peers are asked a second beginning between."""
    damaged = mutant(format_, number, seed)
    path = folder / f"{format_}{damaged.suffix}"
    damaged.write(path)
    yield Result(format_, number, "begun")
    forget_peak()
    begun = time.process_time()
    verdict, ours = judge(damaged, path)
    seconds = time.process_time() - begun
    memory = peak()
    result = Result(format_, number, verdict.outcome, verdict.fault, seconds, (), memory)
    if (peers := peers_of(damaged, number % PEERS_EVERY == 0)) and not verdict.fault:
        yield result._replace(outcome=verdict.outcome + _PEERS)
        result = result._replace(peers=tuple(compare(ours, damaged, path, peers)))
        if faults := [f"{what}: {how}" for what, how in result.peers if how]:
            result = result._replace(outcome="fault", fault=faults[0])
    yield result


def _work(format_: str, first: int, behind: int, seed: int, results: Connection) -> None:
    os.setpgid(0, 0)  # an interrupt is the parent's to handle
    sys.unraisablehook = lambda what: os.abort()
    with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
        for recording, _ in stock(format_):  # what is loaded and compiled at first is not a file's
            path = Path(folder) / f"sound{'.db3' if recording.beside else recording.suffix}"
            path.write_bytes(recording.beside or recording.content)
            if isinstance(recording, LogSeed):
                log_judge.read(path, [signal for signal, _ in recording.samples])
            else:
                read(path)
        with Path("/proc/self/statm").open() as file:
            space = int(file.read().split()[0]) * resource.getpagesize() + SPACE
        resource.setrlimit(resource.RLIMIT_AS, (space, space))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        for number in range(first, behind):
            for result in examine(format_, number, seed, Path(folder)):
                begun = result.outcome.endswith("begun")
                signal.setitimer(signal.ITIMER_PROF, TIME * begun)
                signal.setitimer(signal.ITIMER_REAL, MOST_TIME * begun)
                results.send(result)
    results.close()


class _Worker:
    """A process and the numbers it has yet to do."""

    def __init__(self, format_: str, first: int, behind: int, seed: int) -> None:
        self.format, self.number, self.behind, self.seed = format_, first, behind, seed
        self.peak = Result(format_, first, "begun")
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.results, theirs = context.Pipe(duplex=False)
        arguments = (self.format, self.number, self.behind, self.seed, theirs)
        self.process = context.Process(target=_work, args=arguments)
        self.process.start()
        theirs.close()
        self.last = Result(self.format, self.number, "not begun")

    def next(self) -> Result | None:
        """A result that is complete, or that the process died."""
        try:
            self.last = self.results.recv()
        except EOFError:
            self.process.join()
            self.results.close()
            if self.number == self.behind:
                return None
            return self._died()
        if self.last.outcome.endswith("begun"):
            return None
        self.number += 1
        return self.last

    def _died(self) -> Result:
        code = self.process.exitcode or 0
        if self.last.outcome == "not begun":
            raise RuntimeError(f"a process ended with {code} before its first file")
        name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        if self.last.outcome.endswith(_PEERS):  # theirs is the fault, not ours
            result = self.last._replace(
                outcome=self.last.outcome.removesuffix(_PEERS), peers=(("a peer hangs or crashes", ""),)
            )
        else:
            hangs = code in (-signal.SIGALRM, -signal.SIGPROF)
            fault = f"hangs: longer than {TIME} s" if hangs else f"the process ended: {name}"
            result = self.last._replace(number=self.number, outcome="fault", fault=fault, seconds=TIME * hangs)
        self.number += 1
        self._start()
        return result


def run(work: dict[str, int], seed: int, jobs: int) -> Iterator[Result]:
    """The results of so many files of each format, as they come."""
    waiting = []
    for format_, count in work.items():
        share = -(-count // jobs)
        waiting += [(format_, first, min(first + share, count), seed) for first in range(0, count, share)]
    busy: dict[Connection, _Worker] = {}
    try:
        while waiting or busy:
            while waiting and len(busy) < jobs:
                worker = _Worker(*waiting.pop(0))
                busy[worker.results] = worker
            for ready in wait([*busy]):
                worker = busy.pop(ready)  # type: ignore[call-overload]
                if result := worker.next():
                    yield result
                if not worker.results.closed:
                    busy[worker.results] = worker
    finally:
        for worker in busy.values():
            with contextlib.suppress(OSError):
                worker.process.kill()
