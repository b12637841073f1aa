"""The definitions of an Open-PSA model, and the questions that it asks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from robophm.core.errors import DesignError, nearest
from robophm.core.markup import Element
from robophm.design.importers.open_psa.alignments import Phase, phases
from robophm.design.importers.open_psa.assembly import MEMBER, Assembly, Formula, house_state
from robophm.design.importers.open_psa.common_causes import Group, causes, members
from robophm.design.importers.open_psa.event_trees import EventTrees
from robophm.design.importers.open_psa.expressions import Expressions
from robophm.design.importers.open_psa.files import Files
from robophm.design.importers.open_psa.formulas import references
from robophm.design.importers.open_psa.model import NO_EVENTS, Model
from robophm.design.importers.open_psa.names import Named, Names, name_of
from robophm.design.importers.open_psa.substitutions import Substitutions

_DEFINITIONS = {
    "define-gate": "gate", "define-basic-event": "basic-event", "define-house-event": "house-event",
    "define-parameter": "parameter",
}  # fmt: skip
_GROUP, _TREE = "define-CCF-group", "define-fault-tree"
_MODEL = (
    _TREE, _GROUP, "model-data", "define-event-tree", "define-initiating-event", "define-rule", "define-alignment",
    "define-substitution",
)  # fmt: skip


@dataclass(frozen=True)
class Question:
    """A top event or a sequence in a phase: it occurs where all formulas of any of its ways are true."""

    name: str
    phase: Phase
    ways: tuple[tuple[Formula, ...], ...]
    chance: float | None = None
    """The probability, where expressions say it and no formulas."""
    initiating: str = ""
    """The initiating event of a sequence, and the phase."""
    where: str = ""
    """The line in which it is defined, in words."""


class Definitions:
    """Reads the files of a model at a mission time [h]. Raises DesignError, one line with file and line."""

    def __init__(self, paths: list[Path], time: float | None) -> None:
        self.where = ", ".join(map(str, paths))
        self._files = Files(paths)
        self._time = self._files.time if time is None else time
        self._events, self._parameters = Names(), Names()
        self._groups: list[Group] = []
        self._trees: dict[str, Element] = {}
        self._event_trees = EventTrees()
        self._alignments: list[Element] = []
        self._substituted: list[Element] = []
        for root in self._files.roots:
            for part in self._files.inside(root):
                self._define(part)
        self._phases = list(phases(self._alignments, self._events))
        self._substitutions = Substitutions(self._substituted, self._events)

    def _define(self, part: Element) -> None:
        if part.tag == _TREE:
            first = self._trees.setdefault(name_of(part), part)
            if first is not part:
                raise part.fault(f"'{name_of(part)}' is defined twice; first in line {first.line}")
            self._collect(part, name_of(part), public=_public(part, public=True))
        elif part.tag == "model-data":
            self._collect(part, "", public=True)
        elif part.tag == _GROUP:
            self._group(part, "", public=True)
        elif part.tag == "define-alignment":
            self._alignments.append(part)
        elif part.tag == "define-substitution":
            self._substituted.append(part)
        elif not self._event_trees.define(part):
            raise part.fault(f"'{part.tag}' is not taken{nearest(part.tag, _MODEL)}")

    def _collect(self, whole: Element, base: str, *, public: bool) -> None:
        todo = [(whole, base, public)]
        components: set[str] = set()
        while todo:
            part, within, seen = todo.pop()
            for one in self._files.inside(part):
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
                    table = self._parameters if kind == "parameter" else self._events
                    table.add(one, kind, within, public=_public(one, public=seen))
                else:
                    raise one.fault(f"'{one.tag}' is not taken{nearest(one.tag, _DEFINITIONS)}")

    def _group(self, said: Element, base: str, *, public: bool) -> None:
        if any(name_of(one.said) == name_of(said) for one in self._groups):
            raise said.fault(f"common-cause group '{name_of(said)}' is defined twice")
        names = []
        for one in members(said):
            self._events.add(one, MEMBER, base, public=public)
            names.append(self._events.found(one, base).name)
        self._groups.append(Group(said, tuple(names), base))

    def questions(self, wanted: str | None) -> list[Question]:
        """Return what the model answers: sequences of event trees, then top events, in each phase; or the gate or the
        sequences of the name that is wanted."""
        found = [question for phase in self._phases for question in self._in_phase(phase, wanted)]
        if not found and wanted is not None:
            gates = [one.name for one in self._events if one.kind == "gate"]
            raise DesignError(f"{self.where}: no gate or sequence '{wanted}'{nearest(wanted, gates)}")
        return found

    def check(self) -> None:
        """Raise DesignError for what is wrong in a definition, whoever asks for it.

        Where no mission time is given, expressions are worked out for one hour.
        """
        expressions = Expressions(self._parameters, 1.0 if self._time is None else self._time)
        expressions.check()
        assembly = Assembly(self._events, self._groups, expressions)
        for one in self._events:
            if one.kind == "basic-event" and list(one.said.inside()):
                expressions.probability(one.said, one.base)
            elif one.kind == "house-event":
                house_state(one.said)
            elif one.kind == "gate":
                assembly.value(Formula(one.said, one.base))
        for group in self._groups:
            list(causes(group, expressions))

    def _in_phase(self, phase: Phase, wanted: str | None) -> list[Question]:
        during = f" ({phase.name}, {phase.fraction:g} of the time)" if phase.name else ""
        houses = tuple(sorted(phase.houses.items()))
        sequences = self._event_trees.sequences(self._events, self._expressions(phase), phase.houses)
        found = [
            Question(
                f"{one.initiating}: {one.name}{during}",
                phase,
                tuple(way.formulas for way in one.ways),
                one.chance,
                one.initiating + during,
            )
            for one in sequences
            if wanted in (None, one.name, f"{one.initiating}: {one.name}")
        ]
        gates = self._tops() if wanted is None else [one for one in self._events if one.name == wanted]
        return found + [
            Question(
                one.name + during, phase, ((Formula(one.said, one.base, houses),),), where=f" (line {one.said.line})"
            )
            for one in gates
            if one.kind == "gate"
        ]

    def _expressions(self, phase: Phase) -> Expressions:
        return Expressions(self._parameters, None if self._time is None else self._time * phase.fraction)

    def _tops(self) -> list[Named]:
        """The gates that no other uses; where there are none, the first, which is in a loop."""
        gates = {one.name: one for one in self._events if one.kind == "gate"}
        used = {self._events.found(said, gate.base).name for gate in gates.values() for said in references(gate.said)}
        return [one for name, one in gates.items() if name not in used] or list(gates.values())[:1]

    def model(self, question: Question) -> Model:
        """Return the fault tree of a question, with its probabilities in its phase."""
        expressions = self._expressions(question.phase)
        if question.chance is not None:
            if not 0 <= question.chance <= 1 + 1e-9:
                raise DesignError(
                    f"{self.where}: '{question.name}' has the probability {question.chance:g}; expected 0 … 1"
                )
            decided = min(question.chance, 1.0)
            return Model(
                question.name, None, NO_EVENTS, NO_EVENTS, decided, initiating=question.initiating, time=self._time
            )
        assembly = Assembly(self._events, self._groups, expressions)
        ways = [assembly.all_of([assembly.value(one) for one in formulas]) for formulas in question.ways]
        model = self._substitutions.applied(assembly, question.name, assembly.any_of(ways))
        return replace(model, initiating=question.initiating, time=self._time)


def _public(said: Element, *, public: bool) -> bool:
    """Whether a definition is, which has the role of what it stands in unless it says its own."""
    role = said.attributes.get("role", "public" if public else "private")
    if role not in ("public", "private"):
        raise said.fault(f"role {role!r:.40}; expected public or private")
    return role == "public"
