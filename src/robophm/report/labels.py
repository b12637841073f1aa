"""What stands in the boxes of a robot's diagram: name, hazard rate, how many equal parts, silent sensors."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

from robophm.design.robot import Robot
from robophm.report.outline import Label
from robophm.report.words import rate_text


def part_labels(
    robot: Robot, rates: Mapping[str, float], unit: str = "1/h", stale: Collection[str] = ()
) -> Callable[[str], Label]:
    """Labels by path of module, component or member; ``rates`` [1/h] are by path, all equal parts together."""
    several = {part.path: part for part in robot.all_components() if part.quantity > 1}

    def label(path: str) -> Label:
        stem = path.partition("[")[0]
        part, rate, badge = several.get(stem), rates[stem], ""
        if part and stem != path:
            rate /= part.quantity
        elif part:
            badge = f"×{part.quantity}" if part.required == part.quantity else f"{part.required} of {part.quantity}"
        return Label(path.rpartition("/")[2], rate_text(rate, unit), badge, "stale" if path in stale else "ok")

    return label
