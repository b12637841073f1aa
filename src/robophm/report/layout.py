"""Layout of a block diagram's boxes: recursive, in rows that wrap. The same for pixels and characters.

Series run left to right and wrap into rows joined by dashed wires; branches stand between two bars, with
a gate "k/n" behind them. A piece is measured first (width, height, and where the wire enters and leaves),
then drawn at a place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from robophm.report.outline import Chain, Fork, More, Node

Point = tuple[float, float]


@dataclass(frozen=True)
class Measures:
    """The sizes of a medium: pixels or character cells."""

    box: Callable[[str | More], float]  # its width
    gate: Callable[[str], float]  # its width
    half: Callable[[float], float]  # /2 or //2
    height: float  # of a box
    bar: float  # thickness of a bar
    gap: float  # between boxes in series
    stub: float  # between a bar and what is beside it
    margin: float  # beside wrapped rows, for the wires that join them
    branch_gap: float
    row_gap: float
    narrowest: float  # a row is not wrapped to less than this


class Box(NamedTuple):
    """A box for a unit, or for the parts left out."""

    x: float
    y: float
    width: float
    height: float
    part: str | More


class Gate(NamedTuple):
    """A "k/n" behind branches; ``y`` is the height of its wire."""

    x: float
    y: float
    width: float
    text: str
    of: Fork


class Wire(NamedTuple):
    """A polyline of horizontal and vertical segments."""

    points: tuple[Point, ...]
    dashed: bool


@dataclass
class Drawing:
    """A diagram laid out, from (0, 0) to (width, height); ``ends`` are where it starts and stops."""

    width: float = 0
    height: float = 0
    boxes: list[Box] = field(default_factory=list)
    gates: list[Gate] = field(default_factory=list)
    wires: list[Wire] = field(default_factory=list)
    ends: list[Point] = field(default_factory=list)

    def wire(self, *points: Point, dashed: bool = False) -> None:
        """Add a wire, unless it has no length."""
        if points[0] != points[-1]:
            self.wires.append(Wire(points, dashed))


@dataclass(frozen=True)
class _Piece:
    width: float
    height: float
    enter: float  # below the top of the piece, on its left side
    leave: float  # the same on its right side
    draw: Callable[[Drawing, float, float], None]


def layout(node: Node, measures: Measures, width: float) -> Drawing:
    """The diagram in rows of at most ``width`` where that is possible, else in wider ones."""
    piece = _Layout(measures).chain(node.nodes if isinstance(node, Chain) else (node,), width, outer=True)
    drawing = Drawing(piece.width, piece.height)
    piece.draw(drawing, 0, 0)
    return drawing


@dataclass(frozen=True)
class _Layout:
    m: Measures

    def piece(self, node: Node, room: float) -> _Piece:
        if isinstance(node, Chain):
            return self.chain(node.nodes, room)
        return self.fork(node, room) if isinstance(node, Fork) else self.box(node)

    def box(self, part: str | More) -> _Piece:
        width, height = self.m.box(part), self.m.height
        axis = self.m.half(height - self.m.bar)

        def draw(to: Drawing, x: float, y: float) -> None:
            to.boxes.append(Box(x, y, width, height, part))

        return _Piece(width, height, axis, axis, draw)

    def fork(self, fork: Fork, room: float) -> _Piece:
        m, text = self.m, fork.text
        gate, lead = m.gate(text), m.bar + m.stub
        pieces = [self.piece(node, room - gate - 2 * lead - m.stub) for node in fork.nodes]
        inside = max(piece.width for piece in pieces)
        # branches of several rows stand further apart than their rows
        gap = m.row_gap if any(piece.height > m.height for piece in pieces) else m.branch_gap
        height = sum(piece.height for piece in pieces) + gap * (len(pieces) - 1)
        axis = m.half(height - m.bar)

        def draw(to: Drawing, x: float, y: float) -> None:
            right, middle, top = x + lead + inside + m.stub, y + axis, y
            enters, leaves = [middle], [middle]
            for piece in pieces:
                start = x + lead + m.half(inside - piece.width)
                enters.append(top + piece.enter)
                leaves.append(top + piece.leave)
                to.wire((x, enters[-1]), (start, enters[-1]))
                piece.draw(to, start, top)
                to.wire((start + piece.width, leaves[-1]), (right, leaves[-1]))
                top += piece.height + gap
            to.wire((x, min(enters)), (x, max(enters)))
            to.wire((right, min(leaves)), (right, max(leaves)))
            to.wire((right, middle), (right + lead, middle))
            to.gates.append(Gate(right + lead, middle, gate, text, fork))

        return _Piece(inside + gate + 3 * m.stub + 2 * m.bar, height, axis, axis, draw)

    def chain(self, nodes: Sequence[Node], room: float, outer: bool = False) -> _Piece:
        m = self.m
        room = max(room, m.narrowest) - 2 * m.margin
        rows = self.rows((self.piece(node, room) for node in nodes), room)
        margin = m.margin if outer or len(rows) > 1 else 0
        ups = [max(piece.enter for piece in row) for row in rows]
        heights = [up + max(p.height - p.enter for p in row) for up, row in zip(ups, rows, strict=True)]
        width = max(self.length(row) for row in rows) + 2 * margin
        height = sum(heights) + m.row_gap * (len(rows) - 1)

        def draw(to: Drawing, x: float, y: float) -> None:
            wire: list[Point] = [(x, y + ups[0])]
            for i, (row, up) in enumerate(zip(rows, ups, strict=True)):
                axis, at = y + up, x + margin
                to.wire(*wire, (at, axis), dashed=i > 0)
                for piece in row:
                    piece.draw(to, at, axis - piece.enter)
                    end = at + piece.width
                    at = end + m.gap
                    if piece is not row[-1]:
                        to.wire((end, axis), (at, axis))
                y += heights[i] + m.row_gap
                left, right = x + m.half(margin), end + m.half(margin)
                turn = y - m.row_gap + m.half(m.row_gap - m.bar)
                below = y + ups[i + 1] if i + 1 < len(rows) else y
                wire = [(end, axis), (right, axis), (right, turn), (left, turn), (left, below)]
            stop = end + margin - m.bar if outer else x + width
            to.wire((end, axis), (stop, axis))
            if outer:
                to.ends += [(x, ups[0]), (stop, axis)]

        return _Piece(width, height, ups[0], height - heights[-1] + ups[-1], draw)

    def rows(self, pieces: Iterable[_Piece], room: float) -> list[list[_Piece]]:
        rows: list[list[_Piece]] = []
        used = room
        for piece in pieces:
            used += self.m.gap + piece.width
            if used > room:
                rows.append([])
                used = piece.width
            rows[-1].append(piece)
        return rows

    def length(self, row: Sequence[_Piece]) -> float:
        return sum(piece.width for piece in row) + self.m.gap * (len(row) - 1)
