"""What was learned, written into a design beside each rate; all else in it stays letter for letter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from robophm.core.errors import DesignError
from robophm.design.bom.edits import EditedText
from robophm.design.file import parse
from robophm.design.naming import quoted
from robophm.design.robot import CLOCK_UNITS
from robophm.learning.learn import LearnedRate


def with_evidence(text: str, label: str, learned: Sequence[LearnedRate]) -> str:
    """The text of a design with what was learned of its rates; what was learned of them before gives way.

    Raises DesignError where a part cannot be edited in its place, or the result would not say what was learned.
    """
    return edited(text, label, {one.mode.path: {"learned": _written(one)} for one in learned})


def edited(text: str, label: str, changes: Mapping[str, Mapping[str, str | None]]) -> str:
    """A design with other values of keys of failure modes, by path; None takes a key out. Raises DesignError."""
    design = EditedText(text, label)
    for path, values in changes.items():
        node = _mode(design, path)
        for key, value in values.items():
            _put(design, node, key, value)
    result = design.applied()
    parse(result, label)
    return result


def _mode(design: EditedText, path: str) -> Any:
    """The mapping of a failure mode. Raises DesignError where it has no place of its own."""
    node, rest = design.root, path.split("/")
    while rest:
        steps = _step(node, rest[0])
        if not steps:
            raise DesignError(f"{design.label}: '{path}' cannot be found in its text; expected a place of its own")
        for key, value in steps:
            if EditedText.is_alias(key, value):
                raise DesignError(
                    f"{design.label}:{key.start_mark.line + 1}: '{key.value}' is an alias, which several parts share; "
                    f"expected '{path}' written out, to have evidence of its own"
                )
        node, rest = steps[-1][1], rest[1:]
    return node


def _step(node: Any, name: str) -> list[tuple[Any, Any]]:
    """The group in which a name stands, and what stands there; none where it does not."""
    for kind in ("modules", "components", "failure_modes"):
        group = EditedText.child(node, kind)
        found = EditedText.child(group[1], name) if group else None
        if group and found:
            return [group, found]
    return []


def _put(design: EditedText, node: Any, key: str, value: str | None) -> None:
    there = EditedText.child(node, key)
    if there and value is None:
        if node.flow_style:
            raise DesignError(
                f"{design.label}:{there[0].start_mark.line + 1}: '{key}' stands in braces; expected lines"
            )
        design.delete(*there)
    elif there:
        design.replace(node, key, f"{key}: {value}", "#\0")
    elif value is not None and node.flow_style:
        end = node.end_mark.index - 1
        before = design.text[:end].rstrip()
        design.edits.append((len(before), end, f"{'' if before[-1] in '{,' else ','} {key}: {value}"))
    elif value is not None:
        last = EditedText.child(node, "rate") or EditedText.child(node, "hazard") or EditedText.child(node, "life")
        key_node, value_node = last or node.value[-1]
        design.insert(design.line_end(design.end(value_node)), f"{' ' * key_node.start_mark.column}{key}: {value}\n")


def _written(one: LearnedRate) -> str:
    found = one.posterior
    values: dict[str, str] = {
        "factor": f"{one.factor:.6g}",
        "shape": f"{one.shape:.6g}",
        "failures": f"{one.failures:g}",
        "expected": f"{one.expected:.4g}",
        "exposure": f"{one.exposure:.10g} {CLOCK_UNITS[one.mode.clock]}",
        "low": f"{one.low:.4g}",
        "high": f"{one.high:.4g}",
        "prior": f"{found.prior:.4g}",
    }
    notes = []
    if found.conflict:
        notes.append(f"contradicts the stated rate, whose weight was cut to {100 * found.weight:.2g} %")
    if one.of_fleet.spread:
        notes.append(f"robots differ by {100 * one.of_fleet.spread:.0f} % (standard deviation)")
    if notes:
        values["note"] = quoted("; ".join(notes))
    return "{" + ", ".join(f"{key}: {value}" for key, value in values.items()) + "}"
