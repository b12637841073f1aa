"""An argument too many, and the option or the command that it was meant for."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from typer.core import TyperCommand

from robophm.cli.shared.ros_words import surplus, takes_words, with_options

RECORDINGS = (".bag", ".mcap", ".db3", ".ulg", ".bin", ".tlog", ".journal", ".parquet")
DESIGNS = (".yaml", ".yml")
DESCRIPTIONS = (".urdf", ".xacro")
LISTS = (".csv", ".tsv", ".xls", ".xlsx", ".ods")


class StrictCommand(TyperCommand):
    """A command that says of an argument too many what takes it."""

    allow_extra_args = True  # so that it is refused here

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Return what the options leave over. Raises UsageError where that is more than the command takes."""
        if takes_words(self):
            args = with_options(ctx, args)
        left = super().parse_args(ctx, args)
        if (more := [*ctx.args, *surplus(ctx)]) and not ctx.resilient_parsing:
            ctx.fail(refusal(self, more))
        return left


def refusal(command: Any, words: Sequence[str]) -> str:
    """Return what is said of arguments that a command does not take.

    >>> refusal(TyperCommand("topics"), ["day.mcap"])
    "'day.mcap' is more than topics takes; expected, of a recording, robophm data day.mcap"
    """
    named = ", ".join(f"'{word:.60}'" for word in words[:3]) + ", …" * (len(words) > 3)
    said = f"{named} {'is' if len(words) == 1 else 'are'} more than {command.name} takes"
    options = {option: one for one in command.params for option in one.opts if option.startswith("--")}
    taken = [_option(options, word) for word in words]
    if all(taken):
        return f"{said}; expected {' '.join(taken)}"
    others = list(dict.fromkeys(filter(None, (_command(command.name, word) for word in words))))
    return said + (f"; expected, {' or '.join(others[:2])}" if others else "")


def _option(options: dict[str, Any], word: str) -> str:
    """The option that takes a word, as it is written; "" where none does."""
    from robophm.transports.running_robot import CHOICES

    quoted = shlex.quote(word)
    if "--via" in options and ("://" in word or word in CHOICES):
        return f"--via {quoted}"
    pairs = [option for option, one in options.items() if "=" in (one.metavar or "")]
    if "=" in word and pairs:
        return f"{' or '.join(pairs)} {quoted}"
    ending = Path(word).suffix.lower()
    if "--urdf" in options and ending in DESCRIPTIONS:
        return f"--urdf {quoted}"
    if "--bom" in options and ending in LISTS:
        return f"--bom {quoted}=MODULE"
    return f"--bag {quoted}" if "--bag" in options and _recorded(word) else ""


def _command(name: str, word: str) -> str:
    """The other command that a word was meant for, and what the word is; "" where none is known."""
    ending, quoted = Path(word).suffix.lower(), shlex.quote(word)
    if _recorded(word) and name != "data":
        return f"of a recording, robophm data {quoted}"
    if ending in DESCRIPTIONS:
        return f"of a robot's description, robophm new robot.yaml --urdf {quoted}"
    if ending in LISTS:
        return f"of a parts list, robophm new robot.yaml --bom {quoted}=MODULE"
    return f"of a design, robophm check {quoted}" if ending in DESIGNS and name != "check" else ""


def _recorded(word: str) -> bool:
    """Whether it is called like a recording, or is a folder, which may hold some."""
    return Path(word).suffix.lower() in RECORDINGS or word.endswith("/") or Path(word).is_dir()
