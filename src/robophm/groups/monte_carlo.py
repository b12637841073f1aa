"""Monte Carlo simulation of a diagram: parts live and die as they are said to, and what still works is counted.

It shares no mathematics with the exact ways of solving: parts that stand alone are tossed for by their survival, 64 to
a machine word; the members of a group draw their lives, and its story is told event by event. It checks them, and
stands in for them where there is none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import betaincinv

from robophm.blocks.diagram import Block, Group, KOutOfN, LoadSharing, Network, Series, Standby, Unit
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]
Words = npt.NDArray[np.uint64]

MOST = 1_000_000_000
"""The most samples of one simulation."""

_TURN = 1 << 18  # samples at a time, so that words and lives stay in cache
_HELD = 1 << 28  # samples times gates of a tree at a time: 32 MB of bits
_ALL = np.uint64(0xFFFFFFFFFFFFFFFF)
_DENSE = 10  # bits that are tossed for all words; then only for those in which something is left undecided


@dataclass(frozen=True)
class AgeingMode:
    """A failure mode of a unit, and how it ages per hour."""

    life: LifeDistribution
    speed: float = 1.0
    """The progress of its clock in an hour [unit of its clock per hour]."""
    age: float = 0.0
    """Age at the start [unit of its clock]; of a part that stands alone its life before counts too."""
    multiplicity: float = 1.0
    """Multiple of its life's hazard: equal parts in series, less what they share with a common cause."""


@dataclass(frozen=True)
class Estimate:
    """An estimated probability, and the interval that it lies in (Clopper and Pearson 1934)."""

    probability: float
    low: float
    high: float
    samples: int


def simulate(
    diagram: Block, units: Mapping[str, Sequence[AgeingMode]], hours: float, samples: int, *, seed: int = 0,
    confidence: float = 0.95,
) -> Estimate:  # fmt: skip
    """Estimate P(the diagram works after so many hours) from samples; the same for the same seed.

    Raises ValueError where samples are none or beyond MOST.
    """
    return _estimate(lambda words, random: _Toss(units, hours, words, random).works(diagram), samples, seed, confidence)


def simulate_tree(
    tree: FaultTree, occurred: Sequence[float], samples: int, *, seed: int = 0, confidence: float = 0.95
) -> Estimate:
    """Estimate P(the top event of a fault tree) from samples of its events; as ``simulate``."""

    def tossed(words: int, random: np.random.Generator) -> Words:
        found: list[Words] = []
        events = iter(occurred)
        for k, inputs in tree.gates:
            found.append(toss(next(events), words, random) if k == UNIT else _of_gate(k, [found[i] for i in inputs]))
        return found[-1].copy()

    return _estimate(tossed, samples, seed, confidence, turn=max(64, min(_TURN, _HELD // len(tree.gates))))


def _estimate(
    tossed: Callable[[int, np.random.Generator], Words], samples: int, seed: int, confidence: float, turn: int = _TURN
) -> Estimate:
    """The estimate from the bits that words of samples give."""
    if not 1 <= samples <= MOST:
        raise ValueError(f"samples = {samples}; expected 1 … {MOST:,}")
    random = np.random.Generator(np.random.SFC64(seed))
    met = 0
    for start in range(0, samples, turn):
        count = min(turn, samples - start)
        words = tossed(-(-count // 64), random)
        if spare := -count % 64:
            words[-1] &= _ALL >> np.uint64(spare)
        met += int(np.bitwise_count(words).sum()) if hasattr(np, "bitwise_count") else _bits(words)
    return Estimate(met / samples, *interval(met, samples, confidence), samples)


def interval(count: int, samples: int, confidence: float) -> tuple[float, float]:
    """Return the interval of a probability that was met so often; it holds it at least so surely, whatever it is."""
    tail = (1 - confidence) / 2
    low = float(betaincinv(count, samples - count + 1, tail)) if count else 0.0
    high = float(betaincinv(count + 1, samples - count, 1 - tail)) if count < samples else 1.0
    return low, high


class _Toss:
    """One turn: which units work, a bit for each sample; each is tossed for once, wherever it is drawn."""

    def __init__(
        self, units: Mapping[str, Sequence[AgeingMode]], hours: float, words: int, random: np.random.Generator
    ) -> None:
        self._units, self._hours, self._words, self._random = units, hours, words, random
        self._known: dict[str, Words] = {}

    def works(self, diagram: Block) -> Words:
        done: dict[int, Words] = {}
        todo = [diagram]
        while todo:
            block = todo[-1]
            if isinstance(block, Unit):
                done[id(block)] = self._unit(block)
            elif missing := [inner for inner in block.blocks if id(inner) not in done]:
                todo += missing
                continue
            elif isinstance(block, Network):
                done[id(block)] = _reached(block, done)
            else:
                done[id(block)] = _gate(block, [done[id(inner)] for inner in block.blocks])
            todo.pop()
        return done[id(diagram)].copy()

    def _unit(self, unit: Unit) -> Words:
        if unit.name not in self._known:
            if isinstance(unit, Group):
                self._known[unit.name] = _packed(self._group(unit) > self._hours)
            else:
                lived = sum(
                    float(wear.multiplicity * wear.life.increment(0.0, wear.age + wear.speed * self._hours))
                    for wear in self._units[unit.name]
                )
                self._known[unit.name] = toss(float(np.exp(-lived)), self._words, self._random)
        return self._known[unit.name]

    def _life(self, units: Iterable[str]) -> Array:
        """The hours of work that units in series have in them; shape (samples,)."""
        shortest = np.full(64 * self._words, np.inf)
        for wear in (wear for unit in units for wear in self._units[unit]):
            if wear.speed > 0:
                budget = self._random.standard_exponential(len(shortest)) / wear.multiplicity
                end = wear.life.age_at(float(wear.life.increment(0.0, wear.age)) + budget)
                np.minimum(shortest, np.maximum(end - wear.age, 0.0) / wear.speed, out=shortest)
        return shortest

    def _group(self, group: Group) -> Array:
        """The time at which the group fails [h]; shape (samples,)."""
        lives = [self._life(unit for unit in member if unit not in group.always) for member in group.members]
        lasts = [self._life(unit for unit in member if unit in group.always) for member in group.members]
        if isinstance(group, Standby):
            return self._standby(group, lives, lasts)
        assert isinstance(group, LoadSharing)
        return self._sharing(group, np.array(lives), np.array(lasts))

    @staticmethod
    def _sharing(group: LoadSharing, lives: Array, lasts: Array) -> Array:
        """The life of a load-sharing group, from its members' lives by load and those of their dependences by the
        clock.
        """
        borne, now = np.zeros(lives.shape[1]), np.zeros(lives.shape[1])
        for factor in group.factors:
            ends = now + np.where(lives < np.inf, lives - borne, np.inf) / factor
            np.minimum(ends, lasts, out=ends)
            first = np.argmin(ends, axis=0)[None]
            then = np.take_along_axis(ends, first, axis=0)[0]
            borne, now = borne + np.where(then < np.inf, factor * (then - now), 0.0), then
            np.put_along_axis(lives, first, np.inf, axis=0)
            np.put_along_axis(lasts, first, np.inf, axis=0)
        return now

    def _standby(self, group: Standby, lives: Sequence[Array], lasts: Sequence[Array]) -> Array:
        """The life of a standby group, from its members' lives by work and those of their dependences by the clock."""
        ends = np.minimum(lives[: group.active], lasts[: group.active])
        every = np.arange(ends.shape[1])
        failed = np.full(len(every), np.inf)  # when a switch did not come off
        called = np.full(len(every), -1.0)  # when a switch was called for last
        for spare, until in zip(lives[group.active :], lasts[group.active :], strict=True):
            place = np.argmin(ends, axis=0)
            now = ends[place, every]
            if group.switch < 1:  # one call for each failure, however many dead spares are passed over
                new = now != called
                called = now
                missed = new & (self._random.random(len(every)) >= group.switch)
                failed = np.where(missed & (failed == np.inf), now, failed)
            waits = (spare > group.dormancy * now) & (until > now)
            ends[place[waits], every[waits]] = np.minimum(now + spare - group.dormancy * now, until)[waits]
        first: Array = np.minimum(ends.min(axis=0), failed)
        return first


def toss(probability: float, words: int, random: np.random.Generator) -> Words:
    """Return bits that are 1 with a probability, to the last of 64 bits: a uniform number is compared bit by bit.

    Two bits of it decide on average, and most words after ten; the others go on alone.
    """
    if probability >= 1:
        return np.full(words, _ALL)
    found, open_ = np.zeros(words, dtype=np.uint64), np.full(words, _ALL)
    where: npt.NDArray[np.intp] | None = None
    digits = int(probability * 2.0**64)
    if not digits:
        return found
    for bit in range(63, -1, -1):
        if bit == 63 - _DENSE:
            where = np.flatnonzero(open_)
        elif where is not None:
            where = where[open_[where] != 0]
        drawn = random.bit_generator.random_raw(words if where is None else len(where))
        at: slice | npt.NDArray[np.intp] = slice(None) if where is None else where
        if digits >> bit & 1:
            found[at] |= open_[at] & ~drawn
            open_[at] &= drawn
        else:
            open_[at] &= ~drawn
        if where is not None and not len(where):
            break
    return found


def _gate(block: Block, inputs: Sequence[Words]) -> Words:
    assert not isinstance(block, Unit)
    if isinstance(block, Series):
        every: Words = np.bitwise_and.reduce(inputs)
        return every
    if not isinstance(block, KOutOfN):
        some: Words = np.bitwise_or.reduce(inputs)
        return some
    return _enough(block.k, inputs)


def _of_gate(k: int, inputs: Sequence[Words]) -> Words:
    """The output of a gate of a fault tree."""
    if k == NOT:
        return ~inputs[0]
    if k > ANY:
        return _enough(k, inputs)
    ways: dict[int, np.ufunc] = {ALL: np.bitwise_and, ANY: np.bitwise_or, ODD: np.bitwise_xor}
    found: Words = ways[k].reduce(inputs)
    return found


def _enough(k: int, inputs: Sequence[Words]) -> Words:
    """Whether at least k of the inputs are 1."""
    enough = [np.zeros_like(inputs[0]) for _ in range(k)]  # at least 1, 2, … of those so far
    for one in inputs:
        for j in range(k - 1, 0, -1):
            enough[j] |= enough[j - 1] & one
        enough[0] |= one
    return enough[-1]


def _reached(network: Network, works: Mapping[int, Words]) -> Words:
    """Samples in which the sink is reached along what works (of blocks by id()), node by node until nothing is new."""
    sure = np.full_like(works[id(network.blocks[0])], _ALL)
    stands = {name: works[id(block)] for name, block in network.nodes}
    ways = []
    for start, end, block, one_way in network.links:
        passes = sure if block is None else works[id(block)]
        ways += [(start, end, passes)] + [(end, start, passes)] * (not one_way)
    reached = {name: np.zeros_like(sure) for way in ways for name in way[:2]}
    reached[network.source] = stands.get(network.source, sure).copy()
    news = True
    while news:
        news = False
        for start, end, passes in ways:
            more = reached[start] & passes & stands.get(end, sure) & ~reached[end]
            if more.any():
                reached[end] |= more
                news = True
    return reached[network.sink]


def _packed(works: npt.NDArray[np.bool_]) -> Words:
    return np.packbits(works).view(np.uint64)


def _bits(words: Words) -> int:
    return int(np.unpackbits(words.view(np.uint8)).sum())
