from __future__ import annotations

import os
import textwrap
from collections import Counter
from pathlib import Path

import pytest

NO_SHARED = "no shared/ folder beside the project"
PUBLISHED = "published answer of"
DISPUTED = "disputed answer of"
"""The properties by which a test says of which kind of part the answer is that it has compared."""


@pytest.fixture(scope="session")
def shared() -> Path:
    """The shared/ folder beside the project; tests that need it are skipped without it, but fail under CI."""
    folder = Path(__file__).resolve().parents[2] / "shared"
    if not folder.is_dir():
        (pytest.fail if os.environ.get("CI") == "true" else pytest.skip)(NO_SHARED)
    return folder


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many tests the absence of shared/ has cost, and which published answers were compared."""
    skipped = [report for report in terminalreporter.stats.get("skipped", []) if NO_SHARED in str(report.longrepr)]
    if skipped:
        terminalreporter.write_line(f"{len(skipped)} tests skipped: {NO_SHARED}", yellow=True)
    answers = [
        (report.outcome, name, str(kind))
        for outcome in ("passed", "failed")
        for report in terminalreporter.stats.get(outcome, [])
        for name, kind in getattr(report, "user_properties", ())
        if name in (PUBLISHED, DISPUTED)
    ]
    if answers:
        width = terminalreporter.config.get_terminal_writer().fullwidth
        for line in coverage(answers):
            terminalreporter.write_line(textwrap.fill(line, width, subsequent_indent="    ", break_on_hyphens=False))


def coverage(answers: list[tuple[str, str, str]]) -> list[str]:
    """The kinds of parts by how many answers of each were compared, and those of which there are none.

    An answer is of an outcome, a property, and a kind.
    """
    from robophm.hazard.handbooks import handbook_models

    failed = sum(outcome == "failed" for outcome, _, _ in answers)
    kinds = Counter(kind for _, _, kind in answers)
    disputed = Counter(kind for _, name, kind in answers if name == DISPUTED)
    rows: dict[str, tuple[list[str], list[str]]] = {}
    for kind in sorted(handbook_models(), key=lambda kind: -kinds[kind]):
        handbook, _, part = kind.partition(".")
        some, none = rows.setdefault(handbook, ([], []))
        note = f" (of them {disputed[kind]} disputed)" if disputed[kind] else ""
        (some if kinds[kind] else none).append(f"{part} {kinds[kind]}{note}" if kinds[kind] else part)
    return [
        f"answers of handbooks: {len(answers)} run, {disputed.total()} of them disputed, {failed} failed",
        *(f"  {handbook}: {', '.join(some)}; none run of {', '.join(none)}" for handbook, (some, none) in rows.items()),
    ]
