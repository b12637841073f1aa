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
from typing import TYPE_CHECKING

import pytest
from book.__main__ import main
from book.pages import ROOT, navigated

from .conftest import AXE

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.full
SITE = ROOT / "build" / "book" / "site"
FIRST_LOAD = 300_000
"""Bytes, compressed as web servers do, of all that a page asks for until nothing more comes."""


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


def seen_of(page: Page, address: str, name: str) -> list[str]:
    """Opens a page of the site; what it asked for until nothing more came."""
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address + file_of(name))
    page.wait_for_load_state("networkidle")
    return [url for url in asked if not url.startswith(("blob:", "data:"))]


def violations_of(page: Page) -> list[str]:
    page.add_style_tag(content="* { transition: none !important }")  # colours that are on their way are no colours
    page.evaluate(AXE.read_text(encoding="utf-8"))
    violations = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
    return [f"{one['id']}: {one['nodes'][0]['html'][:150]}" for one in violations if one["impact"] != "minor"]


@pytest.mark.parametrize(("colours", "width"), [("light", 1440), ("dark", 390)])
def test_every_page_fits_its_window_and_is_accessible(browser: Browser, address: str, colours: str, width: int) -> None:
    context = browser.new_context(color_scheme=colours)
    page = context.new_page()
    found = {}
    for name in navigated():
        page.goto(address + file_of(name))
        page.wait_for_selector("article h1")
        wrong = []
        for wide in (*{390, 820, 1440} - {width}, width):
            page.set_viewport_size({"width": wide, "height": 900})
            if page.evaluate("document.documentElement.scrollWidth") > wide:
                wrong.append(f"wider than {wide} px")
        wrong += violations_of(page)
        if wrong:
            found[name] = wrong
    context.close()
    assert found == {}


def test_the_first_load_of_every_page_is_small_and_of_this_host_alone(browser: Browser, address: str) -> None:
    heavy = {}
    for name in navigated():
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        asked = seen_of(context.new_page(), address, name)
        context.close()
        assert [url for url in asked if not url.startswith(address)] == []
        files = {SITE / url.removeprefix(address) for url in asked}
        assert len(files) > 3
        if (weight := sum(len(gzip.compress(file.read_bytes())) for file in files)) > FIRST_LOAD:
            heavy[name] = weight
    assert heavy == {}


@pytest.mark.parametrize("opened_by", ["key", "slash", "button"])
def test_a_word_is_found_once_the_search_is_opened(page: Page, address: str, opened_by: str) -> None:
    """Its index comes only then, and the words that were typed meanwhile are not lost."""
    page.set_viewport_size({"width": 1200, "height": 800})
    assert address + "search.json" not in seen_of(page, address, "README.md")
    with page.expect_request(address + "search.json"):
        if opened_by == "button":
            page.get_by_role("button", name="Search").click()
        else:
            page.keyboard.press("Control+k" if opened_by == "key" else "/")
    page.get_by_role("combobox", name="Search").wait_for()
    page.keyboard.type("weibull")
    page.get_by_text(re.compile(r"^\d+ results$")).wait_for()
    page.get_by_role("option").first.click()
    page.wait_for_url(re.compile(r"\?h="))
    page.locator("article mark").first.wait_for()


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
