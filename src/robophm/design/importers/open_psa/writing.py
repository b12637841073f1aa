"""A fault tree in the Open-PSA model exchange format."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from xml.sax.saxutils import escape, quoteattr

from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT


def document(name: str, tree: FaultTree, occurred: Sequence[float], rates: Mapping[str, float] | None = None) -> str:
    """The XML of a tree: probabilities of its events, or rates [1/h] of those that fail at a constant one.

    Names become identifiers, which the format asks for; what they were stands as labels.
    """
    return "\n".join(_lines(name, tree, occurred, rates or {})) + "\n"


def _lines(name: str, tree: FaultTree, occurred: Sequence[float], rates: Mapping[str, float]) -> Iterable[str]:
    events = iter(_identifiers(tree.names))
    at: list[str] = []  # how a formula refers to each node
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    yield "<opsa-mef>"
    yield '  <define-fault-tree name="tree">'
    yield f"    <label>{escape(name)}</label>"
    named = []
    for i, (k, inputs) in enumerate(tree.gates):
        if k == UNIT:
            named.append(next(events))
            at.append(f'<basic-event name="{named[-1]}"/>')
            continue
        gate = "top" if i == len(tree.gates) - 1 else f"gate_{i}"
        at.append(f'<gate name="{gate}"/>')
        kind = {ALL: "and", ANY: "or", NOT: "not", ODD: "xor"}.get(k, "atleast")
        bound = f' min="{k}"' if kind == "atleast" else ""
        yield f'    <define-gate name="{gate}">'
        yield f"      <{kind}{bound}>" + "".join(at[i] for i in inputs) + f"</{kind}>"
        yield "    </define-gate>"
    yield "  </define-fault-tree>"
    yield "  <model-data>"
    for identifier, original, p in zip(named, tree.names, occurred, strict=True):
        yield f'    <define-basic-event name="{identifier}">'
        if identifier != original:
            yield f"      <label>{escape(original)}</label>"
        if original in rates:
            yield f'      <exponential><float value="{rates[original]!r}"/><system-mission-time/></exponential>'
        else:
            yield f"      <float value={quoteattr(repr(float(p)))}/>"
        yield "    </define-basic-event>"
    yield "  </model-data>"
    yield "</opsa-mef>"


def _identifiers(names: Iterable[str]) -> list[str]:
    """A letter, then letters, digits, - and _; no two alike."""
    found: dict[str, None] = {"top": None}
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_-]+", "_", name).strip("_-")
        plain = plain if plain[:1].isalpha() and not plain.startswith("gate_") else f"e_{plain}"
        unique, n = plain, 1
        while unique in found:
            n += 1
            unique = f"{plain}_{n}"
        found[unique] = None
    return list(found)[1:]
