"""What the examples' pages and the reference of tasks say: commands work, files are valid, pages are short."""

import re
import shlex
import sys
from pathlib import Path

import pytest

from robophm.blocks.reliability import Structure
from robophm.cli import main
from robophm.design.file import parse
from robophm.design.task_file import parse_plan, plan_from_csv

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "examples" / name / "README.md" for name in ("arm", "drone")]
COMMANDS = [
    line for page in PAGES for line in re.findall(r"^    robophm (.*)$", page.read_text(encoding="utf-8"), re.M)
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.parent.name)
def test_a_page_is_short(page):
    assert len(page.read_text(encoding="utf-8").splitlines()) <= 25


@pytest.mark.parametrize("line", COMMANDS)
def test_the_commands_work(line, monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys, "argv", ["robophm", *shlex.split(line)])
    with pytest.raises(SystemExit) as leaving:
        main()
    printed = capsys.readouterr()
    assert not leaving.value.code, printed.err
    assert printed.out.strip()


CRATE = """
schema_version: 1
name: crate fetcher
usage: {cycles: 1 cycle/h, starts: 1 start/h}
acceleration: [{model: q10}, {model: cubic_load}]
functions: {drive: Mobility, lift: Arm, look: Sensing}
modules:
  Mobility: {components: {Motor Left: {rate: 1 FIT}, Motor Right: {rate: 1 FIT}}}
  Arm: {components: {Lift: {rate: 1 FIT}}}
  Sensing: {components: {Camera: {rate: 1 FIT}}}
"""


def test_the_lists_of_the_reference_are_valid():
    page = (ROOT / "docs" / "reference" / "task-file.md").read_text(encoding="utf-8")
    robot = parse(CRATE)
    (listed, _), (table,) = (re.findall(rf"```{kind}\n(.*?)```", page, re.S) for kind in ("yaml", "csv"))
    plan, of_table = parse_plan(listed, robot), plan_from_csv(table, robot)
    assert [len(task.legs) for task in plan.tasks] == [len(task.legs) for task in of_table.tasks] == [2, 1]
    assert plan.every == 24
    assert plan.knowledge.failed == {"Mobility/Motor Left"}
    assert plan.tasks[0].legs[1].stresses == {"load": 0.8, "Arm/temperature": 45}
    assert of_table.tasks[0].legs[1].functions == ("lift", "look")


def of_reference(key):
    """The example in the reference of design files that starts with a key."""
    page = (ROOT / "docs" / "reference" / "design-file.md").read_text(encoding="utf-8")
    (found,) = re.findall(rf"```yaml\n({key}:.*?)```", page, re.S)
    return found


def test_the_network_of_the_reference_is_a_bridge():
    """With the cable one feed and one drive are enough; without it, both of a side."""
    parts = ["left feed", "left drive", "right feed", "right drive", "cross cable"]
    components = "".join(f"  {name}: {{rate: 1e-3 /h}}\n" for name in parts)
    structure = Structure(
        parse(f"schema_version: 1\nname: R\ncomponents:\n{components}{of_reference('diagram')}").diagram
    )
    assert sorted(structure.names) == sorted(parts)
    p = 0.8
    bridge = p * (1 - (1 - p) ** 2) ** 2 + (1 - p) * (1 - (1 - p**2) ** 2)
    assert structure.state([p] * 5, [1 - p] * 5).works == pytest.approx(bridge, rel=1e-14)


def test_the_common_causes_of_the_reference_are_valid():
    groups = of_reference("common_causes")
    parts = ["Motor Left", "Motor Right", "Camera", "Lidar Camera"]
    components = "".join(f"  {name}: {{rate: 1 FIT}}\n" for name in parts) + "  Wheel: {rate: 2 FIT, quantity: 4}\n"
    arm = "modules: {Arm: {components: {Camera: {rate: 1 FIT}}}}\n"
    robot = parse(f"schema_version: 1\nname: R\ncomponents:\n{components}{arm}{groups}")
    assert len(robot.causes) == 1 + 11 + 4
