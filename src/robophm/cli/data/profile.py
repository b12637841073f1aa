"""``robophm data profile``: the levels at which a robot's parts lived."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.cli.shared.measured import Bags, Bins, Overwrite, Page, print_levels
from robophm.cli.shared.options import Design, Json, SkipMissing
from robophm.cli.shared.output import console, may_make, print_json, progress_console, warn, write
from robophm.cli.shared.progress import counted
from robophm.cli.shared.unused import refuse_unused
from robophm.core.counted_notes import said
from robophm.design.file import load
from robophm.measured.profile import Profile, StressProfiles, stress_profiles, task_text
from robophm.measured.recordings import recordings
from robophm.report.measured_page import aged_text, level_rows, parts_text, profile_page, where
from robophm.report.words import duration_text, number_text


def command(
    design: Design,
    bags: Bags,
    to: Annotated[Path | None, typer.Option(help="write it as a future load, .yaml, for predict --plan")] = None,
    bins: Bins = 20,
    report: Page = None,
    skip_missing: SkipMissing = False,
    force: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Stress profiles: at which levels each part of a robot worked, and for how long."""
    if not (to or report):
        refuse_unused("profiles that are not written (--to, --report)", ("bins", "skip_missing"))
    may_make(to, design, *bags, *([report] if report else []), force=force, suffixes=(".yaml", ".yml"))
    may_make(report, design, *bags, force=force)
    robot = load(design)
    (recorded,) = recordings(bags, together=True)
    with counted(progress_console(), "reading"):
        found = stress_profiles(robot, recorded, bins, skip_missing=skip_missing)
    source = ", ".join(path.name for path in recorded.paths[:3]) + (" …" if len(recorded.paths) > 3 else "")
    notes = said(found.notes)
    if to:
        write(to, task_text(found, f"as in {source}", source))
    if report:
        write(report, profile_page(found, source, notes))
    if as_json:
        print_json(_json(found, notes))
        return
    out = console()
    on, whole = duration_text(found.operating), duration_text(found.calendar)
    out.print(f"{robot.name} in {source}: on for {on} of {whole}", markup=False)
    for profile in found.profiles:
        out.print(f"\n{where(profile)}", style="bold", markup=False)
        if len(profile.parts) > 1:
            out.print(parts_text(profile), markup=False)
        out.print(aged_text(profile), markup=False)
        for i, one in enumerate(profile.inputs):
            designed = f"designed for {number_text(one.designed)} {one.unit}".rstrip()
            print_levels(out, f"{one.name} ({one.signal}), {designed}", level_rows(profile.levels, i, one.unit))
    for written in filter(None, (to, report)):
        out.print(f"Written: {written}", markup=False)
    if to:
        out.print(f"As a load to come: robophm predict {design} --plan {to}", markup=False)
    for note in notes:
        warn(note)


def _json(found: StressProfiles, notes: Sequence[str]) -> dict[str, Any]:
    return {
        "robot": found.robot.name,
        "operating": found.operating,
        "calendar": found.calendar,
        "notes": list(notes),
        "profiles": [_profile_json(one) for one in found.profiles],
    }


def _profile_json(one: Profile) -> dict[str, Any]:
    inputs = [
        {"name": each.name, "unit": each.unit, "signal": each.signal, "designed": each.designed, "width": float(width)}
        for each, width in zip(one.inputs, one.levels.widths, strict=True)
    ]
    begins = one.levels.keys * one.levels.widths
    cells = [
        {"begin": begin, "clock": clock, "factor": factor, "typical": typical}
        for begin, clock, factor, typical in zip(
            begins.tolist(), one.levels.sums[:, 0].tolist(), one.factors.tolist(), one.typical.tolist(), strict=True
        )
    ]
    return {"parts": list(one.parts), "clock": one.clock, "unit": one.unit, "factor": one.factor,
            "error": one.error, "inputs": inputs, "levels": cells}  # fmt: skip
