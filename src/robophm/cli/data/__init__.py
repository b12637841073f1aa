"""``robophm data``: what was measured. Each of its commands is a file here."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

from robophm.cli.shared.command_group import CommandGroup

COMMANDS = {
    "list": "List what recordings hold: topics, fields, units, time spans and gaps.",
    "find": "Find where a value is above, below or between levels, changes fast, is stuck or missing.",
    "statistics": "Lowest, mean and highest value, deviation, trend and time at level of signals, also by interval.",
    "profile": "Stress profiles: at which levels each part of a robot worked, and for how long.",
    "export": "Write samples of signals as a table, in order of time, all recordings together.",
}  # fmt: skip


class _Listing(CommandGroup):
    """``robophm data BAGS`` is ``robophm data list BAGS``."""

    package = "robophm.cli.data"
    lines = COMMANDS

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        from difflib import get_close_matches

        known = [*self.commands, "--help"]
        slip = args and not Path(args[0]).exists() and get_close_matches(args[0], self.commands)
        if args and args[0] not in known and not slip:
            args = ["list", *args]
        return super().parse_args(ctx, args)


command = typer.Typer(cls=_Listing, no_args_is_help=True, add_completion=False, rich_markup_mode=None)


@command.callback()
def _data() -> None:
    """Examine measured data; `robophm data BAGS` lists it."""
