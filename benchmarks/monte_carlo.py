"""The simulator of diagrams against RePyability's draws of system lives, and against plain NumPy."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from benchmarks import Line, agree, benchmark, race
from benchmarks.designs import twins
from robophm.blocks.diagram import Block, KOutOfN, Series, Unit
from robophm.blocks.reliability import Structure
from robophm.groups.monte_carlo import AgeingMode, simulate

SAMPLES = 100_000
HOURS = 500.0


@benchmark
def hundred_parts() -> Iterator[Line]:
    twin = twins(100)
    robot, peer = twin.robot, twin.rbd
    units = {part.path: [AgeingMode(mode.life) for mode in part.modes] for part in robot.all_components()}
    lives = {name: wear[0].life for name, wear in units.items()}
    random = np.random.default_rng(1)

    def ours() -> float:
        return simulate(robot.diagram, units, HOURS, SAMPLES, seed=1).probability

    def theirs() -> float:
        return float(np.mean(np.asarray(peer.random(SAMPLES, seed=1)) > HOURS))

    def naive() -> float:
        """Every part draws a life, and the diagram is walked with arrays of booleans."""

        @cache
        def works(block: Block) -> np.ndarray:
            if isinstance(block, Unit):
                return np.asarray(lives[block.name].age_at(random.standard_exponential(SAMPLES)) > HOURS)
            inner = [works(one) for one in block.blocks]
            if isinstance(block, Series):
                return np.logical_and.reduce(inner)
            needed = block.k if isinstance(block, KOutOfN) else 1
            return np.sum(inner, axis=0) >= needed

        return float(np.mean(works(robot.diagram)))

    structure = Structure(robot.diagram)
    hazard = np.array([float(lives[name].cumulative_hazard(HOURS)) for name in structure.names])
    exact = float(structure.state(np.exp(-hazard), -np.expm1(-hazard)).works)
    error = 6 * np.sqrt((1 - exact) / exact / SAMPLES)
    for what, found in (("ours", ours()), ("the peer's", theirs()), ("plain NumPy's", naive())):
        agree(f"reliability by chance, {what}", found, exact, error)
    work = f"a hundred parts, {SAMPLES:,} lives"
    mine, peers = race(ours, theirs, rounds=5)
    speed = f"{100 * SAMPLES / mine:.2g} parts/s"
    yield Line(work, mine, peers, "RePyability", goal=1 / 6, per_second=speed)
    mine, plain = race(ours, naive, rounds=5)
    yield Line(work, mine, plain, "plain NumPy", goal=1 / 3)
