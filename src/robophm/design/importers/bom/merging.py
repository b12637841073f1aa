"""Parts into a level of a design: which component each of them is, and what becomes of it.

A part that was imported says so in its ``source``: the list, the row, the references, and a stamp of what was written.
Where the stamp no longer fits, somebody has edited the part, and it is theirs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from robophm.core.errors import DesignError
from robophm.design.edited_text import EditedText, child, is_alias, plain, scalars
from robophm.design.importers.bom.component import (
    ASSUMED,
    NEEDS,
    RATED_BY,
    Content,
    Wanted,
    content,
    differ,
    hazard_line,
    hazard_text,
    line,
    lines,
    origin,
    rate_text,
    short,
    stamp,
)
from robophm.design.importers.bom.models import Rating
from robophm.design.importers.bom.references import compressed
from robophm.design.naming import quoted
from robophm.hazard.qualities import UNKNOWN

State = Literal["added", "changed", "unchanged", "kept", "removed", "needs a rate"]

_REMARK = "# import-bom: "
HOW_TO_STATE = "commercial, known pedigree or military, once somebody knows"


@dataclass(frozen=True)
class Outcome:
    """The result for one part: its name in the design, and the remark on it."""

    state: State
    name: str
    text: str = ""


@dataclass
class Merged:
    """A design with the parts of a list in it."""

    text: str
    outcomes: list[Outcome]
    """Outcomes of the wanted parts, in their order."""
    removed: list[Outcome] = field(default_factory=list)
    """Parts of an earlier import that the list no longer has; kept where somebody edited or drew them."""


@dataclass
class _There:
    """A component that the level has already."""

    name: str
    key: Any
    node: Any
    said: Content
    references: tuple[str, ...] = ()
    file: str = ""
    imported: bool = False
    edited: bool = True


class Level:
    """A level of a design, the robot's own or a module's, that takes parts."""

    def __init__(self, text: str, label: str, module: Sequence[str]) -> None:
        """Open a level in the text of a valid design. Raises DesignError where the level cannot be edited."""
        self.module = module
        self.design = EditedText(text, label)
        self.levels = [self.design.root]
        for name in module:
            modules = child(self.levels[-1], "modules")
            level = child(modules[1], name) if modules else None
            if level is None:
                break
            self.design.own(*level, "module")
            self.levels.append(level[1])

    @property
    def environment(self) -> str | None:
        """Return the environment that the level states or inherits; None where there is none."""
        stated = [found[1] for level in self.levels if (found := child(level, "environment"))]
        return str(plain(stated[-1])) if stated else None

    @property
    def quality(self) -> str | None:
        """Return the quality that the level states or inherits; None where there is none."""
        stated = [found[1] for level in self.levels if (found := child(level, "quality"))]
        return str(plain(stated[-1])) if stated else None

    @property
    def own_quality(self) -> str | None:
        """Return the quality that the level itself states; None where it states none, or is not there yet."""
        found = child(self.levels[-1], "quality") if self.exists else None
        return str(plain(found[1])) if found else None

    @property
    def exists(self) -> bool:
        """Whether the level is in the design already."""
        return len(self.levels) == len(self.module) + 1

    @property
    def rated(self) -> bool:
        """Whether a part of the level, or below it, is rated by a model already."""
        stack = [self.levels[-1]] if self.exists else []
        while stack:
            for key, node in stack.pop().value:
                if key.value == "hazard":
                    return True
                stack += [node] if node.id == "mapping" else []
        return False

    def merge(
        self, parts: Sequence[Wanted], *, file: str, environment: str, quality: str | None, remarks: Iterable[str]
    ) -> Merged:
        """Put parts in. What is given of a whole level is stated where nothing above states it. Raises DesignError."""
        entry = child(self.levels[-1], "components") if self.exists else None
        if entry:
            self.design.own(*entry, "mapping")
        there = self._there(entry[1] if entry else None)
        drawn = self._drawn()
        taken = set(there)
        if self.exists and (modules := child(self.levels[-1], "modules")):
            taken |= {str(key.value) for key, _ in modules[1].value}
        matches = _matches(parts, there)
        result = Merged("", [])
        added: list[tuple[str, Wanted]] = []
        gone: set[str] = set()
        for part, old in zip(parts, matches, strict=True):
            if old is None:
                name = _free(part, taken)
                taken.add(name)
                added.append((name, part))
                result.outcomes.append(Outcome("added", name) if part.rating else _needs(name, part))
            elif part.rating is None and not old.edited and "rate" not in old.said and old.name in drawn:
                text = f"stays as it was, for it stands in a diagram, but {part.needs}"
                result.outcomes.append(Outcome("kept", old.name, text))
            else:
                result.outcomes.append(self._update(old, part, file))
        matched = {old.name for old in matches if old}
        for old in there.values():
            if old.imported and old.name not in matched:
                reason = (
                    "was edited by hand" if old.edited
                    else f"is of another list, {old.file}" if old.file != file
                    else "stands in a diagram" if old.name in drawn
                    else ""
                )  # fmt: skip
                if not reason:
                    gone.add(old.name)
                    result.removed.append(Outcome("removed", old.name))
                else:
                    result.removed.append(Outcome("kept", old.name, f"is not in the list, and stays: it {reason}"))
        for name in gone:
            self.design.delete(there[name].key, there[name].node)
        others = set(there) - gone - {one.name for one in result.outcomes if one.state == "needs a rate"}
        if not others and not any(part.rating for _, part in added):
            needing = [one for one in result.outcomes if one.state == "needs a rate"]
            why = f", e.g. {needing[0].name}: {needing[0].text}" if needing else ""
            raise DesignError(f"{self.design.label}: no part of {file} has a rate{why}; and no other part is there")
        head = [f"environment: {quoted(environment)}"] if self.environment is None else []
        if quality and self.quality is None:
            head.append(f"quality: {quoted(quality)}{f'  # {HOW_TO_STATE}' if quality == UNKNOWN else ''}")
        elif quality and quality != self.quality:
            self.design.replace(self.levels[-1], "quality", f"quality: {quoted(quality)}", f"  # {HOW_TO_STATE}")
        head += [_REMARK + remark for remark in remarks]
        if entry and (entry[1].value or not entry[1].flow_style):
            self._into(entry, head, added, file)
        else:
            self._make(entry, head, added, file)
        result.text = self.design.applied()
        return result

    # -- what is there

    def _there(self, components: Any) -> dict[str, _There]:
        found = {}
        for key, node in components.value if components is not None else ():
            one = _There(str(key.value), key, node, {})
            found[one.name] = one
            if node.id != "mapping" or is_alias(key, node):
                continue
            one.said = plain(node)
            if source := origin(one.said.get("source")):
                one.imported, one.file, one.references = True, source.file, source.references
                one.edited = stamp(one.said) != source.stamp or bool(node.flow_style)
        return found

    def _drawn(self) -> set[str]:
        """Every name that a diagram or function may mean, by its last step."""
        names: set[str] = set()
        stack = [self.design.root]
        while stack:
            node = stack.pop()
            if node.id != "mapping":
                continue
            for key, value in node.value:
                if key.value in ("diagram", "functions"):
                    names |= set(scalars(value))
                elif key.value == "modules" and value.id == "mapping":
                    stack += [inner for _, inner in value.value]
        return {name.partition("[")[0].rpartition("/")[2] for name in names}

    # -- what becomes of it

    def _update(self, old: _There, part: Wanted, file: str) -> Outcome:
        """Bring an imported part up to the list, or leave one that somebody edited."""
        if old.edited:
            new: Content = content(part, file) if part.rating else {"quantity": part.quantity}
            differing = [
                f"{key} {short(old.said.get(key, 1))}, the list says {short(value)}"
                for key, value in new.items()
                if (key == "quantity" or (key == "hazard" and key in old.said)) and differ(old.said.get(key, 1), value)
            ]  # fmt: skip
            return Outcome("kept", old.name, "; ".join(["edited by hand, stays as it is", *differing]))
        new = content(part, file)
        for key, value in new.items():
            found = child(old.node, key)
            if found and differ(old.said[key], value):
                if key == "hazard" and part.rating:
                    self._update_hazard(old, found, part.rating)
                else:
                    self.design.replace(old.node, key, line(key, value), ASSUMED)
        before = next((key for key in RATED_BY if key in old.said), "rate")
        if before not in new or (part.rating is None and self.design.remarked(old.node, before, NEEDS)):
            there = child(old.node, before)
            pad = " " * there[0].start_mark.column if there else ""
            self.design.replace(old.node, before, rate_text(part, pad), NEEDS if before == "rate" else ASSUMED)
        if part.rating is None:
            return _needs(old.name, part)
        if stamp(old.said) == stamp(new):
            return Outcome("unchanged", old.name)
        changed = [key for key, value in new.items() if key != "source" and differ(old.said.get(key), value)]
        text = ", ".join(f"{key} was {short(old.said.get(key))}" for key in changed)
        if set(old.references) != set(part.references):
            text += f", references were {short(compressed(old.references))}"
        return Outcome("changed", old.name, text)

    def _update_hazard(self, old: _There, found: tuple[Any, Any], rating: Rating) -> None:
        """Input by input where they are the same, so that people's remarks beside them stay."""
        key, hazard = found
        said: dict[str, Any] = old.said["hazard"]
        inputs = child(hazard, "inputs")
        if hazard.flow_style or inputs is None or inputs[1].flow_style or said["inputs"].keys() != rating.inputs.keys():
            text = hazard_text(rating, " " * key.start_mark.column)
            self.design.replace(old.node, "hazard", text, ASSUMED)
            return
        if said["model"] != rating.model:
            self.design.replace(hazard, "model", hazard_line(rating, "model"), ASSUMED)
        for name, text in rating.inputs.items():
            if differ(said["inputs"][name], text):
                self.design.replace(inputs[1], name, hazard_line(rating, name), ASSUMED)

    def _into(self, entry: tuple[Any, Any], head: list[str], body: list[tuple[str, Wanted]], file: str) -> None:
        """Add parts behind those that are there, and say what they rest on."""
        design = self.design
        key, components = entry
        at = design.line_start(key.start_mark.index)
        above = " " * key.start_mark.column
        column = components.value[0][0].start_mark.column if components.value else key.start_mark.column + 2
        pad = " " * column
        design.forget_above(at, above + _REMARK)
        design.forget_lines(at, int(self.levels[-1].end_mark.index), pad + "# ", NEEDS)
        design.insert(at, "".join(f"{above}{text}\n" for text in head))
        behind = design.end(components) if components.value else key.end_mark.index
        design.insert(design.line_end(behind), "".join(_all_lines(body, file, pad)))

    def _make(self, entry: tuple[Any, Any] | None, head: list[str], body: list[tuple[str, Wanted]], file: str) -> None:
        """Make the components of a level, and the level where it is not there."""
        design, level = self.design, self.levels[-1]
        if entry:  # components: {}
            design.delete(*entry)
        pad = " " * (level.value[0][0].start_mark.column if level.value else 0)
        at = design.past_comments(design.line_end(design.end(level)), len(pad))
        text = []
        missing = self.module[len(self.levels) - 1 :]
        if missing and (modules := child(level, "modules")) and modules[1].value:
            design.own(*modules, "mapping")
            pad = " " * modules[1].value[0][0].start_mark.column
            at = design.past_comments(design.line_end(design.end(modules[1])), len(pad))
        elif missing:
            text.append(f"{pad}modules:\n")
            pad += "  "
        for depth, name in enumerate(missing):
            text.append(f"{pad}{quoted(name)}:\n")
            pad += "  "
            if depth + 1 < len(missing):
                text.append(f"{pad}modules:\n")
                pad += "  "
        text += [f"{pad}{one}\n" for one in [*head, "components:"]]
        text += _all_lines(body, file, pad + "  ")
        design.insert(at, "".join(text))


def _needs(name: str, part: Wanted) -> Outcome:
    return Outcome("needs a rate", name, part.needs)


def _all_lines(parts: Iterable[tuple[str, Wanted]], file: str, pad: str) -> Iterator[str]:
    for name, part in parts:
        yield from lines(name, part, file, pad)


def _matches(parts: Sequence[Wanted], there: Mapping[str, _There]) -> list[_There | None]:
    """The component that each part is: the one with most of its references, else the one of its name."""
    owner = {reference: one for one in there.values() for reference in one.references}
    claimed: set[str] = set()
    found: list[_There | None] = []
    for part in parts:
        votes = Counter(one.name for reference in part.references if (one := owner.get(reference)))
        names = [name for name, _ in votes.most_common()]
        named = there.get(part.name)
        if named and not (named.references and part.references):
            names.append(part.name)
        chosen = next((name for name in names if name not in claimed), None)
        if chosen is not None:
            claimed.add(chosen)
        found.append(there[chosen] if chosen is not None else None)
    return found


def _free(part: Wanted, taken: set[str]) -> str:
    name, more = part.name, 1
    while name in taken:
        name = f"{part.name} (row {part.row}, {more})" if more > 1 else f"{part.name} (row {part.row})"
        more += 1
    return name
