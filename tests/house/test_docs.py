"""What the documents say is there, is there."""

import re
from pathlib import Path

from tests.cases import each_case

from robophm.design.file import parse

ROOT = Path(__file__).parents[2]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("examples/**/*.md")])


@each_case("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_files_that_are_named_exist(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    linked = [document.parent / target for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text)]
    named = [ROOT / path for path in re.findall(r"`((?:tests|src|examples|docs|tools|ui|ros)/[\w./-]+)`", text)]
    assert [path for path in linked + named if not path.exists()] == []


def headings(document: Path) -> set[str]:
    """The names by which a page's headings are linked to."""
    titles = re.findall(r"^#+ +(.*)$", document.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}


@each_case("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_headings_that_are_linked_to_exist(document: Path) -> None:
    for target, heading in re.findall(r"\]\(([^)#:]*)#([^)]+)\)", document.read_text(encoding="utf-8")):
        assert heading in headings(document.parent / target if target else document), f"{target}#{heading}"


@each_case("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_placeholder_is_left(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    assert re.findall(r"@@\w*@@|\{\{.*?\}\}|\b(?:TODO|FIXME|TBD|XXX)\b|(?i:lorem ipsum)|<insert[^>]*>", text) == []


def test_the_readmes_robot_is_a_valid_design() -> None:
    pages = ("README.md", "docs/reference/which-command.md")
    text = "".join((ROOT / page).read_text(encoding="utf-8") for page in pages)
    blocks = re.findall(r"```yaml\n(.*?)```", text, re.S)
    assert blocks
    for block in blocks:
        assert parse(block).warnings == ()
