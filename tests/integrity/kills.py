"""Something that writes is killed at random, again and again, goes on where it was, and is judged each time."""

from __future__ import annotations

import os
import random
import shutil
import signal
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from .marking import Marks
from .subjects import Subject

LONGEST = 1800.0
"""The most seconds that a run may take, on a machine that does much else."""


def kills(subject: Subject, count: int, seed: int = 1) -> Iterator[str]:
    """Kill it so many times; yield of each kill what was wrong, or "". Whoever calls has no threads."""
    chance, done = random.Random(seed), 0
    while done < count:
        with tempfile.TemporaryDirectory(prefix="robophm.") as apart:
            folder, copy = Path(apart) / "work", Path(apart) / "copy"
            folder.mkdir()
            subject.prepare(folder)
            heard, lost, finished = 0, [], False
            while done < count and not finished:
                marks = Marks()
                marks.say("heard", heard)
                finished = _killed(subject, folder, marks, chance)
                done += not finished
                before, heard = heard, marks["heard"]
                safe = max(marks["flushed"], marks["kept"], 0 if subject.runs == 1 else before)
                lost = lost if subject.runs > 1 else []
                lost.append((safe, max(heard, safe)))
                shutil.copytree(folder, copy)
                try:
                    subject.judge(folder, heard, lost)
                except Exception as error:  # whatever it is, this kill was not lived through
                    yield f"{subject.name} kill {done}, at {heard}: {type(error).__name__}: {error}"
                    break
                shutil.rmtree(folder)
                copy.rename(folder)
                if not finished:
                    yield ""


def _killed(subject: Subject, folder: Path, marks: Marks, chance: random.Random) -> bool:
    """Let it work, and kill it after it has gone some way; whether it had come to its end before."""
    begin = marks["heard"]
    child = os.fork()
    if not child:
        try:
            subject.work(folder, marks, begin, subject.length)
            os._exit(0)
        finally:
            os._exit(1)
    until, give_up = chance.randint(0, subject.length // 4), time.monotonic() + LONGEST
    while max(marks["heard"], marks["kept"]) - begin < until:
        if (ended := os.waitpid(child, os.WNOHANG))[0]:
            break
        assert time.monotonic() < give_up, "it stands still"
        time.sleep(0.0005)
    else:
        time.sleep(chance.uniform(0, 0.01))
        os.kill(child, signal.SIGKILL)
        ended = os.waitpid(child, 0)
    code = os.waitstatus_to_exitcode(ended[1])
    assert code in (0, -signal.SIGKILL), f"it ended with {code}"
    return code == 0
