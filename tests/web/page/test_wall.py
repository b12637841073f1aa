"""The wall: the robot seen from afar, and inside the pages of those who are named, where nothing can be changed."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from robophm.core.errors import RobophmError
from robophm.web.guard import policy_within

from ..conftest import SMALL, serving
from .test_pages import BEYOND


@contextmanager
def framing() -> Iterator[tuple[str, list[str]]]:
    """A page elsewhere that shows the address in a frame which the list has last; its origin."""
    shown: list[str] = []

    class Frame(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            body = f"<!doctype html><title>frame</title><iframe src='{shown[-1]}' width=900 height=700></iframe>"
            self.send_response(200)
            self.send_header("content-type", "text/html")
            self.end_headers()
            self.wfile.write(body.encode())

        def log_message(self, *_: object) -> None:
            """Say nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), Frame) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}", shown
        server.shutdown()


@pytest.mark.full
def test_it_stands_inside_the_pages_that_are_named_and_in_no_others(tmp_path: Path, browser) -> None:
    design = tmp_path / "courier.yaml"
    design.write_text(f"{SMALL}thresholds: {{hazard_rate: 1e-9 /h}}\n")
    with framing() as (origin, shown), serving(design, embed=(origin,)) as named, serving(design) as alone:
        page = browser.new_page()

        def within(address: str):
            shown.append(address)
            page.goto(origin)
            page.wait_for_load_state("networkidle")
            return page.frames[1]

        frame = within(f"{named.address}wall")
        frame.get_by_role("heading", name="courier").wait_for()
        frame.get_by_text("ERROR").wait_for()
        frame.get_by_text("1.8e-5 /h").first.wait_for()  # 2 · 8 + 2 FPMH; what is redundant does not fail at first
        assert frame.locator("a, button, input, select, textarea").count() == 0
        for address in (named.address, f"{alone.address}wall", f"{alone.address}"):
            frame = within(address)
            assert frame.url.startswith("chrome-error:"), address
        page.close()


@pytest.mark.full
@pytest.mark.parametrize("width", [390, 1920])
def test_it_fits_and_is_accessible(tmp_path: Path, visit, width: int) -> None:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design, seed=1) as courier:
        look = visit(courier)
        look.page.set_viewport_size({"width": width, "height": 1080})
        look.page.goto(f"{courier.address}wall")
        look.page.get_by_text("What will fail it").wait_for()
        assert look.page.evaluate(BEYOND) == []
        assert look.serious() == []
        courier.edit({"op": "put", "path": ["name"], "value": "express"})
        look.page.get_by_role("heading", name="express").wait_for()


@pytest.mark.full
def test_an_origin_that_is_none_is_refused() -> None:
    for wrong in ("grafana.example", "http://a.example/path", "*", "http://a.example; script-src *", "https://"):
        with pytest.raises(RobophmError, match=r"expected the origin of a page"):
            policy_within([wrong])
    assert "frame-ancestors 'self' https://a.example:3000 http://[::1]:1;" in policy_within(
        ["https://a.example:3000", "http://[::1]:1"]
    )
    assert "frame-ancestors 'none'" in policy_within([])
