"""A question to an Open-PSA model as one fault tree: the gates that it hangs on, and its basic events."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ANY, UNIT, Gate
from robophm.core.errors import RobophmError
from robophm.core.markup import Element
from robophm.design.importers.open_psa.common_causes import Group, causes
from robophm.design.importers.open_psa.deviates import MOST_DRAWN, Levels
from robophm.design.importers.open_psa.expressions import Expressions
from robophm.design.importers.open_psa.formulas import Formulas, constant, references
from robophm.design.importers.open_psa.model import NO_EVENTS, Array, Model
from robophm.design.importers.open_psa.names import Named, Names, name_of

MEMBER = "member of a common-cause group"
"""The kind of a basic event whose probability is divided among itself and what fails it together with others."""

Houses = tuple[tuple[str, bool], ...]
"""House events that are set, in order of their names, and their states."""


class Formula(NamedTuple):
    """An element with one formula in it, the path of what it stands in, and the house events that are set for it."""

    said: Element
    base: str = ""
    houses: Houses = ()


class Chances:
    """The probabilities of basic events, as the expressions of a model say them."""

    def __init__(
        self, names: Sequence[str], basic: Mapping[str, Named], groups: Sequence[Group], expressions: Expressions
    ) -> None:
        """``names``: of all events, of which ``basic`` have expressions of their own, and groups say the others'."""
        self._names, self._basic, self._groups, self._expressions = names, basic, groups, expressions

    def now(self) -> Array:
        """Return (p, 1 − p) of each event; shape (events, 2). Raises DesignError where one has none."""
        found = {one.name: self._expressions.probability(one.said, one.base) for one in self._basic.values()}
        found |= {name: (p, 1.0 - p) for group in self._groups for name, p in _common(group, self._expressions)}
        return np.array([found.get(name, (0.0, 1.0)) for name in self._names])

    @property
    def uncertain(self) -> int:
        """Return how many uncertain expressions have been worked out, of which the means were taken."""
        return len(self._expressions.uncertain)

    def drawn(self, count: int, seed: int) -> Array:
        """Return (p, 1 − p) of each event in so many draws; shape (2, events, draws).

        Raises RobophmError for too many.
        """
        if count * len(self._names) > MOST_DRAWN:
            raise RobophmError(f"{count} draws of {len(self._names)} events: too many; expected fewer draws")
        levels = Levels(count, seed)
        found = np.empty((2, len(self._names), count))
        try:
            for levels.draw in range(count):
                self._expressions.drawn(levels)
                found[:, :, levels.draw] = self.now().T
        finally:
            self._expressions.drawn(None)
        return found


class Assembly:
    """The events and gates of one question, each once; events under other house events have other gates."""

    def __init__(self, events: Names, groups: Sequence[Group], expressions: Expressions) -> None:
        self._events, self._groups, self._expressions = events, groups, expressions
        self._names: list[str] = []
        self._gates: list[Gate] = []
        self._numbers: dict[str, int] = {}
        self._used: dict[str, Group] = {}
        """Common-cause groups that it hangs on, by their names."""
        self._set: dict[Houses, Formulas] = {}

    def value(self, formula: Formula) -> int | bool:
        """Return the number of the gate that a formula is, or what it always is. Raises DesignError."""
        found = self._set.get(formula.houses)
        if found is None:
            found = self._set[formula.houses] = Formulas(self._events, {}, self._gates)
        houses = dict(formula.houses)
        for name in _order(self._events, formula.said, formula.base, found.values):
            found.values[name] = self._event(name, found, houses)
        return found.value(_inside(formula.said), formula.base)

    def all_of(self, values: Sequence[int | bool]) -> int | bool:
        """Return the gate that is true while all of these are, or what it always is."""
        return values[0] if len(values) == 1 else self._plain.at_least(len(values), list(values))

    def any_of(self, values: Sequence[int | bool]) -> int | bool:
        """Return the gate that is true while any of these is, or what it always is."""
        return values[0] if len(values) == 1 else self._plain.at_least(1, list(values))

    def implied(self, hypothesis: int | bool, target: int | bool) -> int | bool:
        """Return the gate that is false while the hypothesis is true and the target is not."""
        return self._plain.implied(hypothesis, target)

    def any_set(self, sets: Iterable[Iterable[str]]) -> int | bool:
        """Return the gate that is true while all events of any of these sets have occurred."""
        return self.any_of([self.all_of([self._number(name) for name in one]) for one in sets])

    @property
    def _plain(self) -> Formulas:
        return self._set.setdefault((), Formulas(self._events, {}, self._gates))

    def _event(self, name: str, formulas: Formulas, houses: dict[str, bool]) -> int | bool:
        _, said, kind, base = self._events.named[name]
        if kind == "basic-event":
            return self._number(name)
        if kind == MEMBER:
            return formulas.at_least(1, [self._number(one) for one in self._causes_of(name)])
        if kind == "house-event":
            return houses.get(name, house_state(said))
        return formulas.value(_inside(said), base)

    def _number(self, name: str) -> int:
        if name not in self._numbers:
            self._numbers[name] = len(self._gates)
            self._names.append(name)
            self._gates.append(Gate(UNIT, ()))
        return self._numbers[name]

    def _causes_of(self, member: str) -> Iterator[str]:
        """Yield the events that fail a member of groups: alone, and together with others."""
        for group in self._groups:
            if member in group.members:
                self._used[name_of(group.said)] = group
                for together, _ in causes(group, self._expressions):
                    if member in together:
                        yield f"[{' '.join(together)}]"

    def model(self, name: str, whole: int | bool, *, exchanged: bool = False) -> Model:
        """Return the model whose top event is this gate, or which is decided."""
        if isinstance(whole, bool):
            return Model(name, None, NO_EVENTS, NO_EVENTS, float(whole), exchanged=exchanged)
        gates, names = list(self._gates), list(self._names)
        if whole < len(gates) - 1:  # the last one is the top
            gates.append(Gate(ANY, (whole,)))
        shared = {name for group in self._used.values() for name, _ in _common(group, self._expressions)}
        basic = {name: self._events.named[name] for name in names if name not in shared}
        none = tuple(one.said for one in basic.values() if not list(one.said.inside()))
        tree = FaultTree(names, gates)
        if none:
            half = np.full(len(names), 0.5)
            return Model(name, tree, half, half, lives=(None,) * len(names), no_chance=none, exchanged=exchanged)
        chances = Chances(names, basic, list(self._used.values()), self._expressions)
        p, q = chances.now().T
        lives = {one.name: self._expressions.life(one.said, one.base) for one in basic.values()}
        of_each = tuple(lives.get(name) for name in names)
        return Model(name, tree, p, q, lives=of_each, exchanged=exchanged, chances=chances)


def _common(group: Group, expressions: Expressions) -> Iterator[tuple[str, float]]:
    """The events of a group, by the members that fail in them, and their probabilities."""
    for together, p in causes(group, expressions):
        yield f"[{' '.join(together)}]", p


def _order(events: Names, said: Element, base: str, known: Container[str]) -> list[str]:
    """The events that a formula hangs on but those that are known, inputs first. Raises DesignError for what is not
    defined, and loops."""
    done: dict[str, None] = {}
    under_way: dict[str, None] = {}
    for first in _inputs(events, said, base, under_way):
        todo = [first]
        while todo:
            name = todo[-1]
            if name in done or name in known:
                todo.pop()
            elif name in under_way:
                under_way.pop(name)
                done[todo.pop()] = None
            else:
                under_way[name] = None
                one = events.named[name]
                if one.kind == "gate":
                    inputs = _inputs(events, one.said, one.base, under_way)
                    todo += [inner for inner in reversed(inputs) if inner not in done]
    return list(done)


def _inputs(events: Names, said: Element, base: str, under_way: Iterable[str]) -> list[str]:
    """The events that a formula names. Raises DesignError for what is none of its kind, and loops."""
    inputs: dict[str, None] = {}
    for one in references(said):
        kind = one.attributes.get("type", one.tag).strip()
        inner = events.found(one, base)
        if kind != "event" and kind != (known := "basic-event" if inner.kind == MEMBER else inner.kind):
            raise one.fault(f"'{inner.name}' is used as a {kind}, but is a {known}")
        if inner.name in under_way:
            circle = [*under_way]
            circle = [*circle[circle.index(inner.name) :], inner.name]
            raise one.fault(f"loop: {' → '.join(circle)}")
        inputs[inner.name] = None
    return list(inputs)


def _inside(said: Element) -> Element:
    inside = list(said.inside())
    if len(inside) != 1:
        what = f"gate '{name_of(said)}'" if said.tag == "define-gate" else f"'{said.tag}'"
        raise said.fault(f"{what} has {len(inside)} formulas; expected one")
    return inside[0]


def house_state(house: Element) -> bool:
    """Return the state of a house event; where none is said it is false, as the format has it."""
    inside = list(house.inside())
    if len(inside) > 1 or (inside and inside[0].tag != "constant"):
        raise house.fault(f"house event '{name_of(house)}' has no state; expected a constant")
    return constant(inside[0]) if inside else False
