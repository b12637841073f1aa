"""Labels of the boxes of a robot's diagram: name, hazard rate, how many equal parts, silent sensors."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

from robophm.design.robot import Robot
from robophm.report.outline import Label
from robophm.report.words import rate_text


def part_labels(
    robot: Robot, rates: Mapping[str, float], unit: str = "1/h", stale: Collection[str] = (),
    unknown: Mapping[str, str] | None = None,
) -> Callable[[str], Label]:  # fmt: skip
    """Labels by path of module, component or member; ``rates`` [1/h] are by path, all equal parts together.

    ``unknown``: what stands before the rate of a module with parts of unknown rate in it.
    """
    marked = {part.path: "≥ " for part in robot.all_components() if part.unknown} | dict(unknown or {})
    several = {part.path: part for part in robot.all_components() if part.quantity > 1}

    def label(path: str) -> Label:
        stem = path.partition("[")[0]
        part, rate, badge = several.get(stem), rates[stem], ""
        if part and stem != path:
            rate /= part.quantity
        elif part:
            badge = f"×{part.quantity}" if part.required == part.quantity else f"{part.required} of {part.quantity}"
        mark = marked.get(stem, "")
        said = "rate unknown" if mark and not rate else mark + rate_text(rate, unit)
        return Label(path.rpartition("/")[2], said, badge, "stale" if path in stale else "ok")

    return label
