"""Words that ROS adds to the command of a node: names for others, and parameters, which are options."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, Any

import typer

from robophm.core.errors import nearest

METAVAR = "[FROM:=TO]..."

Words = Annotated[
    list[str] | None,
    typer.Argument(
        metavar=METAVAR,
        help="as roslaunch has it: /motor:=/drive/motor, __ns:=amr_7, __name:=robophm; _speed:=0.3 is --speed 0.3",
    ),
]


def takes_words(command: Any) -> bool:
    """Whether a command is one that ROS may start as a node."""
    return any(one.metavar == METAVAR for one in command.params)


def with_options(context: Any, words: Sequence[str]) -> list[str]:
    """Return the words of a command line, behind the options that its parameters, ``_speed:=0.3``, are.

    What is no option ends it as wrong usage.
    """
    options = {one.name: one for one in context.command.params if one.param_type_name == "option"}
    said: list[str] = []
    for word in words:
        name, between, value = word.partition(":=")
        if between and name[:1] == "_" and name[:2] != "__":
            if name[1:] not in options:
                context.fail(f"'{word}' is no parameter of {context.command.name}{nearest(name[1:], options)}")
            said += _as_options(options[name[1:]], value.strip())
    return [*said, *words]


def _as_options(option: Any, written: str) -> Iterator[str]:
    """A parameter as an option: of a list one for each entry, of a truth value the flag for it."""
    if option.is_flag and written.lower() in ("true", "false"):
        yield from (option.opts if written.lower() == "true" else option.secondary_opts)[:1]
        return
    some = written[1:-1].split(",") if option.multiple and written[:1] == "[" else [written]
    yield from (f"{option.opts[0]}={one}" for each in some if (one := each.strip().strip("'\"")))


def surplus(context: Any) -> list[str]:
    """Return the arguments of a command that ROS may start which are no words of its."""
    return [
        word
        for one in context.command.params
        if one.metavar == METAVAR
        for word in context.params.get(one.name) or ()
        if ":=" not in word
    ]
