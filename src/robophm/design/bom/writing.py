"""Parts into the text of a design. What is there stays letter for letter, but for parts that an earlier import wrote.

A part that was imported says so in its ``source``: the list, the row, the references, and a stamp of what was written.
Where the stamp no longer fits, somebody has edited the part, and it is theirs.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from robophm.core.errors import DesignError
from robophm.design.bom.models import Rating
from robophm.design.bom.references import ReferencesError, compressed, expand

LONGEST_NAME = 80
LONGEST_DESCRIPTION = 300

State = Literal["added", "changed", "unchanged", "kept", "removed", "needs a rate"]

Content = dict[str, Any]
"""A component as a design has it."""

_SOURCE = re.compile(
    r"(?P<file>.*), row \d+: (?P<references>[^;\[]*)(?:.*\[import (?P<stamp>[0-9a-f]{8})\])?", re.DOTALL
)
_REMARK = "# import-bom: "
_NEEDS = "  # needs a rate: "


@dataclass(frozen=True)
class Wanted:
    """A part as the list has it."""

    row: int
    name: str
    references: tuple[str, ...]
    quantity: int
    description: str
    rating: Rating | None
    needs: str
    """Why it has no rate."""
    hazard_rate: float | None = None
    """Of one of them [1/h]."""


@dataclass(frozen=True)
class Outcome:
    """What became of a part: its name in the design, and what is to be said of it."""

    state: State
    name: str
    text: str = ""


@dataclass
class Merged:
    """A design with the parts of a list in it."""

    text: str
    outcomes: list[Outcome]
    """Of the wanted parts, in their order."""
    removed: list[Outcome] = field(default_factory=list)
    """Parts of an earlier import that the list no longer has; kept where somebody edited or drew them."""


def merged(
    text: str,
    label: str,
    module: Sequence[str],
    parts: Sequence[Wanted],
    *,
    file: str,
    environment: str,
    remarks: Iterable[str],
) -> Merged:
    """Put parts into a level of a design, the robot's own or a module's. Raises DesignError where it cannot be done.

    ``environment`` is stated at that level where nothing above states one.
    """
    return _Merge(text, label, list(module)).run(parts, file, environment, list(remarks))


def environment_of(text: str, label: str, module: Sequence[str]) -> str | None:
    """The environment that a level of a design has or inherits."""
    merge = _Merge(text, label, list(module))
    found = [merge.plain(node) for node in merge.stated("environment")]
    return str(found[-1]) if found else None


def quoted(text: str) -> str:
    """A text as YAML writes it, in quotes where it might be taken for something else."""
    if re.fullmatch(r"[A-Za-z][A-Za-z0-9_.()+-]*( [A-Za-z0-9_.()+-]+)*", text) and text.lower() not in _WORDS:
        return text
    if re.fullmatch(r"\d[\d.e-]* [A-Za-z%][A-Za-z/%]*", text):  # 4.7 uF
        return text
    return json.dumps("".join(letter if letter.isprintable() else " " for letter in text), ensure_ascii=False)


_WORDS = {"true", "false", "null", "yes", "no", "on", "off", "y", "n", "nan", "inf"}


def content(part: Wanted, file: str) -> Content:
    """A rated part as a component."""
    if part.rating is None:
        raise ValueError(f"{part.name} has no rate")
    hazard = {"model": part.rating.model, "inputs": dict(part.rating.inputs)}
    made: Content = {"description": part.description, "quantity": part.quantity, "hazard": hazard}
    assumed = f"; assumed {', '.join(part.rating.assumed)}" if part.rating.assumed else ""
    return made | {"source": f"{_origin(part, file)}{assumed} [import {stamp(made)}]"}


def _origin(part: Wanted, file: str) -> str:
    return f"{file}, row {part.row}: {compressed(part.references) or 'no references'}"


def stamp(made: Content) -> str:
    """Of all that a component says but its source."""

    def words(value: Any) -> Any:
        return {key: words(inner) for key, inner in value.items()} if isinstance(value, dict) else str(value)

    said = words({key: value for key, value in made.items() if key != "source"})
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:8]


def _written(key: str, value: Any, pad: str) -> str:
    """A key with its value, the first line without its indentation."""
    if key == "inputs":
        return f"inputs: {{{', '.join(f'{name}: {quoted(text)}' for name, text in value.items())}}}"
    if key == "hazard":
        return "\n".join((f"{key}:", *(f"{pad}  {_written(inner, said, '')}" for inner, said in value.items())))
    return f"{key}: {value if isinstance(value, int) else quoted(value)}"


@dataclass
class _There:
    """A component of the level."""

    name: str
    key: Any
    node: Any
    said: Content
    references: tuple[str, ...] = ()
    file: str = ""
    imported: bool = False
    edited: bool = True


class _Merge:
    """One level of a design's text, found by the places that the YAML parser gives its values."""

    def __init__(self, text: str, label: str, module: list[str]) -> None:
        from ruamel.yaml import YAML

        self.text = text if text.endswith("\n") else text + "\n"
        self.label = label
        self.module = module
        self.root = YAML(typ="safe", pure=True).compose(io.StringIO(self.text))
        if self.root is None or self.root.id != "mapping" or self.root.flow_style:
            raise DesignError(f"{label}: is written in braces; expected a design with a line for each key")
        self.edits: list[tuple[int, int, str]] = []
        self.levels = [self.root]
        for name in module:
            modules = self.child(self.levels[-1], "modules")
            level = self.child(modules[1], name) if modules else None
            if level is None:
                break
            self.own(*level, "module")
            self.levels.append(level[1])

    # -- what is there

    def child(self, node: Any, key: str) -> tuple[Any, Any] | None:
        return next(((k, v) for k, v in node.value if k.value == key), None) if node.id == "mapping" else None

    def own(self, key: Any, node: Any, what: str) -> None:
        """Only what stands where it is used, line by line, can be edited. Raises DesignError."""
        at = f"{self.label}:{key.start_mark.line + 1}"
        if node.start_mark.index < key.end_mark.index:
            raise DesignError(f"{at}: '{key.value}' is an alias; expected a {what} of its own to put parts into")
        if node.id == "mapping" and node.flow_style and node.value:
            raise DesignError(f"{at}: '{key.value}' is written in braces; expected a {what} with a line for each key")

    def stated(self, key: str) -> Iterator[Any]:
        """The values of a key at the level and those above it, from the robot down."""
        for level in self.levels:
            if found := self.child(level, key):
                yield found[1]

    def plain(self, node: Any) -> Any:
        if node.id == "mapping":
            return {str(key.value): self.plain(value) for key, value in node.value}
        return [self.plain(value) for value in node.value] if node.id == "sequence" else str(node.value)

    def there(self, components: Any) -> dict[str, _There]:
        found = {}
        for key, node in components.value if components is not None else ():
            one = _There(str(key.value), key, node, {})
            found[one.name] = one
            if node.id != "mapping" or node.start_mark.index < key.end_mark.index:
                continue
            one.said = self.plain(node)
            source = one.said.get("source")
            match = _SOURCE.match(source) if isinstance(source, str) else None
            if match:
                one.imported, one.file = True, match["file"]
                one.edited = stamp(one.said) != match["stamp"] or bool(node.flow_style)
                try:
                    one.references = expand(match["references"].removeprefix("no references"))
                except ReferencesError:
                    one.edited = True
        return found

    def drawn(self) -> set[str]:
        """Every name that a diagram or function may mean, by its last step."""
        names: set[str] = set()
        stack = [self.root]
        while stack:
            node = stack.pop()
            if node.id != "mapping":
                continue
            for key, value in node.value:
                if key.value in ("diagram", "functions"):
                    names |= set(_scalars(value))
                elif key.value == "modules" and value.id == "mapping":
                    stack += [inner for _, inner in value.value]
        return {name.partition("[")[0].rpartition("/")[2] for name in names}

    # -- what becomes of it

    def run(self, parts: Sequence[Wanted], file: str, environment: str, remarks: list[str]) -> Merged:
        level = self.levels[-1]
        exists = len(self.levels) == len(self.module) + 1
        entry = self.child(level, "components") if exists else None
        if entry:
            self.own(*entry, "mapping")
        there = self.there(entry[1] if entry else None)
        drawn = self.drawn()
        taken = set(there)
        if exists and (modules := self.child(level, "modules")):
            taken |= {str(key.value) for key, _ in modules[1].value}
        matches = _matches(parts, there)
        result = Merged("", [])
        added: list[tuple[str, Content]] = []
        needing: list[tuple[str, Wanted]] = []
        gone: set[str] = set()
        for part, old in zip(parts, matches, strict=True):
            if old is None:
                name = _free(part, taken)
                taken.add(name)
                if part.rating is None:
                    needing.append((name, part))
                    result.outcomes.append(Outcome("needs a rate", name, part.needs))
                else:
                    added.append((name, content(part, file)))
                    result.outcomes.append(Outcome("added", name))
            elif part.rating is None and not old.edited and old.name not in drawn:
                gone.add(old.name)
                needing.append((old.name, part))
                result.outcomes.append(Outcome("needs a rate", old.name, part.needs))
            else:
                result.outcomes.append(self.update(old, part, file))
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
            self.delete(there[name])
        kept = [one for one in there.values() if one.name not in gone]
        environment = "" if any(True for _ in self.stated("environment")) else environment
        self.insert(entry, exists, kept, added, needing, file, environment, remarks)
        result.text = self.applied()
        return result

    def update(self, old: _There, part: Wanted, file: str) -> Outcome:
        """Bring an imported part up to the list, or leave one that somebody edited."""
        if part.rating is None or old.edited:
            if not old.edited:
                return Outcome("kept", old.name, f"stays as it was, for it stands in a diagram, but {part.needs}")
            new: Content = content(part, file) if part.rating else {"quantity": part.quantity}
            differing = [
                f"{key} {_short(old.said.get(key, 1))}, the list says {_short(value)}"
                for key, value in new.items()
                if (key == "quantity" or (key == "hazard" and key in old.said)) and _differ(old.said.get(key, 1), value)
            ]  # fmt: skip
            return Outcome("kept", old.name, "; ".join(["edited by hand, stays as it is", *differing]))
        new = content(part, file)
        same = stamp(old.said) == stamp(new)
        for key, value in new.items():
            found = self.child(old.node, key)
            if found and _differ(old.said[key], value):
                if key == "hazard":
                    self.replace(found[1], "model", value["model"])
                    self.replace(found[1], "inputs", value["inputs"])
                else:
                    self.replace(old.node, key, value)
        text = ""
        if not same:
            changed = [key for key, value in new.items() if key != "source" and _differ(old.said.get(key), value)]
            text = ", ".join(f"{key} was {_short(old.said.get(key))}" for key in changed)
            if set(old.references) != set(part.references):
                text += f", references were {_short(compressed(old.references))}"
        return Outcome("unchanged" if same else "changed", old.name, text)

    def nothing(self, file: str, needing: list[tuple[str, Wanted]]) -> DesignError:
        why = f", e.g. {needing[0][0]}: {needing[0][1].needs}" if needing else ""
        return DesignError(f"{self.label}: no part of {file} has a rate{why}; and no other part is there")

    # -- letters

    def span(self, key: Any, node: Any) -> tuple[int, int]:
        """From a key to the last letter of its value, without the comment behind it."""
        return key.start_mark.index, self.end(node)

    def end(self, node: Any) -> int:
        """Behind the last letter of a value: the parser's own mark of a block is where the next thing begins."""
        index = 0
        while node.id != "scalar" and not node.flow_style and node.value and not index:
            last = node.value[-1]
            key, node = last if isinstance(last, tuple) else (None, last)
            if key is not None and node.start_mark.index < key.end_mark.index:
                index = key.end_mark.index  # an alias; its node stands elsewhere
                index += re.match(r"[^\n#]*", self.text[index : index + 1000]).end()  # type: ignore[union-attr]
        index = int(index or node.end_mark.index)
        while index and self.text[index - 1].isspace():
            index -= 1
        return index

    def line_start(self, index: int) -> int:
        return self.text.rfind("\n", 0, index) + 1

    def line_end(self, index: int) -> int:
        """Where the line after this one begins."""
        return self.text.find("\n", index) + 1 or len(self.text)

    def past_comments(self, index: int, column: int) -> int:
        """Behind the comments that are indented beyond a column: they belong to what stands above them."""
        while match := re.compile(rf" {{{column + 1},}}#").match(self.text, index):
            index = self.line_end(match.end())
        return index

    def replace(self, node: Any, key: str, value: Any) -> None:
        """Another value of a key; the comment behind it stays."""
        if found := self.child(node, key):
            self.edits.append((*self.span(*found), _written(key, value, "")))

    def delete(self, old: _There) -> None:
        start, end = self.span(old.key, old.node)
        self.edits.append((self.line_start(start), self.line_end(end), ""))

    def insert(
        self, entry: tuple[Any, Any] | None, exists: bool, kept: list[_There], added: list[tuple[str, Content]],
        needing: list[tuple[str, Wanted]], file: str, environment: str, remarks: list[str],
    ) -> None:  # fmt: skip
        """Add parts behind those that are there, and say what they rest on."""
        level = self.levels[-1]
        if entry and (entry[1].value or not entry[1].flow_style):
            components = entry[1]
            column: int = (
                components.value[0][0].start_mark.column if components.value else entry[0].start_mark.column + 2
            )
            above = " " * entry[0].start_mark.column
            self.forget(self.line_start(entry[0].start_mark.index), self.after(level), above, _REMARK, "")
            self.forget(self.line_start(entry[0].start_mark.index), self.after(level), " " * column, "# ", _NEEDS)
            head = f"{above}environment: {quoted(environment)}\n" if environment else ""
            head += "".join(f"{above}{_REMARK}{remark}\n" for remark in remarks)
            at = self.line_start(entry[0].start_mark.index)
            self.edits.append((at, at, head))
            at = self.line_end(self.end(components)) if components.value else self.line_end(entry[0].end_mark.index)
            self.edits.append((at, at, "".join(_lines(added, needing, file, " " * column))))
            if not kept and not added:
                raise self.nothing(file, needing)
            return
        if entry:  # components: {}
            start, end = self.line_start(entry[0].start_mark.index), self.line_end(self.end(entry[1]))
            self.edits.append((start, end, ""))
        if not added:
            raise self.nothing(file, needing)
        depth = 0
        first = level.value[0][0] if level.value else None
        pad = " " * (first.start_mark.column if first else 0)
        at = self.past_comments(self.line_end(self.end(level)), len(pad))
        lines = []
        missing = self.module[len(self.levels) - 1 :]
        if missing and (modules := self.child(level, "modules")) and modules[1].value:
            self.own(*modules, "mapping")
            pad = " " * modules[1].value[0][0].start_mark.column
            at = self.past_comments(self.line_end(self.end(modules[1])), len(pad))
        elif missing:
            lines.append(f"{pad}modules:\n")
            pad += "  "
        for depth, name in enumerate(missing):
            lines.append(f"{pad}{quoted(name)}:\n")
            pad += "  "
            if depth + 1 < len(missing):
                lines.append(f"{pad}modules:\n")
                pad += "  "
        if environment:
            lines.append(f"{pad}environment: {quoted(environment)}\n")
        lines += [f"{pad}{_REMARK}{remark}\n" for remark in remarks]
        lines.append(f"{pad}components:\n")
        lines += _lines(added, needing, file, pad + "  ")
        self.edits.append((at, at, "".join(lines)))

    def after(self, node: Any) -> int:
        """Where what follows a level begins, comments between belonging to the level."""
        return int(node.end_mark.index)

    def forget(self, start: int, end: int, pad: str, begin: str, within: str) -> None:
        """Take out the remarks of an earlier import; those on the level stand above its components."""
        if begin == _REMARK:
            while start and self.text.startswith(pad + begin, before := self.line_start(start - 1)):
                self.edits.append((before, start, ""))
                start = before
            return
        while start < end:
            after = self.line_end(start)
            line = self.text[start:after]
            if line.startswith(pad + begin) and within in line:
                self.edits.append((start, after, ""))
            start = after

    def applied(self) -> str:
        pieces, at = [], 0
        for start, end, replacement in sorted(self.edits, key=lambda edit: (edit[0], edit[1])):
            pieces += [self.text[at:start], replacement]
            at = max(at, end)
        return "".join([*pieces, self.text[at:]])


def _scalars(node: Any) -> Iterator[str]:
    stack = [node]
    while stack:
        one = stack.pop()
        if one.id == "scalar":
            yield str(one.value)
        else:
            stack += [inner for item in one.value for inner in (item if isinstance(item, tuple) else (item,))]


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
    name = part.name
    for more in (f"row {part.row}", *(f"row {part.row}, {i}" for i in range(2, len(taken) + 3))):
        if name not in taken:
            break
        name = f"{part.name} ({more})"
    return name


def _lines(added: list[tuple[str, Content]], needing: list[tuple[str, Wanted]], file: str, pad: str) -> Iterator[str]:
    for name, made in added:
        yield f"{pad}{quoted(name)}:\n"
        for key, value in made.items():
            yield f"{pad}  {_written(key, value, pad + '  ')}\n"
    for name, part in needing:
        facts = (
            f"description: {quoted(part.description)}, quantity: {part.quantity}, source: {quoted(_origin(part, file))}"
        )
        why = "".join(letter if letter.isprintable() else " " for letter in part.needs)
        yield f'{pad}# {quoted(name)}: {{rate: "? FIT", {facts}}}{_NEEDS}{why}\n'


def _differ(one: object, other: object) -> bool:
    """As a design says them: 4 is '4'."""
    return stamp({"": one}) != stamp({"": other})


def _short(value: object) -> str:
    if isinstance(value, dict):
        inputs = value.get("inputs")
        model = str(value.get("model", "")).rpartition(".")[2]
        value = f"{model} {', '.join(map(str, inputs.values()))}" if isinstance(inputs, dict) else model
    text = str(value)
    return text if len(text) <= 80 else text[:79] + "…"
