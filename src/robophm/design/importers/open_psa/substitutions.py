"""Substitutions of an Open-PSA model: changes that a hypothesis over basic events makes in every question.

MEF 2.0d, section 7.2. Those without a source are declarations: wherever the hypothesis is true the target is, so that
what contradicts it does not occur. Those with a source exchange events in the minimal cut sets that hold the
hypothesis: what is left is another tree.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from robophm.core.errors import StructureError
from robophm.core.markup import Element
from robophm.design.importers.open_psa.assembly import MEMBER, Assembly, Formula
from robophm.design.importers.open_psa.formulas import constant, references
from robophm.design.importers.open_psa.model import Model
from robophm.design.importers.open_psa.names import Names, name_of

MOST_SETS = 20_000
"""The most minimal cut sets in which events are exchanged."""

_EVENTS = ("basic-event", "event")
_TYPES = ("delete-terms", "recovery-rule", "exchange-event")


class Declaration(NamedTuple):
    """A hypothesis and what it implies; where there is no target, the hypothesis is never true."""

    hypothesis: Formula
    target: Formula | None


class Exchange(NamedTuple):
    """An exchange in minimal cut sets that hold any of the hypotheses: the target takes the place of the source."""

    hypotheses: tuple[frozenset[str], ...]
    source: frozenset[str]
    target: frozenset[str]
    said: Element


class Substitutions:
    """The substitutions of a model. Raises DesignError for what is none, or contradicts others."""

    def __init__(self, definitions: Iterable[Element], events: Names) -> None:
        self._events = events
        self._declarations: list[Declaration] = []
        self._exchanges: list[Exchange] = []
        seen: set[str] = set()
        for said in definitions:
            if name_of(said) in seen:
                raise said.fault(f"substitution '{name_of(said)}' is defined twice")
            seen.add(name_of(said))
            self._define(said)
        self._check()

    def _define(self, said: Element) -> None:
        name = name_of(said)
        parts = {one.tag: one for one in said.inside()}
        if not {"hypothesis", "target"} <= set(parts) <= {"hypothesis", "source", "target"}:
            raise said.fault(f"substitution '{name}' has {', '.join(parts)}; expected hypothesis, source, target")
        if said.attributes.get("type", _TYPES[0]) not in _TYPES:
            raise said.fault(
                f"substitution '{name}' is a {said.attributes['type']!r:.40}; expected {', '.join(_TYPES)}"
            )
        hypothesis, target = parts["hypothesis"], parts["target"]
        exchanges = "source" in parts
        allowed = (*_EVENTS, "and", "or", *(() if exchanges else ("atleast",)))
        for one in hypothesis.all():
            if one is not hypothesis and one.tag not in allowed:
                raise one.fault(f"'{one.tag}' in this hypothesis; expected basic events in {', '.join(allowed[2:])}")
        inputs = self._basic(hypothesis)
        inside = list(target.inside())
        never = always = False
        if len(inside) == 1 and inside[0].tag == "constant":
            always = constant(inside[0])
            never = not always
        targets = frozenset() if never or always else frozenset(self._basic(target))
        if (always and not exchanges) or (never and exchanges):
            raise target.fault(f"substitution '{name}' with a target that is constant has no effect")
        if not exchanges:
            self._declarations.append(Declaration(Formula(hypothesis), None if never else Formula(target)))
            return
        every = next(hypothesis.inside()).tag == "or"
        hypotheses = tuple(frozenset({one}) for one in inputs) if every else (frozenset(inputs),)
        self._exchanges.append(Exchange(hypotheses, frozenset(self._basic(parts["source"])), targets, said))

    def _basic(self, said: Element) -> list[str]:
        """The basic events that an element names."""
        names = []
        for one in references(said):
            found = self._events.found(one, "")
            if found.kind not in ("basic-event", MEMBER):
                raise one.fault(f"'{found.name}' is a {found.kind}; expected a basic event")
            if found.name in names:
                raise one.fault(f"'{found.name}' is twice in '{said.tag}'")
            names.append(found.name)
        if not names:
            raise said.fault(f"'{said.tag}' names no basic event")
        return names

    def _check(self) -> None:
        """Raise DesignError where what one exchange makes or takes away is what another looks for."""
        for one in self._exchanges:
            for other in self._exchanges:
                looked_for = frozenset().union(*other.hypotheses) if other is not one else frozenset()
                for name in one.target & (other.source | looked_for) | one.source & looked_for:
                    raise one.said.fault(f"'{name}' is of another substitution too: which comes first would matter")
            for name in one.source | one.target | frozenset().union(*one.hypotheses):
                if self._events.named[name].kind == MEMBER:
                    raise one.said.fault(f"'{name}' is in a common-cause group; expected basic events of their own")

    def applied(self, assembly: Assembly, name: str, whole: int | bool) -> Model:
        """Return the model of a gate with what the substitutions make of it.

        Raises StructureError where events are exchanged in a tree that is not coherent or has too many cut sets.
        """
        implied = [
            assembly.implied(assembly.value(one.hypothesis), one.target is not None and assembly.value(one.target))
            for one in self._declarations
        ]
        model = assembly.model(name, assembly.all_of([whole, *implied]) if implied else whole)
        if not self._exchanges or model.tree is None:
            return model
        return assembly.model(name, assembly.any_set(self._exchanged(self._sets(model))), exchanged=True)

    @staticmethod
    def _sets(model: Model) -> list[frozenset[str]]:
        event = model.structure()
        event.tree.must_be_coherent("has no minimal cut sets in which substitutions could exchange events")
        listed = event.cut_sets(MOST_SETS + 1).sets
        if len(listed) > MOST_SETS:
            raise StructureError(
                f"'{model.name}' has more than {MOST_SETS:,} minimal cut sets, in which substitutions exchange events"
            )
        return [frozenset(one.names) for one in listed]

    def _exchanged(self, sets: Sequence[frozenset[str]]) -> list[list[str]]:
        found: dict[frozenset[str], None] = {}
        for one in sets:
            fitting = [some for some in self._exchanges if any(all_ <= one for all_ in some.hypotheses)]
            away = frozenset().union(*(some.source for some in fitting))
            found[(one - away).union(*(some.target for some in fitting))] = None
        return [sorted(one) for one in found]
