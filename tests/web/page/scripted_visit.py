"""``make test-page``: what people come to the page for, counted in clicks, and a picture of every page and state.

The pictures, under ``demo-output/pages``, are to be looked at: ``index.html`` there has them all, and each sheet those
of one width and theme. Not collected with the other tests; the file is named to pytest.
"""

from __future__ import annotations

import math
import re
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import pytest

from ...drafting.robots import record, turtlebot
from ..conftest import ROOT, SMALL, Served, serving
from .conftest import Visit
from .test_new_robot import PARTS, from_files_to_a_robot_that_is_watched
from .test_pages import BEYOND, PAGES
from .visited_robot import HOT, HOUR, MOTOR, SHAPE, WHEEL, promised, visited_robot

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

PICTURES = ROOT / "demo-output" / "pages"
WIDTHS = {390: 844, 820: 1180, 1440: 900, 1920: 1080}
"""Widths of the pictures, and the heights of such screens."""
CHECKED = (390, 1440)
"""Widths at which axe-core looks; at the others the same elements stand otherwise beside each other."""
TALLEST = 5000
"""Height beyond which a page is cut off in its picture."""

MOST_CLICKS, MOST_SECONDS = 2, 180

COUNT_CLICKS = """
window.clicks = Number(sessionStorage.clicks ?? 0);
addEventListener("click", (event) => event.isTrusted && (sessionStorage.clicks = ++window.clicks), true);
"""


@pytest.fixture(scope="module")
def courier(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A robot with a past, in the drive of which it has become hot."""
    with visited_robot(tmp_path_factory.mktemp("courier")) as served:
        until = time.monotonic() + 300
        while not served.get("/api/health")["alarms"]:
            assert time.monotonic() < until, "no alarm has begun"
            time.sleep(0.2)
        yield served


@dataclass
class Task:
    """A question, and the page on which it is answered, beginning at the overview."""

    question: str
    answer: Callable[[Page], None]
    """Finds the answer and compares it. Raises AssertionError, or TimeoutError where it is not there."""


def what_is_wrong(page: Page) -> None:
    page.locator(".trouble").get_by_text("is above 0.009 /h").wait_for()


def since_when(page: Page) -> None:
    page.get_by_role("link", name=re.compile("^[0-9]+ alarm")).click()
    active = page.get_by_role("list", name="Active alarms").get_by_role("listitem").filter(has_text="hazard rate")
    (said,) = re.findall(r"since (\d{4}-\d\d-\d\d \d\d:\d\d)", active.text_content() or "")
    began = datetime.fromisoformat(said).replace(tzinfo=UTC).timestamp()
    assert 0 <= began - HOT < HOUR / 2  # looks follow the clock, of which a second is a minute of the robot's


def which_part_decides(page: Page) -> None:
    page.locator(".answer summary").filter(has_text=f"drive/{WHEEL} decides it").click()
    page.get_by_text("temperature 45 °C, designed for 25 °C").wait_for()
    page.get_by_text("it ages 4 times as fast as designed").wait_for()


def what_to_replace_first(page: Page) -> None:
    """The motors alone wear: until the chance that one of the two fails, given that both work, is the accepted one."""
    page.get_by_role("link", name="Maintenance").click()
    said = page.get_by_text("Replace drive/motor first, within").text_content() or ""
    days = float(re.findall(r"within ([\d.]+) days", said)[0])
    risk = float(page.get_by_label("Accepted chance of failure").input_value())
    scale = 1 / (MOTOR * math.gamma(1 + 1 / SHAPE))
    begun = 40 * 8.0  # hours, of 40 shifts; what it ages today is at most a shift at four times the pace
    left = [(age**SHAPE - scale**SHAPE * math.log1p(-risk) / 2) ** (1 / SHAPE) - age for age in (begun, begun + 60)]
    assert left[1] / 4 * 3 - 1 <= days * 24 <= left[0] / 4 * 3 + 1  # of three hours it is on in one


def was_it_honest(page: Page) -> None:
    page.get_by_role("link", name="History").click()
    told = page.get_by_role("region", name="Was it honest?").get_by_text("promised,").first
    counts = re.findall(r"([\d.]+) promised, (\w+) noted", told.text_content() or "")
    assert float(counts[0][0]) == pytest.approx(promised(30), rel=0.1)
    assert counts[0][1] == "2"


TASKS = [
    Task("what is wrong", what_is_wrong), Task("since when", since_when),
    Task("which part decides", which_part_decides),
    Task("what do I replace first, and when", what_to_replace_first),
    Task("was it honest last month", was_it_honest),
]  # fmt: skip


@pytest.mark.parametrize("width", WIDTHS)
def test_what_people_come_for_is_two_clicks_away(courier: Served, visit: Callable[..., Visit], width: int) -> None:
    look = visit(courier)
    look.page.add_init_script(COUNT_CLICKS)
    look.page.set_viewport_size({"width": width, "height": WIDTHS[width]})
    for task in TASKS:
        page = look.open("overview")
        page.evaluate("sessionStorage.clicks = window.clicks = 0")
        task.answer(page)
        clicks = page.evaluate("window.clicks")
        print(f"{width} px, {task.question}: {clicks} clicks")
        assert clicks <= MOST_CLICKS, task.question


def test_a_new_robot_from_nothing_to_a_running_analysis(
    tmp_path: Path, visit: Callable[..., Visit], shared: Path
) -> None:
    (tmp_path / "robot").mkdir()
    (tmp_path / "main.csv").write_text(PARTS)
    drive = record(tmp_path / "drive.mcap", turtlebot())
    with serving(tmp_path / "robot" / "robot.yaml") as nothing:
        begun = time.monotonic()
        from_files_to_a_robot_that_is_watched(
            visit(nothing), [shared / "robots" / "burger.urdf", drive, tmp_path / "main.csv"]
        )
        took = time.monotonic() - begun
    print(f"a new robot from nothing to a running analysis: {took:.0f} s of scripted time")
    assert took <= MOST_SECONDS


def pressing(keys: str) -> Callable[[Page], None]:
    return lambda page: page.keyboard.press(keys)


def clicking(role: Literal["button", "tab"], name: str) -> Callable[[Page], None]:
    return lambda page: page.get_by_role(role, name=name).first.click()


def text_editor(page: Page) -> None:
    page.get_by_role("button", name="Edit as text").click()
    page.locator(".cm-content").wait_for()


def open_answer(page: Page) -> None:
    page.locator(".answer summary").click()


def grouping(page: Page) -> None:
    page.get_by_role("treeitem", name="power").press("ArrowRight")
    page.get_by_role("treeitem", name="battery").click()
    page.get_by_role("treeitem", name="step-down converter").click(modifiers=["Control"])
    page.get_by_role("button", name="Group…").click()


def prognosis(page: Page) -> None:
    page.get_by_role("button", name="Start", exact=True).click()
    page.get_by_text("are completed with").first.wait_for()


STATES: list[tuple[str, str, Callable[[Page], None]]] = [
    ("overview, why", "overview", open_answer),
    ("design, a module", "design/drive", lambda page: page.locator(".react-flow__node-box").first.wait_for()),
    ("design, a part", f"design/drive/{WHEEL}", lambda page: page.get_by_role("heading", name=WHEEL).wait_for()),
    ("design, as text", "design/drive/motor", text_editor),
    ("design, grouping", "design", grouping),
    ("parts, library", "parts", clicking("tab", "Library of models")),
    ("parts, own formula", "parts", clicking("tab", "Own formula")),
    ("parts, paste", "parts", clicking("button", "Paste from a spreadsheet")),
    ("analysis, what matters most", "analysis", clicking("tab", "What matters most")),
    ("analysis, cut sets", "analysis", clicking("tab", "What it takes to fail")),
    ("analysis, fault tree", "analysis", clicking("tab", "Fault tree")),
    ("analysis, what if", "analysis", clicking("tab", "What if")),
    ("analysis, failure modes", "analysis", clicking("tab", "Failure modes")),
    ("analysis, field data", "analysis", clicking("tab", "Field data")),
    ("analysis, compare", "analysis", clicking("tab", "Compare")),
    ("tasks, again and again", "tasks", prognosis),
    ("maintenance, a service", "maintenance", clicking("button", "Note a service of drive/motor")),
    ("palette", "overview", pressing("Control+k")),
    ("help", "overview", pressing("?")),
]
"""Name, page, and what is done there."""


@dataclass
class Album:
    """Pictures that were taken, in folders of a width and theme each."""

    taken: dict[str, list[tuple[str, Path]]] = field(default_factory=dict)

    def take(self, page: Page, sheet: str, name: str, width: int) -> None:
        """Take the picture of a page as a whole, as far as it is not too tall."""
        tall = page.evaluate("(() => { const main = document.querySelector('main');"
                             "return main.scrollHeight - main.clientHeight; })()")  # fmt: skip
        height = min(TALLEST, WIDTHS[width] + tall)
        page.set_viewport_size({"width": width, "height": height})
        page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 60)))")
        path = PICTURES / sheet / f"{name.replace(', ', '-').replace(' ', '-')}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=path)
        self.taken.setdefault(sheet, []).append((name, path))
        page.set_viewport_size({"width": width, "height": WIDTHS[width]})

    def index(self, browser: Browser) -> None:
        """Write a page that has them all, and a sheet of each folder as a picture."""
        links = []
        for sheet, pictures in self.taken.items():
            shown = "".join(
                f"<figure><a href='{path.relative_to(PICTURES)}'><img src='{path.relative_to(PICTURES)}'></a>"
                f"<figcaption>{escape(name)}</figcaption></figure>"
                for name, path in pictures
            )
            page = PICTURES / f"{sheet}.html"
            page.write_text(SHEET.format(title=escape(sheet), figures=shown), encoding="utf-8")
            links.append(f"<li><a href='{page.name}'>{escape(sheet)}</a>, {len(pictures)} pictures")
            wide = browser.new_page(viewport={"width": 2000, "height": 1000})
            wide.goto(page.as_uri())
            wide.screenshot(path=PICTURES / f"{sheet}.png", full_page=True)
            wide.close()
        (PICTURES / "index.html").write_text(f"<!doctype html><title>Pages</title><ul>{''.join(links)}</ul>")


SHEET = """<!doctype html><meta charset="utf-8"><title>{title}</title>
<style>
body {{ font: 14px sans-serif; display: grid; grid-template-columns: repeat(5, 1fr); gap: 12px; background: #777 }}
figure {{ margin: 0 }} img {{ width: 100%; max-height: 560px; object-fit: cover; object-position: top }}
figcaption {{ color: #fff }}</style>{figures}"""


def settled(page: Page) -> None:
    """Wait until nothing is under way any more: what is asked of the service has been answered, and drawn."""
    page.wait_for_function(
        "() => !document.querySelector('main')?.innerText.match(/^(Loading|…$)/m) && document.fonts.status === 'loaded'"
    )
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 150)))")


@pytest.fixture(scope="module")
def album(browser: Browser) -> Iterator[Album]:
    shutil.rmtree(PICTURES, ignore_errors=True)
    album = Album()
    yield album
    album.index(browser)
    count = sum(len(pictures) for pictures in album.taken.values())
    print(f"{count} pictures: {PICTURES.relative_to(ROOT)}/index.html")


@pytest.fixture(scope="module")
def robots(courier: Served, tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Served]]:
    """A robot with a past, none, and one whose design is not complete."""
    nothing, broken = (tmp_path_factory.mktemp(name) / "robot.yaml" for name in ("nothing", "broken"))
    broken.write_text(SMALL.replace("30 FPMH", "30 kg"))
    with serving(nothing) as empty, serving(broken) as wrong:
        yield {"": courier, "nothing, ": empty, "wrong, ": wrong}


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("width", WIDTHS)
def test_every_page_and_state_has_its_picture(
    robots: dict[str, Served], visit: Callable[..., Visit], album: Album, width: int, theme: str
) -> None:
    """None reaches beyond its width, and axe-core finds nothing serious or moderate in any."""
    found: list[str] = []
    for of, served in robots.items():
        look = visit(served, color_scheme=theme)
        look.page.set_viewport_size({"width": width, "height": WIDTHS[width]})
        shown = [(f"{of}{page}", page, lambda page: None) for page in PAGES]
        for name, address, act in [*shown, *([] if of else STATES)]:
            look.page.goto("about:blank")  # what was open there is closed
            page = look.open(address)
            settled(page)
            act(page)
            settled(page)
            album.take(page, f"{width}-{theme}", name, width)
            found += [f"{width} px, {name}: beyond the edge: {one}" for one in page.evaluate(BEYOND)]
            if width in CHECKED:
                found += [f"{width} px, {name}, {theme}: {one}" for one in look.serious()]
    assert found == []
