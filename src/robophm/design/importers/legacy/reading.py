"""The 2020 tool's file (phm_configurations_*.yaml, last_configurations.yaml) → a design; what is odd in it is said.

That file nests System > module > sub-module > component as mappings in which names stand among keys. Groups (s1, p1 …)
wire the members of a level; its "Final Configuration" names the group, or the one member, that counts.
"""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NoReturn

from robophm.core.errors import DesignError
from robophm.core.yaml_values import Lines, values
from robophm.design.file import parse, read
from robophm.design.importers.legacy.blocks import Block, Drawing, Finding, Group, rename, several
from robophm.design.importers.legacy.writing import design_lines
from robophm.design.naming import design_name, printable
from robophm.design.robot import Robot

MAX_CHARACTERS = 500_000
"""The most characters of such a file; its own example has 13,000."""

MAX_NESTING = 40
"""The deepest nesting of groups within groups."""

MAX_DRAWN = 100_000
"""Blocks in all diagrams together: groups that share groups can unfold to billions."""

HIGHEST_RATE = 1e6
"""The highest rate that is accepted [1/h]."""

_LEVEL_KEYS = frozenset({"Configurations", "Failure Rate", "Final Configuration", "Reliability"})
_COMPONENT_KEYS = frozenset({"Elements", "Failure Rate", "Final Configuration", "Formula"})
_GROUP_KEYS = frozenset({"Configuration Count", "Depth Level"})
_RESERVED = _LEVEL_KEYS | _COMPONENT_KEYS | _GROUP_KEYS
_KINDS = ("the system", "a module", "a sub-module", "a component")


@dataclass(frozen=True)
class LegacyFigure:
    """The 2020 tool's failure rate of the system (empty path) or of a module, by its path in the design [1/h]."""

    path: str
    stored: float | None
    """Failure rate as the file states it; None where it states none."""
    recomputed: float
    """Rolled up from the components' rates by that tool's rules, double use and redundancy as it counts them."""


@dataclass(frozen=True)
class Imported:
    """A design made of a file of the 2020 tool."""

    text: str
    """The text of the design file."""
    findings: tuple[Finding, ...]
    figures: tuple[LegacyFigure, ...]
    robot: Robot
    """The robot that the text describes."""


def import_legacy(path: str | os.PathLike[str]) -> Imported:
    """Make a design of a file of the 2020 tool. Formulas in it are not evaluated: their results are there.

    Raises DesignError, one line with file and line, for what is no such file, and for a rate that is none.
    """
    path = Path(path)
    root, lines = _document(path)
    if not isinstance(root, dict) or "System" not in root:
        found = f"; it has {several(list(root))}" if isinstance(root, dict) else ""
        raise DesignError(f"{path}: has no 'System'; expected a file that the 2020 tool saved{found}")
    reader = _Reader(str(path), lines)
    system = reader.level(("System",), root["System"], 0)
    for key in sorted(root.keys() - {"System"}):
        system.note("ignored", f"the file's '{key}' is not the system")
    if system.drawing is None:
        raise DesignError(f"{path}: holds no part with a rate that counts; expected at least one")
    system.name = design_name(path.stem)
    text = "\n".join(design_lines(system, printable(path.name))) + "\n"
    figures = [LegacyFigure("", system.stored, system.rolled_up)]
    figures += [LegacyFigure(module.name, module.stored, module.rolled_up) for module in system.members.values()]
    return Imported(text, tuple(system.all_findings()), tuple(figures), parse(text, f"{path}, as a design"))


def _document(path: Path) -> tuple[Any, Lines]:
    """The plain values of a file, and their lines; refused where it is too large, too deep, or has aliases."""
    text = read(path)
    if len(text) > MAX_CHARACTERS:
        raise DesignError(f"{path}: has more than {MAX_CHARACTERS:,} characters; expected a file of the 2020 tool")
    if "*" in text:
        from ruamel.yaml import YAML
        from ruamel.yaml.error import YAMLError
        from ruamel.yaml.events import AliasEvent

        with suppress(YAMLError, ValueError):  # which the values say better
            for event in YAML(typ="safe", pure=True).parse(text):
                if isinstance(event, AliasEvent):
                    line = event.start_mark.line + 1
                    raise DesignError(f"{path}:{line}: alias '*{event.anchor}' is not taken; expected plain values")
    return values(text, str(path))


class _Reader:
    """Makes blocks of the values of a file."""

    def __init__(self, file: str, lines: Lines) -> None:
        self.file = file
        self.lines = lines
        self.drawn = 0

    def fail(self, place: tuple[str, ...], message: str) -> NoReturn:
        known = next(place[:n] for n in range(len(place), -1, -1) if place[:n] in self.lines)
        raise DesignError(f"{self.file}:{self.lines[known]}: {'/'.join(place)}: {message}")

    def level(self, place: tuple[str, ...], value: object, depth: int) -> Block:
        """The block that a mapping of the file describes, with all blocks below it."""
        data = self.mapping(place, value, f"{_KINDS[depth]} with its 'Failure Rate'")
        for key in sorted(data.keys() & _RESERVED) if depth < 3 else ():
            if isinstance(data[key], dict) and data[key].keys() & (_LEVEL_KEYS | _COMPONENT_KEYS):
                self.fail(
                    (*place, key), f"a part named '{key}', which is a key of the 2020 tool; expected another name"
                )
        block = Block("/".join(printable(step) for step in place[1:]) or "System", self.lines[place], "")
        block.stored = self.rate((*place, "Failure Rate"), data.get("Failure Rate"))
        names = [key for key in data if key not in _RESERVED]
        if depth == 3:
            block.formula = printable(str(data.get("Formula") or ""))
            for name in names:
                block.note("ignored", f"'{name}' is below a component", self.lines[(*place, name)])
        else:
            block.members = {name: self.level((*place, name), data[name], depth + 1) for name in names}
            rename(block.members)
            self.wire(block, place, data)
        if not block.members:
            block.rolled_up = block.stored or 0.0
        without = "no part with a rate that counts" if block.members else "no rate"
        if depth and not block.fails:
            said = without if block.members or block.stored is None else "the rate 0"
            block.note("no rate", f"has {said}; left out: a part that never fails is none, so state its rate")
        elif depth and block.members and block.drawing is None:
            block.note("no rate", f"has {without}; it is drawn as one part with its own rate")
        return block

    def mapping(self, place: tuple[str, ...], value: object, expected: str) -> Mapping[str, Any]:
        if not isinstance(value, dict):
            self.fail(place, f"{value!r:.60} is not {expected}; expected a mapping")
        return value

    def rate(self, place: tuple[str, ...], value: object) -> float | None:
        """A failure rate [1/h]; None where that tool has none."""
        if isinstance(value, dict):
            place, value = (*place, "Nominal"), value.get("Nominal")
        if value in (None, "", "None"):
            return None
        number = math.nan
        if isinstance(value, str | int | float) and not isinstance(value, bool):
            with suppress(ValueError, OverflowError):
                number = float(value)
        if not 0 <= number <= HIGHEST_RATE:
            self.fail(place, f"{value!r:.60} is not a rate per hour; expected a number from 0 to {HIGHEST_RATE:g}")
        return number

    def groups(self, place: tuple[str, ...], value: object) -> dict[str, Group]:
        """The groups of a level by name."""
        groups = {}
        for name, given in self.mapping(place, value or {}, "the groups of a level").items():
            if name in _GROUP_KEYS:
                continue
            at = (*place, name)
            data = self.mapping(at, given, "a group with its 'Components'")
            kind, items = data.get("Type"), data.get("Components")
            if kind not in ("Serial", "Parallel"):
                self.fail((*at, "Type"), f"{kind!r:.60} is no type of group; expected Serial or Parallel")
            if not isinstance(items, list) or any(isinstance(item, dict | list) for item in items):
                self.fail((*at, "Components"), "expected a list of names")
            rate = self.rate((*at, "Failure Rate"), data.get("Failure Rate"))
            groups[name] = Group(name, kind == "Serial", [str(item) for item in items], rate, self.lines[at])
        return groups

    def wire(self, block: Block, place: tuple[str, ...], data: Mapping[str, Any]) -> None:
        """Draw a level as its file says, and compare the rates that it says."""
        groups = self.groups((*place, "Configurations"), data.get("Configurations"))
        wiring = _Wiring(self, place, block, groups)
        final = data.get("Final Configuration") or ""
        if isinstance(final, dict | list):
            self.fail((*place, "Final Configuration"), "expected the name of a group or member")
        chosen = str(final)
        rates = {name: wiring.rolled_up(name) for name in groups}
        wiring.check()
        within = {item for group in groups.values() for item in group.items}
        outermost = [name for name in groups if name not in within]
        counts = chosen in groups or chosen in block.members
        if counts:
            others = [name for name in outermost if name != chosen]
            if others:
                block.note("candidates", f"{chosen} counts and is drawn; {several(others)} could be what counts too")
            block.rolled_up = rates[chosen] if chosen in groups else block.members[chosen].rolled_up
            self.compare(block, chosen, groups)
        else:
            block.rolled_up = block.stored or 0.0
            if chosen:
                block.note("unknown name", f"'{chosen}' is to count, and there is none")
            chosen = outermost[0] if len(outermost) == 1 else ""
            drawn = f"{chosen}, its only outermost group, is drawn" if chosen else "all its members are drawn in series"
            said = f"so the 2020 tool counts {block.rolled_up:g} /h"
            if len(outermost) > 1:
                block.note("candidates", f"none of {several(outermost)} is chosen, {said}; {drawn}")
            elif block.members:
                block.note("not wired", f"nothing in it is chosen, {said}; {drawn}")
        wiring.draw(chosen)

    def compare(self, block: Block, chosen: str, groups: Mapping[str, Group]) -> None:
        """Say where a rate in the file is not what its rates below give."""
        stored = {name: member.stored for name, member in block.members.items()}
        stored |= {name: group.stored for name, group in groups.items()}
        for group in groups.values():
            rates = [rate for item in group.items if (rate := stored.get(item)) is not None]
            self.differ(block, group.name, group.stored, group.roll_up(rates), group.line)
        self.differ(block, "it", block.stored, stored[chosen], block.line)

    def differ(self, block: Block, what: str, said: float | None, below: float | None, line: int) -> None:
        if said is not None and below is not None and not math.isclose(said, below, rel_tol=1e-9):
            block.note("other rate", f"{what} has {said:g} /h in the file, what is below it gives {below:g} /h", line)


class _Wiring:
    """The groups of one level."""

    def __init__(self, reader: _Reader, place: tuple[str, ...], block: Block, groups: Mapping[str, Group]) -> None:
        self.reader = reader
        self.place = place
        self.block = block
        self.groups = groups
        self.rates: dict[str, float] = {}
        self.depths: Counter[str] = Counter()
        self.uses: Counter[str] = Counter()
        self.lost: dict[tuple[str, str], int] = {}
        self.under_way: list[str] = []

    def check(self) -> None:
        """Say which names are odd."""
        block, members, groups = self.block, self.block.members, self.groups
        for group in groups.values():
            counts = Counter(group.items)
            known = [name for name in counts if name in groups or name in members]
            unknown = counts.keys() - set(known)
            if unknown:
                block.note("unknown name", f"{group.name} names {several(sorted(unknown))}, left out here", group.line)
            doubled = [name for name in known if counts[name] > 1]
            if doubled:
                often = group.roll_up([self.rolled_up(name) for name in counts.elements() if name not in unknown])
                once = group.roll_up(map(self.rolled_up, known))
                text = f"{group.name} names {several(doubled)} more than once; it is one part, drawn once"
                said = f"the 2020 tool makes {often:.5g} /h of it instead of {once:.5g} /h"
                block.note("double use", f"{text}, but {said}", group.line)
        for name in sorted(groups.keys() & members.keys()):
            block.note("ignored", f"{name} is a group and a member; the group is meant, as in the 2020 tool")

    def rolled_up(self, name: str) -> float:
        """Return that tool's rate of a group or member, from the components up. Raises DesignError for a circle."""
        if name not in self.groups:
            return self.block.members[name].rolled_up
        if name in self.under_way:
            circle = " → ".join([*self.under_way[self.under_way.index(name) :], name])
            self.reader.fail((*self.place, "Configurations", name), f"cycle: {circle} contains itself")
        if name not in self.rates:
            group = self.groups[name]
            self.under_way.append(name)
            known = [item for item in group.items if item in self.groups or item in self.block.members]
            if len(self.under_way) <= MAX_NESTING:
                self.rates[name] = group.roll_up([self.rolled_up(item) for item in known])
                self.depths[name] = 1 + max((self.depths[item] for item in known), default=0)
            if self.depths[name] > MAX_NESTING or len(self.under_way) > MAX_NESTING:
                self.reader.fail((*self.place, "Configurations", name), f"is nested more than {MAX_NESTING} deep")
            self.under_way.pop()
        return self.rates[name]

    def draw(self, chosen: str) -> None:
        """Draw what counts, or all in series where nothing is chosen."""
        block = self.block
        if chosen:
            used = self.used(chosen, set())
            for name, member in block.members.items():
                if name not in used or name in self.groups:
                    member.note("unused", f"is not in {chosen}, which is drawn; its failures count for nothing")
            drawing = self.drawing(chosen)
            block.drawing = Drawing("series", [drawing]) if isinstance(drawing, str) else drawing
            group = self.groups.get(chosen)
            block.drawn_from = f"{chosen}, line {group.line}" if group else f"{chosen} alone"
        else:
            parts: list[str | Drawing] = [name for name, member in block.members.items() if member.fails]
            block.drawing = Drawing("series", parts) if parts else None
        for (name, item), line in self.lost.items():
            block.note("no rate", f"{name}: '{item}' has no rate; left out, and with it the redundancy it gave", line)
        for name, count in self.uses.items():
            if count > 1:
                text = f"'{name}' stands in {count} places of {chosen}; it is one part in all"
                block.note("double use", f"{text}, the 2020 tool counts it {count} times")

    def used(self, name: str, found: set[str]) -> set[str]:
        """The names that a group reaches."""
        if name not in found:
            found.add(name)
            for item in self.groups[name].items if name in self.groups else ():
                self.used(item, found)
        return found

    def drawing(self, name: str) -> str | Drawing | None:
        """A group or member without what has no rate; series within series are one."""
        self.reader.drawn += 1
        if self.reader.drawn > MAX_DRAWN:
            self.reader.fail((*self.place, "Configurations"), f"unfolds to more than {MAX_DRAWN:,} blocks")
        group = self.groups.get(name)
        if group is None:
            if name not in self.block.members or not self.block.members[name].fails:
                return None
            self.uses[name] += 1
            return name
        blocks: list[str | Drawing] = []
        drawn: set[str] = set()
        for item in dict.fromkeys(group.items):
            inner = self.drawing(item)
            if inner is None:
                if not group.serial and (item in self.groups or item in self.block.members):
                    self.lost[name, item] = group.line
                continue
            merged = inner.blocks if group.serial and isinstance(inner, Drawing) and inner.kind == "series" else [inner]
            blocks += [block for block in merged if not isinstance(block, str) or block not in drawn]
            drawn.update(block for block in merged if isinstance(block, str))
        return _joined("series" if group.serial else "parallel", blocks)


def _joined(kind: Literal["series", "parallel"], blocks: list[str | Drawing]) -> str | Drawing | None:
    return Drawing(kind, blocks) if len(blocks) > 1 else blocks[0] if blocks else None
