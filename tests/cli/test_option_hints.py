"""The rooms below name no option of the command line; the commands add those that give what is asked for."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from robophm.cli.shared.option_hints import OPTIONS, with_options

ROOT = Path(__file__).resolve().parents[2] / "src" / "robophm"
OPTION = re.compile(r"(?<![\w-])(?<!var\()--[a-z]")


@cache
def below() -> tuple[tuple[str, str], ...]:
    """Each text in the code of a module outside ``cli``, and where; what stands between backticks is a command."""
    found = []
    for module in ROOT.rglob("*.py"):
        name = module.relative_to(ROOT).as_posix()
        if name.startswith("cli/"):
            continue
        nodes = list(ast.walk(ast.parse(module.read_text())))
        prose = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
        for node in nodes:
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose:
                found.append((f"{name}:{node.lineno}", re.sub("`[^`]*`", "", node.value)))
    return tuple(found)


def test_no_room_below_names_an_option() -> None:
    assert {where: text for where, text in below() if OPTION.search(text)} == {}


@pytest.mark.parametrize("words", OPTIONS)
def test_what_gets_an_option_is_said_below(words: str) -> None:
    assert any(words in text for _, text in below())


def test_an_option_is_added_where_it_is_asked_for() -> None:
    assert with_options("robot.db: no such store") == "robot.db: no such store; `robophm replay --store` makes it"
    assert with_options("as with fewer levels") == "as with fewer levels (--bins)"
    assert with_options("robot.yaml:3: no unit 'degC/m'") == "robot.yaml:3: no unit 'degC/m'"
