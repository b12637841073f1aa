"""The SVG diagram is checked as geometry: what is where, and that nothing lies on anything else."""

from __future__ import annotations

import time
import xml.etree.ElementTree as ET
from itertools import combinations, pairwise
from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.cases import examples

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit, units
from robophm.report.diagram_svg import diagram_svg
from robophm.report.outline import Label

NAMES = [f"part {i}" for i in range(30)]


class Rect(NamedTuple):
    x: float
    y: float
    width: float
    height: float

    def shrunk(self, by: float) -> Rect:
        return Rect(self.x + by, self.y + by, self.width - 2 * by, self.height - 2 * by)

    def overlaps(self, other: Rect) -> bool:
        apart = (
            self.x + self.width <= other.x
            or other.x + other.width <= self.x
            or self.y + self.height <= other.y
            or other.y + other.height <= self.y
        )
        return not apart

    def inside(self, other: Rect) -> bool:
        return (
            self.x >= other.x
            and self.y >= other.y
            and self.x + self.width <= other.x + other.width
            and self.y + self.height <= other.y + other.height
        )


def label(name: str) -> Label:
    return Label(name, "4e-8 /h", "×2")


def rects(svg: str) -> list[Rect]:
    """The boxes, then the gates."""
    root = ET.fromstring(svg)
    found = []
    for group in root.iter("g"):
        rect = group.find("rect")
        assert rect is not None
        x, y = 0.0, 0.0
        if "transform" in group.attrib:
            x, y = map(float, group.attrib["transform"].removeprefix("translate(").removesuffix(")").split())
        at = (float(rect.get("x", 0)) + x, float(rect.get("y", 0)) + y)
        found.append(Rect(*at, float(rect.attrib["width"]), float(rect.attrib["height"])))
    return found


def view(svg: str) -> Rect:
    return Rect(*map(float, ET.fromstring(svg).attrib["viewBox"].split()))


def titles(svg: str) -> list[str]:
    return [text.text or "" for text in ET.fromstring(svg).iter("text") if text.get("class") == "title"]


def hints(svg: str) -> list[str]:
    return [title.text or "" for group in ET.fromstring(svg).iter("g") for title in group.iter("title")]


def wires(svg: str) -> list[Rect]:
    """Each straight piece of wire, as a rectangle of no width or no height."""
    pieces = []
    for path in ET.fromstring(svg).iter("path"):
        if "wire" in path.get("class", ""):
            for line in path.attrib["d"].split("M")[1:]:
                points = [tuple(map(float, point.split())) for point in line.split("L")]
                for (x0, y0), (x1, y1) in pairwise(points):
                    assert x0 == x1 or y0 == y1
                    pieces.append(Rect(min(x0, x1), min(y0, y1), abs(x1 - x0), abs(y1 - y0)))
    return pieces


def groups(inner: st.SearchStrategy[Block]) -> st.SearchStrategy[Block]:
    several = st.lists(inner, min_size=1, max_size=5)
    return st.one_of(
        several.map(lambda blocks: Series(*blocks)),
        several.map(lambda blocks: Parallel(*blocks)),
        several.flatmap(lambda b: st.integers(1, len(b)).map(lambda k: KOutOfN(k, *b))),
    )


diagrams = st.recursive(st.sampled_from(NAMES).map(Unit), groups, max_leaves=40)


@settings(derandomize=True, deadline=None, max_examples=examples(150))
@given(diagrams, st.sampled_from([300.0, 1000.0]))
def test_nothing_overlaps_and_all_is_in_view(diagram: Block, width: float) -> None:
    svg = diagram_svg(diagram, label, width)
    shown, everything = rects(svg), view(svg)
    assert all(rect.inside(everything) for rect in shown)
    assert not any(a.overlaps(b) for a, b in combinations(shown, 2))
    for wire in wires(svg):
        assert wire.inside(everything)
        assert not any(wire.overlaps(rect.shrunk(0.1)) for rect in shown)
    assert titles(svg) == list(units(diagram))


def test_series_is_one_line() -> None:
    a, b = rects(diagram_svg(Series("a", "b"), label))
    assert a.y == b.y
    assert a.x + a.width < b.x


def test_branches_stand_under_each_other_before_their_gate() -> None:
    svg = diagram_svg(Series("a", KOutOfN(2, "b", "c", "d")), label)
    a, b, c, d, gate = rects(svg)
    assert b.x == c.x == d.x
    assert b.y < c.y < d.y
    assert gate.x > c.x + c.width
    middle = c.y + c.height / 2
    assert a.y + a.height / 2 == gate.y + gate.height / 2 == pytest.approx(middle)
    assert ">2/3</text>" in svg
    assert ">1/2</text>" in diagram_svg(Parallel("a", "b"), label)


def test_long_series_wraps_into_rows_joined_by_dashed_wires() -> None:
    svg = diagram_svg(Series(*NAMES), label, width=700)
    assert view(svg).width <= 700
    assert len({rect.y for rect in rects(svg)}) > 3
    assert 'class="wire dashed"' in svg
    assert 'class="wire dashed"' not in diagram_svg(Series("a", "b"), label, width=700)


def test_long_series_wraps_inside_a_branch_too() -> None:
    assert view(diagram_svg(Parallel(Series(*NAMES), "b"), label, width=700)).width <= 700


def test_what_cannot_wrap_is_scaled_down() -> None:
    svg = diagram_svg(Series("a", "b"), label, width=100)
    root = ET.fromstring(svg)
    assert float(root.attrib["width"]) <= 100 < view(svg).width
    assert float(root.attrib["height"]) < view(svg).height


def test_long_title_is_shortened_and_kept_whole_in_its_hint() -> None:
    name = "a very long name that no box is wide enough for"
    svg = diagram_svg(Unit(name), label)
    (title,) = titles(svg)
    assert title.endswith("…")
    assert name.startswith(title[:-1])
    assert name in hints(svg)[0]


def test_boxes_are_as_wide_as_the_longest_title_needs() -> None:
    short, long = (rects(diagram_svg(Unit(name), label))[0] for name in ("a", "right wheel motor"))
    assert short.width < long.width


def test_unit_in_several_places_is_marked() -> None:
    svg = diagram_svg(Parallel(Series("a", "b"), Series("a", "c")), label)
    assert svg.count('class="shared"') == 2
    assert sum("drawn in 2 places, one part" in hint for hint in hints(svg)) == 2


@pytest.mark.parametrize(("tone", "word"), [("warn", "WARN"), ("error", "ERROR"), ("stale", "STALE")])
def test_state_is_more_than_a_colour(tone: str, word: str) -> None:
    def toned(name: str) -> Label:
        return Label(name, tone=tone)  # type: ignore[arg-type]

    plain, marked = (diagram_svg(Unit("a"), says).count('class="tone"') for says in (label, toned))
    assert (plain, marked) == (1, 2)  # the bar; the bar and a symbol
    assert word in hints(diagram_svg(Unit("a"), toned))[0]


NASTY = "<script>alert('1')</script>&\"]]>\x00\x1b\ud800"


def test_names_are_escaped() -> None:
    svg = diagram_svg(Series(NASTY, "b"), lambda name: Label(name, name, name))
    assert "<script" not in svg
    assert "<script>alert('1')</script>&\"]]>\ufffd\ufffd\ufffd" in hints(svg)[0]
    svg.encode()


def test_description_says_the_structure() -> None:
    root = ET.fromstring(diagram_svg(Series("a", KOutOfN(2, "b", "c", "d"), Parallel("e", "f")), label))
    assert root.attrib["role"] == "img"
    assert root.findtext("title") == "Reliability block diagram"
    assert root.findtext("desc") == "Works while all of (a, at least 2 of 3 (b, c, d), at least 1 of 2 (e, f)) work."


def test_file_names_its_namespace_and_inline_svg_has_no_address() -> None:
    assert ET.fromstring(diagram_svg(Unit("a"), label, standalone=True)).tag == "{http://www.w3.org/2000/svg}svg"
    assert "http" not in diagram_svg(Unit("a"), label)


def test_same_diagram_same_bytes() -> None:
    diagram = Series("a", Parallel("b", Series("c", "a")))
    assert diagram_svg(diagram, label) == diagram_svg(diagram, label)


def test_ten_thousand_units_are_drawn_at_once_and_counted() -> None:
    start = time.process_time()
    svg = diagram_svg(Series(*(f"p{i}" for i in range(10_000))), label)
    assert time.process_time() - start < 2
    assert len(rects(svg)) == 401
    assert "… 9,600 more parts" in hints(svg)


@pytest.mark.parametrize("group", [Series, Parallel])
def test_branches_beyond_the_limit_are_counted(group: type[Series] | type[Parallel]) -> None:
    assert hints(diagram_svg(group("a", "b", "c", "d"), label, max_boxes=3))[-1] == "… 1 more part"


def nested(levels: int) -> Block:
    block: Block = Unit("core")
    for i in range(levels):
        block = Series(f"s{i}", Parallel(f"p{i}", block))
    return block


def test_a_thousand_levels_are_drawn() -> None:
    svg = diagram_svg(nested(1000), label)
    assert len(list(ET.fromstring(svg).iter("g"))) < 60
    shown = sum("more part" not in hint for hint in hints(svg))
    assert f"… {2001 - shown:,} more parts" in hints(svg)


def test_series_inside_series_is_one_series() -> None:
    block: Block = Unit("core")
    for i in range(1000):
        block = Series(f"s{i}", Parallel(block))
    assert len(rects(diagram_svg(block, label, max_boxes=2000))) == 1001
