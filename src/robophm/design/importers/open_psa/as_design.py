"""A fault tree as a design: basic events become parts, gates the blocks of its diagram."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Unit, drawn
from robophm.blocks.graph import graph
from robophm.core.errors import StructureError
from robophm.design.file import parse
from robophm.design.importers.open_psa import Model
from robophm.design.importers.open_psa.expressions import Life
from robophm.design.naming import design_name, design_names, printable, quoted

MOST_DRAWN = 100_000
"""Events in a diagram when all gates are drawn in their places."""


def as_design(model: Model, file: str, time: float | None) -> str:
    """The text of a design that has failed after ``time`` [h] with the probability of the model's top event.

    What fails at a constant or Weibull rate does so in the design; of what has a probability alone, a constant rate
    gives it at that time. Raises StructureError where a design cannot say it: gates of "not" and "xor", events that
    never or always occur, probabilities without a time; DesignError where the design is too large to be read.
    """
    tree = model.tree
    if tree is None:
        raise StructureError(f"{file}: '{model.name}' is decided by constants; expected a tree with basic events")
    tree.must_be_coherent("is no design: no part of a robot helps it by failing")
    diagram = tree.diagram()
    if drawn(diagram) > MOST_DRAWN:
        raise StructureError(f"{file}: '{model.name}' unfolds to more than {MOST_DRAWN:,} events")
    name = design_names(graph(diagram)[0])
    chance = dict(zip(tree.names, map(float, model.occurred), strict=True))
    life = dict(zip(tree.names, model.lives, strict=True))
    lines = [
        f"# Made of {printable(file):.80} by `robophm fault-tree`: its gate '{printable(model.name):.80}'.",
        "schema_version: 1",
        f"name: {quoted(design_name(model.name))}",
        "components:",
        *(_component(file, one, name[one], life[one], chance[one], time) for one in name),
        "diagram:",
        *_Diagram(diagram, name).lines,
    ]
    text = "\n".join(lines) + "\n"
    parse(text, f"{file}, as a design")
    return text


def _component(file: str, event: str, name: str, life: Life | None, chance: float, time: float | None) -> str:
    if not 0 < chance < 1:
        says = "always" if chance else "never"
        raise StructureError(
            f"{file}: '{event}' {says} occurs, and a part has a rate; expected a house event in its place"
        )
    if life and "rate" in life:
        return f"  {quoted(name)}: {{rate: {life['rate']!r} /h}}"
    if life:
        beyond = f", location: {life['location']!r} h" if life["location"] else ""
        shape = f"scale: {life['scale']!r} h, shape: {life['shape']!r}{beyond}"
        return f"  {quoted(name)}: {{life: {{distribution: weibull, {shape}}}}}"
    if not time:
        raise StructureError(
            f"{file}: '{event}' has a probability and no rate, as a part of a design has; expected a mission time "
            "above 0, at which a constant rate gives it"
        )
    return f"  {quoted(name)}: {{rate: {-math.log1p(-chance) / time!r} /h}}  # {chance!r} at {time:g} h"


class _Diagram:
    """The lines of a diagram; a block that is drawn again is named where it is drawn first."""

    def __init__(self, diagram: Block, names: dict[str, str]) -> None:
        self.names = names
        self.uses: Counter[int] = Counter()
        seen: set[int] = set()
        todo = [diagram]
        while todo:
            block = todo.pop()
            self.uses[id(block)] += 1
            if id(block) not in seen and not isinstance(block, Unit):
                seen.add(id(block))
                todo += block.blocks
        self.anchors: dict[int, str] = {}
        self.lines = list(self._lines(diagram, "  ", ""))

    def _lines(self, block: Block, pad: str, lead: str) -> Iterator[str]:
        """The lines of the whole diagram, or of a block in a list, after ``lead``."""
        todo: list[tuple[Block, str, str]] = [(block, pad, lead)]
        while todo:
            one, indent, before = todo.pop()
            if isinstance(one, Unit):
                yield f"{indent}{before}{quoted(self.names[one.name])}"
                continue
            if id(one) in self.anchors:
                yield f"{indent}{before}*{self.anchors[id(one)]}"
                continue
            inner = indent + " " * len(before)
            if self.uses[id(one)] > 1:
                self.anchors[id(one)] = f"gate_{len(self.anchors) + 1}"
                yield f"{indent}{before}&{self.anchors[id(one)]}"
                before = " " * len(before)
            if isinstance(one, KOutOfN):
                yield f"{indent}{before}k_of_n:"
                yield f"{inner}  k: {one.k}"
                yield f"{inner}  of:"
                inner += "  "
            else:
                yield f"{indent}{before}{'parallel' if isinstance(one, Parallel) else 'series'}:"
            todo += [(part, f"{inner}  ", "- ") for part in reversed(one.blocks)]
