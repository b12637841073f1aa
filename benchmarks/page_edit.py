"""From a key to the new figures: a value is edited in a design of 2,000 parts, on the page in Chromium.

``python -m benchmarks.page_edit [EDITS]`` (fifteen edits take half a minute): the time from Enter in the inspector
until the robot's hazard rate in the tree has changed, as the browser's clock has it: each once the page has asked all
that it asks after the one before, as by hand, and then one straight after the other; and what the service and the
browser's processes took of the processor from one to the other. Then, without a browser, edits of each kind: the time
to the service's answer, and what it took of the processor.
"""

from __future__ import annotations

import json
import os
import shutil
import statistics
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.page_live import FLAGS, processes, running, taken

MODULES, PARTS = 40, 50
PORT = 8793
CHANGED = """() => new Promise((resolve) => {
  const robot = document.querySelector('[role=treeitem] .rate');
  const before = robot.textContent;
  addEventListener("keydown", (event) => {
    if (event.key !== "Enter") return;
    const begun = performance.now();
    const look = () => robot.textContent === before ? requestAnimationFrame(look) : resolve(performance.now() - begun);
    look();
  }, {once: true, capture: true});
})"""


def write_design(path: Path) -> None:
    """Forty modules of fifty parts, all in series."""
    parts = "".join(f"      part {i}: {{rate: {1 + i % 7} FPMH}}\n" for i in range(PARTS))
    modules = "".join(f"  module {m}:\n    components:\n{parts}" for m in range(MODULES))
    path.write_text(f"schema_version: 1\nname: large\nmodules:\n{modules}")


def edited(page: Any, value: str) -> float:
    """The time that an edit took until its figures were shown [ms]."""
    page.evaluate(f"() => {{ window.took = ({CHANGED})() }}")
    field = page.get_by_label("Stated rate of one")
    field.fill(value)
    field.press("Enter")
    took = page.evaluate("() => window.took")
    page.locator(".canvas[aria-busy=false]").wait_for()
    return float(took)


class Asking:
    """The questions of a page that are under way."""

    def __init__(self, page: Any) -> None:
        self._page, self._open = page, 0
        page.on("request", lambda _: self._count(1))
        for ended in ("requestfinished", "requestfailed"):
            page.on(ended, lambda _: self._count(-1))

    def _count(self, change: int) -> None:
        self._open += change

    def wait(self) -> None:
        """Wait until nothing has been asked for a third of a second."""
        quiet = 0
        while quiet < 7:
            self._page.wait_for_timeout(50)
            quiet = 0 if self._open else quiet + 1


def asked(path: str, body: object = None) -> Any:
    """The service's answer to a question, or to what is to be done."""
    data = None if body is None else json.dumps(body).encode()
    headers = {"content-type": "application/json"}
    with urllib.request.urlopen(
        urllib.request.Request(f"http://127.0.0.1:{PORT}/api/design{path}", data, headers)
    ) as answer:
        return json.load(answer)


def kinds(i: int) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Edits of each kind, one after the other, such that no design is one that was there before."""
    parts, others = ["modules", "module 5", "components"], ["modules", "module 6", "components"]
    gone = ["modules", "module 7", "components", f"part {i}"]
    yield "value", "/edits", {"op": "put", "path": [*parts, "part 8", "rate"], "value": f"{50 + i} FPMH"}
    yield "new part", "/edits", {"op": "put", "path": [*parts, f"new {i}"], "value": {"rate": "3 FPMH"}}
    yield "rename", "/edits", {"op": "rename", "path": [*parts, f"new {i}"], "name": f"newer {i}"}
    yield "move", "/edits", {"op": "move", "path": [*parts, f"newer {i}"], "to": others[:2]}
    yield "delete", "/edits", {"op": "delete", "path": gone}
    yield "undo", "/undo", {}


def of_each_kind(service: int, edits: int) -> None:
    """Print what edits of each kind take, the first of which, by which the document is read, is not counted."""
    took: dict[str, list[tuple[float, float]]] = {}
    for i in range(edits + 1):
        for kind, path, operation in kinds(i):
            body = {"revision": asked("")["revision"]} | (
                {"operations": [operation], "what": kind} if operation else {}
            )
            before, begun = taken({service}), time.perf_counter()
            asked(path, body)
            took.setdefault(kind, []).append((time.perf_counter() - begun, taken({service}) - before))
    for kind, each in took.items():
        answer, processor = (1e3 * statistics.median(one) for one in zip(*each[1:], strict=True))
        print(f"{kind}: answered after {answer:.0f} ms, {processor:.0f} ms of the service's processor")


def main(edits: int = 15) -> int:
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        design = Path(name) / "large.yaml"
        write_design(design)
        serve = ("-m", "robophm", "serve", str(design), "--port", str(PORT))
        with running(*serve, ready="http") as (service, _):
            before = processes(os.getpid())
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
            page = browser.new_context(viewport={"width": 1440, "height": 900}).new_page()
            asking = Asking(page)
            page.goto(f"http://127.0.0.1:{PORT}/#/design/module%203/part%207")
            page.locator(".canvas[aria-busy=false]").wait_for()
            mine = processes(os.getpid()) - before - processes(service.pid)
            for i in range(2):
                edited(page, f"{20 + i} FPMH")
            apart = []
            for i in range(edits):
                asking.wait()
                apart.append(edited(page, f"{100 + i} FPMH"))
            asking.wait()
            serving, browsing = taken({service.pid}), taken(mine)
            times = sorted(edited(page, f"{30 + i} FPMH") for i in range(edits))
            serving, browsing = (
                (after - at) / edits for after, at in ((taken({service.pid}), serving), (taken(mine), browsing))
            )
            browser.close()
            of_each_kind(service.pid, edits // 3)
    for how, each in (("as by hand", sorted(apart)), ("one straight after the other", times)):
        middle, least, most = (f"{one:.0f} ms" for one in (statistics.median(each), each[0], each[-1]))
        print(f"edit of {MODULES * PARTS} parts, {how}: {middle} to the new figures, {least} to {most}")
    print(
        f"processor for each, all that the page then asks included: service {serving:.2f} s, browser {browsing:.2f} s"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:2])))
