"""A level's block diagram laid out for the page: the same layout as of reports, the boxes as data."""

from __future__ import annotations

from collections import Counter
from itertools import chain

from robophm.blocks.diagram import units
from robophm.core.errors import DesignError, nearest
from robophm.health.unknown_rates import marks
from robophm.report.dependence import dependence
from robophm.report.labels import part_labels
from robophm.report.layout import Measures, layout
from robophm.report.markup import text_width
from robophm.report.outline import Label, More, Spare, names, outline, words
from robophm.web.prepared_robot import PreparedRobot
from robophm.web.shapes import Box, Drawing, Gate, Line, Unit

MOST_BOXES = 400
_TITLE, _DETAIL = 13.0, 12.0  # font sizes
_NARROWEST, _WIDEST = 120.0, 210.0
_HEIGHT = 48.0


def drawing(prepared: PreparedRobot, path: str, width: float, unit: Unit, *, whole: bool = False) -> Drawing:
    """Return the diagram of the level at a path, as drawn, or ``whole``: down to its parts. Raises DesignError."""
    module = prepared.modules.get(path)
    if module is None:
        raise DesignError(f"no module '{path}'{nearest(path, prepared.modules)}")
    diagram = module.diagram if whole else module.wiring
    nodes = outline(diagram, MOST_BOXES)
    places = Counter(units(diagram)) | Counter(names(nodes))
    marked = {path: marks(one)[0] for path, one in prepared.unknown.items()}
    say = part_labels(prepared.robot, prepared.rates, unit, unknown=marked)
    labels: dict[str, Label] = {}
    for name in names(nodes):
        try:
            labels[name] = say(name)
        except KeyError:  # a common cause, a group: no part of the design
            labels[name] = Label(name.rpartition("/")[2])
    wide = max([_NARROWEST, *(_needs(label) for label in labels.values())])
    drawn = layout(nodes, _measures(min(wide, _WIDEST)), width)
    return Drawing(
        path=path,
        width=drawn.width,
        height=drawn.height,
        boxes=[
            _more(box.x, box.y, box.width, box.height, box.part)
            if isinstance(box.part, More)
            else Box(
                x=box.x, y=box.y, width=box.width, height=box.height, part=str(box.part),
                title=labels[box.part].title, detail=labels[box.part].detail, badge=labels[box.part].badge,
                kind="module" if box.part in prepared.modules else "component",
                spare=isinstance(box.part, Spare), places=places[box.part],
                single_point=str(box.part) in prepared.single_points,
            )
            for box in drawn.boxes
        ],
        gates=[
            Gate(x=gate.x, y=gate.y, width=gate.width, text=gate.text, parts=[str(name) for name in names(gate.of)])
            for gate in drawn.gates
        ],
        wires=[Line(points=[*wire.points], dashed=wire.dashed) for wire in drawn.wires],
        ends=[*drawn.ends],
        notes=list(chain(dependence(prepared.robot, path))),
        words=f"Works while {words(nodes, labels)} work.",
    )  # fmt: skip


def _more(x: float, y: float, width: float, height: float, more: More) -> Box:
    return Box(
        x=x, y=y, width=width, height=height, part=None, title=str(more), detail="", badge="", kind="more",
        spare=False, places=1, single_point=False,
    )  # fmt: skip


def _needs(label: Label) -> float:
    detail = text_width(label.detail, _DETAIL) + text_width(label.badge, _DETAIL) + 12
    return 36 + max(text_width(label.title, _TITLE, bold=True) + 16, detail)


def _measures(box: float) -> Measures:
    gap, margin = 26.0, 24.0
    return Measures(
        box=lambda part: box,
        gate=lambda text: max(34.0, text_width(text, _DETAIL) + 14),
        half=lambda length: length / 2,
        height=_HEIGHT,
        bar=0.0,
        gap=gap,
        stub=16.0,
        margin=margin,
        branch_gap=14.0,
        row_gap=32.0,
        narrowest=2 * box + gap + 2 * margin,
    )
