"""``make new-user``: from a built wheel in a clean environment to the first report of five robots, timed.

Prints a row for each robot and leaves with 1 where one takes more than two minutes, asks more than seven questions, has
a warning, fewer than five signals, or a rate without source and grade; or where its ranges of the chance to fail and of
the median life do not hold the figures of a design of it by hand, from sources of its own. Robots whose description is
in shared/robots are left out, and said so, without it.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path
from typing import Any

from tests.drafting.robots import ROOT, NewRobot, robots

MOST_SECONDS, MOST_QUESTIONS, FEWEST_SIGNALS = 120.0, 7, 5


def installed(folder: Path) -> Path:
    """The command of the wheel that is built here, in an environment of its own, with what reads logs of PX4."""
    subprocess.run([sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)],
                   check=True, stdout=subprocess.DEVNULL)  # fmt: skip
    venv.create(folder / "env", with_pip=True)
    (wheel,) = folder.glob("*.whl")
    pip = [str(folder / "env/bin/python"), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "--constraint", str(ROOT / "constraints.txt"), f"{wheel}[px4]"], check=True)
    return folder / "env/bin/robophm"


def told(command: Path, *words: str | Path, cwd: Path) -> dict[str, Any]:
    """What a command says as JSON. Raises CalledProcessError where it fails."""
    done = subprocess.run([command, *words, "--json"], cwd=cwd, check=True, capture_output=True, text=True)
    return dict(json.loads(done.stdout))


def of(robot: NewRobot, command: Path, folder: Path) -> tuple[dict[str, Any], list[str]]:
    """The figures of one robot, and what is not as it should be."""
    bag = robot.recorded(folder)
    said = [word for key, text in robot.said.items() for word in (f"--{key}", text)]
    begun = time.monotonic()
    new = told(command, "new", f"{robot.name}/robot.yaml", "--urdf", robot.urdf, "--bag", bag, *said, cwd=folder)
    took = time.monotonic() - begun
    check = told(command, "check", f"{robot.name}/robot.yaml", cwd=folder)
    questions = (folder / robot.name / "assumptions.md").read_text().count("? Taken: ") + len(robot.said)
    ungraded = [one["path"] for one in new["parts"] if not (one["grade"] and one["source"])]
    wrong = [
        *([f"took {took:.0f} s"] if took > MOST_SECONDS else []),
        *([f"{questions} questions"] if questions > MOST_QUESTIONS else []),
        *([f"{len(check['warnings'])} warnings"] if check["warnings"] else []),
        *([f"{len(check['signals'])} signals"] if len(check["signals"]) < FEWEST_SIGNALS else []),
        *([f"no source or grade: {', '.join(ungraded)}"] if ungraded else []),
    ]
    found = {"seconds": took, "questions": questions, "parts": len(new["parts"]), "signals": len(check["signals"])}
    return found | {"ranges": new["ranges"]}, wrong


def outside(robot: NewRobot, command: Path, ranges: dict[str, Any], folder: Path) -> list[str]:
    """Which figures of a robot's design by hand the ranges of its draft do not hold."""
    health = told(command, "predict", robot.by_hand, "--draws", "0", cwd=folder)
    (system,) = [one for one in health["subjects"] if one["kind"] == "robot"]
    nominal = system["nominal"]
    figures = {"failure": nominal["completion"]["failure"], "median_life": nominal["remaining_life"]["median"]}
    said = []
    for name, figure in figures.items():
        low, _, high = ranges[name]
        print(f"  {name} by hand {figure:.3g}, drafted {low:.3g} … {high:.3g}")
        if not low < figure < high:
            said.append(f"{name} by hand {figure:.3g} is outside {low:.3g} … {high:.3g}")
    return said


def main() -> int:
    """Print the rows; 1 where something is not as it should be."""
    print(f"{'robot':<14}{'seconds':>9}{'questions':>11}{'parts':>7}{'signals':>9}   PoTC fails, 5 … 95 %")
    faults: list[str] = []
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        command = installed(folder)
        for robot in robots(ROOT.parent / "shared"):
            if not robot.urdf.exists():
                print(f"{robot.name:<14}left out: no {robot.urdf}")
                continue
            found, wrong = of(robot, command, folder)
            low, _, high = found["ranges"]["failure"]
            print(f"{robot.name:<14}{found['seconds']:>9.1f}{found['questions']:>11}{found['parts']:>7}"
                  f"{found['signals']:>9}   {low:.3g} … {high:.3g}")  # fmt: skip
            wrong += outside(robot, command, found["ranges"], folder)
            faults += [f"{robot.name}: {one}" for one in wrong]
    for fault in faults:
        print(f"not as it should be: {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
