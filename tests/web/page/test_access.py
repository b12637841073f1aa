"""Logging in and out, in a browser."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from ..conftest import SMALL, serving
from .conftest import Visit


def test_a_person_logs_in_by_the_page_and_out(tmp_path: Path, visit: Callable[..., Visit]) -> None:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as served:
        served.service.visitors.users.add_person("anna", "viewer", "a long pass phrase")
        opened = visit(served)
        page = opened.page
        page.goto(served.address)
        page.get_by_label("Name").fill("anna")
        page.get_by_label("Password").fill("wrong")
        page.get_by_role("button", name="Log in").click()
        page.get_by_text("not right").wait_for()
        assert opened.serious() == []
        page.get_by_label("Name").fill("anna")
        page.get_by_label("Password").fill("a long pass phrase")
        page.get_by_role("button", name="Log in").click()
        page.get_by_text("anna (viewer)").wait_for()
        page.get_by_text("courier").first.wait_for()
        page.get_by_role("button", name="Log out").click()
        page.get_by_label("Password").wait_for()
        opened.wrong = [one for one in opened.wrong if not re.search("status of 401|403", one)]
