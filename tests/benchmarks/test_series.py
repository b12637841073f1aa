"""The series of benchmark runs: what is appended, of which commit, and where its picture shows it."""

import json
import math
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from benchmarks import Line, series

ROOT = Path(__file__).resolve().parents[2]
SVG = "{http://www.w3.org/2000/svg}"
MACHINE = {"processor": "Zilog Z80", "cores": 1, "python": "3.11.2", "numpy": "2.0.0", "system": "CP/M"}


def git(folder: Path, *words: str) -> str:
    named = ["-c", "user.name=nobody", "-c", "user.email=nobody@localhost"]
    done = subprocess.run(["git", *named, *words], cwd=folder, capture_output=True, text=True, check=True)
    return done.stdout.strip()


def made(date: str, ratio: float, processor: str = "Zilog Z80", goal: float | None = None) -> series.Run:
    """A run of one figure."""
    figure = {"name": "sums", "ours": 1.0, "unit": "s", "peer": "abacus", "ratio": ratio, "goal": goal}
    return {**MACHINE, "date": date, "commit": "abc", "processor": processor, "figures": [figure]}


def drawn(runs: list[series.Run]) -> list[ElementTree.Element]:
    """The plots, in their order."""
    return [one for one in ElementTree.fromstring(series.picture(runs)).iter(f"{SVG}g") if one.get("transform")]


def dots(plot: ElementTree.Element) -> list[tuple[float, float]]:
    return [(float(dot.get("cx", "")), float(dot.get("cy", ""))) for dot in plot.iter(f"{SVG}circle")]


def test_a_run_holds_every_line_with_unit_ratio_and_goal() -> None:
    lines = [Line("sums", 2e-3, 8e-3, "abacus", goal=0.5), Line("alone", 3.0)]
    one = series.run(lines, MACHINE, "abc")
    assert {key: one[key] for key in ("commit", "processor", "cores", "python", "numpy")} == {
        "commit": "abc", "processor": "Zilog Z80", "cores": 1, "python": "3.11.2", "numpy": "2.0.0",
    }  # fmt: skip
    assert one["figures"] == [
        {"name": "sums", "ours": 0.002, "unit": "s", "peer": "abacus", "ratio": 0.25, "goal": 0.5},
        {"name": "alone", "ours": 3.0, "unit": "s", "peer": None, "ratio": None, "goal": None},
    ]


def test_a_line_is_added_to_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "series.jsonl"
    later, earlier = made("2026-02-02T00:00:00+00:00", 0.5), made("2026-02-01", 0.7)
    series.append(later, path)
    before = path.read_text("utf-8")
    series.append(earlier, path)
    assert path.read_text("utf-8").startswith(before)
    assert len(path.read_text("utf-8").splitlines()) == 2
    assert series.read(path) == [earlier, later]
    assert series.read(tmp_path / "none.jsonl") == []


def test_the_commit_is_the_one_whose_sources_ran(tmp_path: Path) -> None:
    assert series.commit(tmp_path) is None
    git(tmp_path, "init", "--quiet")
    (tmp_path / "src").mkdir()
    (tmp_path / "benchmarks").mkdir()
    source, lines = tmp_path / "src" / "a.py", tmp_path / "benchmarks" / "series.jsonl"
    source.write_text("1\n", "utf-8")
    lines.write_text("{}\n", "utf-8")
    git(tmp_path, "add", "--all")
    git(tmp_path, "commit", "--quiet", "--message", "one")
    head = git(tmp_path, "rev-parse", "HEAD")[:12]
    lines.write_text("{}\n{}\n", "utf-8")
    assert series.commit(tmp_path) == head, "the series alone makes nothing dirty"
    source.write_text("2\n", "utf-8")
    assert series.commit(tmp_path) == f"{head}-dirty"


def test_a_ratio_stands_where_its_logarithm_is() -> None:
    """Over two decades, 0.1 is half way up, and the goal of √0.1 three quarters."""
    runs = [made("2026-01-01", 0.01), made("2026-01-02", 0.1), made("2026-01-03", 1.0, goal=math.sqrt(0.1))]
    (plot,) = drawn(runs)
    (x0, lowest), (x1, middle), (x2, highest) = dots(plot)
    assert x1 - x0 == pytest.approx(x2 - x1, abs=0.1)
    assert x1 > x0
    assert middle == pytest.approx((lowest + highest) / 2, abs=0.1)
    assert lowest > highest, "more is higher up, where y is less"
    (goal,) = (float(line.get("y1", "")) for line in plot.iter(f"{SVG}line") if line.get("class") == "goal")
    assert goal == pytest.approx(lowest + 0.75 * (highest - lowest), abs=0.1)
    (even,) = (float(line.get("y1", "")) for line in plot.iter(f"{SVG}line") if line.get("class") == "even")
    assert even == pytest.approx(highest, abs=0.1)
    assert "1 > 0.316" in [text.text for text in plot.iter(f"{SVG}text")]


def test_a_goal_that_is_met_is_said_to_be() -> None:
    (plot,) = drawn([made("2026-01-01", 0.2, goal=0.25)])
    assert "0.2 ≤ 0.25" in [text.text for text in plot.iter(f"{SVG}text")]


def test_processors_are_not_mixed() -> None:
    runs = [made("2026-01-01", 0.2, "A"), made("2026-01-02", 0.9, "B"), made("2026-01-03", 0.3, "A")]
    newest, other = drawn(runs)
    assert len(dots(newest)) == 2
    assert len(dots(other)) == 1
    heads = re.findall(r'class="head"[^>]*>([^<]*)<', series.picture(runs))
    assert heads == ["A, 1 core", "B, 1 core"]


def test_a_figure_that_a_run_has_not_is_a_gap_in_its_place() -> None:
    whole, without, last = made("2026-01-01", 0.2), made("2026-01-02", 0.2), made("2026-01-03", 0.2)
    without["figures"] = [{**without["figures"][0], "name": "products"}]
    three, _ = drawn([whole, without, last])
    assert {text.text for text in three.iter(f"{SVG}text")} >= {"sums", "/ abacus"}
    (first, _), (third, _) = dots(three)
    ((alone, _),) = dots(drawn([whole, without, last])[1])
    assert alone == pytest.approx((first + third) / 2, abs=0.1)


def test_the_picture_is_drawn_of_all_lines() -> None:
    runs = series.read()
    assert series.PICTURE.read_text("utf-8") == series.picture(runs), "expected python -m benchmarks.series run"
    shown = sum(len(dots(plot)) for plot in drawn(runs))
    assert shown == sum(len(one["figures"]) for one in runs) > 0


def test_what_was_taken_from_the_page_stood_there() -> None:
    """Figures with an origin are those that the page of the commit printed, as many as it had."""
    for one in series.read():
        if "origin" not in one:
            continue
        try:
            page = git(ROOT, "show", f"{one['commit']}:docs/benchmarks.md")
        except subprocess.CalledProcessError:
            pytest.skip("this checkout has not the whole history")
        table = page[page.index("| work ") :].partition("\n\n")[0].splitlines()[2:]
        rows = [[cell.strip() for cell in row.strip("|").split("|")] for row in table]
        assert [figure["name"] for figure in one["figures"]] == [row[0] for row in rows]
        for figure, (_, ours, peer, ratio, goal) in zip(one["figures"], rows, strict=True):
            assert ours.startswith(in_words(figure["ours"]))
            assert (figure["peer"] or "–") in peer
            assert figure["ratio"] == (None if ratio == "–" else float(ratio))
            assert figure["goal"] == (None if goal == "–" else float(goal[2:]))


def in_words(value: float) -> str:
    for scale, unit in ((1.0, "s"), (1e3, "ms"), (1e6, "µs")):
        if value * scale >= 1:
            return f"{value * scale:.3g} {unit}"
    raise AssertionError(value)


TINY = """
from benchmarks import DisagreementError, Line, benchmark

@benchmark
def sums():
    yield Line("sums", 0.5, 1.0, "abacus", goal=0.4)

@benchmark
def differs():
    raise DisagreementError("1, the peer says 2")
"""


@pytest.fixture
def checkout(tmp_path: Path) -> Callable[..., Any]:
    """The benchmarks in a folder of their own, with one room, as they are run there."""
    shutil.copytree(
        ROOT / "benchmarks", tmp_path / "benchmarks", ignore=shutil.ignore_patterns("*.jsonl", "__pycache__")
    )
    (tmp_path / "docs").mkdir()
    first = tmp_path / "benchmarks" / "__init__.py"
    first.write_text(first.read_text("utf-8") + '\nROOMS = ("tiny",)\n', "utf-8")
    (tmp_path / "benchmarks" / "tiny.py").write_text(TINY, "utf-8")

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "benchmarks", *words]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    return run


def test_a_run_appends_what_it_found_and_draws_it(checkout: Callable[..., Any], tmp_path: Path) -> None:
    path = tmp_path / "benchmarks" / "series.jsonl"
    done = checkout("tiny.sums")
    assert done.returncode == 0, done.stderr
    (one,) = map(json.loads, path.read_text("utf-8").splitlines())
    assert one["python"] == ".".join(map(str, sys.version_info[:3]))
    assert one["numpy"] == np.__version__
    assert one["commit"] is None
    assert [(figure["name"], figure["ratio"]) for figure in one["figures"]] == [("sums", 0.5)]
    ElementTree.parse(tmp_path / "docs" / "benchmarks.svg")
    both = checkout()
    assert both.returncode == 1
    assert "answers differ: tiny.differs" in both.stdout
    assert len(path.read_text("utf-8").splitlines()) == 2, "what agreed is kept"
    checkout("tiny.differs")
    assert len(path.read_text("utf-8").splitlines()) == 2, "a run that found nothing is none"


def test_processors_that_are_called_alike_are_told_apart() -> None:
    """By the family and model that lscpu, which reads them by itself, says."""
    if not shutil.which("lscpu"):
        pytest.skip("no lscpu")
    listed = subprocess.run(["lscpu"], capture_output=True, text=True, check=True, env={"LC_ALL": "C"}).stdout
    said = dict(re.findall(r"^\s*([^:]+):\s+(.*)$", listed, re.M))
    if "CPU family" not in said:
        pytest.skip("this kind of processor has no family")
    expected = f"{said['Model name']}, cpu family {said['CPU family']}, model {said['Model']}"
    assert series.processor() == expected
