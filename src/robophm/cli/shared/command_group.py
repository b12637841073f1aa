"""A group of commands of which each is a file, imported when it is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any, ClassVar

import typer
from typer.core import TyperCommand, TyperGroup


class CommandGroup(TyperGroup):
    """Lists its commands by a line of help each; the file of one is imported when that is asked for.

    The file of ``fault-tree`` is ``fault_tree.py``, and what it names ``command`` is the command: a function, or an
    application of Typer where it has commands of its own.
    """

    package: ClassVar[str]
    """Name of the package where the files are."""
    lines: ClassVar[Mapping[str, str]]
    """Help by command, in the order of the list: the first line of the command's docstring."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.commands = {name: TyperCommand(name, help=line) for name, line in self.lines.items()}

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return the command itself; None where there is none of that name."""
        if cmd_name not in self.lines:
            return None
        command = import_module(f"{self.package}.{cmd_name.replace('-', '_')}").command
        if not isinstance(command, typer.Typer):
            function, command = command, typer.Typer(add_completion=False, rich_markup_mode=None)
            command.command(cmd_name)(function)
        return typer.main.get_command(command)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Print the list of commands, for which no file is imported."""
        TyperGroup(commands=dict(self.commands)).format_commands(ctx, formatter)
