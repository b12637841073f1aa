"""A later draft into a design that people have worked on: it changes only what nobody touched.

A component that a draft wrote carries a stamp of what it said; where that fits no longer, somebody edited it. A key of
the robot carries the like behind it. A drafted part that is gone was taken out by somebody, and stays out.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from robophm.core.errors import DesignError
from robophm.design.draft import DraftPart, drafted, module_lines, part_lines, stamp, untouched
from robophm.design.edited_text import EditedText, child, plain, scalars
from robophm.drafting.answers import Known
from robophm.drafting.drafting import ANSWERED, DRAFTED, EVIDENCE, Draft, with_list

State = Literal["added", "changed", "unchanged", "kept", "removed"]

_HEAD = re.compile(rf"^# ({'|'.join(map(re.escape, (ANSWERED, DRAFTED, EVIDENCE)))})(.*)$", re.MULTILINE)


@dataclass(frozen=True)
class Outcome:
    """The outcome of an update for one part or key of the design."""

    state: State
    name: str
    text: str = ""


@dataclass(frozen=True)
class Updated:
    """A design after a later draft."""

    text: str
    outcomes: tuple[Outcome, ...]


def earlier_answers(text: str) -> dict[str, Any]:
    """Answers that a drafted design keeps in its head; {} where there are none. Raises DesignError for garbled ones."""
    return dict(_told(text, ANSWERED, {}))


def evidence_left_out(text: str, known: Known) -> dict[str, list[str]]:
    """Return the files that a design was drafted of, by what they are, where nothing of the kind is known now.

    A later draft without them would take out what they told of: joints and their parts, signals, what was driven.
    Raises DesignError for a garbled head.
    """
    return {what: list(map(str, names)) for what, names in _told(text, EVIDENCE, {}).items() if what not in known.files}


def was_drafted(text: str) -> bool:
    """Whether a design is of a draft, which a later one can bring up to date."""
    return any(found[1] == DRAFTED for found in _HEAD.finditer(text))


def updated(text: str, draft: Draft, label: str) -> Updated:
    """The text of a design brought up to a later draft; ``label`` is what errors call it. Raises DesignError.

    Parts of lists are brought up as ``robophm import-bom`` does, which leaves what people wrote.
    """
    found = _Update(text, draft, label).made()
    now, outcomes = found.text, [*found.outcomes]
    for module, source in draft.lists.items():
        before = now
        now, said = with_list(now, source, module)
        outcomes.append(Outcome("unchanged" if now == before else "changed", module, said if now != before else ""))
    return Updated(now, tuple(outcomes))


def _told(text: str, key: str, nothing: Any) -> Any:
    for found in _HEAD.finditer(text):
        if found[1] == key:
            try:
                told = json.loads(found[2])
            except ValueError:
                told = None
            if type(told) is not type(nothing):
                line = text.count("\n", 0, found.start()) + 1
                raise DesignError(f"design:{line}: '# {key}' is no JSON that a draft wrote; take the line out")
            return told
    return nothing


class _Update:
    def __init__(self, text: str, draft: Draft, label: str) -> None:
        self.design, self.draft = EditedText(text, label), draft
        self.text, self.label = self.design.text, label
        self.outcomes: list[Outcome] = []

    def made(self) -> Updated:
        new = EditedText(self.draft.text, "the draft")
        self._head()
        self._keys(new)
        self._parts()
        return Updated(self.design.applied(), tuple(self.outcomes))

    def _head(self) -> None:
        """What was answered, and what was drafted, as of now."""
        now = {found[1]: found[0] for found in _HEAD.finditer(self.draft.text)}
        for found in _HEAD.finditer(self.text):
            self.design.edits.append((found.start(), found.end(), now.pop(found[1], found[0])))
        self.design.insert(0, "".join(f"{line}\n" for line in now.values()))

    def _keys(self, new: EditedText) -> None:
        """The keys of the robot that a draft states."""
        for key, node in new.root.value:
            name = str(key.value)
            if name in ("schema_version", "name", "modules"):
                continue
            here, said = child(self.design.root, name), plain(node)
            if here is None:
                at = self.design.line_start(child(self.design.root, "modules")[0].start_mark.index)  # type: ignore[index]
                self.design.insert(at, self._lines(new, key, node))
                self.outcomes.append(Outcome("added", name))
            elif plain(here[1]) == said:
                continue
            elif self._as_drafted(here[1]):
                end = self.design.line_end(self.design.end(here[1]))
                start = self.design.line_start(here[0].start_mark.index)
                self.design.edits.append((start, end, self._lines(new, key, node)))
                self.outcomes.append(Outcome("changed", name))
            else:
                self.outcomes.append(Outcome("kept", name, "was edited by hand"))

    def _as_drafted(self, node: Any) -> bool:
        end = self.design.end(node)
        behind = self.text[end : self.design.line_end(end)]
        found = re.search(r"# drafted ([0-9a-f]{8})", behind)
        return found is not None and found[1] == stamp({"value": plain(node)})

    def _lines(self, new: EditedText, key: Any, node: Any) -> str:
        return new.text[new.line_start(key.start_mark.index) : new.line_end(new.end(node))]

    # -- parts

    def _parts(self) -> None:
        there = dict(self._there())
        known = set(_told(self.text, DRAFTED, []))
        named = self._named()
        wanted = {one.path: one for one in self.draft.parts}
        added: dict[str, list[DraftPart]] = {}
        for path, one in wanted.items():
            if path in there:
                self._bring_up(path, *there[path], one)
            elif path in known:
                self.outcomes.append(Outcome("kept", path, "was taken out by hand, stays out"))
            else:
                added.setdefault(one.module, []).append(one)
                self.outcomes.append(Outcome("added", path))
        gone: dict[str, list[str]] = {}
        for path, (_, _, said) in there.items():
            if path in wanted or not drafted(said):
                continue
            steps = path.split("/")
            drawn = named & {steps[-1], *("/".join(steps[:n]) for n in range(1, len(steps) + 1))}
            reason = "edited by hand" if not untouched(said) else "named in a diagram" if drawn else ""
            if reason:
                self.outcomes.append(Outcome("kept", path, f"is in this draft no longer, and stays: {reason}"))
            else:
                gone.setdefault(path.rpartition("/")[0], []).append(path)
                self.outcomes.append(Outcome("removed", path))
        self._take_out(gone, there, added)
        self._add(added)

    def _take_out(
        self, gone: Mapping[str, list[str]], there: Mapping[str, tuple[Any, Any, Any]], added: Mapping[str, Any]
    ) -> None:
        """Parts, and a module of which nothing else is left."""
        modules = child(self.design.root, "modules")
        for module, paths in gone.items():
            level = child(modules[1], module) if modules else None
            others = [path for path in there if path.rpartition("/")[0] == module and path not in paths]
            if level and not others and module not in added and len(level[1].value) == 1:
                self.design.delete(*level)
                continue
            for path in paths:
                self.design.delete(*there[path][:2])

    def _there(self) -> Iterator[tuple[str, tuple[Any, Any, Mapping[str, Any]]]]:
        """Components by their paths: key, value and what it says."""
        stack = [("", self.design.root)]
        while stack:
            above, level = stack.pop()
            for kind, node in level.value if level.id == "mapping" else ():
                if kind.value not in ("components", "modules") or node.id != "mapping":
                    continue
                for key, inner in node.value:
                    path = f"{above}{key.value}"
                    if kind.value == "modules":
                        stack.append((f"{path}/", inner))
                    elif inner.id == "mapping":
                        yield path, (key, inner, plain(inner))

    def _named(self) -> set[str]:
        """What diagrams, functions and dependences name."""
        names: set[str] = set()
        stack = [self.design.root]
        while stack:
            node = stack.pop()
            for key, value in node.value if node.id == "mapping" else ():
                if key.value in ("diagram", "functions", "depends_on", "common_causes"):
                    names |= {str(one).partition("[")[0].lstrip("/") for one in scalars(value)}
                else:
                    stack.append(value)
        return names

    def _bring_up(self, path: str, key: Any, node: Any, said: Mapping[str, Any], one: DraftPart) -> None:
        if not untouched(said):
            self.outcomes.append(Outcome("kept", path, "edited by hand, stays as it is"))
        elif stamp(said) == stamp(one.content()) and said.get("description") == one.content()["description"]:
            self.outcomes.append(Outcome("unchanged", path))
        else:
            start, end = self.design.line_start(key.start_mark.index), self.design.line_end(self.design.end(node))
            pad = " " * key.start_mark.column
            self.design.edits.append((start, end, "".join(f"{line}\n" for line in part_lines(one, pad))))
            self.outcomes.append(Outcome("changed", path))

    def _add(self, added: Mapping[str, list[DraftPart]]) -> None:
        modules = child(self.design.root, "modules")
        there = {str(key.value) for key, _ in modules[1].value} if modules else set()
        for module, parts in sorted(added.items(), key=lambda one: one[0] not in there):  # a new module goes last
            level = child(modules[1], module) if modules else None
            components = child(level[1], "components") if level else None
            if components and components[1].value and not components[1].flow_style:
                pad = " " * components[1].value[0][0].start_mark.column
                lines: Iterable[str] = (line for one in parts for line in part_lines(one, pad))
                at = self.design.line_end(self.design.end(components[1]))
            elif modules and level is None:
                lines, at = module_lines(module, parts), self.design.line_end(self.design.end(modules[1]))
            else:
                expected = f"expected 'modules' with '{module}' line by line"
                raise DesignError(f"{self.label}: cannot put {parts[0].path} in; {expected}")
            self.design.insert(at, "".join(f"{line}\n" for line in lines))
