"""Fault trees in the Open-PSA model exchange format, as other reliability tools read and write them.

Epstein, Rauzy and Reinhart, "Open-PSA Model Exchange Format", version 2.0d (2008). What is taken: fault trees, their
gates of nested formulas, basic and house events, parameters, in any order and in several fault trees, which may use
each other's events by name. Common-cause groups, components' private names and event trees are refused in words.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT, Gate
from robophm.blocks.top_event import TopEvent
from robophm.core.errors import DesignError, StructureError, nearest
from robophm.core.markup import Element, Markup
from robophm.design.importers.open_psa.expressions import Expressions, Life

Array = npt.NDArray[np.float64]

_DEFINITIONS = {
    "define-gate": "gate", "define-basic-event": "basic-event", "define-house-event": "house-event",
    "define-parameter": "parameter",
}  # fmt: skip
_EVENTS = ("gate", "basic-event", "house-event")
_FORMULAS = ("and", "or", "not", "xor", "nand", "nor", "iff", "imply", "atleast", "cardinality")


@dataclass(frozen=True)
class Model:
    """A fault tree with the probabilities of its basic events at the mission time."""

    name: str
    """Name of the top event."""
    tree: FaultTree | None
    """The fault tree; None where house events and constants decide the top event."""
    occurred: Array
    """Probability of each basic event of the tree."""
    not_yet: Array
    certain: bool = False
    """Whether the top event always occurs, where there is no tree."""
    lives: tuple[Life | None, ...] = ()
    """Life of each basic event that fails as a part does; None where only its probability is known."""

    def top_event(self) -> TopEvent:
        """Return its top event. Raises StructureError where constants and house events decide it."""
        if self.tree is None:
            says = "always occurs" if self.certain else "never occurs"
            raise StructureError(f"'{self.name}' {says}: constants and house events decide it")
        return TopEvent(self.tree, self.occurred, self.not_yet)

    def probability(self) -> float:
        """Return the probability of the top event. Raises StructureError where it is too large to solve exactly."""
        return float(self.tree.probability(self.occurred, self.not_yet)) if self.tree else float(self.certain)


def load(path: Path, time: float | None = None, top: str | None = None) -> Model:
    """Read a model; ``time`` is its mission time [h], ``top`` a gate where several are used by no other.

    Raises DesignError, one line with file and line, for what is no XML, not taken or contradicts itself.
    """
    return _Reader(Markup(path)).model(time, top)


class _Reader:
    def __init__(self, file: Markup) -> None:
        self.file = file
        self.defined: dict[str, Element] = {}
        self.kind: dict[str, str] = {}
        self.parameters: dict[str, Element] = {}
        root = file.root()
        if root.tag != "opsa-mef":
            raise file.fault(root.line, f"is a '{root.tag}'; expected an opsa-mef")
        for part in root.inside():
            if part.tag in ("define-fault-tree", "model-data"):
                self._collect(part)
            else:
                raise file.fault(part.line, f"'{part.tag}' is not taken; expected define-fault-tree or model-data")

    def _collect(self, part: Element) -> None:
        for one in part.inside():
            if one.tag == "define-component":
                self._collect(one)
                continue
            kind = _DEFINITIONS.get(one.tag)
            if kind is None:
                raise self.file.fault(one.line, f"'{one.tag}' is not taken{nearest(one.tag, _DEFINITIONS)}")
            name = self._name(one)
            known = self.parameters if kind == "parameter" else self.defined
            if name in known:
                if kind != "parameter" and self.kind[name] == kind == "basic-event" and not list(one.inside()):
                    continue  # named in a tree, and given its probability in the model data
                first = known[name]
                if kind == "parameter" or self.kind[name] != kind or list(first.inside()):
                    raise self.file.fault(one.line, f"'{name}' is defined twice; first in line {first.line}")
            known[name] = one
            if kind != "parameter":
                self.kind[name] = kind

    def _name(self, said: Element) -> str:
        name = said.attributes.get("name", "")
        if not name:
            raise self.file.fault(said.line, f"'{said.tag}' has no name")
        return name.rpartition(".")[2]

    def model(self, time: float | None, top: str | None) -> Model:
        order = self._order(self._top(top))
        number: dict[str, int] = {}
        values: dict[str, int | bool] = {}
        names: list[str] = []
        gates: list[Gate] = []
        formulas = _Formulas(self, values, gates)
        for name in order:
            said = self.defined[name]
            if self.kind[name] == "basic-event":
                values[name] = number[name] = len(gates)
                names.append(name)
                gates.append(Gate(UNIT, ()))
            elif self.kind[name] == "house-event":
                values[name] = self._state(said)
            else:
                values[name] = formulas.value(self._formula(said))
        whole = values[order[-1]]
        expressions = Expressions(self.file, self.parameters, time)
        chances = [expressions.probability(self.defined[name]) for name in names]
        if isinstance(whole, bool):
            return Model(order[-1], None, np.empty(0), np.empty(0), whole)
        if whole < len(gates) - 1:  # the last one is the top
            gates.append(Gate(ANY, (whole,)))
        p, q = np.array(chances).T
        lives = tuple(expressions.life(self.defined[name]) for name in names)
        return Model(order[-1], FaultTree(names, gates), p, q, lives=lives)

    def _top(self, wanted: str | None) -> str:
        tops = [name for name, kind in self.kind.items() if kind == "gate"]
        if wanted is not None:
            if wanted not in tops:
                raise DesignError(f"{self.file.name}: no gate '{wanted}'{nearest(wanted, tops)}")
            return wanted
        used = {name for gate in tops for name, _ in self._references(self.defined[gate])}
        free = [name for name in tops if name not in used]
        if not tops:
            raise DesignError(f"{self.file.name}: defines no gate")
        if not free:
            self._order(tops[0])  # finds the loop
        if len(free) > 1:
            listed = ", ".join(f"'{name}' (line {self.defined[name].line})" for name in free[:5])
            more = f" and {len(free) - 5} more" if len(free) > 5 else ""
            raise DesignError(
                f"{self.file.name}: {len(free)} gates are used by no other: {listed}{more}; expected one, or "
                "the name of the top gate"
            )
        return free[0]

    def _references(self, said: Element) -> Iterator[tuple[str, Element]]:
        todo = [said]
        while todo:
            one = todo.pop()
            if one is not said and one.tag in (*_EVENTS, "event"):
                yield self._name(one), one
            else:
                todo += reversed(one.children)

    def _order(self, top: str) -> list[str]:
        """All events that the top hangs on, inputs first. Raises DesignError for what is not defined, and loops."""
        done: dict[str, None] = {}
        under_way: dict[str, list[str]] = {}
        todo = [top]
        while todo:
            name = todo[-1]
            if name in done:
                todo.pop()
                continue
            if name in under_way:
                under_way.pop(name)
                done[todo.pop()] = None
                continue
            inputs: dict[str, None] = {}
            if self.kind[name] == "gate":
                for inner, said in self._references(self.defined[name]):
                    kind = said.attributes.get("type", said.tag)
                    if inner not in self.defined:
                        raise self.file.fault(said.line, f"'{inner}' is not defined{nearest(inner, self.defined)}")
                    if kind not in ("event", self.kind[inner]):
                        raise self.file.fault(said.line, f"'{inner}' is used as a {kind}, but is a {self.kind[inner]}")
                    if inner in under_way or inner == name:
                        circle = [*under_way, name]
                        circle = [*circle[circle.index(inner) :], inner]
                        raise self.file.fault(said.line, f"loop: {' → '.join(circle)}")
                    inputs[inner] = None
            under_way[name] = list(inputs)
            todo += [inner for inner in reversed(inputs) if inner not in done]
        return list(done)

    def _formula(self, gate: Element) -> Element:
        inside = list(gate.inside())
        if len(inside) != 1:
            raise self.file.fault(gate.line, f"gate '{self._name(gate)}' has {len(inside)} formulas; expected one")
        return inside[0]

    def _state(self, house: Element) -> bool:
        inside = list(house.inside())
        if len(inside) != 1 or inside[0].tag != "constant":
            raise self.file.fault(house.line, f"house event '{self._name(house)}' has no state; expected a constant")
        return self.constant(inside[0])

    def constant(self, said: Element) -> bool:
        """Return the value of a house event, or of a constant in a formula."""
        if said.attributes.get("value") not in ("true", "false"):
            raise self.file.fault(said.line, f"constant {said.attributes.get('value')!r:.60}; expected true or false")
        return said.attributes["value"] == "true"

    def name_of(self, said: Element) -> str:
        """Return the name of the event to which a formula refers."""
        return self._name(said)


class _Formulas:
    """Formulas as gates; what constants decide is decided."""

    def __init__(self, reader: _Reader, values: dict[str, int | bool], gates: list[Gate]) -> None:
        self.reader, self.values, self.gates = reader, values, gates
        self._known: dict[tuple[int, tuple[int, ...]], int] = defaultdict(lambda: -1)

    def value(self, said: Element) -> int | bool:
        """The number of the gate that a formula is, or what it always is."""
        if said.tag in (*_EVENTS, "event"):
            return self.values[self.reader.name_of(said)]
        if said.tag == "constant":
            return self.reader.constant(said)
        fault = self.reader.file.fault
        if said.tag not in _FORMULAS:
            raise fault(said.line, f"formula '{said.tag}' is not taken{nearest(said.tag, (*_FORMULAS, *_EVENTS))}")
        inputs = [self.value(one) for one in said.inside()]
        n = len(inputs)
        if not n:
            raise fault(said.line, f"'{said.tag}' has no inputs; expected at least one")
        exact = {"not": 1, "iff": 2, "imply": 2}.get(said.tag)
        if (exact is not None and n != exact) or (said.tag == "xor" and n < 2):
            raise fault(said.line, f"'{said.tag}' has {n} inputs; expected {exact or 'at least 2'}")
        if said.tag == "atleast":
            return self._at_least(self._bound(said, "min", n), inputs)
        if said.tag == "cardinality":
            low, high = self._bound(said, "min", n), self._bound(said, "max", n)
            if low > high:
                raise fault(said.line, f"cardinality min {low} above max {high}")
            above = self._not(self._at_least(high + 1, inputs))
            return self._at_least(2, [self._at_least(low, inputs), above])
        if said.tag in ("and", "nand"):
            whole = self._at_least(n, inputs)
            return self._not(whole) if said.tag == "nand" else whole
        if said.tag in ("or", "nor"):
            whole = self._at_least(1, inputs)
            return self._not(whole) if said.tag == "nor" else whole
        if said.tag == "not":
            return self._not(inputs[0])
        if said.tag == "imply":
            return self._at_least(1, [self._not(inputs[0]), inputs[1]])
        odd = self._odd(inputs)
        return odd if said.tag == "xor" else self._not(odd)

    def _bound(self, said: Element, name: str, n: int) -> int:
        text = said.attributes.get(name, "")
        if not (text.isascii() and text.isdigit()) or len(text) > 9:
            raise self.reader.file.fault(said.line, f"'{said.tag}' has {name} {text!r:.60}; expected a whole number")
        if int(text) > n:
            raise self.reader.file.fault(
                said.line, f"'{said.tag}' has {name} = {text} of {n} inputs; expected at most n"
            )
        return int(text)

    def _at_least(self, k: int, inputs: list[int | bool]) -> int | bool:
        k -= sum(one is True for one in inputs)
        left = [one for one in inputs if not isinstance(one, bool)]
        if k <= 0 or k > len(left):
            return k <= 0
        return self._gate(ALL if k == len(left) else k, left)

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
