"""One edit of a design taken to another state of it: so that it is undone, or done again, though others came later."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from copy import deepcopy
from typing import Any, NamedTuple

from robophm.design.located_error import LocatedError, Path

ABSENT = object()
"""The value at a place where there is nothing."""


class Change(NamedTuple):
    """One place of a design that differs between two states of it."""

    path: Path
    before: Any
    """Value before, ``ABSENT`` where there was none."""
    after: Any
    """Value after, ``ABSENT`` where there is none."""


def changes(before: Any, after: Any, path: Path = ()) -> Iterator[Change]:
    """Yield the places that differ between two documents; mappings are looked into, lists are one value."""
    if isinstance(before, MutableMapping) and isinstance(after, MutableMapping):
        for key in [*before, *(key for key in after if key not in before)]:
            yield from changes(before.get(key, ABSENT), after.get(key, ABSENT), (*path, key))
    elif before != after:
        yield Change(path, before, after)


def carry(document: Any, before: Any, after: Any) -> None:
    """Change a document as ``before`` was changed into ``after``, all three being mappings.

    Raises LocatedError, with the document unchanged, where a place of the edit has been changed by another one since.
    """
    found = list(changes(before, after))
    for change in found:
        if _at(document, change.path) != change.before:
            raise LocatedError(change.path, "has been changed since by another edit; expected to find it as it was")
    for change in found:
        *around, key = change.path
        level = document
        for step in around:
            level = level.setdefault(step, type(document)())
        if change.after is ABSENT:
            del level[key]
        else:
            level[key] = deepcopy(change.after)


def _at(document: Any, path: Path) -> Any:
    for key in path:
        if not isinstance(document, MutableMapping) or key not in document:
            return ABSENT
        document = document[key]
    return document
