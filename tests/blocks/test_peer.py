"""Side by side with RePyability, where it is installed."""

import random

import numpy as np
import pytest

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit
from robophm.blocks.reliability import Structure


def draw(rng: random.Random, leaves: int, names: int) -> Block:
    if leaves == 1:
        return Unit(f"u{rng.randrange(names)}")
    cut = sorted(rng.sample(range(1, leaves), min(leaves - 1, rng.randint(1, 4))))
    inner = [draw(rng, b - a, names) for a, b in zip([0, *cut], [*cut, leaves], strict=True)]
    kind = rng.choice([Series, Parallel, KOutOfN])
    return KOutOfN(rng.randint(1, len(inner)), *inner) if kind is KOutOfN else kind(*inner)


@pytest.mark.parametrize("seed", range(20))
def test_unreliability_of_random_diagrams_of_thirty_units(seed: int) -> None:
    peer = pytest.importorskip("repyability")
    rng = random.Random(seed)
    block = draw(rng, 50, 30)
    structure = Structure(block)
    q = {name: 10 ** -rng.uniform(0.1, 4) for name in structure.names}

    gates: dict[str, tuple] = {}

    def gate(block: Block, at: str) -> str:
        """A fault tree's gate for a block: it fails when n + 1 − k of its inputs have."""
        inner = [block.name] if isinstance(block, Unit) else [gate(b, f"{at}.{i}") for i, b in enumerate(block.blocks)]
        n = len(inner)
        k = block.k if isinstance(block, KOutOfN) else 1 if isinstance(block, Parallel) else n
        gates[at] = ("vote", n + 1 - k, inner)
        return at

    gate(block, "top")
    expected = peer.FaultTree(gates, q).top_event_probability()
    failed = np.array([q[name] for name in structure.names])
    assert structure.state(1 - failed, failed).failed == pytest.approx(float(np.squeeze(expected)), rel=1e-11)
