"""``robophm import-legacy``: a file of the 2020 tool becomes a design; what both make of it stands side by side."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.options import Force, Json
from robophm.cli.shared.output import console, may_write, print_json, print_table, table, warn, write
from robophm.core.errors import RobophmError
from robophm.core.json_values import plain
from robophm.design.importers.legacy.reading import import_legacy
from robophm.health.legacy_comparison import HOURS, Comparison, comparisons
from robophm.report.words import number_text, percent_text, rate_text


def command(
    source: Annotated[
        Path, typer.Argument(help="a file phm_configurations_*.yaml of the 2020 tool", metavar="SOURCE.YAML")
    ],
    design: Annotated[Path, typer.Argument(help="design file to write", metavar="ROBOT.YAML")],
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Convert a file of the 2020 tool to a design, and list what is odd in it."""
    may_write(design, source)
    if design.exists() and not force:
        raise RobophmError(f"{design}: exists already; --force puts the design in its place")
    imported = import_legacy(source)
    found = comparisons(imported)
    write(design, imported.text)
    if as_json:
        print_json({
            "robot": imported.robot.name,
            "design": str(design),
            "findings": [asdict(finding) for finding in imported.findings],
            "hours": HOURS,
            "modules": [plain(asdict(one)) for one in found],
        })  # fmt: skip
        return
    for finding in imported.findings:
        warn(f"{source.name}: {finding}")
    out = console()
    rows = [_row(one, imported.robot.name) for one in found]
    at = f"{number_text(HOURS)} h"
    columns = ["2020 tool and exact", "λ stored", "λ recomputed", f"λ exact, {at}", f"R({at}) 2020", f"R({at}) exact"]
    print_table(out, table("", columns, rows, figures=range(1, len(columns))))
    said = f"{design}: {imported.robot.name}, {imported.robot.part_count} parts, {len(imported.findings)} findings"
    out.print(f"{said}; check them, and bind its signals", markup=False)


def _row(one: Comparison, robot: str) -> list[str]:
    def rate(value: float | None) -> str:
        return "–" if value is None else rate_text(value)

    return [
        f"  {one.path}" if one.path else robot,
        rate(one.legacy_stored),
        rate(one.legacy_hazard_rate),
        rate(one.hazard_rate),
        percent_text(one.legacy_reliability),
        "–" if one.reliability is None else percent_text(one.reliability, one.unreliability),
    ]
