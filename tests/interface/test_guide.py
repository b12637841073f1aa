"""The guide to Python: each example as printed, in order; its figures by closed forms; commands and functions."""

import doctest
import math
import re
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

import robophm
from robophm.cli.app import COMMANDS

GUIDE = Path(__file__).parents[2] / "docs" / "guides" / "python.md"
DESIGN = re.search(r"```yaml\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)[1]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the guide's design, in which one works."""
    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robot.yaml").write_text(DESIGN)
    return tmp_path


def test_every_example_prints_what_stands_there(folder):
    blocks = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    examples = doctest.DocTestParser().get_doctest("\n".join(blocks), {}, "python.md", str(GUIDE), 0)
    said = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    runner.run(examples, out=said.append)
    assert "".join(said) == ""
    assert len(examples.examples) > 40


def test_its_figures_are_those_of_closed_forms(folder):
    """Ten hours at a stress of four: motor 1e-4·4·10, bearing −ln 0.9·(t/5000)², lidar 2e-5·t."""
    (folder / "drive.csv").write_text("\n".join(["time,/motor.temperature", *(f"{60 * i},60" for i in range(601))]))
    health = robophm.replay(robophm.load("robot.yaml"), "drive.csv")

    def hazard(t, stress=4.0):
        return 1e-4 * stress * t - math.log(0.9) * (t / 5000) ** 2 + 2e-5 * t

    for hours in (0.0, 100.0, 1000.0):
        since_new = math.exp(-hazard(10 + hours))
        assert health.reliability(hours) == pytest.approx(since_new, rel=1e-9)
        assert health.survival_of_next(hours) == pytest.approx(since_new / math.exp(-hazard(10)), rel=1e-9)
        assert health.reliability(hours, "nominal") == pytest.approx(math.exp(-hazard(10 + hours, 1)), rel=1e-9)
    assert health.survival_of_next([]).shape == health.reliability(np.empty((2, 0)))[0].shape == (0,)
    drive = math.exp(-(hazard(1010) - hazard(10)) + 2e-5 * 1000)
    assert health.survival_of_next(1000.0, of="drive") == pytest.approx(drive, rel=1e-9)


def test_every_command_is_a_function_or_is_said_to_be_of_the_command_line(folder):
    told = GUIDE.read_text(encoding="utf-8").partition("## Commands and functions")[2]
    for command in set(COMMANDS) & {name.replace("_", "-") for name in robophm.__all__}:
        assert f"`{command}`" in told
    for name in re.findall(r"`(\w+)`", told.partition("| in Python |")[2]):
        assert name.replace("_", "-") in {*COMMANDS, "observe", "report", "search", "part", "library"} or hasattr(
            robophm, name
        ), name
