"""Logging in and out, and what is greyed for whom, in a browser."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from ..conftest import SMALL, serving
from .conftest import Visit


@pytest.mark.full
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


CHANGING = """() => [...document.querySelectorAll("button, input:not([type=search])")]
  .filter((one) => !one.matches(":disabled"))
  .map((one) => one.labels?.[0]?.textContent || one.ariaLabel || one.textContent)"""
"""What can be pressed or filled in."""


@pytest.mark.full
def test_what_a_role_does_not_allow_is_greyed_and_says_for_whom_it_is(
    tmp_path: Path, visit: Callable[..., Visit]
) -> None:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design, seed=1) as served:
        users, changes = served.service.visitors.users, served.service.visitors.changes
        for name in ("viewer", "operator", "editor"):
            users.add_person(name, name, "a long pass phrase")
        opened = visit(served)
        page = opened.page
        page.goto(served.address)
        log_in(opened, "viewer")
        start = page.get_by_role("button", name="Start analysis")
        start.wait_for()
        page.locator("fieldset[title='For operators; viewer is a viewer']").first.wait_for(state="attached")
        assert start.is_disabled()
        for where, editing in {
            "design/drive/motor": {"Add module", "Quantity", "Description", "Stated rate of one"},
            "settings": {"Hazard rate at most", "Silent for so long, it is off"},
            "parts": {"Paste from a spreadsheet…", "Quantity of drive/motor"},
            "sensors": {"Bind"}, "reports": {"Open a design file", "Choose a file"},
            "parts/import": {"Choose a parts list"},
        }.items():  # fmt: skip
            opened.open(where)
            if where == "parts/import":
                page.reload()  # so that the tab is that of the address
            page.locator("fieldset[title='For editors; viewer is a viewer']").first.wait_for(state="attached")
            first = min(editing)
            shown = page.get_by_role("button", name=first, exact=True).or_(page.get_by_label(first, exact=True)).first
            shown.wait_for(state="attached")
            assert not editing & set(page.evaluate(CHANGING)), where
            around = shown.locator("xpath=ancestor::fieldset[1]")
            assert around.get_attribute("title") == "For editors; viewer is a viewer"
            assert opened.serious() == []
        opened.open("new").get_by_text("For editors; viewer is a viewer").wait_for()
        opened.open("settings").get_by_text("For editors; viewer is a viewer").wait_for()
        assert opened.wrong == []  # so nothing was asked for that is refused

        page.get_by_role("button", name="Log out").click()
        log_in(opened, "operator")
        page.locator("fieldset[title='For editors; operator is an operator']").first.wait_for(state="attached")
        page.locator("button:enabled", has_text="Start analysis").wait_for()
        page.get_by_role("button", name="Log out").click()
        log_in(opened, "editor")
        opened.open("design/drive/motor").get_by_label("Quantity", exact=True).fill("3")
        page.keyboard.press("Enter")
        page.get_by_role("button", name="Save").click()
        page.get_by_text("Saved courier.yaml").wait_for()
        log = opened.open("settings").get_by_role("list", name="Changes, the latest first").get_by_role("listitem")
        log.get_by_text("modules/drive/components/motor/quantity: 2 → 3").wait_for()
        kept = [one for one in changes.latest(9) if one.values]
        assert json.dumps([one.values for one in kept]) == '[[["modules/drive/components/motor/quantity", "2", "3"]]]'
        log.filter(has_text="logged in").first.get_by_text("editor from 127.0.0.1").wait_for()
        opened.wrong = [one for one in opened.wrong if "status of 401" not in one]


def log_in(opened: Visit, name: str) -> None:
    """Log in at the page that asks for it."""
    page = opened.page
    page.get_by_label("Name").fill(name)
    page.get_by_label("Password").fill("a long pass phrase")
    page.get_by_role("button", name="Log in").click()
    page.get_by_text(f"{name} ({name})").wait_for()
    opened.wrong = [one for one in opened.wrong if "status of 401" not in one]
