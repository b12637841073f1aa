"""The page: well-formed, escaped, and with nothing to fetch."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import pytest

from robophm.blocks.diagram import Parallel
from robophm.report.curve import Line, curve_svg
from robophm.report.diagram_svg import diagram_svg
from robophm.report.markup import Html, element, escape, number, shorten, text_width
from robophm.report.outline import Label
from robophm.report.page import figure, page, section, side_by_side, table_html, tile, tiles

SCRIPT = "<script>alert('1')</script>"


def whole() -> Html:
    curve = curve_svg([Line(SCRIPT, [0, 1], [1, 2])], title=SCRIPT, x_label="t [h]", y_label="λ [1/h]")
    return page(
        f"Robot {SCRIPT}",
        [
            f"Said by {SCRIPT}",
            tiles(
                tile("Hazard rate", {"nominal": "1e-5 /h", SCRIPT: SCRIPT}, SCRIPT, "warn"),
                tile(SCRIPT, SCRIPT),
            ),
            section("Diagram", figure(diagram_svg(Parallel(SCRIPT, "b"), Label), SCRIPT, diagram=True), SCRIPT),
            section("Curves", side_by_side(figure(curve), figure(curve))),
            section("Parts", table_html(["part", SCRIPT], [["a", SCRIPT]], caption=SCRIPT)),
        ],
    )


class Reader(HTMLParser):
    """Fails where an element is not closed in order; keeps what could load something."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: list[str] = []
        self.addresses: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href", "srcset", "action")]
        if tag != "meta":
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_page_is_well_formed_and_loads_nothing() -> None:
    html = whole()
    reader = Reader()
    reader.feed(html)
    assert reader.open == []
    assert reader.addresses == []
    assert not {"script", "link", "img", "iframe", "object"} & set(reader.seen)
    assert not re.search(r"https?:|url\(|@import", html)
    assert "default-src 'none'; style-src 'unsafe-inline'" in html
    assert html.startswith("<!doctype html>")
    assert html.count("&lt;script&gt;") >= 14
    assert html == whole()


def test_table_puts_numbers_right() -> None:
    html = table_html(["part", "rate", "note"], [["motor", 8e-6, "a"], ["wheel", None, 5], ["x", float("nan"), "c"]])
    assert '<th scope="col" class="number">rate</th>' in html
    assert '<th scope="row">motor</th><td class="number">8e-6</td><td>a</td>' in html
    assert '<td class="number">–</td><td>5</td>' in html
    assert '<td class="number">8e-6 /h</td>' in table_html(["part", "rate"], [["motor", "8e-6 /h"]], align="lr")


def test_empty_table() -> None:
    assert "<tbody></tbody>" in table_html(["part"], [])


def test_tile_says_its_state_in_words() -> None:
    assert ">STALE<" in tile("Remaining life", "11.6 days", tone="stale")


def test_only_html_is_markup() -> None:
    bold = element("b", "x < y", class_="big", data_n=1.25, id=None)
    assert bold == '<b class="big" data-n="1.2">x &lt; y</b>'
    assert escape(bold) is bold
    assert isinstance(bold + "<i>", Html)
    assert bold + "<i>" == bold + Html("&lt;i&gt;")
    assert section("t", "<i>") == "<section><h2>t</h2>\n<p>&lt;i&gt;</p></section>"


@pytest.mark.parametrize(("value", "text"), [(12.0, "12"), (12.46, "12.5"), (-0.01, "0"), (-0.5, "-0.5"), (0.04, "0")])
def test_coordinates(value: float, text: str) -> None:
    assert number(value) == text


def test_shorten_keeps_what_fits() -> None:
    assert shorten("Battery A", 100, 11) == "Battery A"
    assert shorten("two\n lines", 100, 11) == "two lines"
    short = shorten("Battery management board", 60, 11)
    assert short.endswith("…")
    assert text_width(short, 11) <= 60
    assert text_width("電池", 10) == 20
