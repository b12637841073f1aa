"""Redundancy allocation: which parts to have more of, so that a robot fails least for a budget, or for least cost.

Each part may get so many more of its kind, all working, of which as many must work as before. What stands in series
fails by itself: of each such block all choices are tried, those are kept that nothing cheaper beats, and these are put
together. Where a block has too many, the whole is searched: a robot is the more reliable the more there are of any
part, so that a choice for some, with as many of each other one as it alone could afford, bounds all that begin with it.
The most promising is looked at first: what is found when that ends is the best, and when time is over how much better
the best could be is stated.
"""

from __future__ import annotations

import heapq
import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import bdtr, bdtrc

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit, units, with_blocks
from robophm.blocks.reliability import Structure
from robophm.core.argument_checks import number
from robophm.core.errors import RobophmError, StructureError, nearest
from robophm.design.robot import Component, Robot
from robophm.health.outlooks import as_designed
from robophm.health.plant import Parts, Plant

Array = npt.NDArray[np.float64]

MOST_PARTS = 200
"""The most parts that may be chosen among."""

MOST_CHOICES = 200_000
"""The most choices of one block in series that are all looked at."""

MOST_MORE = 100
"""The most that one part may get."""


@dataclass(frozen=True)
class Offer:
    """A part that there may be more of."""

    part: str
    cost: float
    """Cost of each more, in any unit: money, mass, power."""
    most: int = 3
    """The most that may be added."""


@dataclass(frozen=True)
class Allocation:
    """The parts to add to a robot, and what that gains."""

    more: Mapping[str, int]
    """How many more of each part; those that get none are not in it."""
    cost: float
    failure: float
    """P(the robot fails within the time), with them."""
    failure_now: float
    """P(it fails within the time) as it is."""
    hours: float
    """The time, in hours of operation since new."""
    best: bool
    """Whether it is proved that nothing is better."""
    bound: float
    """A limit that no choice is below: of P(it fails) for a budget, of the cost for a wanted reliability."""


def allocation(
    robot: Robot, offers: Sequence[Offer], hours: float, *, budget: float | None = None,
    reliability: float | None = None, function: str | None = None, limit: float = 30.0,
) -> Allocation:  # fmt: skip
    """Return what to add for a ``budget``, or for the least cost so that the robot has a ``reliability``, when new.

    After ``hours`` of operation; within ``limit`` seconds. Raises RobophmError for parts that there are not or that
    cannot be added to, a reliability that no choice reaches, and where not exactly one of the two goals is given.
    """
    if (budget is None) == (reliability is None):
        raise RobophmError("expected either a budget or a reliability")
    if reliability is not None and not 0 < number(reliability, "reliability") < 1:
        raise RobophmError(f"reliability {reliability:g}: expected above 0 and below 1, e.g. 0.999")
    money = math.inf if budget is None else number(budget, "budget") * (1 + 1e-12)  # what costs just as much
    number(hours, "hours of operation", above=True, high=1e9)
    number(limit, "limit [s]", above=True)
    system = _System(robot, robot.diagram_of(function), offers, hours)
    goal = 0.0 if reliability is None else 1 - reliability
    if reliability is not None and (least := float(system.failure(system.most[None])[0])) > goal:
        raise RobophmError(
            f"with the most of every part on offer it still fails with {least:.3g}; expected at most {goal:.3g}"
        )
    front, bound = _front(system, money), None
    if front is not None:
        more = (front.surest() if reliability is None else front.cheapest(goal)).tolist()
    elif reliability is None:
        more, bound = _for_budget(system, money, limit)
    else:
        more, bound = _for_goal(system, goal, limit)
    failure, cost = float(system.failure(np.array([more]))[0]), system.cost(more)
    proved = failure if reliability is None else cost
    named = {offer.part: int(n) for offer, n in zip(system.offers, more, strict=True) if n}
    return Allocation(named, cost, failure, system.as_it_is, hours, bound is None, proved if bound is None else bound)


class _System:
    """A robot whose parts on offer are each one block of its diagram."""

    def __init__(self, robot: Robot, diagram: Block, offers: Sequence[Offer], hours: float) -> None:
        parts = {part.path: part for part in robot.all_components() if part not in robot.causes}
        self.offers = tuple(offers)
        if not 1 <= len(self.offers) <= MOST_PARTS:
            raise RobophmError(f"{len(self.offers):,} parts on offer; expected 1 to {MOST_PARTS}")
        for offer in self.offers:
            if offer.part not in parts:
                raise RobophmError(f"no part '{offer.part}' in the design{nearest(offer.part, parts)}")
            if parts[offer.part].unknown:
                raise RobophmError(f"{offer.part} is of unknown rate; expected parts whose gain can be told")
            number(offer.cost, f"cost of {offer.part}", above=True)
            number(offer.most, f"most of {offer.part}", low=1, high=MOST_MORE, whole=True)
        if len({offer.part for offer in self.offers}) < len(self.offers):
            raise RobophmError("a part is on offer twice; expected each once")
        chosen = {offer.part: parts[offer.part] for offer in self.offers}
        self._diagram = _gathered(diagram, chosen)
        structure = self._structure = Structure(self._diagram)
        plant = Plant(robot)
        place = self._place = {name: i for i, name in enumerate(structure.names)}
        if missing := [name for name in chosen if name not in place]:
            raise RobophmError(f"{missing[0]} is used in no diagram that is asked about")
        kept = [name for name in structure.names if name not in chosen]
        works, failed = _survival(plant, [*kept, *(part.units[0] for part in chosen.values())], hours)
        self._works, self._failed = np.empty(len(place)), np.empty(len(place))
        self._works[[place[name] for name in kept]] = works[: len(kept)]
        self._failed[[place[name] for name in kept]] = failed[: len(kept)]
        self._rows = np.array([place[name] for name in chosen])
        self._table = np.ones((2, len(chosen), MOST_MORE + 1))
        for row, (part, fails) in enumerate(zip(chosen.values(), failed[len(kept) :], strict=True)):
            share = fails if part.multiplicity == 1 else -math.expm1(math.log1p(-fails) / part.multiplicity)
            n = part.quantity + np.arange(MOST_MORE + 1)
            spare = n - part.required
            self._table[:, row] = bdtr(spare, n, share), bdtrc(spare, n, share)
        self.costs = np.array([offer.cost for offer in self.offers])
        self.most = np.array([offer.most for offer in self.offers])
        self.as_it_is = float(self.failure(np.zeros((1, len(self.offers)), int))[0])

    def in_series(self) -> Iterator[tuple[npt.NDArray[np.intp], Structure]]:
        """Yield what stands in series and shares no part: the places of its offers, and its structure."""
        blocks = self._diagram.blocks if isinstance(self._diagram, Series) else (self._diagram,)
        together: list[tuple[set[str], list[Block]]] = []
        for block in blocks:
            names, joined = set(units(block)), [block]
            for other in [one for one in together if one[0] & names]:
                together.remove(other)
                names, joined = names | other[0], other[1] + joined
            together.append((names, joined))
        for names, joined in together:
            rows = [i for i, offer in enumerate(self.offers) if offer.part in names]
            yield np.array(rows, dtype=np.intp), Structure(Series(*joined))

    def failure(self, more: npt.NDArray[np.intp], structure: Structure | None = None) -> Array:
        """Return P(it fails, or a part of it) of choices, shape (choices, parts); shape (choices,)."""
        structure = structure or self._structure
        works, failed = (np.repeat(one[:, None], len(more), axis=1) for one in (self._works, self._failed))
        works[self._rows], failed[self._rows] = (
            table[np.arange(len(self.offers))[:, None], more.T] for table in self._table
        )
        if structure is not self._structure:
            rows = [self._place[name] for name in structure.names]
            works, failed = works[rows], failed[rows]
        return np.asarray(structure.probability(works, failed)[1])

    def cost(self, more: Sequence[int] | npt.NDArray[np.intp]) -> float:
        """Return what a choice costs."""
        return float(np.dot(self.costs, more))


def _survival(plant: Plant, names: Sequence[str], hours: float) -> tuple[Array, Array]:
    works, failed = as_designed(plant).unit_survival(Parts(plant, [(name,) for name in names]), np.array([hours]))
    return works[:, 0], failed[:, 0]


def _gathered(diagram: Block, chosen: Mapping[str, Component]) -> Block:
    """The diagram with a unit of each part's own name in the place of the block of all its units.

    Raises StructureError where some of them are drawn elsewhere too.
    """
    blocks = {_block(part): name for name, part in chosen.items()}
    done: dict[int, Block] = {}

    def gathered(block: Block) -> Block:
        if id(block) not in done:
            if (name := blocks.get(_shape(block))) is not None:
                done[id(block)] = Unit(name)
            elif isinstance(block, Unit):
                done[id(block)] = block
            else:
                done[id(block)] = with_blocks(block, [gathered(one) for one in block.blocks])
        return done[id(block)]

    found = gathered(diagram)
    left = set(units(found))
    for name, part in chosen.items():
        if len(part.units) > 1 and left.intersection(part.units):
            raise StructureError(
                f"{name}: its parts are drawn one by one, or fail together; expected one block of them"
            )
    return found


_Shape = tuple[int, frozenset[str]] | None
"""Units side by side, and how many of them must work; None for any other block."""


def _block(part: Component) -> _Shape:
    return max(part.required - part.quantity + len(part.units), 1), frozenset(part.units)


def _shape(block: Block) -> _Shape:
    if isinstance(block, Unit):
        return 1, frozenset((block.name,))
    if not isinstance(block, Series | Parallel | KOutOfN) or not all(isinstance(one, Unit) for one in block.blocks):
        return None
    needed = block.k if isinstance(block, KOutOfN) else len(block.blocks) if isinstance(block, Series) else 1
    return needed, frozenset(units(block))


class _Front(NamedTuple):
    """Choices that nothing cheaper beats, the cheapest first: their costs, ln P(works), and how many more of each."""

    cost: Array
    works: Array
    more: npt.NDArray[np.intp]

    def surest(self) -> npt.NDArray[np.intp]:
        """Return the choice that fails least."""
        found: npt.NDArray[np.intp] = self.more[-1]
        return found

    def cheapest(self, goal: float) -> npt.NDArray[np.intp]:
        """Return the cheapest choice that fails at most so often, of which there is one."""
        found: npt.NDArray[np.intp] = self.more[min(int(np.searchsorted(self.works, np.log1p(-goal) * (1 + 1e-12))),
                                                    len(self.more) - 1)]  # fmt: skip
        return found


def _unbeaten(cost: Array, works: Array, more: npt.NDArray[np.intp]) -> _Front:
    order = np.lexsort((-works, cost))
    works = works[order]
    best = np.maximum.accumulate(works)
    kept = np.append(True, best[1:] > best[:-1])
    return _Front(cost[order][kept], works[kept], more[order][kept])


def _front(system: _System, budget: float) -> _Front | None:
    """The choices within a budget that nothing cheaper beats; None where there are too many to look at all."""
    none = np.zeros((1, len(system.offers)), dtype=np.intp)
    front = _Front(np.zeros(1), np.zeros(1), none)
    for rows, structure in system.in_series():
        most = np.minimum(system.most[rows], np.floor(budget / system.costs[rows])).astype(int)
        if (choices := math.prod((most + 1).tolist())) > MOST_CHOICES:
            return None
        of_block = np.array(list(product(*(range(n + 1) for n in most))), dtype=np.intp).reshape(choices, len(rows))
        more = np.zeros((len(of_block), len(system.offers)), dtype=np.intp)
        more[:, rows] = of_block
        with np.errstate(divide="ignore"):
            works = np.log1p(-system.failure(more, structure))
        block = _unbeaten(more @ system.costs, works, more)
        if len(front.cost) * len(block.cost) > 20 * MOST_CHOICES:
            return None
        cost = np.add.outer(front.cost, block.cost).ravel()
        within = np.flatnonzero(cost <= budget)
        old, new = np.divmod(within, len(block.cost))
        front = _unbeaten(cost[within], front.works[old] + block.works[new], front.more[old] + block.more[new])
    return front


def _for_budget(system: _System, budget: float, limit: float) -> tuple[list[int], float | None]:
    """The choice of least failure within a budget, as of ``_best_first``."""

    def children(begun: list[int]) -> Iterator[_Child]:
        i = len(begun)
        left = budget - float(system.costs[:i] @ begun)
        more = np.arange(min(system.most[i], int(left / system.costs[i])) + 1)
        rest = np.floor((left - more[:, None] * system.costs[i]) / system.costs[i + 1 :])  # each as if it had all of it
        full = _begun(begun, more, np.minimum(rest, system.most[i + 1 :]).astype(int))
        for choice, failure in zip(full.tolist(), system.failure(full).tolist(), strict=True):
            yield _Child(choice, failure, system.cost(choice) <= budget)

    best = _greedy(system, budget)
    return _best_first(best, float(system.failure(np.array([best]))[0]), children, limit)


def _for_goal(system: _System, goal: float, limit: float) -> tuple[list[int], float | None]:
    """The cheapest choice that fails at most so often, of which there is one, as of ``_best_first``."""

    def children(begun: list[int]) -> Iterator[_Child]:
        i = len(begun)
        more = np.arange(system.most[i] + 1)
        others = system.most[i + 1 :]
        may = system.failure(_begun(begun, more, np.tile(others, (len(more), 1)))) <= goal
        bare = _begun(begun, more, np.zeros((len(more), len(others)), int))
        enough = system.failure(bare) <= goal
        another = float(system.costs[i + 1 :].min(initial=math.inf))  # at least that much more where it is not enough
        for choice, can_be, is_enough in zip(bare.tolist(), may.tolist(), enough.tolist(), strict=True):
            if can_be:
                yield _Child(choice, system.cost(choice) + (0.0 if is_enough else another), is_enough)

    best = _greedy(system, goal=goal)
    return _best_first(best, system.cost(best), children, limit)


class _Child(NamedTuple):
    """A choice of which one part more is settled: what it is worth, the less the better, or none that begins so is
    below."""

    choice: list[int]
    worth: float
    whole: bool
    """Whether it can be had as it is."""


def _begun(begun: list[int], more: npt.NDArray[np.intp], rest: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """Choices that begin alike, with so many ``more`` of the next part, and a ``rest`` for each."""
    return np.hstack((np.tile(np.array(begun, dtype=int), (len(more), 1)), more[:, None], rest))


def _best_first(
    best: list[int], worth: float, children: Callable[[list[int]], Iterable[_Child]], limit: float
) -> tuple[list[int], float | None]:
    """The best choice, from one that can be had; and, when time was over, what none is below, else None: it is proved.

    The most promising is gone on with first.
    """
    until, waiting = time.monotonic() + limit, [(0.0, list[int]())]
    while waiting:
        bound, begun = heapq.heappop(waiting)
        if bound >= worth:
            break
        if time.monotonic() > until:
            return best, bound
        for child in children(begun):
            if child.worth < worth and child.whole:
                best, worth = child.choice, child.worth
            elif child.worth < worth:
                heapq.heappush(waiting, (child.worth, child.choice[: len(begun) + 1]))
    return best, None


def _greedy(system: _System, budget: float = math.inf, goal: float = 0.0) -> list[int]:
    """What gains most for its cost, one after the other, within a budget and until it is good enough."""
    more = [0] * len(system.offers)
    failure = system.as_it_is
    while failure > goal:
        steps = [[*more[:i], n + 1, *more[i + 1 :]] for i, n in enumerate(more) if n < system.most[i]]
        steps = [step for step in steps if system.cost(step) <= budget]
        if not steps:
            break
        failures = np.maximum(system.failure(np.array(steps)), 1e-300)
        gain = np.log(failure / failures) / (np.array([system.cost(step) for step in steps]) - system.cost(more))
        chosen = int(np.argmax(gain))
        more, failure = steps[chosen], float(failures[chosen])
    return more
