"""YAML text → nodes with their places. Read by libyaml where PyYAML brings it, else by ruamel.yaml: the same, slower.

What the two may take differently is left to ruamel.yaml, which alone says what a fault is: so designs and errors are
the same on every machine.
"""

from __future__ import annotations

import gc
import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, lru_cache
from typing import Any

MAX_VALUES = 300_000
"""The most values of a file with its aliases followed: a small file can otherwise unfold to billions.

A hundred thousand parts of one rate have two thirds of it. Each takes up to 15 µs.
"""

MAX_SLOW_NODES = 80_000
"""The most keys and values of a text that ruamel.yaml alone can read: each takes it 25 µs and a kilobyte."""

MAX_SLOW_CHARACTERS = 2_000_000
"""The most characters of such a text, remarks and blanks among them: a million takes it a second."""

MAX_DEPTH = 100


class Node:
    """A value in a text: ``id`` is scalar, sequence or mapping; marks have ``index``, ``line``, ``column`` from 0."""

    __slots__ = ("end_mark", "flow_style", "id", "start_mark", "tag", "value")

    def __init__(self, id: str, tag: str, value: Any, event: Any) -> None:  # noqa: A002  as ruamel.yaml calls it
        self.id, self.tag, self.value = id, tag, value
        self.start_mark, self.end_mark = event.start_mark, event.end_mark
        self.flow_style = getattr(event, "flow_style", None)

    def close(self, end_mark: Any) -> None:
        """Set where a value ends, once all its children are there."""
        self.end_mark = end_mark
        if self.id == "mapping":
            self.value = list(zip(self.value[::2], self.value[1::2], strict=False))


@contextmanager
def uncollected() -> Iterator[None]:
    """Switch garbage collection off while many objects are made of which none is garbage."""
    collecting = gc.isenabled()
    if collecting:  # by none but its opener is it closed: another thread may be in here too
        gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


@uncollected()
def compose(text: str) -> Any:
    """The root node of a text, None where it is empty.

    Raises ruamel.yaml's YAMLError, ValueError, RecursionError; TooMuchError beyond MAX_VALUES, or what is read slowly.
    """
    try:
        return quick(text)
    except Unsure as unsure:
        try:
            return bounded_reader("safe").compose(io.StringIO(text))
        except TooMuchError as error:
            first = "" if unsure.line is None else f", of which the first is in line {unsure.line + 1}"
            raise TooMuchError(f"{error}; expected fewer, or no tags, tabs and faults{first}", error.line) from None


def bounded_reader(typ: str) -> Any:
    """The reader of ruamel.yaml of this type, for a stream; it raises TooMuchError beyond MAX_SLOW_NODES or
    MAX_SLOW_CHARACTERS, as soon as it comes to them."""
    from ruamel.yaml import YAML

    reader = YAML(typ=typ, pure=True)
    reader.Composer, reader.Reader = _bounded_classes()
    return reader


class TooMuchError(Exception):
    """Raised for a text of which there is too much to read on; ``line`` is where it becomes too much, from 0."""

    def __init__(self, says: str, line: int) -> None:
        super().__init__(says)
        self.line = line


@cache
def _bounded_classes() -> tuple[Any, Any]:
    """The composer and the reader of characters of ruamel.yaml, which have no bounds, with theirs."""
    from ruamel.yaml.composer import Composer
    from ruamel.yaml.reader import Reader

    class BoundedComposer(Composer):
        def __init__(self, loader: Any = None) -> None:
            super().__init__(loader)
            self._count = 0

        def compose_node(self, parent: Any, index: Any) -> Any:
            self._count += 1
            if self._count > MAX_SLOW_NODES:
                line = self.parser.peek_event().start_mark.line
                raise TooMuchError(f"has more than {MAX_SLOW_NODES:,} keys and values up to here", line)
            return super().compose_node(parent, index)

    class BoundedReader(Reader):
        def update_raw(self, size: int | None = None) -> None:
            if self.stream_pointer > MAX_SLOW_CHARACTERS:
                raise TooMuchError(f"has more than {MAX_SLOW_CHARACTERS:,} characters up to here", self.line)
            super().update_raw(size)

    return BoundedComposer, BoundedReader


class Unsure(Exception):  # noqa: N818  no error: ruamel.yaml has the last word
    """Raised for a text that the quick reader cannot read with certainty, at a line from 0 where it is known."""

    def __init__(self, line: int | None = None) -> None:
        super().__init__(line)
        self.line = line


_ODD = re.compile("[^\n\r\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")
"""Tabs, what no YAML may hold, and what YAML 1.1 took for line breaks."""


_BLOCK = ("|", ">")
_HEADER = re.compile(r"[|>][-+1-9]*[\r\n]")
"""Headers of a block of lines; the two readers differ on whether a remark may follow one."""

_ANCHOR = re.compile(r"[&*][A-Za-z0-9_-]+(?=[ \r\n,\]}]|$)")
"""Anchors and aliases; the two readers differ on where one ends before other letters."""


def quick(text: str) -> Node | None:
    """The root node of a plain, valid YAML text.

    Raises TooMuchError beyond MAX_VALUES, and Unsure of any other text, and where there is no libyaml.
    """
    try:
        from yaml import YAMLError, events
        from yaml.cyaml import CParser
    except ImportError:
        raise Unsure from None
    if odd := _ODD.search(text):
        raise Unsure(text.count("\n", 0, odd.start()))
    ends = text.endswith("\n")
    root: Node | None = None
    inside: list[Node] = []
    anchors: dict[str, Node] = {}
    count = 0
    try:
        parser = CParser(text)
        while (event := parser.get_event()) is not None:
            if isinstance(event, events.CollectionEndEvent):
                inside.pop().close(event.end_mark)
            elif isinstance(event, events.NodeEvent):
                if event.anchor is not None and not _ANCHOR.match(text, event.start_mark.index):
                    raise Unsure(event.start_mark.line)
                parent = inside[-1] if inside else None
                count += not _is_key_of(parent)
                if count > MAX_VALUES:
                    raise TooMuchError(f"unfolds to more than {MAX_VALUES:,} values", event.start_mark.line)
                if isinstance(event, events.AliasEvent):
                    _put(_meant(event, anchors, inside), parent)
                    continue
                node = _node(event, parent)
                lines = node.id == "scalar" and event.style in _BLOCK
                if lines and not (ends and _HEADER.match(text, node.start_mark.index)):
                    raise Unsure(event.start_mark.line)
                root = root or node
                if node.id != "scalar":
                    inside.append(node)
                if event.anchor is not None and anchors.setdefault(event.anchor, node) is not node:
                    raise Unsure(event.start_mark.line)
                if len(inside) > MAX_DEPTH:
                    raise Unsure(event.start_mark.line)
            elif isinstance(event, events.DocumentStartEvent):
                if root or event.version or event.tags:
                    raise Unsure(event.start_mark.line)
            elif isinstance(event, events.DocumentEndEvent) and event.explicit:
                raise Unsure(event.start_mark.line)
    except (YAMLError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        raise Unsure(mark.line if mark else None) from None
    return root


def _node(event: Any, parent: Node | None) -> Node:
    """The node that an event begins, put into what it stands in. Raises Unsure."""
    kind = type(event).__name__
    if event.tag is not None:
        raise Unsure(event.start_mark.line)
    if kind == "ScalarEvent":
        plain = event.implicit[0]
        if parent is None or (plain and not event.value):  # where nothing at all stands, they see otherwise
            raise Unsure(event.start_mark.line)
        node = Node("scalar", _tag(event.value) if plain else _STRING, event.value, event)
    elif _is_key_of(parent):
        raise Unsure(event.start_mark.line)
    else:
        mapping = kind == "MappingStartEvent"
        node = Node("mapping" if mapping else "sequence", _MAP if mapping else _SEQUENCE, [], event)
    _put(node, parent)
    return node


def _put(node: Node, parent: Node | None) -> None:
    if parent is not None:
        parent.value.append(node)


def _is_key_of(parent: Node | None) -> bool:
    """Whether what comes next is a key of the mapping in which it stands."""
    return parent is not None and parent.id == "mapping" and len(parent.value) % 2 == 0


def _meant(alias: Any, anchors: dict[str, Node], inside: list[Node]) -> Node:
    """The node that an alias stands for. Raises Unsure for a key, and for what there is not or not all of yet."""
    node = anchors.get(alias.anchor)
    if node is None or node in inside or _is_key_of(inside[-1] if inside else None):
        raise Unsure(alias.start_mark.line)
    return node


_STRING, _MAP, _SEQUENCE = (f"tag:yaml.org,2002:{kind}" for kind in ("str", "map", "seq"))


@lru_cache(10_000)
def _tag(word: str) -> str:
    """The tag that YAML 1.2 gives an unquoted word."""
    return next((tag for tag, pattern in _resolvers().get(word[0], ()) if pattern.match(word)), _STRING)


@cache
def _resolvers() -> dict[str, list[tuple[str, Any]]]:
    """Resolvers by first letter, ruamel.yaml's own: PyYAML's are of YAML 1.1, where 'no' is false and 1:20 is 80."""
    from ruamel.yaml.resolver import implicit_resolvers

    found: dict[str, list[tuple[str, Any]]] = {}
    for versions, tag, pattern, letters in implicit_resolvers:
        for letter in letters if (1, 2) in versions else ():
            found.setdefault(letter, []).append((tag, pattern))
    return found
