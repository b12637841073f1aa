"""What the 2020 tool makes of a design: its roll-up, kept so that its users can compare. Wrong for redundancy.

Series Σλ; "parallel" Σλ/Hₙ with Hₙ = 1 + 1/2 + … + 1/n; the reliability of a constant rate, exp(−λt). Two equal
units in parallel come out at 4/3 λ, worse than one.
"""

from __future__ import annotations

import math

from robophm.blocks.diagram import Block, Parallel, Series, Unit
from robophm.core.errors import StructureError
from robophm.design.robot import Module


def legacy_rate(module: Module) -> float:
    """The 2020 tool's failure rate of a module as it is drawn [1/h].

    Raises StructureError for what that tool cannot draw: k-of-n groups, and clocks other than hours.
    """
    rates = {inner.path: inner for inner in module.modules}
    parts = {component.path: component for component in module.all_components()}

    def rate(block: Block) -> float:
        if isinstance(block, Unit):
            if block.name in rates:
                return legacy_rate(rates[block.name])
            part = parts[block.name.partition("[")[0]]
            if part.required < part.quantity or any(mode.clock not in ("operating", "calendar") for mode in part.modes):
                raise StructureError(f"{part.path}: the 2020 tool knows neither k-of-n nor clocks other than hours")
            return part.quantity * math.fsum(mode.rate for mode in part.modes)
        total = math.fsum(rate(inner) for inner in block.blocks)
        if isinstance(block, Series):
            return total
        if isinstance(block, Parallel):
            return total / math.fsum(1 / n for n in range(1, len(block.blocks) + 1))
        raise StructureError("the 2020 tool knows no k-of-n groups")

    return rate(module.wiring)


def legacy_reliability(module: Module, hours: float) -> float:
    """The 2020 tool's reliability of a module: exp(−λt) with its rate, whatever the structure."""
    return math.exp(-legacy_rate(module) * hours)
