"""Fault trees in the Open-PSA model exchange format, as other reliability tools read and write them.

Epstein, Rauzy and Reinhart, "Open-PSA Model Exchange Format", version 2.0d (2008). What is taken: fault trees of one
file or several, which may include each other, their gates of nested formulas, basic and house events, parameters and
common-cause groups, public and private, in any order, and trees whose events have no probabilities. Event trees,
alignments and substitutions are refused in words.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ANY, UNIT, Gate
from robophm.blocks.top_event import TopEvent
from robophm.core.errors import DesignError, StructureError, nearest
from robophm.core.markup import Element
from robophm.design.importers.open_psa.common_causes import Group, causes, members
from robophm.design.importers.open_psa.expressions import Expressions, Life
from robophm.design.importers.open_psa.files import Files
from robophm.design.importers.open_psa.formulas import Formulas, constant, references
from robophm.design.importers.open_psa.names import Names, name_of

Array = npt.NDArray[np.float64]

_DEFINITIONS = {
    "define-gate": "gate", "define-basic-event": "basic-event", "define-house-event": "house-event",
    "define-parameter": "parameter",
}  # fmt: skip
_GROUP = "define-CCF-group"
_MEMBER = "member of a common-cause group"


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
    no_chance: tuple[Element, ...] = ()
    """Definitions of basic events without a probability. Where there are any, all probabilities are one half."""

    def top_event(self) -> TopEvent:
        """Return its top event, with the probabilities of its basic events.

        Raises StructureError where constants and house events decide it, DesignError where an event has no probability.
        """
        if self.no_chance:
            first, more = self.no_chance[0], len(self.no_chance) - 1
            also = f", nor {more} more" if more else ""
            raise first.fault(f"'{name_of(first)}' has no probability{also}; expected one of each basic event")
        return self.structure()

    def structure(self) -> TopEvent:
        """Return its top event, whose probabilities mean nothing where an event has none; raises as ``top_event``."""
        if self.tree is None:
            says = "always occurs" if self.certain else "never occurs"
            raise StructureError(f"'{self.name}' {says}: constants and house events decide it")
        return TopEvent(self.tree, self.occurred, self.not_yet)

    def probability(self) -> float:
        """Return the probability of the top event. Raises StructureError where it is too large to solve exactly."""
        return self.top_event().probability if self.tree else float(self.certain)


def load(path: Path | Sequence[Path], time: float | None = None, top: str | None = None) -> Model:
    """Read a model, of one file or several; ``time`` is its mission time [h], ``top`` a gate where several are used
    by no other.

    Raises DesignError, one line with file and line, for what is no XML, not taken or contradicts itself.
    """
    return _Reader([path] if isinstance(path, Path) else list(path)).model(time, top)


class _Reader:
    def __init__(self, paths: list[Path]) -> None:
        self.where = ", ".join(map(str, paths))
        self.files = Files(paths)
        self.events, self.parameters = Names(), Names()
        self.groups: list[Group] = []
        self._trees: dict[str, Element] = {}
        for root in self.files.roots:
            for part in self.files.inside(root):
                if part.tag == "define-fault-tree":
                    first = self._trees.setdefault(name_of(part), part)
                    if first is not part:
                        raise part.fault(f"'{name_of(part)}' is defined twice; first in line {first.line}")
                    self._collect(part, name_of(part), public=_public(part, public=True))
                elif part.tag == "model-data":
                    self._collect(part, "", public=True)
                elif part.tag == _GROUP:
                    self._group(part, "", public=True)
                else:
                    says = f"'{part.tag}' is not taken; expected define-fault-tree, define-CCF-group or model-data"
                    raise part.fault(says)

    def _collect(self, whole: Element, base: str, *, public: bool) -> None:
        todo = [(whole, base, public)]
        components: set[str] = set()
        while todo:
            part, within, seen = todo.pop()
            for one in self.files.inside(part):
                if one.tag == "define-component" and base:
                    path = f"{within}.{name_of(one)}"
                    if path in components:
                        raise one.fault(f"component '{name_of(one)}' is defined twice")
                    components.add(path)
                    todo.append((one, path, _public(one, public=seen)))
                elif one.tag == _GROUP and base:
                    self._group(one, within, public=seen)
                elif kind := _DEFINITIONS.get(one.tag):
                    if not base and not _public(one, public=True):
                        raise one.fault(f"'{name_of(one)}' is private; expected that in a fault tree, which it is of")
                    table = self.parameters if kind == "parameter" else self.events
                    table.add(one, kind, within, public=_public(one, public=seen))
                else:
                    raise one.fault(f"'{one.tag}' is not taken{nearest(one.tag, _DEFINITIONS)}")

    def _group(self, said: Element, base: str, *, public: bool) -> None:
        if any(name_of(one.said) == name_of(said) for one in self.groups):
            raise said.fault(f"common-cause group '{name_of(said)}' is defined twice")
        names = []
        for one in members(said):
            self.events.add(one, _MEMBER, base, public=public)
            names.append(self.events.found(one, base).name)
        self.groups.append(Group(said, tuple(names), base))

    def model(self, time: float | None, top: str | None) -> Model:
        order = self._order(self._top(top))
        expressions = Expressions(self.parameters, time)
        values: dict[str, int | bool] = {}
        names: list[str] = []
        gates: list[Gate] = []
        formulas = Formulas(self.events, values, gates)

        def event(name: str) -> int:
            names.append(name)
            gates.append(Gate(UNIT, ()))
            return len(gates) - 1

        shared: dict[str, list[int | bool]] = defaultdict(list)
        common: dict[str, float] = {}
        for name, together, p in self._common(order, expressions):
            common[name] = p
            number = event(name)
            for one in together:
                shared[one].append(number)
        for name in order:
            _, said, kind, base = self.events.named[name]
            if kind == "basic-event":
                values[name] = event(name)
            elif kind == _MEMBER:
                values[name] = formulas.at_least(1, shared[name])
            elif kind == "house-event":
                values[name] = _state(said)
            else:
                values[name] = formulas.value(_formula(said), base)
        whole = values[order[-1]]
        if isinstance(whole, bool):
            return Model(order[-1], None, np.empty(0), np.empty(0), whole)
        if whole < len(gates) - 1:  # the last one is the top
            gates.append(Gate(ANY, (whole,)))
        basic = {name: self.events.named[name] for name in names if name not in common}
        none = tuple(one.said for one in basic.values() if not list(one.said.inside()))
        tree = FaultTree(names, gates)
        if none:
            half = np.full(len(names), 0.5)
            return Model(order[-1], tree, half, half, lives=(None,) * len(names), no_chance=none)
        found = {one.name: expressions.probability(one.said, one.base) for one in basic.values()}
        found |= {name: (p, 1.0 - p) for name, p in common.items()}
        p, q = np.array([found[name] for name in names]).T
        known = {one.name: expressions.life(one.said, one.base) for one in basic.values()}
        return Model(order[-1], tree, p, q, lives=tuple(known.get(name) for name in names))

    def _common(self, order: list[str], expressions: Expressions) -> Iterator[tuple[str, tuple[str, ...], float]]:
        """The failures of members of the groups that the top hangs on: name, which fail in it, and probability."""
        needed = set(order)
        for group in self.groups:
            if not needed.isdisjoint(group.members):
                for together, p in causes(group, expressions):
                    if not needed.isdisjoint(together):
                        yield f"[{' '.join(together)}]", together, p

    def _top(self, wanted: str | None) -> str:
        tops = {one.name: one for one in self.events if one.kind == "gate"}
        if wanted is not None:
            if wanted not in tops:
                raise DesignError(f"{self.where}: no gate '{wanted}'{nearest(wanted, tops)}")
            return wanted
        used = {self.events.found(said, gate.base).name for gate in tops.values() for said in references(gate.said)}
        free = [name for name in tops if name not in used]
        if not tops:
            raise DesignError(f"{self.where}: defines no gate")
        if not free:
            self._order(next(iter(tops)))  # finds the loop
        if len(free) > 1:
            listed = ", ".join(f"'{name}' (line {tops[name].said.line})" for name in free[:5])
            more = f" and {len(free) - 5} more" if len(free) > 5 else ""
            raise DesignError(
                f"{self.where}: {len(free)} gates are used by no other: {listed}{more}; expected one, or "
                "the name of the top gate"
            )
        return free[0]

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
            one = self.events.named[name]
            if one.kind == "gate":
                for said in references(one.said):
                    kind = said.attributes.get("type", said.tag).strip()
                    inner = self.events.found(said, one.base)
                    if kind != "event" and kind != (known := "basic-event" if inner.kind == _MEMBER else inner.kind):
                        raise said.fault(f"'{inner.name}' is used as a {kind}, but is a {known}")
                    if inner.name in under_way or inner.name == name:
                        circle = [*under_way, name]
                        circle = [*circle[circle.index(inner.name) :], inner.name]
                        raise said.fault(f"loop: {' → '.join(circle)}")
                    inputs[inner.name] = None
            under_way[name] = list(inputs)
            todo += [inner for inner in reversed(inputs) if inner not in done]
        return list(done)


def _public(said: Element, *, public: bool) -> bool:
    """Whether a definition is, which has the role of what it stands in unless it says its own."""
    role = said.attributes.get("role", "public" if public else "private")
    if role not in ("public", "private"):
        raise said.fault(f"role {role!r:.40}; expected public or private")
    return role == "public"


def _formula(gate: Element) -> Element:
    inside = list(gate.inside())
    if len(inside) != 1:
        raise gate.fault(f"gate '{name_of(gate)}' has {len(inside)} formulas; expected one")
    return inside[0]


def _state(house: Element) -> bool:
    """The state of a house event; where none is said it is false, as the format has it."""
    inside = list(house.inside())
    if len(inside) > 1 or (inside and inside[0].tag != "constant"):
        raise house.fault(f"house event '{name_of(house)}' has no state; expected a constant")
    return constant(inside[0]) if inside else False
