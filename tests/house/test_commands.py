"""Each command is one file: its options, its work and the line that the list says of it."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import robophm.cli
from robophm.cli.app import COMMANDS
from robophm.cli.data import COMMANDS as DATA_COMMANDS
from robophm.cli.fleet import COMMANDS as FLEET_COMMANDS

CLI = Path(robophm.cli.__file__).parent
FOLDERS = {CLI: COMMANDS, CLI / "data": DATA_COMMANDS, CLI / "fleet": FLEET_COMMANDS}
FILES = [(folder, name, line) for folder, lines in FOLDERS.items() for name, line in lines.items()]


def file_of(folder: Path, name: str) -> Path:
    path = folder / f"{name.replace('-', '_')}.py"
    return path if path.exists() else path.with_suffix("") / "__init__.py"


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_every_command_file_is_listed(folder: Path) -> None:
    found = {path.stem for path in folder.glob("*.py")} | {path.parent.name for path in folder.glob("*/__init__.py")}
    assert found - {"__init__", "app", "shared"} == {name.replace("-", "_") for name in FOLDERS[folder]}


@pytest.mark.parametrize(("folder", "name", "line"), FILES, ids=lambda value: getattr(value, "stem", value))
def test_the_list_says_of_a_command_what_its_file_says(folder: Path, name: str, line: str) -> None:
    """Read, not imported: of a group its callback says it."""
    (declared,) = (
        one
        for one in ast.parse(file_of(folder, name).read_text("utf-8")).body
        if isinstance(one, ast.FunctionDef)
        if one.name == "command" or "command.callback()" in map(ast.unparse, one.decorator_list)
    )
    assert (ast.get_docstring(declared) or "").partition("\n")[0] == line


@pytest.mark.parametrize(("folder", "name", "line"), FILES, ids=lambda value: getattr(value, "stem", value))
def test_no_command_needs_another(folder: Path, name: str, line: str) -> None:
    text = file_of(folder, name).read_text("utf-8")
    assert set(re.findall(r"^\s*(?:from|import) robophm\.cli\.(\w+)", text, re.M)) <= {"shared"}


@pytest.mark.parametrize(
    ("words", "imported"), [("--help", set()), ("--version", set()), ("chek", set()), ("schema", {"schema"})]
)
def test_only_the_file_of_the_command_that_is_asked_for_is_imported(words: str, imported: set[str]) -> None:
    code = (f"import sys; sys.argv = ['robophm', {words!r}]\nfrom robophm.cli import main\n"
            "try:\n    main()\nexcept SystemExit:\n    print('\\0', *sys.modules, file=sys.__stdout__)")  # fmt: skip
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    modules = set(done.stdout.rpartition("\0")[2].split())
    commands = {name.replace("-", "_") for name in COMMANDS}
    assert {name for name in commands if f"robophm.cli.{name}" in modules} == imported
    if not imported:
        assert not {"numpy", "pint", "rich"} & modules
