"""Chromium on the built page; whatever it asks of anybody but the service under test is a failure."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest

from robophm.web.app import STATIC

from ...conftest import NO_BROWSER
from ..conftest import Served

if TYPE_CHECKING:
    from playwright.sync_api import Browser, ConsoleMessage, Page

AXE = Path(__file__).parents[3] / "ui" / "node_modules" / "axe-core" / "axe.min.js"
FLAGS = ["--no-sandbox", "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--no-first-run", "--disable-gpu"]  # fmt: skip


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One for all tests of a file: while it is there, its thread can run no other event loop."""
    chromium = shutil.which("chromium")
    if not chromium or not (STATIC / "index.html").is_file():
        pytest.skip(NO_BROWSER)
    api = pytest.importorskip("playwright.sync_api", reason=NO_BROWSER)
    with api.sync_playwright() as playwright:
        yield playwright.chromium.launch(executable_path=chromium, args=FLAGS)


LATE = """
let seed = %d;
const ask = window.fetch;
window.fetch = async (...words) => {
  const answer = await ask(...words);
  seed = (seed * 16807) %% 2147483647;
  await new Promise((go) => setTimeout(go, seed / 2147483647 * 600));
  return answer;
};
"""


class Visit:
    """A page of a service, and what went wrong in it."""

    def __init__(self, page: Page, served: Served) -> None:
        self.page, self.served = page, served
        self.wrong: list[str] = []
        page.set_default_timeout(90_000)
        page.on("pageerror", lambda error: self.wrong.append(str(error)))
        page.on("console", self._said)
        page.on("request", lambda request: self._asked(request.url))
        page.on("websocket", lambda socket: self._asked(socket.url))

    def _said(self, said: ConsoleMessage) -> None:
        """Errors, but that the service has refused something in words, or is gone: both of which the page shows."""
        if said.type == "error" and not any(
            words in said.text for words in ("status of 422", "status of 409", "ERR_CONNECTION_REFUSED")
        ):
            self.wrong.append(said.text)

    def _asked(self, url: str) -> None:
        home = urlsplit(self.served.address)
        if urlsplit(url).scheme not in ("blob", "data") and urlsplit(url).netloc != home.netloc:
            self.wrong.append(f"asked for {url}")

    def open(self, where: str = "") -> Page:
        """Go to a page of it."""
        self.page.goto(f"{self.served.address}#/{where}")
        self.page.wait_for_selector("main h1, main .empty, .design .tree")
        return self.page

    def serious(self) -> list[str]:
        """What axe-core finds moderate, serious or critical."""
        if not AXE.is_file():
            pytest.skip("no axe-core (npm ci in ui/)")
        if self.page.evaluate("typeof axe === 'undefined'"):
            self.page.evaluate(AXE.read_text(encoding="utf-8"))
        found: Any = self.page.evaluate("axe.run(document, {resultTypes: ['violations']})")
        return [
            f"{one['id']}: {node['html'][:150]} {node['failureSummary'][:200]}"
            for one in found["violations"]
            if one["impact"] != "minor"
            for node in one["nodes"][:3]
        ]


@pytest.fixture
def visit(browser: Browser) -> Iterator[Callable[..., Visit]]:
    """Opens a service in a browser of its own; at the end nothing may have gone wrong.

    With ``late``, a seed, the answers of the service come up to 0.6 s late, and not in their order.
    """
    visits: list[Visit] = []

    def begin(served: Served, late: int = 0, **options: Any) -> Visit:
        context = browser.new_context(viewport={"width": 1400, "height": 900}, **options)
        if late:
            context.add_init_script(LATE % late)
        visits.append(Visit(context.new_page(), served))
        return visits[-1]

    yield begin
    for one in visits:
        one.page.context.close()
    assert [wrong for one in visits for wrong in one.wrong] == []
