"""The Aralia fault trees, side by side with RePyability, each in a process of its own with 60 s and 8 GB.

Needs shared/cases beside the project. Usage: python -m benchmarks.fault_trees [--peer] [NAME ...]
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

CASES = Path(__file__).resolve().parents[2] / "shared" / "cases" / "aralia_top_event.json"
SECONDS, BYTES = 60, 8 << 30


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


def one(solver: str, name: str) -> None:
    """In a process of its own: print the answer."""
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    sys.setrecursionlimit(100_000)
    cases = {case["name"]: case["system"] for case in json.loads(CASES.read_text())["cases"]}
    print(repr({"ours": ours, "peer": peer}[solver](cases[name])))


def timed(solver: str, name: str) -> tuple[float | str, float]:
    """The answer, or why there is none, and the seconds."""
    words = [sys.executable, "-m", "benchmarks.fault_trees", "--one", solver, name]
    begun = time.perf_counter()
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return "no answer in time", time.perf_counter() - begun
    taken = time.perf_counter() - begun
    if done.returncode == 0:
        return float(done.stdout), taken
    return (done.stderr.strip().rpartition("\n")[2] or f"ended with {done.returncode}")[-70:], taken


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--peer", action="store_true", help="beside RePyability")
    parser.add_argument("--one", choices=("ours", "peer"), help=argparse.SUPPRESS)
    said = parser.parse_args()
    if said.one:
        one(said.one, said.names[0])
        return
    solvers = ["ours", "peer"] if said.peer else ["ours"]
    solved, seconds = dict.fromkeys(solvers, 0), dict.fromkeys(solvers, 0.0)
    if not CASES.exists():
        print("fault trees: no shared/ folder beside the project")
        return
    cases = json.loads(CASES.read_text())["cases"]
    for case in cases:
        if said.names and case["name"].partition("/")[2] not in said.names:
            continue
        line = f"{case['name']:18}"
        for solver in solvers:
            answer, taken = timed(solver, case["name"])
            known = case.get("peer_check", {}).get("top_event_probability")
            off = f" off by {abs(answer / known - 1):.0e}" if isinstance(answer, float) and known else ""
            line += f"  {solver} {answer if isinstance(answer, str) else f'{answer:.15g}'} in {taken:.1f} s{off}"
            solved[solver] += isinstance(answer, float)
            seconds[solver] += taken if isinstance(answer, float) else 0.0
        print(line, flush=True)
    for solver in solvers:
        print(f"{solver}: {solved[solver]} solved within {SECONDS} s each, {seconds[solver]:.0f} s in all")


if __name__ == "__main__":
    main()
