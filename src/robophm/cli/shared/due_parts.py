"""The upkeep that a robot asks for, printed: which parts are due, and how many replacements lie ahead."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from robophm.cli.shared.output import may_write, print_table, table, warn
from robophm.core.files import write_atomically
from robophm.design.robot import UNKNOWN
from robophm.health.part_due import PartDue
from robophm.health.unknown_rates import few
from robophm.monitoring.replacements_ahead import ReplacementsAhead
from robophm.monitoring.upkeep_ahead import UpkeepAhead
from robophm.report.maintenance_calendar import calendar
from robophm.report.words import duration_text, number_text

MOST_SHOWN = 25
"""Parts, and types of parts, that are listed."""


def print_upkeep(out: Console, found: UpkeepAhead) -> None:
    """Print the parts that are due, then the replacements to come."""
    parts = [one for one in found.dues.parts if one.state != "useless"]
    rows = [[one.part, _when(one), _between(one), one.why] for one in parts[:MOST_SHOWN]]
    if rows:
        title = f"Parts of {found.robot.name} that are due, a failure before with {100 * found.dues.risk:g} %"
        print_table(out, table(title, ("", "due in", "fails within (5 … 50 … 95 %)", "why"), rows, figures=(1, 2)))
    useless = [one.part for one in found.dues.parts if one.state == "useless"]
    if useless:
        out.print(
            f"Replacing these before they fail gains nothing, as their hazard does not rise with age: {few(useless)}",
            markup=False, soft_wrap=True,
        )  # fmt: skip
    others = max(len(parts) - MOST_SHOWN, 0) + found.dues.others
    if others:
        out.print(f"{others} more parts are due later, or do not wear; --json tells more", markup=False)
    if not all(one.alone for one in parts[:MOST_SHOWN]):
        names = ", ".join(one.part for one in parts[:MOST_SHOWN] if not one.alone)
        out.print(f"Told as if the parts that they depend on all worked: {names}", markup=False, soft_wrap=True)
    if found.silence:
        warn(f"what is due {found.silence}")
    types: dict[str, list[ReplacementsAhead]] = {}
    for within in found.replacements.values():
        for one in within:
            types.setdefault(one.name, []).append(one)
    longest = found.replacements[max(found.replacements)]
    order = [one.name for one in longest][:MOST_SHOWN]
    columns = ["type of part", "parts", *(f"in {duration_text(hours)}" for hours in found.replacements)]
    rows = [[name, str(types[name][0].count), *map(_count, types[name])] for name in order]
    out.print()
    print_table(out, table("Replacements to come, mean (90 % between)", columns, rows, figures=range(1, len(columns))))
    out.print("What has failed is replaced at once; what is replaced before is not in it.", soft_wrap=True)


def _when(one: PartDue) -> str:
    if one.due is None:
        return UNKNOWN if one.state == "unknown" else "never"
    return "now" if one.due == 0 else duration_text(one.due)


def _between(one: PartDue) -> str:
    if one.state in ("now", "unknown", "still"):
        return "–"
    return " … ".join(map(duration_text, (one.early, one.median, one.late)))


def _count(one: ReplacementsAhead) -> str:
    if one.expected is None:
        return UNKNOWN
    return f"{number_text(one.expected, 2)} ({one.low} … {one.high})"


def write_calendar(path: Path, design: Path, found: UpkeepAhead) -> None:
    """Write what is due as a calendar. Raises RobophmError where it cannot be written."""
    may_write(path, design)
    write_atomically(path, calendar(found.robot.name, found.robot.identity, found.dues, found.known_to))
