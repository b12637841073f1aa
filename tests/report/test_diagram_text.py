"""Text diagrams against drawings made by hand."""

from __future__ import annotations

from textwrap import dedent

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.cases import examples

from robophm.blocks.diagram import Block, KOutOfN, Link, Network, Parallel, Series, Unit
from robophm.report.diagram_text import cells, diagram_text
from robophm.report.outline import Label

BRIDGE = Network("s", "t", [Link("s", "1", "A"), Link("s", "2", "B"), Link("1", "2", "C"), Link("1", "t", "D"),
                            Link("2", "t", "E")], {})  # fmt: skip
MESH = Network("0", "5", [Link(str(i), str(j), f"{i}{j}") for i in range(6) for j in range(i + 1, 6)], {})

BY_HAND = [
    (
        BRIDGE,
        """
           ┌─ A ⧉ ── C ⧉ ── E ⧉ ─┐
        ───┼──── A ⧉ ── D ⧉ ─────┼─(1/4)───
           ├─ B ⧉ ── C ⧉ ── D ⧉ ─┤
           └──── B ⧉ ── E ⧉ ─────┘
        """,
    ),
    (
        MESH,
        """
           ┌─ 01 ─┐
           ├─ 02 ─┤
           ├─ 03 ─┤
           ├─ 04 ─┤
           ├─ 05 ─┤
           ├─ 12 ─┤
           ├─ 13 ─┤
        ───┼─ 14 ─┼─(network)───
           ├─ 15 ─┤
           ├─ 23 ─┤
           ├─ 24 ─┤
           ├─ 25 ─┤
           ├─ 34 ─┤
           ├─ 35 ─┤
           └─ 45 ─┘
        """,
    ),
    (Unit("A"), "─── A ───"),
    (Series("A", "B"), "─── A ── B ───"),
    (
        Parallel("A", "B"),
        """
        ───┬─ A ─┬─(1/2)───
           └─ B ─┘
        """,
    ),
    (
        KOutOfN(2, "A", "B", "motor"),
        """
           ┌─── A ───┐
        ───┼─── B ───┼─(2/3)───
           └─ motor ─┘
        """,
    ),
    (
        Series("A", Parallel(Series("B", "C"), Series("D", "E")), "F"),
        """
        ─── A ──┬─ B ── C ─┬─(1/2)── F ───
                └─ D ── E ─┘
        """,
    ),
    (
        Series("A", Parallel("B", "C", KOutOfN(2, "D", "E", "F"))),
        """
                ┌────── B ──────┐
                │               │
                ├────── C ──────┤
        ─── A ──┤               ├─(1/3)───
                │ ┌─ D ─┐       │
                └─┼─ E ─┼─(2/3)─┘
                  └─ F ─┘
        """,
    ),
]


def drawn(block: Block, width: int = 100, ascii_only: bool = False) -> str:
    return diagram_text(block, Label, width, ascii_only)


@pytest.mark.parametrize(("diagram", "expected"), BY_HAND)
def test_as_drawn_by_hand(diagram: Block, expected: str) -> None:
    assert drawn(diagram) == dedent(expected).strip("\n")


def test_ascii() -> None:
    diagram = Series("λ", Parallel("A", "B"), "C", "D")
    tones = {"A": "warn", "B": "error", "C": "stale"}
    text = diagram_text(diagram, lambda n: Label(n, badge="×2", tone=tones.get(n, "ok")), 44, ascii_only=True)  # type: ignore[arg-type]
    expected = """
        --- ? x2 --+- ! A x2 -+-(1/2)-- ? C x2 ->
                   +- x B x2 -+

         >- D x2 ---
    """
    assert text == dedent(expected).strip("\n").rstrip()


def test_rows_wrap() -> None:
    expected = """
        ─── one ── two ── three ╌>

         >╌ four ──┬─ five ─┬─(1/2)╌>
                   └─ six ──┘

         >╌ seven ───
    """
    diagram = Series("one", "two", "three", "four", Parallel("five", "six"), "seven")
    assert drawn(diagram, width=32) == dedent(expected).strip("\n").rstrip()


def test_rows_wrap_inside_a_branch() -> None:
    expected = """
           ┌──── one ── two ╌>
           │
        ───┤  >╌ three ─────────┬─(1/2)───
           │                    │
           └─────── four ───────┘
    """
    assert drawn(Parallel(Series("one", "two", "three"), "four"), width=34) == dedent(expected).strip("\n").rstrip()


def test_symbols_for_state_and_for_units_drawn_twice() -> None:
    text = diagram_text(Series("A", "B", "A"), lambda n: Label(n, "hidden", "×4", "warn" if n == "A" else "ok"))
    assert text == "─── ▲ A ×4 ⧉ ── B ×4 ── ▲ A ×4 ⧉ ───"


def test_wide_and_combining_characters_keep_the_columns() -> None:
    lines = drawn(Parallel("電池", "e\u0301", "abcd")).splitlines()
    assert [cells(line) for line in lines] == [13, 22, 13]


def test_names_cannot_steer_the_terminal() -> None:
    assert drawn(Unit("a\x1b[31m\nb\r")) == "─── a\ufffd[31m b ───"


def test_long_titles_are_shortened() -> None:
    assert drawn(Unit("x" * 100), width=60) == "─── " + "x" * 19 + "… ───"


names = st.text(alphabet="abcdefgh ", min_size=1, max_size=12).map(lambda s: Unit(s.strip() or "z"))


def groups(inner: st.SearchStrategy[Block]) -> st.SearchStrategy[Block]:
    several = st.lists(inner, min_size=1, max_size=12)
    return st.one_of(several.map(lambda blocks: Series(*blocks)), several.map(lambda blocks: Parallel(*blocks)))


@settings(derandomize=True, deadline=None, max_examples=examples(100))
@given(groups(st.one_of(names, groups(st.one_of(names, groups(names))))), st.sampled_from([80, 120]))
def test_lines_are_not_longer_than_the_terminal(diagram: Block, width: int) -> None:
    assert max(map(cells, drawn(diagram, width=width).splitlines())) <= width


def test_deep_and_wide() -> None:
    block: Block = Unit("core")
    for _ in range(1000):
        block = Parallel("p", Series("s", block))
    assert "(… " in drawn(block)
    assert "(… 9,600 more parts)" in drawn(Series(*(f"p{i}" for i in range(10_000))))
    assert "(... 9,600 more parts)" in drawn(Series(*map(str, range(10_000))), ascii_only=True)
