"""``robophm data export``: samples of signals as a table."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.measured import Bags, Overwrite, SignalNames, warn_of
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, may_make, print_json, progress_console
from robophm.cli.shared.progress import counted
from robophm.core.counted_notes import said
from robophm.measured.export import SUFFIXES, export
from robophm.measured.recordings import recordings, signal_of


def command(
    bags: Bags,
    signal: SignalNames,
    to: Annotated[Path, typer.Option(help="table to write, .csv or .parquet")],
    force: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Write samples of signals as a table, in order of time, all recordings together."""
    may_make(to, *bags, force=force, suffixes=SUFFIXES)
    (together,) = recordings(bags, together=True)
    signals = [signal_of(name, [together]) for name in dict.fromkeys(signal)]
    notes: Counter[str] = Counter()
    with counted(progress_console(), "writing"):
        count = export(together, signals, to, notes)
    if as_json:
        columns = {sought.name: sought.unit for sought in signals}
        print_json({"file": str(to), "rows": count, "columns": columns, "notes": said(notes)})
        return
    of = "signal" if len(signals) == 1 else "signals"
    console().print(f"Written: {to}, {count:,} rows of {len(signals)} {of}", markup=False)
    warn_of(said(notes))
