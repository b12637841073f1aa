"""A level's block diagram laid out for the page: the same layout as of reports, the boxes as data."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress

from robophm.blocks.diagram import units
from robophm.core.errors import DesignError, RobophmError, nearest
from robophm.design.drawable import Drawable
from robophm.health.unknown_rates import marks
from robophm.report.dependence import dependence
from robophm.report.labels import part_labels
from robophm.report.layout import Box as PlacedBox
from robophm.report.layout import Measures, layout
from robophm.report.markup import text_width
from robophm.report.outline import Label, More, Spare, names, outline, words
from robophm.report.words import count_text
from robophm.web.prepared_robot import PreparedRobot
from robophm.web.shapes import Box, Drawing, Gate, Line, Unit

MOST_BOXES, MOST_PARTS = 400, 2000
"""The most boxes of a level as it opens, and down to its parts."""
_TITLE, _DETAIL = 13.0, 12.0  # font sizes
_NARROWEST, _WIDEST = 120.0, 210.0
_HEIGHT = 48.0
_MANY, _BROADEST = 12, 20_000.0


def drawing(
    prepared: PreparedRobot, drawn: Drawable, path: str, width: float, unit: Unit, *, whole: bool = False,
    around: str = "",
) -> Drawing:  # fmt: skip
    """Return the diagram of the level at a path, as drawn, or ``whole``: down to its parts. Raises DesignError.

    Where it has more parts than are drawn at once, it is the stretch in which the part ``around`` is, else the first.
    Of a design that is wrong all levels are drawn for themselves: what is in them together may not be known.
    """
    module = prepared.modules.get(path)
    if module is None:
        raise DesignError(f"no module '{path}'{nearest(path, prepared.modules)}")
    level = Drawing(
        path=path, wrong=drawn.mistakes(path), wired=path not in drawn.unwired,
        elsewhere=len(drawn.mistakes("")) - len(drawn.mistakes(path)), notes=[*dependence(prepared.robot, path)],
        width=0, height=0, boxes=[], gates=[], wires=[], ends=[], words="It has no parts.",
    )  # fmt: skip
    if path in drawn.empty:
        return level
    diagram, most = module.diagram if whole and not drawn.wrong else module.wiring, MOST_PARTS if whole else MOST_BOXES
    every = [unit.partition("[")[0] for unit in units(diagram)]
    first = _place_of(around, every) // most * most
    level.earlier = every[first - most] if first else None
    level.later = every[first + most] if first + most < len(every) else None
    nodes = outline(diagram, most, first)
    places = Counter(units(module.diagram if whole else module.wiring)) | Counter(names(nodes))
    labels = _labels(prepared, drawn, [*names(nodes)], unit)
    wide = max([_NARROWEST, *(_needs(label) for label in labels.values())])
    measures = _measures(min(wide, _WIDEST))
    laid = layout(nodes, measures, width)
    while len(laid.boxes) > _MANY and laid.height > laid.width and width < _BROADEST:
        width *= 1.5  # a strip is seen from too far away
        laid = layout(nodes, measures, width)
    if level.earlier or level.later:
        level.notes.append(_left_out(laid.boxes))
    level.wrong = _in_no_box(drawn, path, {name.partition("[")[0] for name in names(nodes)})
    level.width, level.height = laid.width, laid.height
    level.boxes = [
        _more(box.x, box.y, box.width, box.height, box.part)
        if isinstance(box.part, More)
        else Box(
            x=box.x, y=box.y, width=box.width, height=box.height, part=str(box.part),
            title=labels[box.part].title, detail=labels[box.part].detail, badge=labels[box.part].badge,
            kind="module" if box.part in prepared.modules else "component",
            spare=isinstance(box.part, Spare), places=places[box.part],
            single_point=not drawn.wrong and str(box.part) in prepared.single_points,
            wrong=drawn.mistakes(box.part.partition("[")[0]),
        )
        for box in laid.boxes
    ]  # fmt: skip
    level.words = "How its parts work together is not known."
    if level.wired:
        level.words = f"Works while {words(nodes, labels)} work."
        level.wires = [Line(points=[*wire.points], dashed=wire.dashed) for wire in laid.wires]
        level.ends = [*laid.ends]
    level.gates = [
        Gate(x=gate.x, y=gate.y, width=gate.width, text=gate.text, parts=[str(name) for name in names(gate.of)])
        for gate in laid.gates
    ]
    return level


def _place_of(part: str, every: Sequence[str]) -> int:
    """The place of a part's first unit among those of a diagram, of the first in it, or of what it is in; else 0."""
    if not part:
        return 0
    for is_it in (part.__eq__, lambda one: one.startswith(f"{part}/"), lambda one: part.startswith(f"{one}/")):
        if (found := next((i for i, one in enumerate(every) if is_it(one)), None)) is not None:
            return found
    return 0


def _left_out(boxes: Sequence[PlacedBox]) -> str:
    """What is said of the parts before and behind those that are drawn."""
    counts = [box.part.count if isinstance(box.part, More) else 0 for box in boxes]
    first = next((i for i, count in enumerate(counts) if not count), len(counts))
    before, behind = sum(counts[:first]), sum(counts[first:])
    return f"Not drawn are {count_text(before)} parts before these and {count_text(behind)} behind."


def _labels(prepared: PreparedRobot, drawn: Drawable, parts: Sequence[str], unit: Unit) -> dict[str, Label]:
    """Labels of what is drawn; without a rate where that is wrong, or the robot cannot be computed at all."""
    labels: dict[str, Label] = {}
    try:
        marked = {path: marks(one)[0] for path, one in prepared.unknown.items()}
        say = part_labels(prepared.robot, prepared.rates, unit, unknown=marked)
    except RobophmError:
        return {name: Label(name.rpartition("/")[2]) for name in parts}
    for name in parts:
        mistakes = drawn.mistakes(name.partition("[")[0])
        labels[name] = Label(name.rpartition("/")[2], mistakes[0] if mistakes else "")
        if not mistakes:
            with suppress(KeyError):  # a common cause, a group: no part of the design
                labels[name] = say(name)
    return labels


def _in_no_box(drawn: Drawable, level: str, boxes: set[str]) -> list[str]:
    """The mistakes of a level itself, and of what is in it and not drawn."""
    below = f"{level}/" if level else ""
    found = [*drawn.wrong.get(level, ())]
    for path, said in drawn.wrong.items():
        inside = path != level and path.startswith(below)
        if inside and not any(f"{path}/".startswith(f"{box}/") for box in boxes):
            found += [f"{path.removeprefix(below)}: {message}" for message in said]
    return found


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
