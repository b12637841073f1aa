"""The reference page that is kept is of the library that there is."""

from __future__ import annotations

from pathlib import Path

from robophm.parts import library
from robophm.report.part_reference import reference

ROOT = Path(__file__).parents[2]


def test_the_reference_page_is_of_these_entries() -> None:
    page = (ROOT / "docs/reference/parts.md").read_text(encoding="utf-8")
    assert page == "\n".join(reference()) + "\n", "made anew by: robophm parts --reference > docs/reference/parts.md"
    for name in library():
        assert page.count(f"| `{name}` |") == 1
