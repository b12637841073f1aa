"""``robophm import-legacy``: a file of the 2020 tool becomes a design; what both make of it stands side by side."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.options import Force, Json
from robophm.cli.shared.output import console, may_write, print_json, print_table, table, warn, write
from robophm.cli.shared.promises import promises
from robophm.core.errors import RobophmError
from robophm.design.importers.legacy.figures import reliability_at
from robophm.design.importers.legacy.reading import Imported, import_legacy
from robophm.health.report import plain
from robophm.report.words import number_text, percent_text, rate_text

HOURS = 1000.0
"""Of operation, at which figures are compared: those of the 2020 tool's guide."""


@dataclass(frozen=True)
class Comparison:
    """Failure rates [1/h] and reliabilities at 1000 h of the system (empty path) or a module, the exact ones when new.

    Without exact ones the module is left out of the design.
    """

    path: str
    legacy_stored: float | None
    legacy_hazard_rate: float
    legacy_reliability: float
    hazard_rate: float | None
    reliability: float | None
    unreliability: float | None


def command(
    source: Annotated[Path, typer.Argument(help="phm_configurations_*.yaml of the 2020 tool", metavar="SOURCE.YAML")],
    design: Annotated[Path, typer.Argument(help="the design file to write", metavar="ROBOT.YAML")],
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Make a design of a file of the 2020 tool, and say what is odd in it."""
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
    count = sum(component.quantity for component in imported.robot.all_components())
    said = f"{design}: {imported.robot.name}, {count} parts, {len(imported.findings)} findings"
    out.print(f"{said}; check them, and bind its signals", markup=False)


def comparisons(imported: Imported) -> list[Comparison]:
    """Of the system, then of its modules."""
    exact: dict[str, tuple[float, float, float]] = {
        one.path: (one.hazard_rate, one.reliability, one.unreliability)
        for one in promises(imported.robot, HOURS, legacy=False)
    }
    for part in imported.robot.components:  # a module without parts of its own is one part
        rate = part.modes[0].rate
        exact[part.path] = rate, math.exp(-rate * HOURS), -math.expm1(-rate * HOURS)
    return [
        Comparison(
            figure.path,
            figure.stored,
            figure.recomputed,
            reliability_at(HOURS * 3600, figure.recomputed),
            *exact.get(figure.path, (None, None, None)),
        )
        for figure in imported.figures
    ]


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
