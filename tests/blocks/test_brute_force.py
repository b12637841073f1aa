"""Random diagrams with shared parts against the sum over all states, in exact integer arithmetic."""

import random
from fractions import Fraction

import numpy as np
import pytest
from tests.cases import each_case

from robophm.blocks.diagram import Block
from robophm.blocks.reliability import Structure

from ..structures import draw, works

WHOLE = 1 << 129  # probabilities are integers out of this many: exact, down to 1e-36
DIGITS = 1e-12


def chances(rng: random.Random, n: int) -> list[int]:
    """Ordinary ones, or in every other diagram also some as small as 1e-30."""
    shifts = rng.choice([[107], [0, 8, 28, 60, 88, 107, 107]])
    return [rng.randint(1, 2**20) << rng.choice(shifts) for _ in range(n)]


def phi(block: Block, names: tuple[str, ...]) -> np.ndarray:
    """φ of all states; bit i of a state tells whether unit i works."""
    states = np.arange(2 ** len(names))
    return works(block, {name: states >> i & 1 == 1 for i, name in enumerate(names)})


def real(numerator: int, units: int) -> float:
    return float(Fraction(int(numerator), WHOLE**units))


def agree(found: float, exact: float) -> None:
    if exact > 1e-290:  # below, floating point itself gives out
        assert found == pytest.approx(exact, rel=DIGITS, abs=0)
    else:
        assert 0 <= found < 1e-289


@each_case("seed", range(300))
def test_state(seed: int) -> None:
    rng = random.Random(seed)
    size = rng.choice([2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 14])
    block = draw(rng, [f"u{i}" for i in range(size)], rng.randint(size, 3 * size))
    structure = Structure(block)
    n = len(structure.names)
    small = chances(rng, n)
    p = [x if rng.random() < 0.5 else WHOLE - x for x in small]
    q, f = [WHOLE - x for x in p], chances(rng, n)

    weight = np.array([1], dtype=object)
    for p_i, q_i in zip(p, q, strict=True):
        weight = np.concatenate([weight * q_i, weight * p_i])
    up = phi(block, structure.names)
    states = np.arange(2**n)
    density = Fraction(0)
    for i in range(n):
        decides = up & ~up[states & ~(1 << i)]  # works, and would not without unit i
        density += Fraction(int(weight[decides].sum()) * f[i], p[i])

    found = structure.state(*([real(x, 1) for x in column] for column in (p, q, f)))
    agree(found.works, real(weight[up].sum(), n))
    agree(found.failed, real(weight[~up].sum(), n))
    agree(found.density, float(density / WHOLE**n))


@each_case("seed", range(150))
def test_transition(seed: int) -> None:
    rng = random.Random(1000 + seed)
    size = rng.randint(2, 8)
    block = draw(rng, [f"u{i}" for i in range(size)], rng.randint(size, 3 * size))
    structure = Structure(block)
    n = len(structure.names)
    units = []
    for x, y in zip(chances(rng, n), chances(rng, n), strict=True):
        unit = [x, y, WHOLE - x - y]
        rng.shuffle(unit)
        units.append(unit)

    weight = np.array([1], dtype=object)
    now = end = np.array([0])
    for i, (b, c, s) in enumerate(units):
        weight = np.concatenate([weight * b, weight * c, weight * s])
        now = np.concatenate([now, now | 1 << i, now | 1 << i])
        end = np.concatenate([end, end, end | 1 << i])
    up = phi(block, structure.names)
    b, c, s = (weight[which].sum() for which in (~up[now], up[now] & ~up[end], up[end]))

    found = structure.transition(*([real(unit[j], 1) for unit in units] for j in range(3)))
    agree(found.failed, real(b, n))
    agree(found.fails, real(c, n))
    agree(found.survives, real(s, n))
    if min(found.fails + found.survives, real(c, n)) > 1e-290:
        agree(found.fails / (found.fails + found.survives), float(Fraction(int(c), int(c + s))))
