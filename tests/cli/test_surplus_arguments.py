"""An argument too many: what is said names the option or the command that it was meant for, and runs as it says."""

import re
import shlex

import pytest
import typer
from typer.exceptions import TyperException

from robophm.cli.app import COMMANDS, app

MEANT = {
    ("topics", "day.mcap"): "expected, of a recording, robophm data day.mcap",
    ("topics", "drives/"): "expected, of a recording, robophm data drives/",
    ("topics", "ros1"): "expected --via ros1",
    ("watch", "robot.yaml", "mqtt://broker/topic"): "expected --via mqtt://broker/topic",
    ("rate", "mil_hdbk_217f.capacitor", "style=RM", "quality=M"): "expected --set style=RM --set quality=M",
    ("rate", "mil_hdbk_217f.capacitor", "temperature=60 degC"): "expected --set 'temperature=60 degC'",
    ("new", "robot.yaml", "my.urdf"): "expected --urdf my.urdf",
    ("new", "robot.yaml", "a.mcap", "main.csv"): "expected --bag a.mcap --bom main.csv=MODULE",
    ("show", "robot.yaml", "my.urdf"): "expected, of a robot's description, robophm new robot.yaml --urdf my.urdf",
    ("schema", "robot.yaml"): "expected, of a design, robophm check robot.yaml",
    ("check", "robot.yaml", "other"): "'other' is more than check takes",
}


@pytest.mark.parametrize("words", MEANT)
def test_what_was_meant_is_said(inside, words):
    done = inside(*words)
    assert done.returncode == 2
    assert MEANT[words] in " ".join(done.stderr.split())
    assert "unexpected" not in done.stderr


@pytest.mark.parametrize("words", [words for words in MEANT if "robophm" in MEANT[words]])
def test_the_command_that_is_named_takes_it(inside, words):
    """It may find nothing there, but it says so in its own words."""
    (said,) = re.findall(r"robophm (.*)", MEANT[words])
    assert inside(*shlex.split(said)).returncode != 2


def commands():
    """Every command, those within others too."""
    root = typer.main.get_command(app)
    for name in COMMANDS:
        command = root.get_command(None, name)
        inner = [command.get_command(None, one) for one in command.list_commands(None)] if group(command) else []
        yield from inner or [command]


def group(command):
    return hasattr(command, "list_commands")


def test_every_command_refuses_in_these_words():
    """Those aside that take any number of arguments."""
    for command in commands():
        arguments = [one for one in command.params if one.param_type_name == "argument"]
        if all(one.nargs == 1 for one in arguments):
            given = [
                word for one in command.params if one.required and one not in arguments for word in (one.opts[0], "x")
            ]
            with pytest.raises(TyperException, match=f"are more than {command.name} takes"):
                command.make_context(command.name, [*given, *["7"] * 30])
