"""``robophm service``: a part of a robot was replaced or repaired; its ledger knows from then on."""

from __future__ import annotations

from pathlib import Path

from robophm.cli.output import console, print_json
from robophm.cli.past import existing_store, past_in
from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.design.file import load
from robophm.health.service import find, repair, replace
from robophm.report.words import moment_text, number_text


def run(
    design: Path, part: str, store: Path, repaired: float | None, *,
    replaced: bool, failed: bool, history: bool, as_json: bool,
) -> None:  # fmt: skip
    """Put it into the store's ledger, and say what the part has behind it now; or only what was done to it so far."""
    if replaced + (repaired is not None) != 1 and not (history and not replaced and repaired is None):
        raise RobophmError("was it replaced or repaired? expected --replaced or --repaired SHARE, or --history to look")
    if failed and not replaced and repaired is None:
        raise RobophmError("--failed says why it was served; expected --replaced or --repaired SHARE with it")
    robot = load(design)
    with existing_store(store) as kept:
        ledger = past_in(kept, robot)
        before = len(ledger.services)
        if replaced:
            replace(robot, ledger, part, failed=failed)
        elif repaired is not None:
            repair(robot, ledger, part, repaired, failed=failed)
        if len(ledger.services) > before:
            kept.save(robot.name, ledger.to_json())
    named = {mode.key for mode in find(robot, part)[1]}
    some = ledger.services[before:] if not history else [one for one in ledger.services if one.mode in named]
    if as_json:
        print_json({"robot": robot.name, "services": [one._asdict() for one in some]})
        return
    paths = {mode.key: mode.path for mode in robot.modes}
    out = console()
    if not some:
        out.print(f"{part}: neither replaced nor repaired so far", markup=False)
    for one in some:
        path = paths[one.mode]
        when = moment_text(one.time) if one.time > SECOND else "before its first recording"
        out.print(
            f"{when}: {path} {one.kind}{' after it failed' if one.failed else ''}, at an effective age of "
            f"{number_text(one.before[1])}; goes on at {number_text(one.after[1])}",
            markup=False, soft_wrap=True,
        )  # fmt: skip
