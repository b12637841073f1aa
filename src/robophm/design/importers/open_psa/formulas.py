"""Formulas of an Open-PSA model as the gates of a fault tree."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from robophm.blocks.graph import ALL, NOT, ODD, Gate
from robophm.core.errors import nearest
from robophm.core.markup import Element
from robophm.design.importers.open_psa.names import Names

EVENTS = ("gate", "basic-event", "house-event")
"""The kinds of events."""

_FORMULAS = ("and", "or", "not", "xor", "nand", "nor", "iff", "imply", "atleast", "cardinality")


def references(said: Element) -> Iterator[Element]:
    """Yield the elements of a gate that refer to events."""
    todo = [said]
    while todo:
        one = todo.pop()
        if one is not said and one.tag in (*EVENTS, "event"):
            yield one
        else:
            todo += reversed(one.children)


def constant(said: Element) -> bool:
    """Return the value of a house event, or of a constant in a formula. Raises DesignError for neither."""
    if said.attributes.get("value") not in ("true", "false"):
        raise said.fault(f"constant {said.attributes.get('value')!r:.60}; expected true or false")
    return said.attributes["value"] == "true"


class Formulas:
    """Formulas as gates; what constants decide is decided. ``values`` are those of events by name, so far."""

    def __init__(self, events: Names, values: dict[str, int | bool], gates: list[Gate]) -> None:
        self.events, self.values, self.gates = events, values, gates
        self._known: dict[tuple[int, tuple[int, ...]], int] = defaultdict(lambda: -1)

    def value(self, said: Element, base: str) -> int | bool:
        """The number of the gate that a formula in ``base`` is, or what it always is. Raises DesignError."""
        if said.tag in (*EVENTS, "event"):
            return self.values[self.events.found(said, base).name]
        if said.tag == "constant":
            return constant(said)
        if said.tag not in _FORMULAS:
            raise said.fault(f"formula '{said.tag}' is not taken{nearest(said.tag, (*_FORMULAS, *EVENTS))}")
        inputs = [self.value(one, base) for one in said.inside()]
        n = len(inputs)
        if not n:
            raise said.fault(f"'{said.tag}' has no inputs; expected at least one")
        exact = {"not": 1, "iff": 2, "imply": 2}.get(said.tag)
        if (exact is not None and n != exact) or (said.tag == "xor" and n < 2):
            raise said.fault(f"'{said.tag}' has {n} inputs; expected {exact or 'at least 2'}")
        if said.tag == "atleast":
            return self.at_least(self._bound(said, "min", n), inputs)
        if said.tag == "cardinality":
            low, high = self._bound(said, "min", n), self._bound(said, "max", n)
            if low > high:
                raise said.fault(f"cardinality min {low} above max {high}")
            above = self._not(self.at_least(high + 1, inputs))
            return self.at_least(2, [self.at_least(low, inputs), above])
        if said.tag in ("and", "nand"):
            whole = self.at_least(n, inputs)
            return self._not(whole) if said.tag == "nand" else whole
        if said.tag in ("or", "nor"):
            whole = self.at_least(1, inputs)
            return self._not(whole) if said.tag == "nor" else whole
        if said.tag == "not":
            return self._not(inputs[0])
        if said.tag == "imply":
            return self.implied(*inputs)
        odd = self._odd(inputs)
        return odd if said.tag == "xor" else self._not(odd)

    def _bound(self, said: Element, name: str, n: int) -> int:
        text = said.attributes.get(name, "")
        if not (text.isascii() and text.isdigit()) or len(text) > 9:
            raise said.fault(f"'{said.tag}' has {name} {text!r:.60}; expected a whole number")
        if int(text) > n:
            raise said.fault(f"'{said.tag}' has {name} = {text} of {n} inputs; expected at most n")
        return int(text)

    def at_least(self, k: int, inputs: list[int | bool]) -> int | bool:
        """Return the number of the gate that is true while at least k of the inputs are, or what it always is."""
        k -= sum(one is True for one in inputs)
        left = [one for one in inputs if not isinstance(one, bool)]
        if k <= 0 or k > len(left):
            return k <= 0
        return self._gate(ALL if k == len(left) else k, left)

    def implied(self, hypothesis: int | bool, target: int | bool) -> int | bool:
        """Return the number of the gate that is false only where the first is true and the second is not."""
        return self.at_least(1, [self._not(hypothesis), target])

    def _not(self, value: int | bool) -> int | bool:
        return not value if isinstance(value, bool) else self._gate(NOT, [value])

    def _odd(self, inputs: list[int | bool]) -> int | bool:
        flipped = sum(one is True for one in inputs) % 2 == 1
        left = [one for one in inputs if not isinstance(one, bool)]
        if not left:
            return flipped
        odd = left[0] if len(left) == 1 else self._gate(ODD, left)
        return self._not(odd) if flipped else odd

    def _gate(self, k: int, inputs: list[int]) -> int:
        key = k, tuple(inputs)
        if key not in self._known:
            self._known[key] = len(self.gates)
            self.gates.append(Gate(*key))
        return self._known[key]
