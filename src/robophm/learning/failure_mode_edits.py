"""Keys of failure modes changed in a design's text; all else in it stays letter for letter."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from robophm.core.errors import DesignError, nearest
from robophm.design.edited_text import EditedText, child, is_alias
from robophm.design.file import parse
from robophm.design.robot import FailureMode, Robot
from robophm.parts import FIGURES


def edited(text: str, label: str, changes: Mapping[str, Mapping[str, str | None]]) -> str:
    """A design with other values of keys of failure modes, by path; None takes a key out. Raises DesignError."""
    design = EditedText(text, label)
    for path, values in changes.items():
        _put(design, _mode(design, path), values)
    result = design.applied()
    parse(result, label)
    return result


def named_mode(robot: Robot, path: str) -> FailureMode:
    """The failure mode of that path, or the only one of the component of that path. Raises DesignError."""
    for part in robot.all_components():
        if part.path == path and part not in robot.causes:
            if len(part.modes) > 1:
                names = ", ".join(f"'{mode.path}'" for mode in part.modes)
                raise DesignError(f"'{path}' fails in several ways; expected one of {names}")
            return part.modes[0]
    for mode in robot.modes:
        if mode.path == path and not mode.member:
            return mode
    raise DesignError(f"no part '{path}'{nearest(path, [mode.path for mode in robot.modes])}")


def _mode(design: EditedText, path: str) -> Any:
    """The mapping of a failure mode. Raises DesignError where it has no place of its own."""
    node, rest = design.root, path.split("/")
    while rest:
        steps = _step(node, rest[0])
        if not steps:
            raise DesignError(
                f"{design.label}: '{path}' cannot be found in its text; expected a place of its own{_elsewhere(node)}"
            )
        for key, value in steps:
            if is_alias(key, value):
                raise DesignError(
                    f"{design.label}:{key.start_mark.line + 1}: '{key.value}' is an alias, which several parts share; "
                    f"expected '{path}' written out, to have evidence of its own"
                )
        node, rest = steps[-1][1], rest[1:]
    return node


def _elsewhere(node: Any) -> str:
    """The place of a part's failure modes, in words, where they are not in the design itself."""
    named = child(node, "part") if node.id == "mapping" else None
    return f": failure_modes copied from '{named[1].value}' of the library" if named else ""


def _step(node: Any, name: str) -> list[tuple[Any, Any]]:
    """The group in which a name stands, and what stands there; none where it does not."""
    for kind in ("modules", "components", "failure_modes"):
        group = child(node, kind)
        found = child(group[1], name) if group else None
        if group and found:
            return [group, found]
    return []


def _put(design: EditedText, node: Any, changes: Mapping[str, str | None]) -> None:
    """Other values of the keys of a mapping; new ones stand behind the rate, None takes a key out."""
    stated = (*FIGURES, "hazard", "part", "life")
    anchor = next(filter(None, (child(node, key) for key in stated)), node.value[-1])
    new = [f"{key}: {value}" for key, value in changes.items() if value is not None and not child(node, key)]
    kept = 0
    for key, value in node.value:
        if key.value not in changes:
            kept += 1
        elif changes[key.value] is not None:
            kept += 1
            design.replace(node, key.value, f"{key.value}: {changes[key.value]}", "\0")
        elif node.flow_style:
            _take_out(design, node, key, value)
        else:
            design.delete(key, value)
    if not new:
        return
    if node.flow_style:
        end = node.end_mark.index - 1
        before = len(design.text[:end].rstrip())
        comma = "" if not kept or design.text[before - 1] in "{," else ","
        design.edits.append((before, end, f"{comma}{' ' * (design.text[before - 1] != '{')}{', '.join(new)}"))
    else:
        key, value = anchor
        pad = " " * key.start_mark.column
        # Behind a key that is taken out, what is new stands in its place.
        at = design.line_end(design.end(value))
        design.insert(at, "".join(f"{pad}{line}\n" for line in new))


def _take_out(design: EditedText, node: Any, key: Any, value: Any) -> None:
    """A key and its value out of braces, with the comma behind them, or else the one before."""
    start, end = key.start_mark.index, design.end(value)
    behind = re.compile(r"\s*,\s*").match(design.text, end)
    if behind:
        design.edits.append((start, behind.end(), ""))
        return
    before = design.text[:start].rstrip()
    design.edits.append((len(before) - before.endswith(","), end, ""))
