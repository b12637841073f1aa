"""Event trees of an Open-PSA model: the ways from an initiating event to the sequences in which it ends.

MEF 2.0d, section 6. At each fork a functional event takes one of its states; instructions on the way collect the
formulas that must be true there, or the probabilities of its branches, and set house events for the formulas that are
collected after them. The probability of a sequence is that of any of the ways that end in it, given the initiating
event.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeVar

from robophm.core.errors import nearest
from robophm.core.markup import Element
from robophm.design.importers.open_psa.assembly import Formula
from robophm.design.importers.open_psa.expressions import Expressions
from robophm.design.importers.open_psa.formulas import constant, references
from robophm.design.importers.open_psa.names import Names, name_of

MOST_WAYS = 100_000
"""The most ways through the event trees of a model, in all."""

MOST_DEEP = 100
"""The most forks, branches, rules and other instructions within each other."""

T = TypeVar("T")

_TARGETS = ("fork", "sequence", "branch")


@dataclass(frozen=True)
class Way:
    """Knowledge on a way through an event tree: what is set, collected and tested there."""

    houses: Mapping[str, bool] = field(default_factory=dict)
    """House events that are set: first those of a phase, then those of the instructions."""
    formulas: tuple[Formula, ...] = ()
    """Formulas that must be true on it."""
    chance: float | None = None
    """The product of the expressions that were collected; None while there are none."""
    states: Mapping[str, str] = field(default_factory=dict)
    """The states of the functional events so far."""
    links: tuple[tuple[Element, Way], ...] = ()
    """Event trees in which it goes on, and what was known then."""


class Sequence(NamedTuple):
    """An end of the event tree of an initiating event, and the ways to it."""

    initiating: str
    name: str
    ways: tuple[Way, ...]

    @property
    def chance(self) -> float | None:
        """Return the probability by the expressions on its ways alone; None where formulas say it."""
        known = [way.chance for way in self.ways if way.chance is not None]
        return sum(known) if known else None


class _Tree(NamedTuple):
    said: Element
    parts: Mapping[str, Mapping[str, Element]]
    """Its functional events in order, sequences and branches, by name."""
    initial: Element


class EventTrees:
    """The event trees of a model, walked for one phase at a time."""

    def __init__(self) -> None:
        self._initiating: dict[str, Element] = {}
        self._trees: dict[str, _Tree] = {}
        self._rules: dict[str, Element] = {}
        self._sequences: dict[str, Element] = {}

    def define(self, said: Element) -> bool:
        """Take a definition, and return whether it is one of event trees. Raises DesignError for one that is wrong."""
        if said.tag == "define-initiating-event":
            _once(self._initiating, said)
        elif said.tag == "define-rule":
            _once(self._rules, said)
        elif said.tag == "define-event-tree":
            self._define_tree(said)
        return said.tag in ("define-initiating-event", "define-rule", "define-event-tree")

    def _define_tree(self, said: Element) -> None:
        if name_of(said) in self._trees:
            raise said.fault(f"event tree '{name_of(said)}' is defined twice")
        parts: dict[str, dict[str, Element]] = {
            "define-functional-event": {}, "define-sequence": {}, "define-branch": {}
        }  # fmt: skip
        *definitions, initial = said.inside() if any(said.inside()) else [said]
        for one in definitions:
            if one.tag not in parts:
                raise one.fault(f"'{one.tag}' is not taken{nearest(one.tag, parts)}")
            if one.tag != "define-sequence" and "role" in one.attributes:
                raise one.fault(f"'{name_of(one)}' has a role; expected none: it is its event tree's")
            _once(parts[one.tag], one)
            if one.tag == "define-sequence":
                _once(self._sequences, one)
        if initial.tag != "initial-state":
            raise said.fault(f"event tree '{name_of(said)}' ends without an initial-state")
        self._trees[name_of(said)] = _Tree(said, parts, initial)

    def sequences(self, events: Names, expressions: Expressions, houses: Mapping[str, bool]) -> list[Sequence]:
        """Return the sequences of each initiating event that has an event tree, in order of the file.

        ``houses`` are set from the start. Raises DesignError for what is not defined, loops and contradicts itself,
        also where no initiating event leads there.
        """
        walk = _Walk(self._trees, self._rules, self._sequences, events, expressions)
        found = []
        for initiating, said in self._initiating.items():
            if (name := said.attributes.get("event-tree", "")) == "":
                continue
            ends: dict[str, list[Way]] = {}
            for end, way in walk.ways(initiating, self._tree(name, said), Way(houses)):
                ends.setdefault(end, []).append(way)
            collected = [way for ways in ends.values() for way in ways]
            if any(way.formulas for way in collected) and any(way.chance is not None for way in collected):
                raise said.fault(f"the event tree of '{initiating}' collects formulas and expressions; expected either")
            found += [Sequence(initiating, end, tuple(ways)) for end, ways in ends.items()]
        walk.rest()
        return found

    def _tree(self, name: str, said: Element) -> _Tree:
        return _known(self._trees, name, said, "event tree")


class _Walk:
    """Goes all ways, with a bound on how many."""

    def __init__(
        self, trees: Mapping[str, _Tree], rules: Mapping[str, Element], sequences: Mapping[str, Element],
        events: Names, expressions: Expressions,
    ) -> None:  # fmt: skip
        self._trees, self._rules, self._sequences = trees, rules, sequences
        self._events, self._expressions = events, expressions
        self._initiating = ""
        self._count = self._depth = 0
        self._under_way: list[tuple[str, str]] = []
        """Event trees, branches and rules within which it is: kind and name."""
        self._visited: set[tuple[str, str]] = set()

    def ways(self, initiating: str, tree: _Tree, way: Way) -> Iterator[tuple[str, Way]]:
        """Yield the name of the sequence and what is known at the end of each way through a tree."""
        self._initiating = initiating
        yield from self._into("event tree", name_of(tree.said), tree.said, self._within(tree, tree.initial, way, -1))

    def rest(self) -> None:
        """Go where no initiating event led, so that what is wrong there is found."""
        self._initiating = ""
        for name, rule in self._rules.items():
            if ("rule", name) not in self._visited:
                self._rule(name, rule, Way())
        for name, tree in self._trees.items():
            if ("event tree", name) not in self._visited:
                list(self.ways("", tree, Way()))
            for branch, said in tree.parts["define-branch"].items():
                if ("branch", f"{name}.{branch}") not in self._visited:
                    key = f"{name}.{branch}"
                    list(self._into("branch", key, said, self._within(tree, said, Way(), -1)))

    def _into(
        self, kind: str, name: str, said: Element, ways: Iterable[tuple[str, Way]]
    ) -> Iterator[tuple[str, Way]]:  # fmt: skip
        self._enter(kind, name, said)
        yield from ways
        self._under_way.pop()

    def _enter(self, kind: str, name: str, said: Element) -> None:
        if (kind, name) in self._under_way:
            circle = [inner for _, inner in self._under_way[self._under_way.index((kind, name)) :]]
            raise said.fault(f"loop: {kind} {' → '.join([*circle, name])}")
        self._under_way.append((kind, name))
        self._visited.add((kind, name))

    @contextmanager
    def _deeper(self, said: Element) -> Iterator[None]:
        if self._depth >= MOST_DEEP:
            raise said.fault(f"is within more than {MOST_DEEP} forks, branches and instructions")
        self._depth += 1
        yield
        self._depth -= 1

    def _within(self, tree: _Tree, said: Element, way: Way, last: int) -> Iterator[tuple[str, Way]]:
        """Go on through what stands in a branch, a path or an initial state; ``last``: the functional event before."""
        with self._deeper(said):
            yield from self._onward(tree, said, way, last)

    def _onward(self, tree: _Tree, said: Element, way: Way, last: int) -> Iterator[tuple[str, Way]]:
        inside = list(said.inside())
        if not inside or inside[-1].tag not in _TARGETS:
            raise said.fault(f"'{said.tag}' leads nowhere; expected a fork, a sequence or a branch as its end")
        *instructions, target = inside
        way = self._instructed(instructions, way)
        if way.links:
            raise way.links[0][0].fault("goes on in another event tree; expected that in a sequence")
        if target.tag == "fork":
            yield from self._fork(tree, target, way, last)
            return
        name = name_of(target)
        if target.tag == "branch":
            found = _known(tree.parts["define-branch"], name, target, "branch")
            key = f"{name_of(tree.said)}.{name}"
            yield from self._into("branch", key, target, self._within(tree, found, way, last))
            return
        found = _known(self._sequences, name, target, "sequence")
        way = self._instructed(list(found.inside()), way)
        self._count += 1
        if self._count > MOST_WAYS:
            raise tree.said.fault(f"more than {MOST_WAYS:,} ways through the event trees")
        if not way.links:
            yield name, way
        for link, known in way.links:
            linked = _known(self._trees, name_of(link), link, "event tree")
            onward = replace(known, states={}, links=())
            yield from self._into("event tree", name_of(link), link, self._within(linked, linked.initial, onward, -1))

    def _fork(self, tree: _Tree, said: Element, way: Way, last: int) -> Iterator[tuple[str, Way]]:
        order = tree.parts["define-functional-event"]
        name = said.attributes.get("functional-event", "")
        _known(order, name, said, "functional event")
        place = list(order).index(name)
        if place <= last:
            raise said.fault(
                f"functional event '{name}' comes after a later one or itself; expected the order of their definitions"
            )
        seen: set[str] = set()
        for path in said.inside():
            state = path.attributes.get("state", "")
            if path.tag != "path" or not state or state in seen:
                raise path.fault(f"'{path.tag}' of state {state!r:.60}; expected paths, each of a state of its own")
            seen.add(state)
            yield from self._within(tree, path, replace(way, states={**way.states, name: state}), place)

    def _instructed(self, instructions: Iterable[Element], way: Way) -> Way:
        for one in instructions:
            with self._deeper(one):
                way = self._instruct(one, way)
        return way

    def _instruct(self, said: Element, way: Way) -> Way:
        if said.tag == "rule":
            return self._rule(name_of(said), _known(self._rules, name_of(said), said, "rule"), way)
        if said.tag == "block":
            return self._instructed(said.inside(), way)
        if said.tag == "event-tree":
            return replace(way, links=(*way.links, (said, way)))
        inside = list(said.inside())
        self._expressions.happened(self._initiating, way.states)
        if said.tag == "if" and len(inside) in (2, 3):
            chosen = 1 if self._expressions.value(inside[0]) else 2
            return self._instructed(inside[chosen : chosen + 1], way)
        if said.tag == "collect-formula":
            for one in references(said):
                self._events.found(one, "")
            return replace(way, formulas=(*way.formulas, Formula(said, "", tuple(sorted(way.houses.items())))))
        if said.tag == "collect-expression" and len(inside) == 1:
            chance = (1.0 if way.chance is None else way.chance) * self._expressions.value(inside[0])
            if not 0 <= chance <= 1:
                raise said.fault(f"makes the probability of its way {chance:g}; expected 0 … 1")
            return replace(way, chance=chance)
        if said.tag == "set-house-event" and len(inside) == 1:
            return replace(way, houses={**way.houses, **house_set(self._events, said)})
        known = ("if", "block", "rule", "collect-formula", "collect-expression", "set-house-event", "event-tree")
        if said.tag in known:
            raise said.fault(f"'{said.tag}' has {len(inside)} elements in it; expected what it is about")
        raise said.fault(f"'{said.tag}' is not taken{nearest(said.tag, known)}")

    def _rule(self, name: str, rule: Element, way: Way) -> Way:
        self._enter("rule", name, rule)
        way = self._instructed(rule.inside(), way)
        self._under_way.pop()
        return way


def house_set(events: Names, said: Element) -> dict[str, bool]:
    """Return the house event that an element sets, and its state. Raises DesignError where there is none."""
    inside = list(said.inside())
    if len(inside) != 1 or inside[0].tag != "constant":
        raise said.fault(f"sets '{name_of(said)}' to nothing; expected a constant")
    return {events.found(said, "", "house-event").name: constant(inside[0])}


def _once(table: dict[str, Element], said: Element) -> None:
    first = table.setdefault(name_of(said), said)
    if first is not said:
        raise said.fault(f"'{name_of(said)}' is defined twice; first in line {first.line}")


def _known(table: Mapping[str, T], name: str, said: Element, kind: str) -> T:
    if name not in table:
        raise said.fault(f"{kind} '{name}' is not defined{nearest(name, table)}")
    return table[name]
