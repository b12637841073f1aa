"""``robophm audit``: who changed what."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json
from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.report.words import moment_text


def command(
    design: Annotated[Path, typer.Argument(help="the robot's design file; the log is kept beside it")],
    most: Annotated[int, typer.Option("--last", min=1, help="number of newest entries")] = 50,
    as_json: Json = False,
) -> None:
    """Who changed what in a robot's design, and what else was done on its page."""
    from robophm.web.access.changes import ChangeLog
    from robophm.web.access.file import AccessFile, access_path

    path = access_path(design)
    if not design.is_file() and not path.exists():
        raise RobophmError(f"{design}: no such file; expected a robot's design")
    file = AccessFile(path if path.exists() else None)
    found = ChangeLog(file).latest(most)
    file.close()
    if as_json:
        keys = ("time", "who", "role", "address", "what", "more")
        print_json({"changes": [
            {**{key: getattr(one, key) for key in keys},
             "values": [dict(zip(("place", "before", "after"), value, strict=True)) for value in one.values]}
            for one in found
        ]})  # fmt: skip
        return
    out = console()
    if not found:
        out.print(f"Nothing was changed on the page of {design} so far", markup=False, soft_wrap=True)
    for one in reversed(found):
        who = f"{one.who} ({one.role})" if one.who and one.role else one.who or "anybody"
        where = f" from {one.address}" if one.address else ""
        out.print(f"{moment_text(round(one.time * SECOND))}  {who if one.address else 'somebody'}{where}: {one.what}",
                  markup=False, soft_wrap=True)  # fmt: skip
        for place, before, after in one.values:
            out.print(f"    {place}: {before or '–'} → {after or '–'}", markup=False, soft_wrap=True)
        if one.more:
            out.print(f"    and {one.more} more", markup=False)
