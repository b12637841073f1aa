"""Each recipe of docs/guides/extending.md, performed in a copy of the project as it is printed there."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs/guides/extending.md").read_text(encoding="utf-8")
RECIPES = dict(re.findall(r"^## (A .+?)\n(.*?)(?=^## |\Z)", GUIDE, re.MULTILINE | re.DOTALL))
BLOCK = re.compile(r"^\*\*([\w./-]+)\*\*(, first in `(\w+)`)?\n\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.fixture
def copy(tmp_path):
    """The project without what is built, but for what Python has compiled; what builds the page is linked."""
    left_out = shutil.ignore_patterns("static", "node_modules", "schema.ts")
    for folder in ("src", "tests", "examples", "ui", "docs/reference"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=left_out)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    (tmp_path / "ui" / "node_modules").symlink_to(ROOT / "ui" / "node_modules")
    return tmp_path


def write(copy, text):
    """The files of a recipe."""
    for name, within, place, block in BLOCK.findall(text):
        path = copy / name
        if within:
            heading = f"{place} = {{\n"
            before = path.read_text(encoding="utf-8")
            assert heading in before
            block = before.replace(heading, heading + block, 1)
        else:
            assert not path.exists()
        path.write_text(block, encoding="utf-8")


def test_there_is_a_recipe_for_each():
    assert [*RECIPES] == [
        "A hazard model", "A life distribution", "A degradation model", "A format of recordings", "A store",
        "A page", "A command",
    ]  # fmt: skip


LONG = {"A page", "A store", "A life distribution", "A degradation model", "A hazard model"}


@pytest.mark.parametrize(
    "title", [pytest.param(title, marks=pytest.mark.full) if title in LONG else title for title in RECIPES]
)
def test_a_recipe_works(copy, title):
    """All its commands succeed, and of its suite something is run; without its files they do not.

    That of a page builds the page, which takes a minute.
    """
    text = RECIPES[title]
    if "npm" in text and not (shutil.which("npm") and (ROOT / "ui" / "node_modules" / ".bin").is_dir()):
        pytest.skip("the page cannot be built here: it needs Node, and `npm ci` in ui/")
    (commands,) = re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    environment = {**os.environ, "PYTHONPATH": str(copy / "src")}

    def run(line):
        program, *words = shlex.split(line)
        options = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist"] if program == "pytest" else []
        programs = {"npm": ["npm"], "python": [sys.executable]}
        command = [*programs.get(program, [sys.executable, "-m", program]), *options, *words]
        return subprocess.run(command, cwd=copy, env=environment, capture_output=True, text=True, check=False)

    lines = commands.strip().splitlines()
    assert run(lines[-1]).returncode != 0
    write(copy, text)
    for line in lines:
        done = run(line)
        assert done.returncode == 0, done.stdout + done.stderr
        assert "no tests ran" not in done.stdout
    if "passed" not in done.stdout and "skipped" in done.stdout:
        pytest.skip(done.stdout)


@pytest.mark.parametrize(
    "title",
    [pytest.param(title, marks=pytest.mark.full) if "npm" in text else title for title, text in RECIPES.items()],
)
def test_recipes_are_short_and_well_written(copy, title):
    """Ten lines of code or so: at most seventeen that are neither imports, docstrings nor blank; ruff finds nothing."""
    write(copy, RECIPES[title])
    for name, within, _, block in BLOCK.findall(RECIPES[title]):
        lines = [line.strip() for line in block.splitlines()]
        code = [line for line in lines if line and not line.startswith(("from ", "import ", '"""'))]
        assert len(code) <= 17
        if name.endswith(".py") and not within:
            command = [sys.executable, "-m", "ruff", "check", "--no-cache", "--quiet", str(copy / name)]
            found = subprocess.run(command, cwd=copy, capture_output=True, text=True, check=False)
            assert found.returncode == 0, found.stdout
