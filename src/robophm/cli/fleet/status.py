"""``robophm fleet status``: how each robot is, by what it last sent."""

from __future__ import annotations

import time

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.core.signal import HOUR
from robophm.fleet.commit import BELIEVED
from robophm.fleet.questions import RobotStatus, refused_of_nobody, status
from robophm.fleet.store import FleetStore
from robophm.report.words import count_text, duration_text, moment_text


def command(store: FleetStorePath, as_json: Json = False) -> None:
    """How each robot of a fleet is by its last report, and what was lost or refused."""
    with FleetStore(store) as fleet:
        robots, refused = status(fleet), refused_of_nobody(fleet)
    if as_json:
        print_json({"robots": [one._asdict() for one in robots], "refused": refused})
        return
    out, now = console(), time.time_ns()
    rows = [
        [
            one.robot,
            one.design or "–",
            one.state or "–",
            "–" if one.time is None else moment_text(one.time),
            "never" if one.heard is None else f"{duration_text(max(now - one.heard, 0) / HOUR)} ago",
            count_text(one.reports),
            "–" if one.waiting is None else count_text(one.waiting),
            "; ".join(_notes(one)) or "–",
        ]
        for one in robots
    ]
    columns = ("robot", "design", "state", "newest report", "heard", "reports", "waiting", "notes")
    print_table(out, table("", columns, rows, figures=(5, 6)))
    for why, count in refused.items():
        out.print(f"Refused: {why} ({count_text(count)} times)", markup=False)


def _notes(one: RobotStatus) -> list[str]:
    """What is odd about a robot, in words."""
    found = []
    if one.clock_ahead is not None and abs(one.clock_ahead) > BELIEVED:
        said = "ahead of" if one.clock_ahead > 0 else "behind"
        found.append(f"its clock is {duration_text(abs(one.clock_ahead) / 3600)} {said} the fleet's")
    if one.thinned:
        found.append(f"{count_text(one.thinned)} thinned out by the robot")
    if one.missing:
        found.append(f"{count_text(one.missing)} missing")
    return found + [f"{why} ({count_text(count)} times)" for why, count in one.refused.items()]
