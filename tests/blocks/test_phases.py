"""What must work until different times, against the sum over all orders in which the parts can fail."""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from itertools import product

import numpy as np
import pytest
from mpmath import mp, mpf
from tests.cases import each_case

from robophm.blocks import decision_diagram
from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit
from robophm.blocks.phases import Phases
from robophm.blocks.reliability import Structure
from robophm.core.errors import StructureError

from ..structures import draw, works

Needs = list[tuple[int, Block]]
DIGITS = 1e-12
A, B, C, D = Unit("a"), Unit("b"), Unit("c"), Unit("d")


def intervals(hazards: Iterable[float]) -> list[mpf]:
    """P(a part fails in each stretch of time, or after all of them), from what each adds to its hazard."""
    found, lived = [], mpf(0)
    for hazard in hazards:
        if mp.isinf(hazard):
            found.append(mp.exp(-lived))
            lived = mp.inf
        else:
            found.append(mp.exp(-lived) * -mp.expm1(-mpf(hazard)) if not mp.isinf(lived) else mpf(0))
            lived += mpf(hazard)
    return [*found, mp.exp(-lived) if not mp.isinf(lived) else mpf(0)]


def brute_force(names: Sequence[str], known: Needs, wanted: Needs, hazards: np.ndarray) -> list[mpf]:
    """(b, c, s): every part fails in every stretch once; ``hazards`` of shape (1 + phases, units), the past first."""
    stretches = len(hazards) + 1
    weight = np.array([mpf(1)], dtype=object)
    for unit in hazards.T:
        weight = np.multiply.outer(weight, np.array(intervals(unit), dtype=object)).ravel()
    fails_in = np.array(list(product(range(stretches), repeat=len(names)))).T

    def hold(needs: Needs) -> np.ndarray:
        every = np.ones(len(weight), dtype=bool)
        for phase, block in needs:
            every &= works(block, {name: when > phase for name, when in zip(names, fails_in, strict=True)})
        return every

    before, after = hold(known), hold(wanted)
    return [mp.fsum(weight[which]) for which in (~before, before & ~after, before & after)]


def agree(found: float, exact: mpf) -> None:
    if exact > mpf("1e-290"):  # below, floating point itself gives out
        assert found == pytest.approx(float(exact), rel=DIGITS, abs=0)
    else:
        assert 0 <= found < 1e-289


def check(known: Needs, wanted: Needs, past: np.ndarray, more: np.ndarray, phases: Phases | None = None) -> None:
    phases = phases or Phases(known, wanted)
    found = phases.transition(past, more)
    with mp.workdps(40):
        exact = brute_force(phases.names, known, wanted, np.concatenate(([past], more)))
        for one, other in zip(found, exact, strict=True):
            agree(float(one), other)
        _, c, s = exact
        given = phases.given(past, more)
        agree(float(given[0]), c / (c + s) if c + s else mpf(1))  # however little speaks for what is known
        agree(float(given[1]), s / (c + s) if c + s else mpf(0))
        if c + s:
            assert float(phases.log_known(past, more)) == pytest.approx(float(mp.log(c + s)), rel=1e-14, abs=1e-15)
        if c + s > mpf("1e-280"):
            alive = found.fails + found.survives
            agree(float(found.fails / alive), c / (c + s))
            agree(float(found.survives / alive), s / (c + s))


HAZARDS = {
    "ordinary": [0.1, 0.5, 1.0, 2.0],
    "tiny": [1e-15, 3e-14, 0.2, 1e-9],
    "vanishing": [1e-300, 1e-150, 1e-15, 0.3, 1.0],
    "large": [40.0, 700.0, 0.5, 3.0, 1e-3],
    "rare": [0.0, 0.0, 1e-12, 0.7],
    "failed": [0.3, np.inf, 1e-6],
    "old": [800.0, 801.5, 1e5, 1e5 + 2, 0.3, 1e-9],
    "old or failed": [746.0, 2e4, 2e4 + 0.5, np.inf, 0.1],
}


@each_case("kind", HAZARDS)
@each_case("seed", range(40))
def test_random_missions(seed: int, kind: str) -> None:
    rng = random.Random(f"{seed} {kind}")
    count = rng.randint(1, 4)
    size = rng.randint(1, {1: 6, 2: 5, 3: 4, 4: 4}[count])
    names = [f"u{i}" for i in range(size)]
    blocks = [draw(rng, names, rng.randint(1, 2 * size), most=4) for _ in range(rng.randint(1, 4))]
    wanted = [(rng.randint(1, count), rng.choice(blocks)) for _ in range(rng.randint(1, 5))]
    match rng.choice(["nothing", "now", "wanted now", "later"]):
        case "nothing":
            known: Needs = []
        case "now":
            known = [(0, rng.choice(blocks))]
        case "wanted now":
            known = [(0, block) for _, block in wanted]
        case _:
            known = [(rng.randint(0, count), rng.choice(blocks)) for _ in range(rng.randint(1, 3))]
    phases = Phases(known, wanted)
    assert set(phases.names) <= set(names)
    draws = np.array([[rng.choice(HAZARDS[kind]) for _ in phases.names] for _ in range(count + 1)])
    check(known, wanted, draws[0], draws[1:], phases)


def module(rng: random.Random, names: Sequence[str]) -> Block:
    """A module of parts that nothing else draws by themselves: mostly a series with redundancy inside."""
    a, b, c, *more = map(Unit, rng.sample(list(names), len(names)))
    core = rng.choice([
        Series(a, Parallel(b, c)), Series(Parallel(a, b), Parallel(a, c)), Series(a, Series(b, Parallel(a, c))),
        Series(a, KOutOfN(2, a, b, c)), Series(KOutOfN(2, a, b, c), Parallel(a, c)), KOutOfN(2, a, b, c),
        Parallel(a, Series(b, c)), Series(a, b, c),
    ])  # fmt: skip
    return Series(core, *more) if rng.random() < 0.7 else Parallel(core, *more)


@pytest.mark.full
@each_case("seed", range(150))
def test_modules_that_are_needed_and_drawn_inside_other_functions(seed: int) -> None:
    """What must work by itself, or in a module that must, and is also in a parallel of another function that must."""
    rng = random.Random(9000 + seed)
    names = [f"u{i}" for i in range(rng.randint(3, 4))]
    inner = module(rng, names)
    d, e = Unit("d"), Unit("e")
    outer = rng.choice([inner, inner, Series(inner, e), Series(Parallel(inner, e), d)])
    kinds = [Parallel(outer, d), KOutOfN(2, outer, d, e), Series(Parallel(inner, d), Parallel(outer, e)),
             Parallel(Series(outer, d), e), Parallel(outer, *map(Unit, names[:1]))]  # fmt: skip
    count = rng.randint(1, 2)
    functions = [rng.choice([outer, inner]), *rng.sample(kinds, rng.randint(1, 2))]
    wanted: Needs = [(rng.randint(1, count), function) for function in functions]
    rng.shuffle(wanted)
    known = rng.choice([[], [(0, block) for _, block in wanted], [(0, functions[-1])], [(1, functions[0])]])
    phases = Phases(known, wanted)
    values = HAZARDS["ordinary"] if rng.random() < 0.8 else HAZARDS["failed"]
    draws = np.array([[rng.choice(values) for _ in phases.names] for _ in range(count + 1)])
    check(known, wanted, draws[0], draws[1:], phases)


def test_a_needed_series_inside_a_parallel_of_another_function() -> None:
    """Its parts decide both: neither a module of its own nor apart from it."""
    past, more = np.full(4, 0.3), np.array([[0.5, 0.1, 0.2, 0.7]] * 2)
    for drive in (Series(A, Parallel(B, C)), Series(Parallel(A, B), Parallel(A, C)), Series(A, Series(B, C))):
        wanted = [(1, drive), (2, Parallel(drive, D))]
        check([(0, block) for _, block in wanted], wanted, past, more)
        check([], wanted[::-1], past, more)


@each_case("at_once", [1, 50, 200_000])
@each_case("seed", range(12))
def test_many_columns_are_as_each_alone(seed: int, at_once: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robophm.blocks.phases.AT_ONCE", at_once)
    rng = random.Random(5000 + seed)
    blocks = [draw(rng, "abcd", 6, most=4) for _ in range(3)]
    phases = Phases([(0, block) for block in blocks], list(enumerate(blocks, 1)))
    values = np.random.default_rng(seed).exponential(size=(4, len(phases.names), 2, 3))
    together = phases.transition(values[0], values[1:])
    for i, j in np.ndindex(2, 3):
        alone = phases.transition(values[0, :, i, j], values[1:, :, i, j])
        for one, other in zip(together, alone, strict=True):
            assert one[i, j] == pytest.approx(float(other), rel=1e-14)
    old = values.copy()
    old[0, :, 0] *= 1e4  # some columns have outlived all that was expected, others have not
    given = phases.given(old[0], old[1:])
    for i, j in np.ndindex(2, 3):
        alone = phases.given(old[0, :, i, j], old[1:, :, i, j])
        for one, other in zip(given, alone, strict=True):
            assert one[i, j] == pytest.approx(float(other), rel=1e-14)
    broadcast = phases.transition(values[0, :, :1, :1], values[1:])
    assert broadcast.survives.shape == (2, 3)


def test_one_phase_is_a_transition_of_the_structure() -> None:
    block = Parallel(Series(A, B), Series(A, C), KOutOfN(2, B, C, D))
    phases = Phases([(0, block)], [(1, block)])
    structure = Structure(block)
    past, more = np.array([0.3, 1e-9, 2.0, 0.0]), np.array([[1e-7, 0.4, 1e-30, 5.0]])
    found = phases.transition(past, more)
    rows = [phases.names.index(name) for name in structure.names]
    h, m = past[rows], more[0, rows]
    for one, other in zip(
        found, structure.transition(-np.expm1(-h), np.exp(-h) * -np.expm1(-m), np.exp(-h - m)), strict=True
    ):
        assert float(one) == pytest.approx(float(other), rel=DIGITS, abs=0)


@each_case("pair", [Parallel(A, B), Series(A, B), KOutOfN(2, A, B, C)], ids=str)
def test_one_part_that_has_failed(pair: Block) -> None:
    for past in product([0.0, 0.2, np.inf], repeat=3):
        for known in ([], [(0, pair)], [(1, Parallel(A, B))]):
            phases = Phases(known, [(1, pair), (2, A)])
            row = dict(zip("abc", past, strict=True))
            start = np.array([row[name] for name in phases.names])
            check(known, [(1, pair), (2, A)], start, np.full((2, len(start)), 0.1), phases)


def test_each_phase_counts_though_the_last_does_not_need_it() -> None:
    """In the first hour a and b, in the second a or c: losing b in the second hour costs nothing."""
    wanted = [(1, Series(A, B)), (2, Parallel(A, C))]
    phases = Phases([], wanted)
    order = [phases.names.index(name) for name in "abc"]
    more = np.zeros((2, 3))
    more[1, order[1]] = np.inf
    assert float(phases.transition(np.zeros(3), more).survives) == 1.0
    more[0, order[1]] = np.inf
    assert float(phases.transition(np.zeros(3), more).survives) == 0.0


def test_the_same_need_earlier_adds_nothing() -> None:
    pair = Parallel(Series(A, B), Series(A, C))
    values = np.array([[0.1, 0.2, 0.3], [0.5, 0.1, 0.2], [1.0, 1e-3, 0.1]])
    found = Phases([(0, pair)], [(3, pair)]).transition(values[0] * 0.1, values)
    more = Phases([(0, pair)], [(1, pair), (2, pair), (3, pair)]).transition(values[0] * 0.1, values)
    for one, other in zip(found, more, strict=True):
        assert float(one) == pytest.approx(float(other), rel=1e-14)


def test_forty_pairs_over_three_phases() -> None:
    """Pairs that share nothing multiply: 40 of them, each until its own phase, by closed form."""
    pairs = [Parallel(f"l{i}", f"r{i}") for i in range(40)]
    wanted = [(1 + i % 3, pair) for i, pair in enumerate(pairs)]
    phases = Phases([(0, Series(*pairs))], wanted)
    rates = {name: mpf(1 + i) / 1000 for i, name in enumerate(phases.names)}
    more = np.array([[float(rates[name]) for name in phases.names]] * 3)
    found = phases.transition(np.full(80, 1e-5), more)
    with mp.workdps(40):
        before, survives = mpf(1), mpf(1)
        for i, pair in enumerate(pairs):
            lived = [mpf(1e-5), *(mpf(1e-5) + (1 + i % 3) * mpf(float(rates[unit.name])) for unit in pair.blocks)]  # type: ignore[union-attr]
            before *= 1 - mp.expm1(-lived[0]) ** 2
            survives *= 1 - mp.expm1(-lived[1]) * mp.expm1(-lived[2])
        agree(float(found.survives), survives)
        agree(float(found.fails), before - survives)
        agree(float(found.failed), 1 - before)


def test_a_shared_bus_with_twenty_arms_in_four_legs() -> None:
    """Given the bus, arms are independent: sums over when the bus fails, in closed form."""
    legs = [Series("bus", KOutOfN(3, *(f"arm{i}" for i in range(n)))) for n in (20, 15, 10, 5)]
    phases = Phases([], list(enumerate(legs, 1)))
    names = phases.names
    rate = {name: 0.02 if name == "bus" else 0.05 for name in names}
    found = phases.transition(np.zeros(21), np.array([[rate[name] for name in names]] * 4))
    # Of the first five at least three outlive leg 4; they are in every group, so that the last group decides.
    p = mp.exp(-4 * mpf(0.05))
    some = mp.fsum(mp.binomial(5, k) * p**k * (1 - p) ** (5 - k) for k in (3, 4, 5))
    agree(float(found.survives), mp.exp(-4 * mpf(0.02)) * some)


def test_what_cannot_be_decided_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decision_diagram, "LIMIT", 5000)
    rng = random.Random(1)
    names = [f"u{i}" for i in range(60)]
    tangle = [KOutOfN(7, *(Unit(name) for name in rng.sample(names, 15))) for _ in range(40)]
    with pytest.raises(StructureError, match="too many to solve exactly"):
        Phases([(0, Series(*tangle))], [(1, Series(*tangle)), (2, Parallel(*tangle))])
