"""Random dynamic trees against a simulation written apart, and by modules against one chain."""

import math
import random
import time
from itertools import pairwise

import pytest

from robophm.blocks.dynamic_chain import DynamicChain
from robophm.blocks.dynamic_modules import solve
from robophm.blocks.dynamic_tree import Basic, Dependency, DynamicTree, Gate, Restriction
from robophm.core.errors import StructureError

from ..cases import each_case, examples

TIME = 1.0


def random_tree(draw):
    events = [
        Basic(f"e{i}", draw.choice([0.3, 0.7, 1.5]), draw.choice([0.0, 0.4, 1.0])) for i in range(draw.randint(3, 6))
    ]
    elements = list(events)
    for i in range(draw.randint(1, 5)):
        kind = draw.choice(["at least", "at least", "pand", "por", "spare", "pand exclusive"])
        inputs = tuple(draw.sample(range(len(elements)), min(draw.randint(2, 3), len(elements))))
        elements.append(Gate(f"g{i}", kind, inputs, draw.randint(1, len(inputs))))
    dependencies, restrictions = [], []
    if draw.random() < 0.4:
        trigger, dependent = draw.sample(range(len(events)), 2)
        dependencies.append(Dependency(trigger, (dependent,), draw.choice([1.0, 0.5])))
    if draw.random() < 0.3:
        restrictions.append(Restriction(tuple(draw.sample(range(len(events)), 2)), draw.random() < 0.3))
    return DynamicTree(tuple(elements), len(elements) - 1, tuple(dependencies), tuple(restrictions))


class Life:
    """One life of a tree, event by event, each gate as its definition says it."""

    def __init__(self, tree):
        self.tree = tree
        self.failed_at = {}  # element: number of the moment
        self.lost = set()
        self.moment = 0
        self.used = {i: 0 for i, one in enumerate(tree.elements) if isinstance(one, Gate) and one.kind == "spare"}
        self.taken = set()  # (spare gate, input) that have been in use
        self.activate()

    def parents(self, i):
        return [j for j, one in enumerate(self.tree.elements) if isinstance(one, Gate) and i in one.inputs]

    def in_use(self, i, seen=()):
        """Whether any way up leads to what is in use, over spare gates that have taken it while in use themselves."""
        parents = self.parents(i)
        if not parents or i == self.tree.top:
            return True
        return any((j, i) in self.taken if j in self.used else self.in_use(j) for j in parents)

    def activate(self):
        changed = True
        while changed:
            changed = False
            for i, place in self.used.items():
                wanted = self.tree.elements[i].inputs[place]
                if i not in self.failed_at and (i, wanted) not in self.taken and self.in_use(i):
                    self.taken.add((i, wanted))
                    changed = True

    def fail(self, event):
        """Whether it may; what follows at the same moment."""
        kept = dict(self.failed_at), set(self.lost), dict(self.used), set(self.taken)
        self.moment += 1
        self.failed_at[event] = self.moment
        for i, one in enumerate(self.tree.elements):  # inputs come before gates
            if isinstance(one, Gate) and i not in self.failed_at and i not in self.lost:
                self.judge(i, one)
        self.activate()
        for rule in self.tree.restrictions:
            failed = [one in self.failed_at for one in rule.inputs]
            if (rule.exclusive and sum(failed) > 1) or (not rule.exclusive and failed != sorted(failed, reverse=True)):
                self.failed_at, self.lost, self.used, self.taken = kept
                return False
        return True

    def judge(self, i, gate):
        at = [self.failed_at.get(one, math.inf) for one in gate.inputs]
        failed = sum(one < math.inf for one in at)
        if gate.kind == "at least":
            occurs, never = failed >= gate.k, False
        elif gate.kind == "pand":
            occurs, never = failed == len(at) and at == sorted(at), at != sorted(at)
        elif gate.kind == "pand exclusive":
            strict = all(a < b or b == math.inf for a, b in pairwise(at))
            occurs, never = failed == len(at) and strict, not strict
        elif gate.kind == "por":
            occurs, never = at[0] < math.inf and at[0] <= min(at[1:]), min(at[1:]) < at[0]
        else:
            place = self.used[i]
            while place < len(at) and at[place] < math.inf:
                place += 1
                while place < len(at) and (at[place] < math.inf or self.elsewhere(gate.inputs[place], i)):
                    place += 1
            occurs, never = place == len(at), False
            if not occurs:
                self.used[i] = place
        if occurs:
            self.failed_at[i] = self.moment
        elif never:
            self.lost.add(i)

    def elsewhere(self, wanted, by):
        return any(j != by and j not in self.failed_at and self.tree.elements[j].inputs[place] == wanted
                   for j, place in self.used.items())  # fmt: skip

    def run(self, draw):
        now = 0.0
        while self.tree.top not in self.failed_at:
            rates = {
                i: one.rate * (1.0 if self.in_use(i) else one.dormancy)
                for i, one in enumerate(self.tree.elements) if isinstance(one, Basic) and i not in self.failed_at
            }  # fmt: skip
            total = sum(rates.values())
            if not total:
                return False
            now += draw.expovariate(total)
            if now > TIME:
                return False
            event = draw.choices(list(rates), list(rates.values()))[0]
            if self.fail(event):
                for said in self.tree.dependencies:
                    dependent = said.dependents[0]
                    if said.trigger == event and dependent not in self.failed_at and draw.random() < said.chance:
                        self.fail(dependent)
        return True


def chance(tree):
    """P(top by TIME); None where the order at one moment decides."""
    try:
        return DynamicChain(tree).probability(TIME)
    except StructureError:
        return None


@pytest.mark.full
@each_case("seed", range(examples(60)))
def test_random_trees_are_as_simulated(seed):
    draw = random.Random(seed)
    tree = random_tree(draw)
    p = chance(tree)
    if p is None:
        return
    runs = 2_000
    count = sum(Life(tree).run(draw) for _ in range(runs))
    assert abs(count - runs * p) < 4.5 * math.sqrt(runs * p * (1 - p)) + 1


@each_case("seed", range(examples(300)))
def test_by_modules_it_is_as_one_chain(seed):
    tree = random_tree(random.Random(1000 + seed))
    expected = chance(tree)
    if expected is None:
        return
    assert solve(tree, TIME, {}).probability == pytest.approx(expected, rel=1e-9, abs=1e-15)


def test_many_steps_of_a_chain_end_in_time():
    pair = (Basic("a", 1.0), Basic("b", 1e-9), Gate("top", "pand", (1, 0)))
    with pytest.raises(StructureError, match="steps in this time"):
        solve(DynamicTree(pair, 2), 400_000.0, {}, time.perf_counter() + 0.05)
