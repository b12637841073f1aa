"""``python -m tests.transports.recordings.columns.fuzz``; exits with 1 where there are findings."""

from __future__ import annotations

import argparse
import secrets
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from . import logs, messages
from .mutate import mutant
from .pool import Result, examine, run

FORMATS = ("bag", "db3", "wal", "mcap", *logs.FORMATS, *messages.FORMATS)
OUTCOMES = ("whole", "in part", "changed", "refused", "fault")
FOUND = Path("fuzz-findings")


@dataclass
class Tally:
    """What became of the files of one format."""

    outcomes: Counter[str] = field(default_factory=Counter)
    peers: Counter[str] = field(default_factory=Counter)
    slowest: tuple[float, int] = (0.0, 0)
    memory: int = 0

    def add(self, result: Result) -> None:
        """Count one more."""
        self.outcomes[result.outcome] += 1
        self.peers.update(what for what, _ in result.peers)
        self.slowest = max(self.slowest, (result.seconds, result.number))
        self.memory = max(self.memory, result.memory)


def tallied(work: dict[str, int], seed: int, jobs: int, found: Callable[[Result], None]) -> dict[str, Tally]:
    """Read all files; progress goes to standard error."""
    tallies = {format_: Tally() for format_ in work}
    start = shown = time.monotonic()
    total = sum(work.values())
    for done, result in enumerate(run(work, seed, jobs), 1):
        tallies[result.format].add(result)
        if result.fault:
            found(result)
        now = time.monotonic()
        terminal = sys.stderr.isatty()
        if now - shown > (1 if terminal else 60):
            shown = now
            faults = sum(tally.outcomes["fault"] for tally in tallies.values())
            line = f"{done:,} of {total:,} files, {faults} findings, {now - start:.0f} s"
            print(line, end="\r" if terminal else f"\n{table(tallies)}\n", file=sys.stderr)
    return tallies


def table(tallies: dict[str, Tally]) -> str:
    """The tallies as Markdown."""
    lines = ["| format | files | " + " | ".join(OUTCOMES) + " | slowest | memory |", "|---" * (len(OUTCOMES) + 4) + "|"]
    for format_, tally in tallies.items():
        counts = " | ".join(f"{tally.outcomes[outcome]:,}" for outcome in OUTCOMES)
        slowest, number = tally.slowest
        total = sum(tally.outcomes.values())
        memory = f"{tally.memory / 2**20:.0f} MiB"
        label = format_ if " " in format_ else f".{format_}"
        lines.append(f"| {label} | {total:,} | {counts} | {slowest:.2f} s (number {number}) | {memory} |")
    for format_, tally in tallies.items():
        lines += [f".{format_}: {what}: {count:,}" for what, count in sorted(tally.peers.items())]
    return "\n".join(lines)


def repeat(format_: str, number: int, seed: int) -> int:
    """Read one file again, in this process, and say all that can be said."""
    damaged = mutant(format_, number, seed)
    print(f".{format_} {number}: {damaged.name}, {len(damaged.content):,} bytes")
    with tempfile.TemporaryDirectory() as folder:
        *_, result = examine(format_, number, seed, Path(folder))
    print(f"{result.outcome}, {result.seconds:.2f} s", *result.peers, result.fault, sep="\n")
    return 1 if result.fault else 0


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.transports.recordings.columns.fuzz", description="damaged recordings"
    )
    parser.add_argument("--files", type=int, default=100_000, help="of each format; default 100,000")
    parser.add_argument("--seed", type=int, help="default a fresh one")
    parser.add_argument("--format", choices=FORMATS, help="only this one")
    parser.add_argument("--number", type=int, help="only this file, of --format and --seed")
    parser.add_argument("--jobs", type=int, default=2, help="processes; default 2")
    arguments = parser.parse_args()
    seed = secrets.randbits(32) if arguments.seed is None else arguments.seed
    if arguments.number is not None:
        if arguments.format is None:
            parser.error("--number needs --format")
        return repeat(arguments.format, arguments.number, seed)
    formats = [arguments.format] if arguments.format else FORMATS
    print(f"{arguments.files:,} files of each format, seed {seed}")

    def keep(finding: Result) -> None:
        FOUND.mkdir(exist_ok=True)
        path = FOUND / f"{seed}-{finding.number}.{finding.format}"
        mutant(finding.format, finding.number, seed).write(path)
        print(f"{path}: {finding.fault}\n", flush=True)

    tallies = tallied(dict.fromkeys(formats, arguments.files), seed, arguments.jobs, keep)
    print(table(tallies))
    return 1 if any(tally.outcomes["fault"] for tally in tallies.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
