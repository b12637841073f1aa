"""Parts dragged on the canvas, or moved by the keyboard; networks drawn and edited; each undone as any edit."""

import pytest
from playwright.sync_api import expect

from ..conftest import SMALL, serving

BRIDGE = """\
schema_version: 1
name: bridge
diagram:
  network:
    from: in
    to: out
    links: [[in, a, out], [in, b, out]]
components:
  a: {rate: 1 FPMH}
  b: {rate: 1 FPMH}
  c: {rate: 1 FPMH}
  d: {rate: 1 FPMH}
"""


@pytest.fixture(scope="module")
def courier(tmp_path_factory):
    design = tmp_path_factory.mktemp("moving") / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as served:
        yield served


@pytest.fixture(scope="module")
def bridge(tmp_path_factory):
    design = tmp_path_factory.mktemp("network") / "bridge.yaml"
    design.write_text(BRIDGE)
    with serving(design) as served:
        yield served


def drag(page, source, target, *, share=0.5):
    """By the mouse, once the canvas shows the design as it is: from the middle of one to a place along the other."""
    page.locator(".canvas[aria-busy=false]").wait_for()
    start, end = source.bounding_box(), target.bounding_box()
    page.mouse.move(start["x"] + start["width"] / 2, start["y"] + start["height"] / 2)
    page.mouse.down()
    page.mouse.move(end["x"] + end["width"] / 2, end["y"], steps=3)
    page.mouse.move(end["x"] + end["width"] * share, end["y"] + end["height"] / 2, steps=3)
    page.mouse.up()


def undo(page, *, to):
    with page.expect_response("**/api/design/undo"):
        page.get_by_role("button", name="Undo", exact=True).first.click()
    to.wait_for()


def module(served, name):
    return served.get("/api/design")["document"]["modules"][name]


@pytest.mark.full
@pytest.mark.parametrize("late", [0, *(pytest.param(one, marks=pytest.mark.full) for one in (2222, 6666666))])
def test_a_box_is_dragged_into_a_module_and_into_a_group(courier, visit, late):
    page = visit(courier, late).open("design/drive")
    box = page.locator(".react-flow__node-box")
    drag(page, box.filter(has_text="encoder"), page.get_by_role("treeitem", name="see"), share=0.3)
    page.get_by_text("Moved encoder to see").wait_for()
    assert list(module(courier, "drive")["components"]) == ["motor"]
    page.get_by_role("treeitem", name="see").dblclick()
    box.filter(has_text="lidar").wait_for()
    assert module(courier, "see")["diagram"]["series"] == [{"parallel": ["lidar", "camera"]}, "encoder"]
    drag(page, box.filter(has_text="encoder"), page.locator(".gate", has_text="1/2"))
    page.locator(".gate", has_text="1/3").wait_for()
    assert module(courier, "see")["diagram"] == {"parallel": ["lidar", "camera", "encoder"]}
    drag(page, box.filter(has_text="encoder"), box.filter(has_text="lidar"), share=0.2)
    page.get_by_text("Moved encoder before lidar").wait_for()
    assert module(courier, "see")["diagram"] == {"parallel": ["encoder", "lidar", "camera"]}
    undo(page, to=page.get_by_role("button", name="Redo", exact=True))
    undo(page, to=page.locator(".gate", has_text="1/2"))
    undo(page, to=page.get_by_role("treeitem", name="encoder"))
    assert list(module(courier, "drive")["components"]) == ["motor", "encoder"]


@pytest.mark.full
def test_the_same_by_the_keyboard(courier, visit):
    look = visit(courier)
    page = look.open("design/see")
    node = page.locator(".react-flow__node", has_text="lidar")
    node.focus()
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="lidar").wait_for()
    page.keyboard.press("m")
    page.get_by_label("To the level").select_option("drive")
    page.get_by_label("Drawn").select_option("motor")
    assert look.serious() == []
    page.get_by_label("Drawn").press("Tab")
    page.keyboard.press("Enter")
    page.get_by_text("Moved lidar behind motor").wait_for()
    assert module(courier, "drive")["diagram"] == {"series": ["motor", "lidar", "encoder"]}
    assert module(courier, "see")["diagram"] == "camera"
    page.locator(".react-flow__node-box", has_text="encoder").wait_for()
    page.keyboard.press("Control+z")
    page.get_by_role("heading", name="drive").wait_for()  # where it was
    assert module(courier, "see")["diagram"] == {"parallel": ["lidar", "camera"]}


@pytest.mark.full
def test_a_network_is_drawn_and_edited(bridge, visit):
    look = visit(bridge)
    page = look.open("design")

    def network():
        return bridge.get("/api/design")["document"]["diagram"]["network"]

    node = page.locator(".react-flow__node-place")
    expect(node).to_have_count(4)
    drag(page, page.locator("[data-id=a] .react-flow__handle-right"), page.locator("[data-id=b]"))
    page.get_by_text("Linked a and b").wait_for()
    assert network()["links"] == [["in", "a", "out"], ["in", "b", "out"], ["a", "b"]]
    page.get_by_role("button", name="Add a node…").click()
    page.get_by_label("What", exact=True).select_option("c")
    page.get_by_label("From", exact=True).select_option("b")
    page.get_by_role("button", name="Put it there").click()
    expect(node).to_have_count(5)
    assert network()["links"] == [["in", "a", "out"], ["in", "b"], ["b", "c", "out"], ["a", "b"]]
    page.get_by_text("6 links, 5 nodes").click()
    page.get_by_label("What on a – b may fail").select_option("d")
    page.locator(".through", has_text="d").wait_for()
    page.locator("li", has_text="a – b").get_by_role("button", name="One way").click()
    page.get_by_role("button", name="Turn").wait_for()
    assert network()["links"][-1] == {"from": "a", "to": "b", "through": "d"}
    page.get_by_role("button", name="Problems of the design: No problems").wait_for()
    assert look.serious() == []
    page.get_by_role("button", name="Take c out of the network").click()
    expect(node).to_have_count(4)
    undo(page, to=page.get_by_role("button", name="Take c out of the network"))
    page.locator(".react-flow__edge").nth(1).focus()
    page.keyboard.press("Delete")
    page.get_by_text("Removed the link a – out").wait_for()
    assert network()["links"][0] == ["in", "a"]
    undo(page, to=page.locator("li", has_text="a – out"))
    page.get_by_role("button", name="Blocks").click()
    page.locator(".gate").first.wait_for()
