"""The pages that one reads first: their commands print what the pages say, and messages that they explain exist."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from tests.cases import each_case

from ..cli.conftest import run_inside

ROOT = Path(__file__).resolve().parents[2]
GUIDES = [page for page in ROOT.glob("docs/guides/*.md") if 'title="' in page.read_text(encoding="utf-8")]
"""Those that state the files that their commands need."""

PAGES = sorted([*ROOT.glob("docs/concepts/*.md"), *ROOT.glob("docs/start/*.md"), *ROOT.glob("docs/*.md"), *GUIDES])
RUN = [page for page in PAGES if "```console" in page.read_text(encoding="utf-8")]


def words(text: str) -> str:
    return " ".join(text.split())


@pytest.mark.full
@each_case("page", RUN, ids=lambda path: path.stem)
def test_commands_print_what_the_page_says(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In an empty folder, with the files that the page itself states; a printed line is within a line of the output."""
    text = page.read_text(encoding="utf-8")
    for name, content in re.findall(r'```\w+ title="([^"]+)"\n(.*?)```', text, re.S):
        (tmp_path / name).write_text(content, encoding="utf-8")
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "200")
    output = ""
    for line in "\n".join(re.findall(r"```console\n(.*?)```", text, re.S)).splitlines():
        if not line.startswith("$ "):
            assert words(line) in output, f"{line}\n{output}"
            continue
        program, *arguments = shlex.split(line[2:])
        if program == "python3":
            subprocess.run([sys.executable, *arguments], cwd=tmp_path, check=True, timeout=60)
            continue
        done = run_inside(tmp_path, arguments, monkeypatch)
        output = words(done.stdout + done.stderr)
        assert done.returncode == 0, f"{line}\n{output}"


def test_pages_are_short_and_have_a_picture_or_a_table() -> None:
    for page in ROOT.glob("docs/concepts/*.md"):
        text = page.read_text(encoding="utf-8")
        assert len(text.split()) < 1200, page
        assert "\n| " in text or "![" in text, page


def test_messages_that_are_explained_exist() -> None:
    source = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "src" / "robophm").rglob("*.py"))
    page = (ROOT / "docs" / "troubleshooting.md").read_text(encoding="utf-8")
    quoted = re.findall(r"^\| `([^`]+)` \|", page, re.M)
    assert len(quoted) > 10
    pieces = [piece.strip() for one in quoted for piece in one.split("…")]
    assert [piece for piece in pieces if piece not in source] == []
