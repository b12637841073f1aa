"""A block diagram as SVG: for a page, a notebook or a file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from robophm.blocks.diagram import Block, units
from robophm.report.layout import Box, Gate, Measures, Wire, layout
from robophm.report.markup import Html, element, number, shorten, text_width
from robophm.report.outline import Label, More, Spare, names, outline, words
from robophm.report.style import MARKS
from robophm.report.svg import svg, text

_HEIGHT, _PAD, _RADIUS = 36.0, 10.0, 12.5
_NARROWEST, _WIDEST = 92.0, 160.0  # boxes are all of one width, that of the longest text between these
_INDENT, _EDGE, _SYMBOL = 12.0, 8.0, 14.0  # left and right of the text in a box; a symbol and its gap
_TITLE, _DETAIL = 11.0, 10.0  # font sizes

_STYLE = (
    f".rbd text{{fill:var(--ink)}}.rbd .title{{font-size:{_TITLE:g}px;font-weight:600}}"
    f".rbd .detail,.rbd .badge{{font-size:{_DETAIL:g}px;fill:var(--quiet)}}.rbd .badge{{text-anchor:end}}"
    f".rbd .gate text{{font-size:{_DETAIL:g}px;text-anchor:middle}}"
    ".rbd .gate rect{fill:var(--card);stroke:var(--gate)}"
    ".rbd .box{fill:var(--card);stroke:var(--edge)}.rbd .more .box,.rbd .spare .box{stroke-dasharray:4 3}"
    ".rbd .wire{fill:none;stroke:var(--line);stroke-width:1.2;stroke-linejoin:round}"
    ".rbd .dashed{stroke-dasharray:2.5 2.5}.rbd .end{fill:var(--line)}"
    ".rbd .shared{fill:none;stroke:var(--quiet);stroke-width:1.2}"
    + "".join(f".rbd .{tone} .tone{{fill:var(--{tone})}}" for tone in MARKS)
)


def diagram_svg(
    diagram: Block,
    label: Callable[[str], Label],
    width: float = 1000,
    standalone: bool = False,
    max_boxes: int = 400,
) -> Html:
    """The diagram as one SVG element, in rows of ``width`` [px]; what cannot wrap is scaled down to it.

    A unit drawn in several places carries two overlapping squares. Beyond ``max_boxes`` boxes, and in
    groups nested very deeply, a dashed box counts the parts left out. ``standalone`` makes it a file.
    """
    nodes = outline(diagram, max_boxes)
    places = Counter(units(diagram)) | Counter(names(nodes))
    labels = {name: label(name) for name in names(nodes)}
    box = max([_NARROWEST, *(_needs(says, places[name]) for name, says in labels.items())])
    drawn = layout(nodes, _measures(min(box, _WIDEST)), width - 2 * _PAD)
    wide, high = drawn.width + 2 * _PAD, drawn.height + 2 * _PAD
    content = [
        _wires("wire", [wire for wire in drawn.wires if not wire.dashed]),
        _wires("wire dashed", [wire for wire in drawn.wires if wire.dashed]),
        *(element("circle", class_="end", cx=x, cy=y, r=3) for x, y in drawn.ends),
        *(
            _more(box, box.part) if isinstance(box.part, More) else _unit(box, labels[box.part], places[box.part])
            for box in drawn.boxes
        ),
        *map(_gate, drawn.gates),
    ]
    return svg(
        "rbd",
        content,
        title="Reliability block diagram",
        description=f"Works while {words(nodes, labels)} work.",
        style=_STYLE,
        view=(-_PAD, -_PAD, wide, high),
        scale=min(1.0, width / wide),
        standalone=standalone,
    )


def _measures(box: float) -> Measures:
    gap, margin = 18, 20
    return Measures(
        box=lambda part: box,
        gate=lambda text: max(2 * _RADIUS, text_width(text, _DETAIL) + 12),
        half=lambda length: length / 2,
        height=_HEIGHT,
        bar=0,
        gap=gap,
        stub=12,
        margin=margin,
        branch_gap=10,
        row_gap=24,
        narrowest=2 * box + gap + 2 * margin,
    )


def _needs(label: Label, places: int) -> float:
    """The width of a box in which nothing of the label is shortened."""
    symbols = _SYMBOL * ((label.tone != "ok") + (places > 1))
    title = text_width(label.title, _TITLE, bold=True) + symbols
    detail = text_width(label.detail, _DETAIL) + text_width(label.badge, _DETAIL) + _EDGE * bool(label.badge)
    return _INDENT + max(title, detail) + _EDGE


def _wires(kind: str, wires: list[Wire]) -> Html:
    path = "".join("M" + "L".join(f"{number(x)} {number(y)}" for x, y in wire.points) for wire in wires)
    return element("path", class_=kind, d=path) if path else Html()


def _unit(box: Box, label: Label, places: int) -> Html:
    hint = [f"{label.title} {label.badge}".strip(), label.detail, MARKS[label.tone].word]
    edge = end = box.width - _EDGE
    symbols = []
    if label.tone != "ok":
        place = f"translate({number(end - 10)} 7)"
        symbols.append(element("path", class_="tone", d=MARKS[label.tone].path, transform=place))
        end -= _SYMBOL
    if places > 1:
        hint.append(f"drawn in {places} places, one part")
        place = f"translate({number(end - 10)} 7.5)"
        symbols.append(element("path", class_="shared", d="M0 0h6.5v6.5H0ZM3.5 3.5H10V10H3.5Z", transform=place))
        end -= _SYMBOL
    badge = shorten(label.badge, box.width / 2, _DETAIL)
    room = edge - _INDENT - text_width(badge, _DETAIL) - _EDGE * bool(badge)
    if waits := isinstance(box.part, Spare):
        hint.append("waits as a spare")
    return _frame(
        box,
        f"{label.tone} spare" if waits else label.tone,
        " · ".join(filter(None, hint)),
        element("path", class_="tone", d=f"M5 0H4a4 4 0 0 0-4 4V{_HEIGHT - 4:g}a4 4 0 0 0 4 4H5Z"),
        text(_INDENT, 15.5, shorten(label.title, end - _INDENT, _TITLE, bold=True), "title"),
        text(_INDENT, 29, shorten(label.detail, room, _DETAIL), "detail"),
        text(edge, 29, badge, "badge"),
        *symbols,
    )


def _more(box: Box, more: More) -> Html:
    short = shorten(str(more), box.width - _INDENT - _EDGE, _DETAIL)
    return _frame(box, "more", str(more), text(_INDENT, 22, short, "detail"))


def _frame(box: Box, kind: str, hint: str, *content: Html) -> Html:
    frame = element("rect", class_="box", width=box.width, height=box.height, rx=4)
    place = f"translate({number(box.x)} {number(box.y)})"
    return element("g", element("title", hint), frame, *content, class_=kind, transform=place)


def _gate(gate: Gate) -> Html:
    x, y, width, high = gate.x, gate.y - _RADIUS, gate.width, 2 * _RADIUS
    outline = element("rect", x=x, y=y, width=width, height=high, rx=_RADIUS)
    return element("g", outline, text(x + width / 2, gate.y + 3.5, gate.text), class_="gate")
