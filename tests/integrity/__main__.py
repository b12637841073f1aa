"""``python -m tests.integrity``: kills and cuts of power; exits with 1 where something was not lived through."""

from __future__ import annotations

import argparse
import logging
import sys
import time
from collections import Counter

from .kills import kills
from .power_cuts import tally
from .subjects import subjects


def main() -> int:
    """Kill and cut, and print a line for each subject."""
    parser = argparse.ArgumentParser(prog="python -m tests.integrity", description=__doc__)
    names = [one.name for one in subjects()]
    parser.add_argument("subjects", nargs="*", metavar="SUBJECT", help=f"of {', '.join(names)}; default all")
    parser.add_argument("--kills", type=int, default=1000, help="of all subjects together")
    parser.add_argument("--cuts", type=int, default=1000, help="states after a cut of power, of all together")
    parser.add_argument("--seed", type=int, default=1)
    said = parser.parse_args()
    logging.getLogger("robophm.stores").setLevel(logging.ERROR)  # that saves were not finished is what it is about
    wanted = [one for one in subjects() if one.name in (said.subjects or names)]
    faults: list[str] = []
    for subject in wanted:
        begun = time.monotonic()
        found = [*kills(subject, -(-said.kills // len(wanted)), said.seed)] if said.kills else []
        print(f"{subject.name}: {len(found)} kills, {sum(map(bool, found))} not lived through, "
              f"{time.monotonic() - begun:.0f} s", flush=True)  # fmt: skip
        faults += [one for one in found if one]
    for subject in wanted:
        begun = time.monotonic()
        counts, wrong = tally(subject, -(-said.cuts // len(wanted)), said.seed) if said.cuts else (Counter(), [])
        of = ", ".join(f"{count} {fate}" for fate, count in counts.items())
        print(f"{subject.name}: {counts.total()} cuts of power ({of}), {len(wrong)} not lived through, "
              f"{time.monotonic() - begun:.0f} s", flush=True)  # fmt: skip
        faults += wrong
    print(*faults, sep="\n", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
