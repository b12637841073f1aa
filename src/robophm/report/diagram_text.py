"""A block diagram in characters, for a terminal."""

from __future__ import annotations

import unicodedata
from collections import Counter
from collections.abc import Callable

from robophm.blocks.diagram import Block, units
from robophm.report.layout import Drawing, Measures, layout
from robophm.report.outline import Label, More, Spare, names, outline
from robophm.report.style import MARKS

_UP, _DOWN, _LEFT, _RIGHT = 1, 2, 4, 8  # arms of a cell; their sum indexes the lines
_LINES, _ASCII_LINES = " │││─┘┐┤─└┌├─┴┬┼", " |||-+++-+++-+++"


def diagram_text(
    diagram: Block,
    label: Callable[[str], Label],
    width: int = 100,
    ascii_only: bool = False,
    max_boxes: int = 400,
) -> str:
    """The diagram in box-drawing characters, in rows of ``width`` columns where that is possible.

    A box is its label's title and badge; ▲ ✖ ? before it say warn, error, stale, and ⧉ behind it that
    the unit is drawn in several places; a spare that waits is in parentheses. A row that goes on ends in
    ``╌>``, the next starts with ``>╌``.
    ``ascii_only`` draws with ``+-|>``, ``! x ?`` and ``&``.
    """
    nodes = outline(diagram, max_boxes)
    places = Counter(units(diagram)) | Counter(names(nodes))
    longest = max(8, min(32, width // 3))

    def text(part: str | More) -> str:
        if isinstance(part, More):
            return _ascii(f"({part})") if ascii_only else f"({part})"
        says, mark = label(part), MARKS[label(part).tone]
        words = [
            mark.plain if ascii_only else mark.symbol,
            _shorten(_printable(says.title), longest),
            _shorten(_printable(says.badge), longest),
            ("&" if ascii_only else "⧉") if places[part] > 1 else "",
        ]
        line = " ".join(filter(None, words))
        if isinstance(part, Spare):
            line = f"({line})"
        return _ascii(line) if ascii_only else line

    measures = Measures(
        box=lambda part: cells(text(part)) + 2,
        gate=lambda text: len(text) + 2,
        half=lambda length: length // 2,
        height=1,
        bar=1,
        gap=2,
        stub=1,
        margin=3,
        branch_gap=0,
        row_gap=1,
        narrowest=0,
    )
    return _drawn(layout(nodes, measures, width), text, ascii_only)


def _drawn(drawn: Drawing, text: Callable[[str | More], str], ascii_only: bool) -> str:
    """Wires, boxes and gates in their places."""
    arms = [[0] * int(drawn.width) for _ in range(int(drawn.height))]
    for wire in drawn.wires:
        steps = list(zip(wire.points, wire.points[1:], strict=False))
        for (x0, y0), (x1, y1) in steps[-1:] if wire.dashed else steps:
            _line(arms, int(x0), int(y0), int(x1), int(y1))
    canvas = [[(_ASCII_LINES if ascii_only else _LINES)[cell] for cell in row] for row in arms]
    for wire in drawn.wires:
        if wire.dashed:  # the way back to the next row would fill the screen: two arrows are enough
            (end, above), *_, (start, below) = wire.points
            _write(canvas[int(above)], int(end), "->" if ascii_only else "╌>")
            _write(canvas[int(below)], int(start) - 2, ">-" if ascii_only else ">╌")
    for box in drawn.boxes:
        _write(canvas[int(box.y)], int(box.x), f" {text(box.part)} ")
    for gate in drawn.gates:
        _write(canvas[int(gate.y)], int(gate.x), f"({gate.text})")
    return "\n".join("".join(row).rstrip() for row in canvas)


def cells(text: str) -> int:
    """Columns that a text takes in a terminal: two for a wide character, none for a combining one."""
    return sum(map(_cell, text))


def _cell(character: str) -> int:
    if unicodedata.category(character) in ("Mn", "Me", "Cf"):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def _line(arms: list[list[int]], x0: int, y0: int, x1: int, y1: int) -> None:
    (x0, x1), (y0, y1) = sorted((x0, x1)), sorted((y0, y1))
    for x in range(x0, x1):
        arms[y0][x] |= _RIGHT
        arms[y0][x + 1] |= _LEFT
    for y in range(y0, y1):
        arms[y][x0] |= _DOWN
        arms[y + 1][x0] |= _UP


def _write(row: list[str], x: int, text: str) -> None:
    for character in text:
        if (taken := _cell(character)) == 0:
            row[x - 1] += character
            continue
        row[x : x + taken] = [character, *[""] * (taken - 1)]
        x += taken


def _shorten(text: str, width: int) -> str:
    if cells(text) <= width:
        return text
    while cells(text) > width - 1:
        text = text[: min(len(text) - 1, width)]
    return text.rstrip() + "…"


def _printable(text: str) -> str:
    """The text on one line, without the control characters that would steer a terminal."""
    return "".join(c if c.isprintable() else "\ufffd" for c in " ".join(text.split()))


def _ascii(text: str) -> str:
    return text.replace("×", "x").replace("…", "...").encode("ascii", "replace").decode()
