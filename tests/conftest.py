from __future__ import annotations

import os
from pathlib import Path

import pytest

NO_SHARED = "no shared/ folder beside the project"


@pytest.fixture(scope="session")
def shared() -> Path:
    """The shared/ folder beside the project; tests that need it are skipped without it, but fail under CI."""
    folder = Path(__file__).resolve().parents[2] / "shared"
    if not folder.is_dir():
        (pytest.fail if os.environ.get("CI") == "true" else pytest.skip)(NO_SHARED)
    return folder


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many tests the absence of shared/ has cost."""
    skipped = [report for report in terminalreporter.stats.get("skipped", []) if NO_SHARED in str(report.longrepr)]
    if skipped:
        terminalreporter.write_line(f"{len(skipped)} tests skipped: {NO_SHARED}", yellow=True)
