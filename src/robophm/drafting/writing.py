"""A draft written beside what there was: the design, the page of assumptions, and the tasks that were seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from robophm.design.file import write_text
from robophm.drafting.answers import Answers
from robophm.drafting.composing import Change, change_of
from robophm.drafting.drafting import Draft
from robophm.drafting.updating import earlier_answers

ASSUMPTIONS, TASKS = "assumptions.md", "tasks.yaml"
"""Names of the two files that are written into the folder of the design: a page of assumptions, and a task file."""


def with_earlier(answers: Answers, changes: Sequence[Change], before: str) -> tuple[Answers, list[Change]]:
    """Answers and changes, with those of the draft that a design's text is of where none are given now."""
    told = earlier_answers(before)
    earlier = [change_of(str(one)) for one in told.pop("changes", [])]
    now = {key: text for key, text in asdict(answers).items() if text is not None}
    names = {one.part for one in changes}
    return Answers().with_(**{**told, **now}), [*(one for one in earlier if one.part not in names), *changes]


def write_beside(design: Path, draft: Draft, *, again: bool) -> list[Path]:
    """Write the page of assumptions and the tasks of a draft beside its design, and return which files were written.

    What was there is kept as .bak; tasks are, at a later draft (``again``), left as somebody has them. Raises OSError.
    """
    page, tasks = design.parent / ASSUMPTIONS, design.parent / TASKS
    write_text(page, draft.assumptions)
    if not draft.tasks or (again and tasks.exists()):
        return [page]
    write_text(tasks, draft.tasks_file)
    return [page, tasks]
