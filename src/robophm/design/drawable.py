"""The robot of a design that is no valid one yet, for its drawing: what is wrong is left out, and said at its block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

from robophm.core.yaml_values import Lines
from robophm.design.located_error import Path
from robophm.design.problems import Problem, built
from robophm.design.robot import UNKNOWN, Robot

MOST_ROUNDS = 20
"""Times that a design is built without what was wrong the time before; then as often with the names of its parts."""

NAMELESS = "robot"
"""Name under which a robot without a name is drawn."""

_KINDS = ("modules", "components")
_OF_A_BOX = ("quantity", "required", "depends_on")  # keys of a component that its box shows
_IN_A_GROUP = "1 /h"  # of a part in a group, which cannot be of unknown rate; no figure is shown for it


@dataclass(frozen=True)
class Drawable:
    """A robot to be drawn, and what of it is not as the design says."""

    robot: Robot
    wrong: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """Mistakes by the path of the part or level that they are of; "" is the robot."""
    unwired: frozenset[str] = frozenset()
    """Paths of levels whose diagram is wrong: how their parts work together is not known."""
    empty: frozenset[str] = frozenset()
    """Paths of levels without a part, in which one stands that is not to be drawn."""
    problems: Sequence[Problem] = ()
    """The mistakes at their places in the document, as they were found."""

    def mistakes(self, path: str) -> list[str]:
        """Return what is wrong with a part or level, and with what is in it, what is its own first."""
        below = f"{path}/" if path else ""
        own = self.wrong.get(path, ())
        return [
            *own,
            *chain.from_iterable(said for at, said in self.wrong.items() if at != path and at.startswith(below)),
        ]


def drawable(document: Mapping[str, Any], lines: Lines) -> Drawable | None:
    """Return the robot of a document, what is wrong left out, to be drawn; None where there is nothing to draw."""
    draft = _Draft(deepcopy(dict(document)))
    for n in range(2 * MOST_ROUNDS if document else 0):
        robot, wrong = built(draft.document, lines)
        if robot:
            return Drawable(robot, draft.wrong, frozenset(draft.unwired), frozenset(draft.empty), draft.problems)
        if not draft.without(wrong) or n == MOST_ROUNDS:
            draft.strip(draft.document, "")
    return None


class _Draft:
    """A document that becomes a design by leaving out what is wrong in it."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document
        self.wrong: dict[str, list[str]] = {}
        self.unwired: set[str] = set()
        self.empty: set[str] = set()
        self.problems: list[Problem] = []
        self.round: set[str] = set()  # parts that were changed in this round

    def without(self, wrong: Sequence[Problem]) -> bool:
        """Leave out what is wrong; whether that was possible."""
        self.round = set()
        changed = [self._left_out(one) for one in wrong]
        return any(changed)

    def _left_out(self, problem: Problem) -> bool:
        level, place = self.document, problem.place
        path, above, name, parts = "", "", "", dict[str, Any]()
        while len(place) > 1 and place[0] in _KINDS and place[1] in (found := _mapping(level, place[0])):
            parts, name, above, path = found, place[1], path, _below(path, place[1])
            if place[0] == "components":
                done = self._without_in_part(parts, name, path, place[2:], problem)
                break
            level = parts[name] = parts[name] if isinstance(parts[name], dict) else {}
            place = place[2:]
        else:
            done = self._without_in_level(level, path, place, problem)
        if not done and name:  # nothing in it, but itself, by its name
            self._say(above, problem)
            self.wrong.pop(path, None)
            del parts[name]
        return done or bool(name)

    def _say(self, path: str, problem: Problem) -> None:
        if problem.message not in (said := self.wrong.setdefault(path, [])):
            said.append(problem.message)
        if problem not in self.problems:
            self.problems.append(problem)

    def _without_in_part(self, parts: dict[str, Any], name: str, path: str, rest: Path, problem: Problem) -> bool:
        stated = parts[name] if isinstance(parts[name], dict) else {}
        if rest[:1] == ("depends_on",) and rest[0] in stated:
            self._say(path, problem)
            del stated["depends_on"]
            return True
        kept = {key: value for key, value in stated.items() if key in _OF_A_BOX and key not in rest}
        bare = {**kept, "rate": stated["rate"] if stated.get("rate") == _IN_A_GROUP else UNKNOWN}
        if bare != parts[name]:
            self._say(path, problem)
            parts[name] = bare
            self.round.add(path)
        elif path in self.round:
            self._say(path, problem)
        elif rest[:1] == ("rate",):
            parts[name] = {**kept, "rate": _IN_A_GROUP}
        else:
            return False
        return True

    def _without_in_level(self, level: dict[str, Any], path: str, rest: Path, problem: Problem) -> bool:
        key = rest[0] if rest else ""
        name = self._unknown_part(level, rest) if key == "diagram" else ""
        self._say(_below(path, name) if name else path, problem)
        if not key and not any(level.get(kind) for kind in _KINDS):
            level["components"] = {"none": {"rate": UNKNOWN}}
            self.empty.add(path)
        elif name:
            level["components"] = {**(level.get("components") or {}), name: {"rate": UNKNOWN}}
        elif not path and key in ("name", "schema_version"):
            level[key] = NAMELESS if key == "name" else 1
        elif key in level:
            del level[key]
            self.unwired |= {path} if key == "diagram" else set()
        else:
            return False
        return True

    @staticmethod
    def _unknown_part(level: dict[str, Any], place: Path) -> str:
        """The name at a place of a diagram where it is one that a part of this level could have, but none has."""
        here: Any = level
        for step in place:
            here = here[int(step)] if isinstance(here, list) else here.get(step) if isinstance(here, dict) else None
        there = [name for kind in _KINDS for name in _mapping(level, kind)]
        return here if isinstance(here, str) and here not in there and not set("/[]") & set(here) else ""

    def strip(self, level: dict[str, Any], path: str) -> None:
        """Leave of a level, and those in it, the names of its parts alone."""
        self.unwired.add(path)
        parts = {kind: _mapping(level, kind) for kind in _KINDS}
        named = {} if path else {"schema_version": 1, "name": level.get("name", NAMELESS)}
        level.clear()
        level.update(named)
        for kind, found in parts.items():
            level[kind] = {name: {} if kind == "modules" else {"rate": UNKNOWN} for name in found}
            for name, inner in found.items() if kind == "modules" else ():
                if isinstance(inner, dict):
                    level[kind][name] = inner
                    self.strip(inner, _below(path, name))


def _mapping(level: dict[str, Any], key: str) -> dict[str, Any]:
    found = level.get(key)
    return found if isinstance(found, dict) else {}


def _below(path: str, name: str) -> str:
    return f"{path}/{name}" if path else name
