"""The design file as text on the page: keys of the schema offered, problems where they are, comments kept."""

from __future__ import annotations

import pytest

from ..conftest import SMALL, serving


@pytest.fixture
def courier(tmp_path):
    """A small robot's file, served."""
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as served:
        yield served


def begin(look):
    """The editor at a part of the design, and its text."""
    page = look.open("design/drive/motor")
    page.get_by_role("button", name="Edit as text").click()
    text = page.get_by_role("textbox", name="The design file (YAML)")
    text.get_by_text("encoder").wait_for()
    return page, text


def write(page, after, words):
    """Write at the end of the line that holds some words, an indented line more."""
    page.locator(".cm-line", has_text=after).click()
    page.keyboard.press("End")
    page.keyboard.type(words)


@pytest.mark.full
def test_keys_and_values_are_offered_problems_stand_at_their_line_and_comments_are_kept(visit, courier):
    look = visit(courier)
    page, text = begin(look)
    schema = courier.get("/api/design/schema")["$defs"]
    offered = page.locator(".cm-tooltip-autocomplete li")

    write(page, "camera: {rate", "\nlamp:\n  ")  # indented as the line above, and deeper
    page.keyboard.press("Control+Space")
    offered.filter(has_text="failure_modes").wait_for()
    assert set(offered.all_inner_texts()) <= schema["Component"]["properties"].keys()
    page.keyboard.type("monit")
    offered.filter(has_text="monitored").wait_for()
    page.get_by_text("known to work until reported failed").wait_for()
    page.keyboard.press("Escape")
    page.keyboard.type("ored: tr")
    offered.get_by_text("true", exact=True).wait_for()
    page.keyboard.press("Escape")
    page.keyboard.type("ue\nrate: 1 FPMHH")
    page.locator(".cm-lintRange-error", has_text="FPMHH").wait_for()
    assert page.locator(".cm-lint-marker-error").count() == 1
    page.locator(".cm-lintRange-error").hover()
    page.locator(".cm-diagnostic", has_text="unknown unit 'FPMHH'").wait_for()
    assert look.serious() == []
    page.set_viewport_size({"width": 390, "height": 500})  # so that the text scrolls
    page.locator(".drawing").wait_for(state="hidden")
    assert look.serious() == []
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    page.set_viewport_size({"width": 1400, "height": 900})

    page.keyboard.press("Backspace")
    page.locator(".cm-lintRange-error").wait_for(state="detached")
    page.locator(".cm-line", has_text="motor:").get_by_text("quantity").hover()
    page.locator(".cm-tooltip .about").wait_for()
    page.keyboard.press("Control+s")
    page.get_by_text("Saved courier.yaml").wait_for()
    page.get_by_role("status").get_by_text("As the design is").wait_for()
    added = "      lamp:\n        monitored: true\n        rate: 1 FPMH\n"
    assert courier.design.read_text() == SMALL + added
    page.locator(".box", has_text="motor").first.wait_for()

    page.keyboard.press("Control+a")
    page.keyboard.type("all")  # over what is selected, without a style of the browser's own
    assert text.inner_text() == "all"
    page.keyboard.press("Control+z")  # of the editor, not of the design
    page.get_by_role("status").get_by_text("As the design is").wait_for()
    assert "lamp" in text.inner_text()
    page.keyboard.press("Control+Home")
    page.keyboard.press("Escape")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.shadowRoot") is None


@pytest.mark.full
def test_what_others_edit_is_taken_in_and_asked_about_where_it_touches_what_is_written(visit, courier):
    look = visit(courier)
    page, text = begin(look)
    all_three = SMALL
    write(page, "camera: {rate", "   # seen at night")
    courier.edit({"op": "put", "path": ["modules", "drive", "components", "encoder", "rate"], "value": "5 FPMH"})
    text.get_by_text("5 FPMH").wait_for()
    assert "# seen at night" in text.inner_text()
    courier.post("/api/design/save", {"revision": courier.get("/api/design")["revision"]})
    courier.design.write_text(courier.design.read_text().replace("name: courier", "name: messenger"))
    text.get_by_text("messenger").wait_for()
    page.get_by_role("button", name="Apply").click()
    page.get_by_role("status").get_by_text("As the design is").wait_for()
    for before, after in (
        ("courier\n", "messenger\n"),
        ("2 FPMH}", "5 FPMH}"),
        ("90 FPMH}", "90 FPMH}   # seen at night"),
    ):
        all_three = all_three.replace(before, after)
    assert courier.get("/api/design/text")["text"] == all_three

    write(page, "lidar: {rate", "   # mine")
    courier.edit({"op": "put", "path": ["modules", "see", "components", "lidar"], "value": {"rate": "31 FPMH"}})
    page.get_by_text("where you have changed it too").wait_for()
    assert page.get_by_role("button", name="Apply").is_disabled()
    page.get_by_role("button", name="Take theirs").click()
    page.get_by_role("status").get_by_text("As the design is").wait_for()
    assert "31 FPMH" in text.inner_text()
    assert "# mine" not in text.inner_text()


def test_a_mistake_of_meaning_stands_at_its_key_among_several_on_its_line(visit, courier):
    page, _ = begin(visit(courier))
    write(page, "camera: {rate", "\nlamp: {quantity: 1, rate: 1 kg}")
    wrong = page.locator(".cm-lintRange-error")
    wrong.first.wait_for()
    assert wrong.first.inner_text().startswith("rate: 1 kg")


def test_what_was_not_applied_is_there_after_a_reload_and_told_of_before_it_is_lost(visit, courier):
    look = visit(courier)
    page, text = begin(look)
    write(page, "camera: {rate", "   # seen at night")
    asked = []
    page.on("dialog", lambda dialog: (asked.append(dialog.type), dialog.accept()))
    page.reload()
    text.get_by_text("# seen at night").wait_for()
    assert asked == ["beforeunload"]
    page.get_by_role("status").get_by_text("Not applied yet").wait_for()
    courier.edit({"op": "put", "path": ["modules", "drive", "components", "encoder", "rate"], "value": "5 FPMH"})
    text.get_by_text("5 FPMH").wait_for()
    page.get_by_role("button", name="Apply").click()
    page.get_by_role("status").get_by_text("As the design is").wait_for()
    both = SMALL.replace("90 FPMH}", "90 FPMH}   # seen at night").replace("2 FPMH}", "5 FPMH}")
    assert courier.get("/api/design/text")["text"] == both
    page.reload()
    page.get_by_role("button", name="Edit as text").wait_for()  # nothing is left to be shown
    assert asked == ["beforeunload"]


@pytest.mark.full
def test_a_message_under_a_pointer_that_rests_is_that_of_the_newest_check(visit, courier):
    """Also where a check was not answered: it is made again, and what was found before it stays."""
    look = visit(courier)
    page, _ = begin(look)
    write(page, "camera: {rate", "\nlamp: {rate: 1 FP}")
    page.keyboard.press("ArrowLeft")
    wrong = page.locator(".cm-lintRange-error")
    wrong.hover()
    page.locator(".cm-diagnostic", has_text="unknown unit 'FP'").wait_for()
    asked = []

    def fail_once(route):
        asked.append(route.request.post_data_json["text"])
        route.fulfill(status=503, body="{}") if len(asked) == 1 else route.continue_()

    page.route("**/api/design/check", fail_once)
    page.keyboard.type("MHH")
    page.locator(".cm-diagnostic", has_text="unknown unit 'FPMHH'").wait_for()
    assert asked[0] == asked[1]
    assert "1 FPMHH}" in asked[1]
    look.wrong = [one for one in look.wrong if "status of 503" not in one]
