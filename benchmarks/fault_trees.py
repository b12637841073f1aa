"""The Aralia fault trees, side by side with RePyability, each in a process of its own with 60 s and 8 GB.

A line for each tree as it is solved: answer and seconds of both, how far each is off SCRAM's answer (where there is
one) and off each other; then the totals. Exits with 1 where answers differ. Needs shared/cases beside the project.
Usage: python -m benchmarks.fault_trees [--peer] [NAME ...]
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

CASES = Path(__file__).resolve().parents[2] / "shared" / "cases" / "aralia_top_event.json"
SECONDS, BYTES = 60, 8 << 30
CLOSE = 1e-9


def ours(system: dict[str, Any]) -> float:
    from robophm.blocks.fault_tree import FaultTree
    from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT, Gate

    number: dict[str, int] = {}
    gates: list[Gate] = []

    def add(said: Any) -> int:
        if isinstance(said, str) and said in number:
            return number[said]
        if isinstance(said, str) and said in system["events"]:
            gate = Gate(UNIT, ())
        else:
            formula = system["gates"][said] if isinstance(said, str) else said
            kinds = {"and": ALL, "or": ANY, "not": NOT, "xor": ODD, "null": ANY, "k_of_n_fail": formula.get("k")}
            gate = Gate(kinds[formula["op"]], tuple(add(one) for one in formula["args"]))
        gates.append(gate)
        if isinstance(said, str):
            number[said] = len(gates) - 1
        return len(gates) - 1

    add(system["top"][0])
    names = [name for name in number if name in system["events"]]
    return float(FaultTree(names, gates).probability(np.array([system["events"][name]["prob"] for name in names])))


def peer(system: dict[str, Any]) -> float:
    import repyability

    gates: dict[Any, Any] = {}

    def add(said: Any) -> str:
        if isinstance(said, str) and (said in gates or said in system["events"]):
            return said
        formula = system["gates"][said] if isinstance(said, str) else said
        name = said if isinstance(said, str) else f"inner {len(gates)}"
        inputs = [add(one) for one in formula["args"]]
        kind = {"null": "or"}.get(formula["op"], formula["op"])
        gates[name] = ("vote", formula["k"], inputs) if kind == "k_of_n_fail" else (kind, inputs)
        return name

    add(system["top"][0])
    used = {one for gate in gates.values() for one in gate[-1]}
    chances = {name: event["prob"] for name, event in system["events"].items() if name in used}
    return float(np.squeeze(repyability.FaultTree(gates, chances).top_event_probability()))


SOLVERS = {"ours": ours, "peer": peer}


def one(solver: str, name: str) -> None:
    """In a process of its own: print the answer, and the seconds without the start of Python and its packages."""
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    bound = BYTES if hard == resource.RLIM_INFINITY else min(BYTES, hard)
    resource.setrlimit(resource.RLIMIT_AS, (bound, bound))
    sys.setrecursionlimit(100_000)
    import_module("repyability" if solver == "peer" else "robophm.blocks.fault_tree")
    system = next(case["system"] for case in json.loads(CASES.read_text())["cases"] if case["name"] == f"aralia/{name}")
    begun = time.perf_counter()
    answer = SOLVERS[solver](system)
    print(repr(answer), time.perf_counter() - begun)


@dataclass(frozen=True)
class Outcome:
    """Of one solver for one tree."""

    answer: float | None
    seconds: float
    """To the answer, or until there was none."""
    why_not: str = ""

    def __str__(self) -> str:
        if self.answer is None:
            return f"{self.why_not}, {self.seconds:.1f} s"
        return f"{self.answer:.13g}, {self.seconds:.2f} s"


def solved(solver: str, name: str) -> Outcome:
    """In a process of its own, ended after SECONDS."""
    words = [sys.executable, "-m", "benchmarks.fault_trees", "--one", solver, name]
    begun = time.perf_counter()
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return Outcome(None, time.perf_counter() - begun, "no answer in time")
    if done.returncode == 0:
        answer, seconds = map(float, done.stdout.split())
        return Outcome(answer, seconds)
    said = done.stderr.strip().rpartition("\n")[2] or f"ended with {done.returncode}"
    return Outcome(None, time.perf_counter() - begun, said.partition(": ")[2][:40] or said[:40])


def off(one: Outcome, other: float | None) -> str:
    if one.answer is None or not other:
        return "–"
    return f"{abs(one.answer / other - 1):.0e}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="e.g. baobab1; default all")
    parser.add_argument("--peer", action="store_true", help="beside RePyability")
    parser.add_argument("--one", choices=tuple(SOLVERS), help=argparse.SUPPRESS)
    said = parser.parse_args()
    if said.one:
        one(said.one, said.names[0])
        return 0
    if not CASES.exists():
        print("fault trees: no shared/ folder beside the project")
        return 0
    cases = {case["name"].partition("/")[2]: case for case in json.loads(CASES.read_text())["cases"]}
    if unknown := [name for name in said.names if name not in cases]:
        parser.error(f"no tree {unknown[0]!r}; expected {', '.join(cases)}")
    solvers = tuple(SOLVERS) if said.peer else ("ours",)
    columns = ["ours", "off SCRAM", *(["RePyability", "off SCRAM", "ours off it"] if said.peer else [])]
    _row("tree", columns)
    found: dict[str, list[Outcome]] = {solver: [] for solver in solvers}
    differing: list[str] = []
    for name in said.names or cases:
        known = cases[name].get("peer_check", {}).get("top_event_probability")
        mine = solved("ours", name)
        found["ours"].append(mine)
        cells, others = [str(mine), off(mine, known)], [known]
        if said.peer:
            theirs = solved("peer", name)
            found["peer"].append(theirs)
            cells += [str(theirs), off(theirs, known), off(mine, theirs.answer)]
            others.append(theirs.answer)
        _row(name, cells)
        if mine.answer is not None and any(other and abs(mine.answer / other - 1) > CLOSE for other in others):
            differing.append(name)
    for solver in solvers:
        answers = [one for one in found[solver] if one.answer is not None]
        print(f"{solver}: {len(answers)} of {len(found[solver])} solved, these in {_sum(answers):.1f} s")
    if said.peer:
        both = [(a, b) for a, b in zip(found["ours"], found["peer"], strict=True) if None not in (a.answer, b.answer)]
        mine_too, theirs_too = (_sum(one) for one in zip(*both, strict=True)) if both else (0.0, 0.0)
        print(f"both: {len(both)}, ours in {mine_too:.1f} s, RePyability in {theirs_too:.1f} s")
    for name in differing:
        print(f"answers differ by more than {CLOSE:g}: {name}")
    return 1 if differing else 0


def _sum(outcomes: Iterable[Outcome]) -> float:
    return math.fsum(one.seconds for one in outcomes)


def _row(name: str, cells: Sequence[str]) -> None:
    """Printed at once: what is interrupted has shown what it did."""
    widths = (38, 9) * 2 + (11,)
    print(f"{name:10}", *(cell.ljust(width) for cell, width in zip(cells, widths, strict=False)), flush=True)


if __name__ == "__main__":
    sys.exit(main())
