"""Stretches of a diagram that is too large to be drawn at once: together they draw each part, and count the rest."""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit, units
from robophm.report.outline import Chain, Fork, More, Node, names, outline


def drawn_blocks(draw: random.Random, count: int, depth: int = 0) -> Block:
    """A random diagram of so many units, named by their order."""
    sizes = [count] if count == 1 or depth > 3 else [draw.randint(1, 9) for _ in range(count)]
    first, blocks = 0, list[Block]()
    for size in sizes:
        size = min(size, count - first)
        if size <= 0:
            break
        nested = size > 1 and len(sizes) > 1
        blocks += [drawn_blocks(draw, size, depth + 1)] if nested else [Unit("x") for _ in range(size)]
        first += size
    kind = draw.choice([Series, Series, Parallel, lambda *some: KOutOfN(1, *some)])
    return kind(*blocks) if len(blocks) > 1 else blocks[0]


def numbered(block: Block, left: Iterator[int]) -> Block:
    if isinstance(block, Unit):
        return Unit(f"part {next(left)}")
    inner = [numbered(one, left) for one in block.blocks]
    return KOutOfN(block.k, *inner) if isinstance(block, KOutOfN) else type(block)(*inner)


def left_out(node: Node) -> Iterator[int]:
    if isinstance(node, More):
        yield node.count
    elif isinstance(node, Chain | Fork):
        for one in node.nodes:
            yield from left_out(one)


@pytest.mark.parametrize("seed", range(20))
def test_stretches_draw_each_part_once_and_count_the_others(seed: int) -> None:
    draw = random.Random(seed)
    diagram = numbered(drawn_blocks(draw, draw.randint(2, 60)), iter(range(1000)))
    every, most = [*units(diagram)], draw.randint(1, 20)
    seen: list[str] = []
    for skip in range(0, len(every), most):
        nodes = outline(diagram, most, skip)
        assert len([*names(nodes)]) + sum(left_out(nodes)) == len(every)
        seen += names(nodes)
        assert every[skip] in [*names(nodes)]
    assert seen == every
