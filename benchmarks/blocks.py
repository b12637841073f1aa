"""The diagram alone, the states of its units given, against RePyability's exact evaluation."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks import Line, agree, benchmark, race
from benchmarks.designs import twins
from robophm.blocks.reliability import State, Structure


def evaluate(parts: int, columns: int) -> Line:
    twin = twins(parts)
    structure = Structure(twin.robot.diagram)
    rng = np.random.default_rng(columns)
    failed = 10 ** rng.uniform(-6, -1, (parts, columns))
    density = failed * rng.uniform(0.5, 1.5, failed.shape)
    works = 1 - failed
    row = [twin.names.index(name) for name in structure.names]
    given = failed[row], density[row], works[row]

    def ours() -> State:
        b, c, s = given
        return structure.state(s, b, c)

    def theirs() -> np.ndarray:
        return twin.system(works)

    state = ours()
    agree(f"reliability of {parts} units", state.works, theirs(), 1e-9)
    # the peer's derivative by each unit, all of them as columns of one evaluation of the first state
    up, down = (np.where(np.eye(parts) == 1, held, works[:, :1]) for held in (1.0, 0.0))
    weight = twin.system(up) - twin.system(down)
    agree(f"density of {parts} units", state.density[0], weight @ density[:, 0], 1e-9)
    noun = "state" if columns == 1 else "states"
    return Line(f"diagram of {parts} units, {columns:,} {noun}: R, F, f", *race(ours, theirs), "RePyability, R alone")


@benchmark
def diagram() -> Iterator[Line]:
    yield evaluate(100, 1)
    yield evaluate(100, 10_000)
