"""Two people edit one design in two browsers, or one in the page and one in the file: nobody's work is lost."""

from __future__ import annotations

import random

import pytest
from playwright.sync_api import expect

from ..conftest import SMALL, serving


@pytest.fixture
def courier(tmp_path):
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as served:
        yield served


def answer(page, route):
    """The answer to what the page asks for; where the other came first (409), it asks again by itself."""
    return page.expect_response(lambda response: response.url.endswith(route) and response.status != 409)


def set_quantity(page, of, number):
    field = page.get_by_label(f"Quantity of {of}")
    with answer(page, "/api/design/edits"):
        field.fill(str(number))
        field.press("Enter")
    expect(field).to_have_value(str(number))


def undo(page):
    page.get_by_role("heading", name="Parts").click()
    with answer(page, "/api/design/undo"):
        page.keyboard.press("Control+z")


def quantities(served):
    motor = served.get("/api/design")["document"]["modules"]["drive"]["components"]
    return [motor[name].get("quantity", 1) for name in ("motor", "encoder")]


def test_undo_is_of_ones_own_edits(courier, visit):
    here, there = (visit(courier).open("parts") for _ in range(2))
    set_quantity(here, "drive/motor", 3)
    expect(there.get_by_label("Quantity of drive/motor")).to_have_value("3")
    set_quantity(there, "drive/encoder", 4)
    undo(here)
    assert quantities(courier) == [2, 4]
    here.get_by_role("button", name="Redo").click()
    expect(there.get_by_label("Quantity of drive/motor")).to_have_value("3")
    undo(there)
    assert quantities(courier) == [3, 1]
    there.keyboard.press("Control+z")  # nothing of this browser is left: the other's is not taken back by a key
    there.get_by_text("Nothing that was edited in this browser is left to undo").wait_for()
    assert quantities(courier) == [3, 1]


@pytest.mark.full
def test_an_edit_that_the_other_has_touched_is_not_taken_back(courier, visit):
    here, there = (visit(courier).open("parts") for _ in range(2))
    set_quantity(here, "drive/motor", 3)
    expect(there.get_by_label("Quantity of drive/motor")).to_have_value("3")
    set_quantity(there, "drive/motor", 5)
    undo(here)
    here.get_by_text("has been changed since by another edit").first.wait_for()
    assert quantities(courier) == [5, 1]


def test_what_is_half_typed_stays_and_says_what_came_meanwhile(courier, visit):
    page = visit(courier).open("parts")
    field = page.get_by_label("Quantity of drive/motor")
    field.fill("7")
    courier.edit({"op": "put", "path": ["modules", "drive", "components", "motor", "quantity"], "value": 5})
    page.get_by_text("Changed meanwhile to 5; Escape takes that.").wait_for()
    expect(field).to_have_value("7")
    field.press("Escape")
    expect(field).to_have_value("5")
    assert quantities(courier) == [5, 1]


def test_a_file_that_is_edited_by_hand_is_shown_at_once_and_undone(courier, visit):
    page = visit(courier).open("parts")
    expect(page.get_by_label("Quantity of drive/motor")).to_have_value("2")
    courier.design.write_text(SMALL.replace("quantity: 2", "quantity: 6"))
    expect(page.get_by_label("Quantity of drive/motor")).to_have_value("6")
    page.get_by_text("courier.yaml, saved").wait_for()
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Undo that").click()
    expect(page.get_by_label("Quantity of drive/motor")).to_have_value("2")
    assert "quantity: 6" in courier.design.read_text()


def test_a_file_that_is_edited_by_hand_beside_unsaved_edits_is_told_of(courier, visit):
    page = visit(courier).open("parts")
    set_quantity(page, "drive/motor", 3)
    courier.design.write_text(SMALL.replace("name: courier", "name: express"))
    page.get_by_text("courier.yaml was changed by hand").wait_for()
    page.get_by_role("button", name="See what was changed").click()
    page.get_by_text("+name: express").wait_for()
    page.get_by_role("button", name="Cancel").click()
    assert quantities(courier) == [3, 1]


@pytest.mark.full
def test_two_people_edit_for_long_and_each_finds_their_own(courier, visit):
    """Random edits and undos in two browsers: at the end each has what their own edits and undos make of it."""
    rng = random.Random(8)
    pages = {part: visit(courier).open("parts") for part in ("drive/motor", "drive/encoder")}
    courses = {"drive/motor": [2], "drive/encoder": [1]}
    for _ in range(200):
        part = rng.choice(list(pages))
        if len(courses[part]) > 1 and rng.random() < 0.4:
            undo(pages[part])
            courses[part].pop()
            expect(pages[part].get_by_label(f"Quantity of {part}")).to_have_value(str(courses[part][-1]))
        else:
            number = rng.choice([n for n in range(1, 99) if n != courses[part][-1]])
            set_quantity(pages[part], part, number)
            courses[part].append(number)
    assert quantities(courier) == [courses["drive/motor"][-1], courses["drive/encoder"][-1]]
