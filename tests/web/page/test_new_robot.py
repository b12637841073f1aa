"""From nothing to a watched robot without leaving the page: files, questions, parts, sensors, use, first health."""

import pytest

from robophm.design.file import load

from ...drafting.robots import record, turtlebot
from ..conftest import serving
from .test_pages import BEYOND

PARTS = "Reference,Value,Footprint,Qty\nR1 R2,10k,R_0603_1608Metric,2\nC1,100nF,C_0603_1608Metric,1\n"
PHONE = {"width": 390, "height": 844}


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    return record(tmp_path_factory.mktemp("drive") / "drive.mcap", turtlebot())


@pytest.fixture
def nothing(tmp_path):
    with serving(tmp_path / "robot" / "robot.yaml") as served:
        yield served


@pytest.fixture(autouse=True)
def folder(tmp_path):
    (tmp_path / "robot").mkdir()


def hand_in(page, *files):
    page.get_by_label("Choose files").set_input_files([str(one) for one in files])


def from_files_to_a_robot_that_is_watched(look, files):
    """Begin with no robot: hand in files, answer questions, add and change parts; the first health, while it runs."""
    page = look.open()
    page.get_by_role("heading", name="No robot yet").wait_for()
    hand_in(page, *files)
    page.get_by_text("1 recording, 7 topics").wait_for()
    page.get_by_label("How many hours a day").fill("25")
    page.get_by_label("How many hours a day").press("Enter")
    page.get_by_text("expected more than 0 and at most 24 a day").wait_for()
    page.get_by_label("How many hours a day").fill("4")
    page.get_by_label("How many hours a day").press("Enter")
    page.get_by_label("Module that main.csv is of").fill("drive/board")
    page.get_by_label("Module that main.csv is of").press("Enter")
    page.get_by_role("row", name="drive/board/").first.wait_for()
    lidar = page.get_by_label("What sensing/lidar is", exact=False).first
    lidar.fill("lidar_3d")
    lidar.press("Enter")
    page.get_by_role("button", name="Take back: sensing/lidar").wait_for()
    page.get_by_label("Another part").fill("sensing/bumper")
    page.get_by_label("What it is").fill("limit switch")
    page.get_by_role("button", name="Add part").click()
    page.get_by_role("row", name="sensing/bumper").wait_for()
    page.get_by_text("/diagnostics.status[raspberry pi: cpu].values[Temperature].value").wait_for()
    page.get_by_label("And then").select_option("recordings")
    assert look.serious() == []
    page.get_by_role("button", name="Use this robot").click()
    page.get_by_role("heading", name="How sure this is").wait_for()
    page.get_by_role("row", name="median remaining life").wait_for()
    assert page.locator("section", has_text="What it would help most to know").locator("li").count() == 3
    page.get_by_text("Watching", exact=True).wait_for()
    assert look.serious() == []


@pytest.mark.full
def test_from_files_to_the_first_health_of_a_robot_that_is_watched(nothing, visit, shared, drive, tmp_path):
    (tmp_path / "main.csv").write_text(PARTS)
    from_files_to_a_robot_that_is_watched(
        visit(nothing), [shared / "robots" / "burger.urdf", drive, tmp_path / "main.csv"]
    )
    robot = load(nothing.design)
    assert robot.usage.operating == pytest.approx(4 / 24, rel=1e-5)
    assert {"sensing/bumper", "sensing/lidar"} < {part.path for part in robot.all_components()}
    assert robot.warnings == ()
    beside = {
        path.name
        for path in nothing.design.parent.iterdir()
        if not any(part in path.name for part in (".edits", ".access"))
    }
    assert beside == {"robot.yaml", "assumptions.md", "tasks.yaml", "robot.yaml.files"}
    assert "lidar" in (nothing.design.parent / "assumptions.md").read_text()


def test_a_service_without_a_robot_invites_and_names_the_files_that_it_takes(nothing, visit):
    look = visit(nothing)
    page = look.open("design")
    assert page.get_by_text("to mend").count() == 0
    page.get_by_role("button", name="No robot yet: begin here").click()
    page.get_by_role("heading", name="No robot yet").wait_for()
    hint = page.get_by_text("Drop its URDF").inner_text()
    for ending in (".bag", ".bin", ".db3", ".mcap", ".parquet", ".tlog", ".ulg", ".csv", ".ods", ".xlsx"):
        assert ending in hint
    assert look.serious() == []


@pytest.mark.full
def test_what_cannot_be_read_is_refused_in_words_and_leaves_nothing_behind(nothing, visit, tmp_path):
    (tmp_path / "bad.urdf").write_text('<robot name="r"><link name=></robot>')
    (tmp_path / "wheel.stl").write_bytes(b"solid wheel")
    with (tmp_path / "weeks.mcap").open("wb") as huge:
        huge.truncate(9_000_000_000)
    look = visit(nothing)
    page = look.open("new")
    page.get_by_text("Nothing is here yet. A URDF tells of joints").wait_for()
    hand_in(page, tmp_path / "bad.urdf", tmp_path / "wheel.stl", tmp_path / "weeks.mcap")
    page.get_by_text("bad.urdf:1: is no XML").wait_for()
    page.get_by_text("wheel.stl: tells nothing of a robot; expected its URDF, a recording").wait_for()
    page.get_by_text("weeks.mcap: has 9.0 GB").wait_for()
    assert not nothing.design.with_name("robot.yaml.files").exists()
    assert look.serious() == []


DROP = """(area) => {
  const dropped = new DataTransfer();
  dropped.items.add(new File(["Reference,Value,Footprint,Qty\\nR1,10k,R_0603_1608Metric,1\\n"], "board.csv"));
  area.dispatchEvent(new DragEvent("drop", {dataTransfer: dropped, bubbles: true, cancelable: true}));
}"""


def test_a_dropped_file_is_handed_in_and_taken_away_again(nothing, visit):
    page = visit(nothing).open()
    page.locator(".drop").evaluate(DROP)
    page.get_by_role("button", name="Remove board.csv").wait_for()
    page.get_by_role("row", name="electronics/board/R1").wait_for()
    page.get_by_role("button", name="Remove board.csv").click()
    page.get_by_text("Nothing is here yet.").wait_for()


def test_a_robot_by_words_alone_on_a_phone(nothing, visit):
    look = visit(nothing)
    look.page.set_viewport_size(PHONE)
    page = look.open()
    page.get_by_label("Another part").fill("drive/left motor")
    page.get_by_label("What it is").fill("brushless motor")
    page.get_by_role("button", name="Add part").click()
    page.get_by_role("row", name="drive/left motor").wait_for()
    page.get_by_role("button", name="Leave out power/converter").click()
    page.get_by_role("button", name="Take back: power/converter none").wait_for()
    page.get_by_text("Without a recording no signal is known.").wait_for()
    assert page.evaluate(BEYOND) == []
    page.get_by_role("button", name="Use this robot").click()
    page.get_by_role("heading", name="How sure this is").wait_for()
    assert {part.path for part in load(nothing.design).all_components()} == {
        "power/battery", "power/battery management", "computing/computer", "computing/memory card", "drive/left motor",
    }  # fmt: skip
    page.get_by_role("link", name="New robot").click()
    page.get_by_text("a later one changes only what nobody has touched").wait_for()


def test_an_example_robot_drives_by_one_click(nothing, visit):
    page = visit(nothing).open()
    page.get_by_role("button", name="Watch an example robot drive").click()
    page.get_by_text("Watching", exact=True).wait_for()
    page.get_by_text("Works on for").first.wait_for()
    assert nothing.get("/api/monitoring")["source"] == "synthetic OTA"
    assert not nothing.design.exists()
