"""What people who work on the project call: the targets of make."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def recipe(target: str, *words: str) -> list[str]:
    """The commands that make would run."""
    if not shutil.which("make"):
        pytest.skip("no make")
    command = ["make", "--dry-run", "--no-print-directory", f"PYTHON={sys.executable}", target, *words]
    environment = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def test_help_says_what_each_target_does() -> None:
    text = (ROOT / "Makefile").read_text("utf-8")
    targets = set(re.search(r"^\.PHONY: (.*)$", text, re.M)[1].split())  # type: ignore[index]
    told = re.findall(r'@echo "make ([\w-]+) ', text)
    assert targets - set(told) == {"help", "setup", "lint", "peers", "compiled"}, "what the others call"
    assert set(told) <= targets


def test_check_sets_up_lints_and_runs_the_touched_tests_in_this_order() -> None:
    lines = recipe("check", "SECONDS=7")
    wanted = (
        "tools/setup",
        "ruff format --check",
        "ruff check",
        "mypy",
        "lint-imports",
        "touched_tests.py --seconds 7",
    )
    places = [next(i for i, line in enumerate(lines) if word in line) for word in wanted]
    assert places == sorted(places)
    assert recipe("check")[-1].split()[-1] == "tools/touched_tests.py"


def test_the_slowest_tests_are_told_by_the_processes_that_share_them(tmp_path: Path) -> None:
    """With the words that make test gives to pytest: what took a second and more, ten at most."""
    (words,) = (shlex.split(line)[1:] for line in recipe("test") if "/pytest -n" in line)
    slow = "@pytest.mark.parametrize('i', range(12))\ndef test_slow(i): time.sleep(1.05)\n"
    (tmp_path / "test_one.py").write_text(f"import pytest, time\n{slow}def test_quick(): ...\n")
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST")}
    environment |= {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTEST_PLUGINS": "xdist.plugin,pytest_timeout"}
    command = [sys.executable, "-m", "pytest", *words, "test_one.py"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    told = done.stdout.partition("slowest 10 durations")[2]
    assert len(re.findall(r"^\d+\.\d+s call +test_one\.py::test_slow\[\d+\]", told, re.M)) == 10
    assert "test_quick" not in told
