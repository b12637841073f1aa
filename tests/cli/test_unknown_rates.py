"""Faces that were made for parts of known rate, of robots with one whose rate is unknown: none takes it for zero."""

from __future__ import annotations

import io
import json
import re
from contextlib import redirect_stdout
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from robophm.cli.shared.live_table import LiveTable
from robophm.cli.shared.task_recording import _print_records
from robophm.cli.shared.watch_output import Lines
from robophm.core.signal import SECOND, Sample
from robophm.design.file import load
from robophm.health.mission import Completion
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.task_history import judge_on_the_way
from robophm.stores.sqlite import SqliteStore
from robophm.transports.signals.report_sink import JudgedTask
from robophm.transports.tasks import PlannedTask
from robophm.transports.tasks.told import PlannedLeg

from .conftest import Run

PARTS = """
schema_version: 1
name: Rover
components:
  motor: {rate: 1e-4 /h, initial_exposure: 1000 h, uncertainty: {error_factor: 3}}
  pump: {rate: 2e-4 /h, life: {distribution: weibull, shape: 2}, uncertainty: {error_factor: 3}}
  board: {rate: unknown}
task: {duration: 10 h}
"""
WIRED = {"single": "", "pair": "diagram: {series: [pump, {parallel: [motor, board]}]}\n"}
"""The part of unknown rate as a single point of failure, and inside a 1-of-2."""

TABLES = {
    "tasks.yaml": "schema_version: 1\ntasks: [{legs: [{duration: 1000 h}]}]\n",
    "costs.csv": "part,preventive,corrective,downtime\nmotor,100,1000,4 h\npump,100,1000,4 h\nboard,50,500,4 h\n",
    "only_board.csv": "part,preventive,corrective\nboard,50,500\n",
    "sensors.csv": "sensor,part,detects,false alarm,fitted\nheat,motor,0.9,0.001,\nheat,board,0.9,,\n"
                   "own,board,0.9,0,\nflow,pump,0.8,0.001,no\n",
    "log.csv": "robot,part,exposure,censored\nr1,motor,9000 h,yes\nr1,board,4000 h,\nr1,board,6000 h,yes\n",
    "only_board_log.csv": "robot,part,exposure,censored\nr1,board,4000 h,yes\n",
}  # fmt: skip


@pytest.fixture(params=WIRED)
def wired(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """How the part is wired; the design and tables are in the folder."""
    (tmp_path / "robot.yaml").write_text(PARTS + WIRED[request.param])
    for name, text in TABLES.items():
        (tmp_path / name).write_text(text)
    rng = np.random.default_rng(1)
    worn = np.cumsum(rng.normal(0.01, 0.02, 300))
    (tmp_path / "wear.csv").write_text("time [h],value\n" + "".join(f"{i},{x:.5f}\n" for i, x in enumerate(worn)))
    lives = "".join(f"{900 * x:.1f}\n" for x in rng.weibull(2, 30))
    (tmp_path / "lives.csv").write_text("time [h]\n" + lives)
    design = load(tmp_path / "robot.yaml")
    monitor = Monitor(design)
    for i in range(300):
        monitor.observe(Sample((1_700_000_000 + i) * SECOND, "/odom", 1.0))
    with SqliteStore(tmp_path / "past.db") as store:
        store.save("Rover", monitor.ledger.to_json())
    return str(request.param)


LEFT_OUT = "1 part of unknown rate is left out of the totals"
FACES = [
    ("maintain costs.csv --repetitions 20", [
        r"board +unknown +– ", rf"{LEFT_OUT} \(board\): when to replace is not known", r"only what fails +≥ .* ≤ ",
        rf"{LEFT_OUT}: costs and failures are at least, availability is at most what is stated",
        "motor 1, pump 1, board unknown",
    ]),
    ("maintain costs.csv --repetitions 20 --store past.db", [
        rf"What to replace first: {LEFT_OUT}"]),
    ("diagnose sensors.csv --alarm heat", [
        r"board +unknown +unknown +9\.06\n", r"motor +\? ", r"false alarm: ≤ ",
        rf"{LEFT_OUT}: .* if it never fails.*\(board\)",
    ]),
    ("diagnose sensors.csv --alarm own", [r"board +unknown +unknown +∞", r"motor +unknown"]),
    ("diagnose sensors.csv --quiet", [
        r"board +unknown +unknown +0\.01", r"\nmotor +0\.1", r"Nothing has failed: ≤ ",
        r"1 part of unknown rate may have failed as well: how likely is not known \(board\)",
    ]),
    ("learn log.csv", [
        r"board +1 +– +10,000 h +unknown +–", "board: its rate is unknown", "1e-4 /h, 90 % between 5.13e-6 and 4.74e-4",
    ]),
    ("learn only_board_log.csv", [r"board +0 +– +4,000 h", "below 7.49e-4 /h with 95 %"]),
    ("learn log.csv --to new.yaml", [r"beside each rate; not of what is of unknown rate \(board\)"]),
    ("learn past.db", [r"board +0 +– ", "below "]),
    ("wear wear.csv --part motor --threshold 10", [r"Rover by hazard alone +[≤?] ", r"Rover with its wear.* [≤?] ",
        LEFT_OUT]),
    ("wear wear.csv --part board --threshold 10", [
        r"board by hazard alone +unknown", r"board with its wear[^0-9≤?]*\d", r"Rover by hazard alone +[≤?] ",
        r"Rover with its wear[^0-9≤?]*\d", "With the wear nothing is left out",
    ]),
    ("fault-tree", [r"occurs with at least 0\.", rf"{LEFT_OUT}: a probability of failing is at least"]),
    ("cutsets", [r"has failed with at least \d", rf"{LEFT_OUT}: a probability of failing is at least"]),
    ("fault-tree --monte-carlo 1000", [r"occurs with at least ", rf"{LEFT_OUT}: a probability of failing"]),
    ("importance", [
        r"fails within .* with (at least \d+\.\d+ %|\d+\.\d+ %, if it never fails)\n",
        rf"{LEFT_OUT}: a figure without 'at least' or 'at most' is as if it never fails",
        r"As it is: (at most median [^,]*, mean .*|median .*, if it never fails)\n",
    ]),
    ("predict --draws 200", [r"with rates unsure: (at most .*|.*, if it never fails)"]),
    ("task tasks.yaml --draws 20", [r"[≤?] \d", rf"{LEFT_OUT}: every PoTC", r"All of it fails .*, if it never fails"]),
    ("service board --store past.db --replaced --failed", ["board replaced after it failed"]),
]  # fmt: skip


@pytest.mark.parametrize(("words", "says"), FACES, ids=lambda one: str(one)[:40])
def test_each_face_says_what_it_leaves_out(inside: Run, wired: str, words: str, says: list[str]) -> None:
    command, *rest = words.split()
    found = inside(command, "robot.yaml", *rest)
    assert found.returncode == 0, found.stderr
    for one in says:
        assert re.search(one, found.stdout), (one, found.stdout)
    assert "∞" not in found.stdout or "own" in words or command == "importance"  # an infinite ratio bounds nothing
    assert "if it never fails" in found.stdout or wired == "single" or "wear" not in command


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("maintain only_board.csv", "all parts in it are of unknown rate (board); expected one with a rate"),
        ("learn only_board_log.csv --to new.yaml", "all that was seen is of unknown rate (board)"),
    ],
)
def test_what_is_of_unknown_rate_alone_is_refused_in_a_line(inside: Run, wired: str, words: str, says: str) -> None:
    command, *rest = words.split()
    found = inside(command, "robot.yaml", *rest)
    assert found.returncode == 3
    assert says in found.stderr
    assert found.stderr.count("\n") == 1


def test_a_fitted_life_makes_it_known(inside: Run, wired: str, tmp_path: Path) -> None:
    assert inside("fit", "lives.csv", "--to", "robot.yaml", "--part", "board").returncode == 0
    assert not any(mode.unknown for mode in load(tmp_path / "robot.yaml").modes)
    assert "unknown" not in inside("show", "robot.yaml").stdout


def test_machines_are_told_too(inside: Run, wired: str) -> None:
    said = {
        words: json.loads(inside(words.split()[0], "robot.yaml", *words.split()[1:], "--json").stdout)
        for words in (
            "maintain costs.csv --repetitions 20 --store past.db", "diagnose sensors.csv --alarm heat", "learn log.csv",
            "wear wear.csv --part board --threshold 10",
        )
    }  # fmt: skip
    upkeep, suspects, rates, worn = said.values()
    assert upkeep["unknown"]["parts"] == ["board"]
    assert upkeep["unknown"]["first"]["parts"] == 1
    assert upkeep["spares"]["board"] is None
    assert "board" not in [row["part"] for row in upkeep["first"]]
    assert (suspects["suspects"][0]["fault"], suspects["suspects"][0]["probability"]) == ("board", None)
    assert suspects["unknown"]["parts"] == 1
    assert [one["mode"] for one in rates["unknown"]] == ["board"]
    assert "unknown" in worn["remaining_life"]["Rover"]["hazard"]
    assert "unknown" not in worn["remaining_life"]["Rover"]["fused"]


def test_the_notebook_table(wired: str, tmp_path: Path) -> None:
    table = Monitor(load(tmp_path / "robot.yaml")).report()._repr_html_()
    assert "1 part of unknown rate is left out of the totals" in table
    assert "(board)" in table
    row = re.findall(r"<td>(.*?)</td>", table)
    assert all(cell[:2] in ("≥ ", "≤ ", "? ") or cell == "unknown" for cell in row)


def test_what_watch_says_while_the_robot_runs(wired: str, tmp_path: Path) -> None:
    report = Monitor(load(tmp_path / "robot.yaml")).report()
    out = Console(file=io.StringIO(), width=200)
    shown = Lines(out, every=0.0, unit="1/h", as_json=False)
    shown.publish(report)
    task = {"nominal": Completion(0.75, 0.25), "sensor_based": Completion(0.5, 0.5)}
    shown.judged(JudgedTask(False, 0, "/plan", 1.0, 2.0, task, report.system.unknown))
    out.print(LiveTable().draw(report))
    said = out.file.getvalue()
    assert re.search(r"0\.000 h  λ (≥ 1e-4 /h|unknown)  \(1 part of unknown rate\)", said), said
    half = "at most 50 %" if wired == "single" else "50 %, if it never fails"
    assert f"completed with {half} ({LEFT_OUT})" in said, said
    assert re.search(r"Rover \* +(≥|unknown)", said)


def test_tasks_of_a_recording_say_what_they_leave_out(wired: str, tmp_path: Path) -> None:
    monitor = Monitor(load(tmp_path / "robot.yaml"))
    begun = 1_700_000_000 * SECOND
    leg = PlannedLeg(10.0, 1.0)
    tasks = judge_on_the_way(monitor, [PlannedTask(begun + 20 * SECOND, "/plan", (leg,))])
    for i in range(60):
        monitor.observe(Sample(begun + i * SECOND, "/odom", 1.0))
    monitor.reach_marks()
    (found,) = tasks()
    assert found.predicted
    assert found.unknown == Monitor(load(tmp_path / "robot.yaml")).report(remaining_life=False).system.unknown
    out = io.StringIO()
    with redirect_stdout(out):
        _print_records(monitor.plant.robot, [found])
    assert f"{LEFT_OUT}: every PoTC is" in out.getvalue()
    assert re.search(r"[≥?] |unknown", out.getvalue().splitlines()[2])


def test_the_page_says_it_of_the_span_too(inside: Run, wired: str, tmp_path: Path) -> None:
    assert inside("report", "robot.yaml", "--store", "past.db", "--to", "health.html").returncode == 0
    said = r"median; at most 90 % between" if wired == "single" else r"median; 90 % between [^<]*, if it never fails"
    assert re.search(said, (tmp_path / "health.html").read_text())
