"""The site of the documents in a browser: whole, narrow, by keyboard, and asking nobody else for anything."""

from __future__ import annotations

import functools
import gzip
import http.server
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from book.__main__ import main
from book.pages import ROOT, navigated

from .conftest import AXE

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.full
SITE = ROOT / "build" / "book" / "site"
FIRST_LOAD = 300_000
"""Bytes, compressed as web servers do, of the first page as it stands; the search index follows it."""


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    pytest.importorskip("zensical", reason="no zensical (the extra docs)")
    assert main() == 0
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(SITE))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


@pytest.fixture
def page(browser: Browser, address: str) -> Iterator[Page]:
    context = browser.new_context(viewport={"width": 390, "height": 844})
    yield context.new_page()
    context.close()


def file_of(name: str) -> str:
    return name.replace("README.md", "index.html").replace(".md", ".html")


def test_every_page_is_narrow_accessible_and_of_this_host_alone(page: Page, address: str) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    found: dict[str, Any] = {}
    for name in navigated():
        page.goto(address + file_of(name))
        page.wait_for_selector("article h1")
        page.evaluate(AXE.read_text(encoding="utf-8"))
        violations = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
        wrong = [f"{one['id']}: {one['nodes'][0]['html'][:150]}" for one in violations if one["impact"] != "minor"]
        if page.evaluate("document.documentElement.scrollWidth") > 390:
            wrong.append("wider than 390 px")
        if wrong:
            found[name] = wrong
    assert found == {}
    assert [url for url in asked if not url.startswith((address, "blob:", "data:"))] == []


def test_the_first_load_is_small(page: Page, address: str) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address)
    page.wait_for_load_state("networkidle")
    files = {SITE / (url.removeprefix(address) or "index.html") for url in asked} - {SITE / "search.json"}
    assert len(files) > 3
    assert sum(len(gzip.compress(file.read_bytes())) for file in files) <= FIRST_LOAD


def test_a_word_is_found_by_the_keyboard_alone(page: Page, address: str) -> None:
    page.set_viewport_size({"width": 1200, "height": 800})
    page.goto(address)
    page.wait_for_load_state("networkidle")
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Search").wait_for()
    page.keyboard.type("weibull")
    page.get_by_text(re.compile(r"^\d+ results$")).wait_for()


def test_the_reference_has_what_the_code_has(address: str) -> None:
    import robophm
    from robophm.cli.app import COMMANDS

    def headings(name: str) -> set[str]:
        text = (ROOT / "build/book/pages/docs/reference" / name).read_text("utf-8")
        return {one.strip("`") for one in re.findall(r"^##+ (.*)$", text, re.M)}

    assert {f"robophm {name}" for name in COMMANDS} <= headings("commands.md")
    assert set(robophm.__all__) <= headings("api.md")
    assert {"Robot", "Component", "FailureMode"} <= headings("design-file-fields.md")


def test_a_broken_link_ends_the_build(tmp_path: Path) -> None:
    pytest.importorskip("zensical", reason="no zensical (the extra docs)")
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("# Start\n\n[nowhere](#nothing)\n", encoding="utf-8")
    (tmp_path / "zensical.toml").write_text('[project]\nsite_name = "one"\n', encoding="utf-8")
    command = [sys.executable, "-m", "zensical", "build", "--strict"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "anchor does not exist" in done.stdout + done.stderr
