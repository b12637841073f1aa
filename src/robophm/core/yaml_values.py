"""YAML text → plain values, the line of each, and what is wrong at which place: of designs, task files, parts."""

from __future__ import annotations

import re
from typing import Any

from robophm.core.errors import DesignError
from robophm.core.yaml_nodes import MAX_DEPTH, MAX_VALUES, TooMuchError, compose, uncollected

MAX_BYTES = 20_000_000
"""A larger file is refused before it is parsed; so is one that is larger when its aliases are written out.

Each value then has a line of its own, two spaces in for each level: what is kept of its place takes as much.
"""

_MOST_DIGITS = 1000
"""A longer whole number is a text: Python writes none of more than 4,300 digits, hexadecimal ones read or not."""

_HALF = re.compile("[\ud800-\udfff]")


class Lines(dict[tuple[str, ...], int]):
    """The line of each value, by the keys that lead to it; both count from 1."""

    def __init__(self) -> None:
        super().__init__()
        self.columns: dict[tuple[str, ...], int] = {}
        """The column of its line at which each value, or its key, begins."""

    def nearest(self, place: tuple[str, ...]) -> tuple[int, int] | None:
        """Return line and column of a place, or of the innermost around it that there is; None without any."""
        known = next((place[:n] for n in range(len(place), -1, -1) if place[:n] in self), None)
        return None if known is None else (self[known], self.columns.get(known, 1))


def values(text: str, name: str) -> tuple[Any, Lines]:
    """The plain values of a YAML text, and the line of each."""
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    try:
        root = compose(text)
    except MarkedYAMLError as error:
        line, column = (error.problem_mark.line, error.problem_mark.column) if error.problem_mark else (0, 0)
        raise DesignError(f"{name}:{line + 1}: is not YAML: {error.problem}, in column {column + 1}") from None
    except (YAMLError, ValueError) as error:
        raise DesignError(f"{name}: is not YAML: {str(error).splitlines()[0]}") from None
    except TooMuchError as error:
        raise DesignError(f"{name}:{error.line + 1}: {error}") from None
    except RecursionError:
        raise DesignError(f"{name}: is nested too deeply; expected at most {MAX_DEPTH} levels") from None
    reader = _Reader(name)
    with uncollected():
        return (None if root is None else reader.value(root, ())), reader.lines


class _Reader:
    """YAML nodes to plain values: only what JSON has too, no tags, no doubled keys, within bounds."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.lines = Lines()
        self.count = 0
        self.characters = 0

    def value(self, node: Any, place: tuple[str, ...]) -> Any:
        line = self.lines[place] = node.start_mark.line + 1
        self.lines.columns[place] = node.start_mark.column + 1
        self.count += 1
        if self.count > MAX_VALUES:
            raise DesignError(f"{self.name}:{line}: unfolds to more than {MAX_VALUES:,} values")
        self._count(2 * len(place), f"{self.name}:{line}")
        if len(place) > MAX_DEPTH:
            raise DesignError(f"{self.name}:{line}: is nested too deeply; expected at most {MAX_DEPTH} levels")
        kind = str(node.tag).removeprefix("tag:yaml.org,2002:")
        if kind != {"mapping": "map", "sequence": "seq"}.get(node.id, kind):
            raise DesignError(f"{self.name}:{line}: {_text(place)}tag '{node.tag}' is not taken; expected plain values")
        if node.id == "mapping":
            result: dict[str, Any] = {}
            for key_node, value_node in node.value:
                at = f"{self.name}:{key_node.start_mark.line + 1}"
                if key_node.id != "scalar":
                    raise DesignError(f"{at}: {_text(place)}a key is a list or mapping; expected a name")
                self._count(len(str(key_node.value)), at)
                key = self._text(str(key_node.value), at, place)
                if key in result:
                    raise DesignError(f"{at}: {_text(place)}duplicate name '{key}'; names of one level must differ")
                result[key] = self.value(value_node, (*place, key))
                self.lines[(*place, key)] = key_node.start_mark.line + 1
                self.lines.columns[(*place, key)] = key_node.start_mark.column + 1
            return result
        if node.id == "sequence":
            return [self.value(item, (*place, str(i))) for i, item in enumerate(node.value)]
        self._count(len(node.value), f"{self.name}:{line}")
        try:
            if kind == "null":
                return None
            if kind == "bool":
                return node.value.lower() in ("true", "yes", "on")
            if kind == "int" and len(node.value) <= _MOST_DIGITS:
                return int(node.value.replace("_", ""), 0)
            if kind == "float":
                return float(node.value.replace("_", "").lower().replace(".inf", "inf").replace(".nan", "nan"))
        except ValueError:
            pass
        if kind in ("str", "timestamp", "int", "float"):
            return self._text(node.value, f"{self.name}:{line}", place)
        raise DesignError(f"{self.name}:{line}: {_text(place)}tag '{node.tag}' is not taken; expected plain values")

    def _count(self, characters: int, at: str) -> None:
        """Some more are written out; raises DesignError where they are too many."""
        self.characters += characters
        if self.characters > MAX_BYTES:
            raise DesignError(f"{at}: unfolds to more than {MAX_BYTES:,} characters")

    @staticmethod
    def _text(text: str, at: str, place: tuple[str, ...]) -> str:
        """The same, where it is text that can be written: an escape can be half a character."""
        if not text.isascii() and _HALF.search(text):
            raise DesignError(f"{at}: {_text(place)}{text!r:.60} is no text; expected whole characters")
        return text


def _text(place: tuple[str, ...]) -> str:
    return "/".join(place) + ": " if place else ""


def located(name: str, lines: Lines, place: tuple[str, ...], message: str) -> str:
    """Return a fault's message with the file, the line and the place in it."""
    line, _ = lines.nearest(place) or (1, 1)
    return f"{name}:{line}: {_text(place)}{message}"
