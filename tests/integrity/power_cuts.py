"""Power is cut while something writes: its writes are recorded once, and many states of the disk are judged."""

from __future__ import annotations

import random
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from .disk import FATES, lay, left, marks
from .marking import TracedMarks
from .recorded_writes import Marked, record
from .subjects import Subject


def worked(subject: Subject, folder: Path) -> None:
    """Do the whole work, in as many runs as the subject is made of; ``record`` runs this in a process of its own."""
    said = TracedMarks()
    step = -(-subject.length // subject.runs)
    for begin in range(0, subject.length, step):
        subject.work(folder, said, begin, min(begin + step, subject.length))


def cuts(subject: Subject, states: int, seed: int = 1) -> Iterator[tuple[str, str]]:
    """Judge so many states; yield of each what became of what had not been synced, and what was wrong, or ""."""
    with tempfile.TemporaryDirectory(prefix="robophm.") as apart:
        folder, log = Path(apart) / "work", Path(apart) / "calls"
        folder.mkdir()
        subject.prepare(folder)
        recorded = record(["tests.integrity.power_cuts", subject.name, str(folder)], folder, log)
        log.unlink()
        places = [number for number, deed in enumerate(recorded.deeds) if not isinstance(deed, Marked)]
        for number in range(states):
            chance, fate = random.Random(1000 * seed + number), FATES[number % len(FATES)]
            cut = chance.choice(places) + 1
            lay(left(recorded, cut, fate, chance), folder)
            said = marks(recorded.deeds[:cut])
            heard = said.get("heard", 0)
            try:
                subject.judge(folder, heard, [(said.get("kept", 0), heard)])
            except Exception as error:  # whatever it is, this state was not lived through
                yield fate, f"{subject.name} state {number}, cut at {cut}: {type(error).__name__}: {error}"
            else:
                yield fate, ""


def tally(subject: Subject, states: int, seed: int = 1) -> tuple[Counter[str], list[str]]:
    """How many states of each fate were judged, and what was wrong with which."""
    counts: Counter[str] = Counter()
    wrong = []
    for fate, said in cuts(subject, states, seed):
        counts[fate] += 1
        wrong += [said] if said else []
    return counts, wrong


if __name__ == "__main__":
    import sys

    from .subjects import subjects

    worked(next(one for one in subjects() if one.name == sys.argv[1]), Path(sys.argv[2]))
