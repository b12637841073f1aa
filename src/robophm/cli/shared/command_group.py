"""A group of commands of which each is a file, imported when it is asked for."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any, ClassVar

import typer
from typer.core import TyperCommand, TyperGroup

from robophm.cli.shared.surplus_arguments import StrictCommand
from robophm.core.ending import be_interruptible


class CommandGroup(TyperGroup):
    """Lists its commands by a line of help each; the file of one is imported when that is asked for.

    A file whose ``ENDS_BY_ITSELF`` is true heeds SIGINT and SIGTERM itself, and until then they end it at once.

    The file of ``fault-tree`` is ``fault_tree.py``, and what it names ``command`` is the command: a function, or an
    application of Typer where it has commands of its own.
    """

    package: ClassVar[str]
    """Name of the package where the files are."""
    lines: ClassVar[Mapping[str, str]]
    """Help by command: the first line of the command's docstring."""
    groups: ClassVar[Mapping[str, Sequence[str]]] = {}
    """Commands by what they are for, as the help lists them; none: one list, in the order of ``lines``."""
    former: ClassVar[Mapping[tuple[str, str], str]] = {}
    """Options by command and the name that they had: still taken, with a note on stderr."""
    sought: ClassVar[Mapping[str, str]] = {}
    """Commands by what people call them who have not read the help: taken, with a note on stderr."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.commands = {name: TyperCommand(name, help=line) for name, line in self.lines.items()}

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return the command itself; None where there is none of that name."""
        if cmd_name not in self.lines:
            return None
        module = import_module(f"{self.package}.{cmd_name.replace('-', '_')}")
        if not getattr(module, "ENDS_BY_ITSELF", False):
            be_interruptible()
        command = module.command
        if not isinstance(command, typer.Typer):
            function, command = command, typer.Typer(add_completion=False, rich_markup_mode=None)
            command.command(cmd_name)(function)
        for one in command.registered_commands:
            one.cls = StrictCommand
        return typer.main.get_command(command)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command and its arguments, commands and options of another name under that of now."""
        if args and (meant := self.sought.get(args[0])):
            print(f"note: {args[0]} is called {meant}", file=sys.stderr)
            args = [meant, *args[1:]]
        name, command, rest = super().resolve_command(ctx, args)
        ends = rest.index("--") if "--" in rest else len(rest)
        for i, word in enumerate(rest[:ends]):
            option, equals, value = word.partition("=")
            if now := self.former.get((str(name), option)):
                print(f"note: {option} of {name} is called {now} now", file=sys.stderr)
                rest[i] = f"{now}{equals}{value}"
        return name, command, rest

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Print the commands by what they are for; no file of one is imported."""
        width = max(map(len, self.lines))
        for title, names in (self.groups or {"Commands": tuple(self.lines)}).items():
            with formatter.section(title):
                formatter.write_dl([(name.ljust(width), self.lines[name]) for name in names])
