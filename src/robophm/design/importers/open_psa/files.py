"""The files of an Open-PSA model, with what they include: all within the bounds of one.

A project of SCRAM names the files of a model and its mission time; how SCRAM solves it is its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from pathlib import Path, PurePosixPath

from robophm.core.errors import DesignError
from robophm.core.markup import MAX_BYTES, Element, Markup

MOST_FILES = 100
"""The most files of one model."""

_INCLUDE = "xi:include"


class Files:
    """Reads the files of a model. Raises DesignError for what is no XML or model, and beyond the bounds."""

    def __init__(self, paths: Iterable[Path]) -> None:
        self._read = self._bytes = 0
        self.time: float | None = None
        """The mission time that a project says [h]; None where none does."""
        self.roots: list[Element] = []
        """The outermost element of each file of the model."""
        for path in paths:
            root = self._root(path)
            if root.tag == "scram":
                self.roots += [self._root(one) for one in self._of_project(root)]
            else:
                self.roots.append(root)
        for root in self.roots:
            if root.tag != "opsa-mef":
                raise root.fault(f"is a '{root.tag}'; expected an opsa-mef")

    def inside(self, said: Element) -> Iterator[Element]:
        """Yield what stands in an element, and in its place what is included from other files."""
        todo: list[tuple[Element, tuple[str, ...]]] = [(one, (said.file,)) for one in reversed(list(said.inside()))]
        while todo:
            one, within = todo.pop()
            if one.tag != _INCLUDE:
                yield one
                continue
            path = self._included(one)
            if str(path) in within:
                raise one.fault(f"includes itself: {' → '.join([*within, str(path)])}")
            root = self._root(path)
            parts = list(root.inside()) if root.tag == "opsa-mef" else [root]
            todo += [(part, (*within, str(path))) for part in reversed(parts)]

    def _of_project(self, root: Element) -> list[Path]:
        """Return the files that a project of SCRAM names; its mission time is kept."""
        files = []
        for one in root.all():
            if one.tag == "file":
                files.append(_beside(one, one.content))
            elif one.tag == "mission-time":
                self.time = _hours(one)
        if not files:
            raise root.fault("names no file of a model; expected model and file")
        return files

    @staticmethod
    def _included(said: Element) -> Path:
        if said.attributes.get("parse", "xml") != "xml":
            raise said.fault("includes a text; expected parse='xml'")
        return _beside(said, said.attributes.get("href", ""))

    def _root(self, path: Path) -> Element:
        self._read += 1
        if self._read > MOST_FILES:
            raise DesignError(f"{path}: is one of more than {MOST_FILES} files of a model")
        markup = Markup(path)
        self._bytes += markup.size
        if self._bytes > MAX_BYTES:
            raise DesignError(f"{path}: with the other files of the model, is larger than {MAX_BYTES:,} bytes")
        return markup.root()


def _beside(said: Element, name: str) -> Path:
    """The path of a file that an element names. Raises DesignError where it is not in the same folder or below."""
    path = PurePosixPath(name)
    if not name or path.is_absolute() or ".." in path.parts or ":" in name or "\\" in name:
        raise said.fault(f"includes {name!r:.60}; expected a file in the same folder or below")
    return Path(said.file).parent / path


def _hours(said: Element) -> float:
    try:
        hours = float(said.content)
    except ValueError:
        hours = math.nan
    if not 0 <= hours < math.inf:
        raise said.fault(f"mission time {said.content!r:.60}; expected hours")
    return hours
