"""A design's text, changed in places: all else stays letter for letter."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from robophm.core.errors import DesignError
from robophm.core.yaml_nodes import compose


class EditedText:
    """A text and the places that the YAML parser gives its values; edits are kept until ``applied``."""

    def __init__(self, text: str, label: str) -> None:
        """Parse a valid design, which ``label`` names. Raises DesignError where it is not written line by line."""
        self.text = text if text.endswith("\n") else text + "\n"
        self.label = label
        self.root = compose(self.text)
        if self.root is None or self.root.id != "mapping" or self.root.flow_style:
            raise DesignError(f"{label}: is written in braces; expected a design with a line for each key")
        self.edits: list[tuple[int, int, str]] = []

    def applied(self) -> str:
        """Return the text with all edits made."""
        pieces, at = [], 0
        for start, end, replacement in sorted(self.edits, key=lambda edit: (edit[0], edit[1])):
            pieces += [self.text[at:start], replacement]
            at = max(at, end)
        return "".join([*pieces, self.text[at:]])

    def own(self, key: Any, node: Any, what: str) -> None:
        """Raise DesignError unless a value stands, line by line, where it is used: no other can be edited."""
        at = f"{self.label}:{key.start_mark.line + 1}"
        if is_alias(key, node):
            raise DesignError(f"{at}: '{key.value}' is an alias; expected a {what} of its own to put parts into")
        if node.id == "mapping" and node.flow_style and node.value:
            raise DesignError(f"{at}: '{key.value}' is written in braces; expected a {what} with a line for each key")

    # -- edits

    def replace(self, node: Any, key: str, text: str, own_remark: str) -> None:
        """Replace a key and its value by a text; the remark behind it stays, unless it begins with ``own_remark``."""
        if found := child(node, key):
            end = self.end(found[1])
            if self.text.startswith(own_remark, end):
                end = self.line_end(end) - 1
            self.edits.append((found[0].start_mark.index, end, text))

    def remarked(self, node: Any, key: str, remark: str) -> bool:
        """Whether the remark behind the value of a key begins with this text."""
        found = child(node, key)
        return found is not None and self.text.startswith(remark, self.end(found[1]))

    def delete(self, key: Any, node: Any) -> None:
        """Delete the lines of a key and its value."""
        self.edits.append((self.line_start(key.start_mark.index), self.line_end(self.end(node)), ""))

    def insert(self, at: int, text: str) -> None:
        """Insert a text at this index."""
        self.edits.append((at, at, text))

    def forget_lines(self, start: int, end: int, begin: str, within: str = "") -> None:
        """Delete the lines between two places that begin with ``begin`` and contain ``within``."""
        while start < end:
            after = self.line_end(start)
            line = self.text[start:after]
            if line.startswith(begin) and within in line:
                self.edits.append((start, after, ""))
            start = after

    def forget_above(self, start: int, begin: str) -> None:
        """Delete the lines just above a place that begin with ``begin``."""
        while start and self.text.startswith(begin, before := self.line_start(start - 1)):
            self.edits.append((before, start, ""))
            start = before

    # -- places

    def end(self, node: Any) -> int:
        """Return the index behind a value's last letter: the parser's mark of a block is where the next thing
        begins."""
        index = 0
        while node.id != "scalar" and not node.flow_style and node.value and not index:
            last = node.value[-1]
            key, node = last if isinstance(last, tuple) else (None, last)
            if key is not None and is_alias(key, node):
                index = key.end_mark.index  # the node itself stands elsewhere
                index += re.match(r"[^\n#]*", self.text[index : index + 1000]).end()  # type: ignore[union-attr]
        index = int(index or node.end_mark.index)
        while index and self.text[index - 1].isspace():
            index -= 1
        return index

    def line_start(self, index: int) -> int:
        """Return the index at which the line of ``index`` begins."""
        return self.text.rfind("\n", 0, index) + 1

    def line_end(self, index: int) -> int:
        """Return the index at which the line after that of ``index`` begins."""
        return self.text.find("\n", index) + 1 or len(self.text)

    def past_comments(self, index: int, column: int) -> int:
        """Return the index behind comments indented beyond a column: they belong to what stands above them."""
        while match := re.compile(rf" {{{column + 1},}}#").match(self.text, index):
            index = self.line_end(match.end())
        return index


def child(node: Any, key: str) -> tuple[Any, Any] | None:
    """Return the key and value nodes of a name in a mapping; None where it is no mapping, or has no such name."""
    return next(((k, v) for k, v in node.value if k.value == key), None) if node.id == "mapping" else None


def is_alias(key: Any, node: Any) -> bool:
    """Whether a value stands elsewhere in the text, and is only referred to here."""
    return bool(node.start_mark.index < key.end_mark.index)


def plain(node: Any) -> Any:
    """Return the value of a node, every scalar as it is written."""
    if node.id == "mapping":
        return {str(key.value): plain(value) for key, value in node.value}
    return [plain(value) for value in node.value] if node.id == "sequence" else str(node.value)


def scalars(node: Any) -> Iterator[str]:
    """Yield every scalar of a value, keys too."""
    stack = [node]
    while stack:
        one = stack.pop()
        if one.id == "scalar":
            yield str(one.value)
        else:
            stack += [inner for item in one.value for inner in (item if isinstance(item, tuple) else (item,))]
