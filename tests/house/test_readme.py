"""The first page speaks of every command."""

from pathlib import Path

import pytest

from robophm.cli.app import app

README = Path(__file__).resolve().parents[2] / "README.md"
COMMANDS = [command.name or command.callback.__name__ for command in app.registered_commands]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_in_the_readme(command):
    assert f"robophm {command}" in README.read_text(encoding="utf-8")
