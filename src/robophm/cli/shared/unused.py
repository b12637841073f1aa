"""Options that a command takes, but not for what it is asked: named and refused, never left aside without a word."""

from __future__ import annotations

import importlib
from collections.abc import Collection
from typing import Any

import typer


def refuse_unused(path: str, used: Collection[str], *, as_json: bool = True) -> None:
    """Refuse, as wrong usage, what was given on the command line beyond what one path of a command uses.

    ``path`` in words, such as 'lives at stress'; ``used``: parameters of the command's function. Those that it cannot
    do without count as used, and so does --json unless ``as_json`` says otherwise. Where no command runs nothing was
    given.
    """
    context = _context()
    if context is None:
        return
    given, takes = [], []
    for parameter in context.command.params:
        name = (
            parameter.opts[0]
            if parameter.param_type_name == "option"
            else (parameter.metavar or parameter.name.upper())
        )
        if parameter.name in used or parameter.required or (as_json and parameter.name == "as_json"):
            if parameter.param_type_name == "option":
                takes.append(name)
        elif context.get_parameter_source(parameter.name).name == "COMMANDLINE":
            given.append(name)
    if given:
        context.fail(f"{', '.join(given)}: not used for {path}; expected at most {', '.join(takes)}")


def _context() -> Any:
    """The context of the command that runs: Typer may bring its own Click, so it is asked where its context comes
    from."""
    base = typer.Context.__mro__[1].__module__.rpartition(".")[0]
    return importlib.import_module(f"{base}.globals").get_current_context(silent=True)
